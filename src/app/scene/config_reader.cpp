#include "app/scene/config_reader.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "app/process/suggestion.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {

bool NumberRange::contains(double value) const {
  return std::isfinite(value) && (low_included ? value >= low : value > low) &&
         (high_included ? value <= high : value < high);
}

namespace {

/// The end of a message. A setting of the command line may be a list of numbers or a range.
const char* hint_of_list(const ConfigNode& node) {
  const auto* text = std::get_if<std::string>(&node.scalar);
  const bool is_list = node.kind == ConfigNode::Kind::scalar && text != nullptr && node.place.starts_with("--set") &&
                       text->find_first_not_of("0123456789+-.eE,: ") == std::string::npos &&
                       text->find_first_of(",:") != std::string::npos;
  return is_list ? "; `cloudbow sweep` takes lists" : "";
}

/// The tables of a table, or of the first entries of its arrays, that have this key: "sun.zenith_deg".
std::string found_below(const ConfigNode& table, const std::string& key) {
  for (std::size_t n = 0; n < table.items.size(); ++n) {
    const ConfigNode& item = table.items[n];
    if (item.kind == ConfigNode::Kind::table && item.find(key) != nullptr)
      return fmt::format("{}.{}", table.keys[n], key);
    if (item.kind == ConfigNode::Kind::array && !item.items.empty() && item.items.front().find(key) != nullptr)
      return fmt::format("{}.0.{}", table.keys[n], key);
  }
  return "";
}

}  // namespace

ConfigReader::ConfigReader(const ConfigNode& table, std::string path) : table_(table), path_(std::move(path)) {}

const std::string& ConfigReader::place_of(const std::string& key) const {
  const ConfigNode* node = table_.find(key);
  return node != nullptr ? node->place : table_.place;
}

void ConfigReader::fail(const std::string& key, std::string_view problem, std::string_view found,
                        std::string_view allowed) const {
  throw InputError(
      fmt::format("{}: {}: {} (found {}, allowed {})", place_of(key), full_name(key), problem, found, allowed));
}

void ConfigReader::fail_missing(const std::string& key, std::string_view allowed) const {
  fail(key, "missing", "no such key", allowed);
}

void ConfigReader::with_place(const std::string& key, const std::function<void()>& action) const {
  try {
    action();
  } catch (const InputError& error) {
    throw InputError(fmt::format("{}: {}: {}", place_of(key), full_name(key), error.what()));
  }
}

double ConfigReader::as_number(const std::string& key, const ConfigNode& node, const NumberRange& range) const {
  double value = 0;
  if (const auto* real = std::get_if<double>(&node.scalar); real != nullptr && node.kind == ConfigNode::Kind::scalar) {
    value = *real;
  } else if (const auto* integer = std::get_if<std::int64_t>(&node.scalar);
             integer != nullptr && node.kind == ConfigNode::Kind::scalar) {
    value = static_cast<double>(*integer);
  } else {
    const bool is_text = node.kind == ConfigNode::Kind::scalar && std::holds_alternative<std::string>(node.scalar);
    fail(key, "not a number", describe(node),
         fmt::format("{}{}", range.allowed,
                     *hint_of_list(node) != 0 ? hint_of_list(node)
                     : is_text                ? "; numbers stand without quotes"
                                              : ""));
  }
  if (!range.contains(value)) fail(key, "out of range", describe(node), range.allowed);
  if (std::fpclassify(value) == FP_SUBNORMAL) {
    fail(key, "too small for its digits", describe(node), fmt::format("{}, 0 or from 2.3e-308 on", range.allowed));
  }
  return value;
}

std::optional<double> ConfigReader::find_number(const std::string& key, const NumberRange& range) const {
  const ConfigNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  return as_number(key, *node, range);
}

double ConfigReader::number(const std::string& key, const NumberRange& range) const {
  const auto value = find_number(key, range);
  if (!value) fail_missing(key, range.allowed);
  return *value;
}

void ConfigReader::check_spectral_list(const std::string& key, const ConfigNode& list, SpectralPlace at) const {
  if (at.count == 0) fail(key, "a list without [spectrum]", describe(list), "one value, or [spectrum] wavelengths_um");
  if (list.items.size() != at.count) {
    fail(key, "not one for each wavelength", describe(list),
         fmt::format("one value, or a list of {} as spectrum.wavelengths_um is", at.count));
  }
}

std::optional<double> ConfigReader::find_number(const std::string& key, const NumberRange& range,
                                                SpectralPlace at) const {
  const ConfigNode* node = find(key);
  if (node == nullptr || node->kind != ConfigNode::Kind::array) return find_number(key, range);
  check_spectral_list(key, *node, at);
  return as_number(key, node->items[at.index], range);
}

double ConfigReader::number(const std::string& key, const NumberRange& range, SpectralPlace at) const {
  const auto value = find_number(key, range, at);
  if (!value) fail_missing(key, range.allowed);
  return *value;
}

std::vector<std::string> ConfigReader::spectral_texts(const std::string& key, SpectralPlace at) const {
  const ConfigNode* node = find(key);
  if (node == nullptr || node->kind != ConfigNode::Kind::array) return {text(key)};
  check_spectral_list(key, *node, at);
  return *find_texts(key);
}

