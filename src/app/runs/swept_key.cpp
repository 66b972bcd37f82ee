#include "app/runs/swept_key.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <optional>
#include <set>
#include <string_view>
#include <utility>
#include <variant>

#include "app/scene/config_tree.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

constexpr std::size_t most_values = 10000;
constexpr const char* allowed_lists = "KEY=VALUE,VALUE,... or KEY=FIRST:LAST:STEP";

/// Names of coordinates, variables, groups and attributes of results that are also last parts of keys.
constexpr std::array<std::string_view, 20> taken{
    "x",       "y",      "z",       "bound",     "file",          "name",           "mode",
    "air",     "method", "cloud",   "gas_model", "optical_depth", "control_points", "directions",
    "thermal", "solver", "band_um", "radiance",  "wavelength_um", "error_estimate"};

[[noreturn]] void fail(const std::string& assignment, const std::string& problem) {
  throw InputError(fmt::format("--set {}: {}", assignment.substr(0, 200), problem));
}

/// Parts between separators that are neither in quotes nor in brackets.
struct SplitText {
  std::vector<std::string> parts{std::string()};
  bool is_balanced = true;  ///< each quote and each bracket has its partner
};

SplitText split_text(const std::string& text, char separator) {
  SplitText split;
  char quote = 0;
  int depth = 0;
  bool escaped = false;
  for (const char c : text) {
    if (quote != 0) {
      if (c == quote && !escaped) quote = 0;
      escaped = c == '\\' && quote == '"' && !escaped;
    } else if (c == '"' || c == '\'') {
      quote = c;
    } else if (c == '[' || c == '{') {
      ++depth;
    } else if (c == ']' || c == '}') {
      split.is_balanced = split.is_balanced && --depth >= 0;
    } else if (c == separator && depth == 0) {
      split.parts.emplace_back();
      continue;
    }
    split.parts.back() += c;
  }
  split.is_balanced = split.is_balanced && depth == 0 && quote == 0;
  return split;
}

std::vector<std::string> split(const std::string& text, char separator) { return split_text(text, separator).parts; }

std::string trimmed(const std::string& text) {
  const auto begin = text.find_first_not_of(" \t");
  if (begin == std::string::npos) return "";
  return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
}

std::optional<double> number_of(const std::string& text) {
  double value = 0;
  const char* const first = text.data() + (text.starts_with('+') ? 1 : 0);
  const auto [end, error] = std::from_chars(first, text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size() || !std::isfinite(value)) return std::nullopt;
  return value;
}

/// Digits after the point; none: the number has an exponent.
std::optional<int> decimals(const std::string& text) {
  if (text.find_first_of("eE") != std::string::npos) return std::nullopt;
  const auto point = text.find('.');
  return point == std::string::npos ? 0 : static_cast<int>(text.size() - point - 1);
}

/// Numbers of "FIRST:LAST:STEP"; none: the text is no range.
std::optional<std::vector<std::string>> range_of(const std::string& assignment, const std::string& text) {
  const std::vector<std::string> parts = split(text, ':');
  if (parts.size() != 3) return std::nullopt;
  std::array<double, 3> number{};
  for (std::size_t n = 0; n < 3; ++n) {
    const std::optional<double> value = number_of(trimmed(parts[n]));
    if (!value) return std::nullopt;
    number[n] = *value;
  }
  const auto [first, last, step] = number;
  if (step == 0 || (last - first) * step < 0) {
    fail(assignment,
         fmt::format("a range without end (found {}, allowed FIRST:LAST:STEP whose STEP leads to LAST)", text));
  }
  // A last step that falls short by rounding alone is a step.
  const double steps = std::floor((last - first) / step * (1 + 1e-12) + 1e-9);
  if (steps >= static_cast<double>(most_values))
    fail(assignment, fmt::format("a range too long (found {:.10g} values, allowed {})", steps + 1, most_values));
  const std::optional<int> of_first = decimals(trimmed(parts[0])), of_step = decimals(trimmed(parts[2]));
  std::vector<std::string> values;
  for (int n = 0; n <= static_cast<int>(steps); ++n) {
    const double value = first + n * step;
    values.push_back(of_first && of_step ? fmt::format("{:.{}f}", value, std::max(*of_first, *of_step))
                                         : fmt::format("{}", value));
  }
  return values;
}

bool are_numbers(const std::vector<std::string>& parts) {
  return std::all_of(parts.begin(), parts.end(), [](const std::string& part) { return number_of(trimmed(part)); });
}

/// Refuses numbers between separators of other lists: "0:60", "0 30".
void check_separators(const std::string& assignment, const std::string& item) {
  if (const auto parts = split(item, ':'); parts.size() > 1 && are_numbers(parts))
    fail(assignment, fmt::format("a range has FIRST:LAST:STEP (found {}, allowed as in 0:60:20)", item));
  std::vector<std::string> words = split(item, ' ');
  std::erase(words, "");
  if (words.size() > 1 && are_numbers(words))
    fail(assignment, fmt::format("commas separate values (found {}, allowed {})", item, fmt::join(words, ",")));
}

}  // namespace

