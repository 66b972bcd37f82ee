#include "cloudbow/core/number_text.hpp"

#include <algorithm>
#include <charconv>
#include <string>

namespace cloudbow {

std::vector<std::string_view> split_words(std::string_view line) {
  constexpr std::string_view separators = " \t\r,";
  std::vector<std::string_view> words;
  for (std::size_t at = line.find_first_not_of(separators); at != std::string_view::npos;) {
    const std::size_t end = std::min(line.find_first_of(separators, at), line.size());
    words.push_back(line.substr(at, end - at));
    at = line.find_first_not_of(separators, end);
  }
  return words;
}

std::optional<double> number_in(std::string_view word) {
  if (word.starts_with('+')) {
    word.remove_prefix(1);
    if (word.starts_with('-')) return std::nullopt;
  }
  std::string plain(word);
  if (const auto at = plain.find_first_of("dD"); at != std::string::npos && at > 0) plain[at] = 'e';
  double value = 0;
  const auto [end, error] = std::from_chars(plain.data(), plain.data() + plain.size(), value);
  if (error != std::errc() || end != plain.data() + plain.size()) return std::nullopt;
  return value;
}

}  // namespace cloudbow
