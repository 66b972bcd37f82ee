#include "app/process/toml_hint.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>

namespace cloudbow {
namespace {

constexpr std::string_view blanks = " \t\r";
constexpr std::size_t longest_value = 60;  // bytes of a value in a message

std::string_view trimmed(std::string_view text) {
  const auto first = text.find_first_not_of(blanks);
  if (first == std::string_view::npos) return {};
  return text.substr(first, text.find_last_not_of(blanks) - first + 1);
}

bool begins_with_digit(std::string_view text) {
  const auto first = text.find_first_not_of("+-");
  return first != std::string_view::npos && std::isdigit(static_cast<unsigned char>(text[first])) != 0;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(), [](unsigned char c) { return std::tolower(c); });
  return result;
}

std::string hint_of_number(std::string_view value) {
  if (value.find_first_not_of("0123456789+-.") == std::string_view::npos)
    return "a number has digits on both sides of its point, and no zeros in front: 0.5";
  if (value.find_first_not_of("0123456789+-.eE \t") == std::string_view::npos)
    return "several numbers stand in brackets, with commas: [0.5, 0.6]";
  return "a number stands alone, with a point and without its unit, which the key names: 0.5";
}

std::string hint_of_value(std::string_view value, std::string_view key) {
  if (value.empty()) return "the value is missing";
  if (value.front() == '=') return "a line is KEY = VALUE";
  if (value.starts_with("\xe2\x80")) return "quotes of TOML are straight: \" or '";
  if (value.front() == '"' && value.find('\\') != std::string_view::npos)
    return "in \"...\" a backslash is an escape; in '...' it stands for itself";
  if (value.front() == '"' || value.front() == '\'')
    return value.size() > 1 && value.back() == value.front() ? "" : "a string ends with the quote that it begins with";
  const std::string word = lower(value);
  if (word == "true" || word == "false") return fmt::format("true and false are written in small letters: {}", word);
  if (begins_with_digit(value) || (value.front() == '.' && begins_with_digit(value.substr(1))))
    return hint_of_number(value);
  const bool printable = std::none_of(value.begin(), value.end(), [](unsigned char c) { return std::iscntrl(c) != 0; });
  if (value.front() == '[' || value.front() == '{' || value.size() > longest_value || !printable)
    return "text stands in quotes";
  return fmt::format("text stands in quotes: {}\"{}\"", key.empty() ? "" : fmt::format("{} = ", key), value);
}

}  // namespace

std::string toml_hint(std::string_view problem, std::string_view line, std::size_t column) {
  const auto says = [problem](std::string_view words) { return problem.find(words) != std::string_view::npos; };
  if (says("redefine") && (trimmed(line).starts_with("[cloud]") || trimmed(line).starts_with("[[cloud]]")))
    return "clouds stand in [cloud] alone, or [[cloud]] for each constituent";
  if (says("redefine")) return "each key and each [table] stands once";
  if (says("expected '='")) return "a line is KEY = VALUE";
  if (says("table header") || (says("parsing key:") && trimmed(line).starts_with('[')))
    return "a table begins with its name in brackets: [sun]";
  const auto equals = line.find('=');
  const std::string_view key = equals == std::string_view::npos ? "" : trimmed(line.substr(0, equals));
  const std::size_t after_key = equals == std::string_view::npos ? 0 : equals + 1;
  if (after_key >= column) return "a line is KEY = VALUE";

  // The value that the fault is in, or of a list the item; a list may have begun on an earlier line.
  const std::string_view all = trimmed(line.substr(after_key));
  const bool in_list = key.empty() || all.starts_with('[') || all.starts_with('{');
  const auto opened = line.substr(0, column - 1).find_last_of("[{,");
  const std::size_t begin = in_list && opened != std::string_view::npos ? opened + 1 : after_key;
  const std::string_view rest = line.substr(begin);
  return hint_of_value(trimmed(rest.substr(0, rest.find_first_of(in_list ? ",]}#" : "#"))), in_list ? "" : key);
}

}  // namespace cloudbow