SweptKey parse_swept_key(const std::string& assignment) {
  const auto equals = assignment.find('=');
  if (equals == std::string::npos || equals == 0)
    throw InputError(fmt::format("--set: found '{}', allowed {}", assignment.substr(0, 200), allowed_lists));
  SweptKey swept{trimmed(assignment.substr(0, equals)), {}};
  const std::string list = assignment.substr(equals + 1);
  const auto& [items, is_balanced] = split_text(list, ',');
  if (!is_balanced && list.find(',') != std::string::npos)
    fail(assignment, fmt::format("a quote or bracket without its partner (found {}, allowed pairs; a text with one "
                                 "stands in quotes of the other kind)",
                                 trimmed(list).substr(0, 200)));
  swept.is_list = items.size() > 1;
  for (const std::string& untrimmed : items) {
    const std::string item = trimmed(untrimmed);
    if (item.empty()) fail(assignment, fmt::format("an empty value (allowed {})", allowed_lists));
    if (const auto range = range_of(assignment, item)) {
      swept.is_list = true;
      swept.values.insert(swept.values.end(), range->begin(), range->end());
    } else {
      check_separators(assignment, item);
      swept.values.push_back(item);
    }
  }
  check_values(swept);
  return swept;
}

void check_values(const SweptKey& swept) {
  const auto refuse = [&swept](const std::string& problem) {
    throw InputError(fmt::format("{}: {}", swept.key, problem));
  };
  if (swept.values.empty()) refuse("an empty list (allowed one value or more)");
  if (swept.values.size() > most_values)
    refuse(fmt::format("too many values (found {}, allowed {})", swept.values.size(), most_values));
  const CoordinateValues values = coordinate_values(swept);
  std::set<std::pair<double, std::string>> seen;
  for (std::size_t n = 0; n < swept.values.size(); ++n) {
    // The scene refuses it. Here it has no order.
    if (values.texts.empty() && std::isnan(values.numbers[n])) continue;
    const bool repeated =
        values.texts.empty() ? !seen.emplace(values.numbers[n], "").second : !seen.emplace(0, values.texts[n]).second;
    if (repeated) refuse(fmt::format("a value twice (found {}, allowed each once)", swept.values[n]));
  }
}

CoordinateValues coordinate_values(const SweptKey& key) {
  CoordinateValues values;
  for (const std::string& text : key.values) {
    const ConfigNode node = config_value(text, fmt::format("--set {}", key.key));
    if (const auto* integer = std::get_if<std::int64_t>(&node.scalar)) {
      values.numbers.push_back(static_cast<double>(*integer));
    } else if (const auto* real = std::get_if<double>(&node.scalar)) {
      values.numbers.push_back(*real);
    }
    const auto* const word = std::get_if<std::string>(&node.scalar);
    values.texts.push_back(node.kind == ConfigNode::Kind::scalar && word != nullptr ? *word : text);
  }
  if (values.numbers.size() == values.texts.size()) {
    values.texts.clear();
  } else {
    values.numbers.clear();
  }
  return values;
}

std::vector<std::string> dimension_names(std::span<const SweptKey> keys) {
  const auto last_part = [](const std::string& key) { return key.substr(key.rfind('.') + 1); };
  std::vector<std::string> names;
  for (const SweptKey& key : keys) {
    std::string name = last_part(key.key);
    const auto alike =
        std::count_if(keys.begin(), keys.end(), [&](const SweptKey& other) { return last_part(other.key) == name; });
    const bool is_taken = std::find(taken.begin(), taken.end(), name) != taken.end();
    if (alike > 1 || is_taken) name = key.key;
    // A table or list of the first level ("cloud") has no longer name.
    if (is_taken && name.find('.') == std::string::npos) name += "_of_scene";
    // A name that the user chose is part of the key of a phase function; / would separate groups.
    std::replace_if(
        name.begin(), name.end(), [](char c) { return c == '.' || c == '/'; }, '_');
    while (std::find(names.begin(), names.end(), name) != names.end()) name += "_2";
    names.push_back(std::move(name));
  }
  return names;
}

std::string units_of_key(const std::string& key) {
  constexpr std::array<std::pair<std::string_view, const char*>, 14> endings{{{"_w_m2_sr", "W m-2 sr-1"},
                                                                              {"_w_m2", "W m-2"},
                                                                              {"_g_m3", "g m-3"},
                                                                              {"_g_m2", "g m-2"},
                                                                              {"_m_s", "m s-1"},
                                                                              {"_deg", "degree"},
                                                                              {"_um", "um"},
                                                                              {"_km", "km"},
                                                                              {"_m", "m"},
                                                                              {"_pa", "Pa"},
                                                                              {"_ppm", "1e-6"},
                                                                              {"_ppb", "1e-9"},
                                                                              {"_k", "K"},
                                                                              {"_percent", "percent"}}};
  for (const auto& [ending, units] : endings) {
    if (key.ends_with(ending)) return units;
  }
  return "1";
}

}  // namespace cloudbow
