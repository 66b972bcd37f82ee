#include "number_rows.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

#include "cloudbow/core/error.hpp"

namespace cloudbow {

std::ifstream open_text(const std::filesystem::path& file) {
  constexpr std::uintmax_t max_bytes = 256u << 20;
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) throw InputError(fmt::format("{}: there is no such file", file.string()));
  if (!std::filesystem::is_regular_file(status)) {
    throw InputError(fmt::format("{}: {} (allowed: a text file)", file.string(),
                                 std::filesystem::is_directory(status) ? "a directory" : "not a file"));
  }
  if (std::filesystem::file_size(file, error) > max_bytes) {
    throw InputError(fmt::format("{}: too large (allowed at most {} MB)", file.string(), max_bytes >> 20));
  }
  std::ifstream stream(file);
  if (!stream) throw InputError(fmt::format("{}: cannot be opened", file.string()));
  return stream;
}

std::optional<std::vector<double>> numbers_in(std::string_view line) {
  constexpr std::string_view separators = " \t\r,";
  line = line.substr(0, line.find_first_of("#!"));
  std::vector<double> numbers;
  for (std::size_t at = line.find_first_not_of(separators); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
    std::string word(line.substr(at, end - at));
    if (word.front() == '+') word.erase(0, 1);
    std::replace_if(
        word.begin(), word.end(), [](char c) { return c == 'D' || c == 'd'; }, 'e');
    double number = 0;
    const auto [stop, failure] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (failure != std::errc() || stop != word.data() + word.size() || !std::isfinite(number)) return std::nullopt;
    numbers.push_back(number);
    at = line.find_first_not_of(separators, end);
  }
  return numbers;
}

std::string printable(std::string_view text) {
  std::string shown(text.substr(0, 80));
  for (char& c : shown) {
    if (c < 0x20 || c > 0x7e) c = '?';
  }
  return shown;
}

}  // namespace cloudbow