std::optional<int> ConfigReader::find_integer(const std::string& key, int low, int high) const {
  const ConfigNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  const std::string allowed = fmt::format("an integer from {} to {}", low, high);
  const auto* value = std::get_if<std::int64_t>(&node->scalar);
  if (node->kind != ConfigNode::Kind::scalar || value == nullptr)
    fail(key, "not an integer", describe(*node), allowed + hint_of_list(*node));
  if (*value < low || *value > high) fail(key, "out of range", describe(*node), allowed);
  return static_cast<int>(*value);
}

std::optional<std::string> ConfigReader::find_text(const std::string& key) const {
  const ConfigNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  const auto* value = std::get_if<std::string>(&node->scalar);
  if (node->kind != ConfigNode::Kind::scalar || value == nullptr)
    fail(key, "not a string", describe(*node), "a string");
  return *value;
}

std::string ConfigReader::text(const std::string& key) const {
  auto value = find_text(key);
  if (!value) fail_missing(key, "a string");
  if (value->empty()) fail(key, "empty", "\"\"", "a string that is not empty");
  return *value;
}

std::optional<std::string> ConfigReader::find_choice(const std::string& key,
                                                     const std::vector<std::string>& allowed) const {
  auto value = find_text(key);
  if (value && std::find(allowed.begin(), allowed.end(), *value) == allowed.end()) {
    fail(key, "not one of the choices", describe(*table_.find(key)), candidates_for(*value, allowed));
  }
  return value;
}

std::optional<std::vector<double>> ConfigReader::find_numbers(const std::string& key, const NumberRange& range) const {
  const ConfigNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (node->kind != ConfigNode::Kind::array) fail(key, "not a list", describe(*node), "a list of numbers");
  std::vector<double> values;
  for (const ConfigNode& item : node->items) values.push_back(as_number(key, item, range));
  return values;
}

std::optional<std::array<double, 3>> ConfigReader::find_triple(const std::string& key, const NumberRange& range) const {
  const auto values = find_numbers(key, range);
  if (!values) return std::nullopt;
  if (values->size() != 3) fail(key, "not of length 3", describe(*table_.find(key)), "[x, y, z]");
  return std::array<double, 3>{(*values)[0], (*values)[1], (*values)[2]};
}

std::optional<std::vector<std::string>> ConfigReader::find_texts(const std::string& key) const {
  const ConfigNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (node->kind != ConfigNode::Kind::array) fail(key, "not a list", describe(*node), "a list of strings");
  std::vector<std::string> values;
  for (const ConfigNode& item : node->items) {
    const auto* value = std::get_if<std::string>(&item.scalar);
    if (item.kind != ConfigNode::Kind::scalar || value == nullptr) fail(key, "not a string", describe(item), "strings");
    values.push_back(*value);
  }
  return values;
}

bool ConfigReader::flag(const std::string& key, bool otherwise) const {
  const ConfigNode* node = find(key);
  if (node == nullptr) return otherwise;
  const auto* value = std::get_if<bool>(&node->scalar);
  if (node->kind != ConfigNode::Kind::scalar || value == nullptr)
    fail(key, "neither true nor false", describe(*node), "true, false");
  return *value;
}

std::optional<ConfigReader> ConfigReader::find_table(const std::string& key) const {
  const ConfigNode* node = find(key);
  if (node == nullptr) return std::nullopt;
  if (node->kind != ConfigNode::Kind::table)
    fail(key, "not a table", describe(*node), fmt::format("[{}]", full_name(key)));
  return ConfigReader(*node, full_name(key));
}

std::vector<ConfigReader> ConfigReader::tables(const std::string& key) const {
  std::vector<ConfigReader> readers;
  const ConfigNode* node = find(key);
  if (node == nullptr) return readers;
  const std::string allowed = fmt::format("[[{}]]", full_name(key));
  if (node->kind != ConfigNode::Kind::array) fail(key, "not an array of tables", describe(*node), allowed);
  for (const ConfigNode& item : node->items) {
    if (item.kind != ConfigNode::Kind::table) fail(key, "not an array of tables", describe(item), allowed);
    readers.emplace_back(item, fmt::format("{}.{}", full_name(key), readers.size()));
  }
  return readers;
}

void ConfigReader::check_keys(const std::vector<std::string>& known,
                              const std::vector<std::string>& not_available) const {
  for (const std::string& key : table_.keys) {
    if (std::find(known.begin(), known.end(), key) != known.end()) continue;
    if (std::find(not_available.begin(), not_available.end(), key) != not_available.end()) {
      throw InputError(fmt::format("{}: {}: not available in this version", place_of(key), full_name(key)));
    }
    const std::string below = path_.empty() ? found_below(table_, key) : "";
    fail(key, "unknown key", describe_key(key),
         below.empty() ? candidates_for(key, known)
                       : fmt::format("{}; did you mean {}?", fmt::join(known, ", "), below));
  }
}

}  // namespace cloudbow
