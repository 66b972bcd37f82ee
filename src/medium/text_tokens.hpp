// Text files of numbers, line by line.
#pragma once

#include <charconv>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "cloudbow/core/input_file.hpp"
#include "import_parts.hpp"

namespace cloudbow {

/// Words between blanks, tabs and commas.
inline std::vector<std::string_view> split_words(std::string_view line) {
  constexpr std::string_view separators = " \t\r,";
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(separators); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(separators, end);
  }
  return words;
}

/// The number that the whole word is; none where it is something else. "nan" and "inf" are numbers here.
inline std::optional<double> number_in(std::string_view word) {
  if (word.starts_with('+')) word.remove_prefix(1);
  double value = 0;
  const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
  if (error != std::errc() || end != word.data() + word.size()) return std::nullopt;
  return value;
}

class TextLines {
 public:
  explicit TextLines(const std::filesystem::path& path) : path_(path), stream_(open_input(path, "a text file")) {}

  /// False at the end of the file.
  bool next(std::string& line) {
    if (!std::getline(stream_, line)) return false;
    ++number_;
    return true;
  }

  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    throw InputError(fmt::format("{}:{}: {}", path_.string(), number_, fmt::format(text, std::forward<Args>(args)...)));
  }

  /// A line's words as numbers, at least so many.
  std::vector<double> numbers(const std::string& line, std::size_t least, const char* what) const {
    std::vector<double> value;
    for (const std::string_view word : split_words(line)) {
      const auto number = number_in(word);
      if (!number) break;
      value.push_back(*number);
    }
    if (value.size() < least) fail("{}: not {} numbers (found {})", what, least, value.size());
    return value;
  }

  /// An index from `first` to `first + count - 1`, brought to 0.
  int index(double number, int first, int count, const char* axis) const {
    if (!(number >= first && number < first + count) || number != std::floor(number)) {
      fail("index along {} out of range (found {}, allowed {} to {})", axis, number, first, first + count - 1);
    }
    return static_cast<int>(number) - first;
  }

  /// A value within a range, ends included.
  float in_range(double number, double low, double high, const char* what) const {
    if (!(number >= low && number <= high)) fail("{} is {} (allowed: {} to {})", what, number, low, high);
    return static_cast<float>(number);
  }

 private:
  std::filesystem::path path_;
  std::ifstream stream_;
  int number_ = 0;
};

inline constexpr double kLargestValue = 1e30;  // finite as a float, with room for sums

}  // namespace cloudbow
