#include "io/number_rows.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace cloudbow {

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

}  // namespace cloudbow
