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
#include "cloudbow/core/number_text.hpp"
#include "import_parts.hpp"

namespace cloudbow {

/// Blank, or a comment.
inline bool is_comment(std::string_view line) {
  const auto at = line.find_first_not_of(" \t\r,");
  return at == std::string_view::npos || line[at] == '#';
}

/// Meaning of a word of Fortran's list-directed output: "3*280" is 280 three times.
struct RepeatedNumber {
  std::size_t count;
  double value;
};

inline constexpr std::size_t most_repeats = 1000000;

inline std::optional<RepeatedNumber> repeated_number_in(std::string_view word) {
  std::size_t count = 1;
  if (const auto star = word.find('*'); star != std::string_view::npos) {
    const auto [end, error] = std::from_chars(word.data(), word.data() + star, count);
    if (error != std::errc() || end != word.data() + star || count < 1 || count > most_repeats) return std::nullopt;
    word.remove_prefix(star + 1);
  }
  const auto value = number_in(word);
  return value ? std::optional(RepeatedNumber{count, *value}) : std::nullopt;
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
      const auto number = repeated_number_in(word);
      if (!number) break;
      if (number->count > 1 && value.size() + number->count > most_repeats) {
        fail("{}: too many numbers (found \"{}\", allowed {} in a line with repeat counts)", what, word, most_repeats);
      }
      value.insert(value.end(), number->count, number->value);
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

inline constexpr double largest_number = 1e30;  // finite as a float, with room for sums

}  // namespace cloudbow
