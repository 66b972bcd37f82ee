#include "plots/figure_text.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

#include "cloudbow/core/printable.hpp"

namespace cloudbow {

namespace {

constexpr std::string_view minus = "\u2212";

std::string raised(std::string_view exponent) {
  const bool negative = exponent.starts_with('-');
  return fmt::format("<sup>{}{}</sup>", negative ? minus : "", exponent.substr(negative ? 1 : 0));
}

/// One factor of a unit: letters, then perhaps an exponent.
std::string factor_text(std::string_view factor) {
  std::size_t letters = 0;
  while (letters < factor.size() && std::isalpha(static_cast<unsigned char>(factor[letters])) != 0) ++letters;
  const std::string_view name = factor.substr(0, letters), exponent = factor.substr(letters);
  const bool is_exponent =
      !exponent.empty() && exponent.find_first_not_of("0123456789", exponent[0] == '-' ? 1 : 0) == std::string::npos;
  const std::string symbol = name == "um" ? "\u00b5m" : name == "degree" ? "\u00b0" : plain_text(name);
  return symbol + (is_exponent && letters > 0 ? raised(exponent) : plain_text(exponent));
}

}  // namespace

std::string plain_text(std::string_view text) {
  std::string line(text), marked;
  std::replace_if(
      line.begin(), line.end(), [](char c) { return c == '\n' || c == '\t' || c == '\r'; }, ' ');
  for (const char c : printable(line)) {
    switch (c) {
      case '&':
        marked += "&amp;";
        break;
      case '<':
        marked += "&lt;";
        break;
      case '>':
        marked += "&gt;";
        break;
      default:
        marked += c;
    }
  }
  return marked;
}

std::string unit_text(std::string_view unit) {
  if (unit == "1") return "";
  std::string marked;
  while (!unit.empty()) {
    const std::size_t end = unit.find(' ');
    // A thin space that breaks no line.
    if (!marked.empty()) marked += "\u202f";
    marked += factor_text(unit.substr(0, end));
    unit = end == std::string_view::npos ? "" : unit.substr(end + 1);
  }
  return marked;
}

std::string power_of_ten(int exponent) { return "10" + raised(fmt::format("{}", exponent)); }

std::string labelled_with_unit(std::string_view name, std::string_view unit, int factor) {
  const std::string power = factor == 0 ? "" : power_of_ten(factor), printed = unit_text(unit);
  if (power.empty() && printed.empty()) return plain_text(name);
  return fmt::format("{} [{}{}{}]", plain_text(name), power, power.empty() || printed.empty() ? "" : "\u202f", printed);
}

std::string number_text(double value, int decimals) {
  std::string text = fmt::format("{:.{}f}", value, decimals);
  if (!text.starts_with('-')) return text;
  text.erase(0, 1);
  // Rounded to nothing, it has no sign.
  return text.find_first_not_of("0.") == std::string::npos ? text : std::string(minus) + text;
}

}  // namespace cloudbow
