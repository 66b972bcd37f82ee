#include "io/number_rows.hpp"

#include <cmath>

#include "cloudbow/core/number_text.hpp"

namespace cloudbow {

std::optional<std::vector<double>> numbers_in(std::string_view line) {
  std::vector<double> numbers;
  for (const std::string_view word : split_words(line.substr(0, line.find_first_of("#!")))) {
    const auto number = number_in(word);
    if (!number || !std::isfinite(*number)) return std::nullopt;
    numbers.push_back(*number);
  }
  return numbers;
}

}  // namespace cloudbow
