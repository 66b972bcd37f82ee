#include "app/scene/config_tree.hpp"

#include <fmt/format.h>

// A table header without a key ("[&]") fails a check of toml++'s own. Without NDEBUG it would end the program; with it,
// the compiler may assume that it holds. The parser refuses such text a few lines later.
#undef NDEBUG
#define TOML_ASSERT(condition) static_assert(true)
#include <toml++/toml.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <memory>
#include <sstream>
#include <type_traits>
#include <utility>

#include "app/scene/toml_depth.hpp"
#include "app/scene/toml_hint.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"

namespace cloudbow {
namespace {

// Scenes are small; a larger file is no scene.
constexpr std::uintmax_t max_bytes = 4u << 20;
constexpr std::size_t longest_place = 200;  // bytes of a --set in a message

/// A kind of file that users pass instead of a scene by mistake: its first bytes, its name and the remedy.
struct OtherFile {
  std::string_view begin, found, way_out;
};
constexpr std::string_view import =
    "; `cloudbow cloud import` makes a cloud of a model's output, for [cloud] of a scene";
constexpr std::string_view encoding = "; save it as UTF-8";
constexpr std::array<OtherFile, 8> other_files{{{" BDV", "an OpenVDB file", "; a scene names it: file in [cloud]"},
                                                {"\x89HDF", "an HDF5 or netCDF-4 file", import},
                                                {"CDF\x01", "a netCDF file", import},
                                                {"CDF\x02", "a netCDF file", import},
                                                {"CDF\x05", "a netCDF file", import},
                                                {"\x89PNG", "a PNG picture", ""},
                                                {"\xff\xfe", "text in UTF-16", encoding},
                                                {"\xfe\xff", "text in UTF-16", encoding}}};

std::string read_text(const std::filesystem::path& path) {
  const auto fail = [&](std::string_view found, std::string_view way_out = "") {
    throw InputError(fmt::format("{}: cannot be read as a scene (found {}, allowed a TOML file of at most {} MB){}",
                                 path.string(), found, max_bytes >> 20, way_out));
  };
  if (const std::string reason = unreadable_reason(path); !reason.empty()) fail(reason);
  std::ifstream stream = open_input(path, "a TOML file");
  std::error_code error;
  std::string text(std::min<std::uintmax_t>(std::filesystem::file_size(path, error), max_bytes + 1), '\0');
  stream.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (!stream) fail("a file that may not be read");
  for (const OtherFile& other : other_files)
    if (text.starts_with(other.begin)) fail(other.found, other.way_out);
  if (text.size() > max_bytes) fail("a larger file");
  return text;
}

[[noreturn]] void fail_too_deep(const std::string& place) {
  throw InputError(
      fmt::format("{}: nested too deeply (found more than {} levels of keys, lists and tables, allowed {})", place,
                  max_toml_depth, max_toml_depth));
}

/// @param number from 1
std::string_view line_of(std::string_view text, std::size_t number) {
  for (std::size_t n = 1; n < number; ++n) text.remove_prefix(std::min(text.find('\n'), text.size() - 1) + 1);
  return text.substr(0, text.find('\n'));
}

/// The parser and the functions that traverse its tree recurse: some ten thousand levels overflow the stack.
void check_depth(const std::string& text, const std::string& file) {
  if (const auto line = first_line_too_deep(text)) fail_too_deep(fmt::format("{}:{}", file, *line));
}

ConfigNode convert(const toml::node& node, const std::string& place_of_file) {
  ConfigNode result;
  const auto line = node.source().begin.line;
  result.place =
      place_of_file.starts_with("--set") || line == 0 ? place_of_file : fmt::format("{}:{}", place_of_file, line);
  if (const auto* table = node.as_table()) {
    result.kind = ConfigNode::Kind::table;
    std::vector<std::pair<toml::source_position, const toml::key*>> order;
    for (const auto& [key, value] : *table) order.emplace_back(key.source().begin, &key);
    std::stable_sort(order.begin(), order.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    for (const auto& [position, key] : order) {
      result.keys.emplace_back(key->str());
      result.items.push_back(convert(*table->get(*key), place_of_file));
      // A table that a deeper header made has no line of its own.
      if (position.line != 0 && !place_of_file.starts_with("--set")) {
        result.items.back().place = fmt::format("{}:{}", place_of_file, position.line);
      }
    }
  } else if (const auto* array = node.as_array()) {
    result.kind = ConfigNode::Kind::array;
    for (const auto& item : *array) result.items.push_back(convert(item, place_of_file));
  } else {
    result.kind = ConfigNode::Kind::scalar;
    if (const auto boolean = node.value_exact<bool>()) {
      result.scalar = *boolean;
    } else if (const auto integer = node.value_exact<std::int64_t>()) {
      result.scalar = *integer;
    } else if (const auto real = node.value_exact<double>()) {
      result.scalar = *real;
    } else if (const auto text = node.value_exact<std::string>()) {
      result.scalar = *text;
    } else {
      std::ostringstream other;
      node.visit([&other](const auto& value) { other << value; });
      result.scalar = ConfigNode::OtherScalar{other.str()};
    }
  }
  return result;
}

/// For messages, as the two below.
std::string quoted(const std::string& text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') {
      result += '\\';
      result += c;
    } else if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      result += fmt::format("\\u{:04X}", static_cast<unsigned>(c));
    } else {
      result += c;
    }
  }
  return result + '"';
}

std::string scalar_text(const ConfigNode::Scalar& scalar) {
  struct Writer {
    std::string operator()(const ConfigNode::OtherScalar& other) const { return other.text; }
    std::string operator()(bool value) const { return value ? "true" : "false"; }
    std::string operator()(std::int64_t value) const { return std::to_string(value); }
    std::string operator()(double value) const {
      std::string text = fmt::format("{}", value);
      const bool looks_integer = text.find_first_not_of("0123456789-") == std::string::npos;
      return looks_integer ? text + ".0" : text;
    }
    std::string operator()(const std::string& value) const { return quoted(value); }
  };
  return std::visit(Writer{}, scalar);
}

std::string key_text(const std::string& key) {
  const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), [](unsigned char c) {
    return c < 0x80 && (std::isalnum(c) != 0 || c == '_' || c == '-');
  });
  return bare ? key : quoted(key);
}

/// For messages.
std::string shortened(const std::string& text) { return text.size() <= 80 ? text : text.substr(0, 77) + "..."; }

template <class Value>
std::unique_ptr<toml::node> scalar_node(const Value& value) {
  return std::make_unique<toml::value<Value>>(value);
}

std::unique_ptr<toml::node> scalar_node(const ConfigNode::OtherScalar& other) {
  const toml::table parsed = toml::parse(fmt::format("value = {}", other.text));
  return parsed.get("value")->visit([](const auto& value) -> std::unique_ptr<toml::node> {
    return std::make_unique<std::decay_t<decltype(value)>>(value);
  });
}

/// The other way round from convert().
std::unique_ptr<toml::node> toml_node(const ConfigNode& node) {
  if (node.kind == ConfigNode::Kind::table) {
    auto table = std::make_unique<toml::table>();
    for (std::size_t n = 0; n < node.items.size(); ++n)
      table->insert_or_assign(node.keys[n], std::move(*toml_node(node.items[n])));
    return table;
  }
  if (node.kind == ConfigNode::Kind::array) {
    auto array = std::make_unique<toml::array>();
    for (const ConfigNode& item : node.items) array->push_back(std::move(*toml_node(item)));
    return array;
  }
  return std::visit([](const auto& value) { return scalar_node(value); }, node.scalar);
}

/// TOML in which each value is written so that it reads back as the same bits.
std::string toml_text(const ConfigNode& root) {
  const std::unique_ptr<toml::node> node = toml_node(root);
  std::ostringstream text;
  text << toml::toml_formatter(*node, toml::format_flags::allow_unicode_strings) << '\n';
  return text.str();
}

/// "VALUE" as TOML if it is one value, else as a string.
ConfigNode parse_override_value(const std::string& value, const std::string& place) {
  try {
    const toml::table parsed = toml::parse(fmt::format("value = {}", value), place);
    if (parsed.size() == 1) return convert(*parsed.get("value"), place);
  } catch (const toml::parse_error&) {
  }
  ConfigNode node;
  node.kind = ConfigNode::Kind::scalar;
  node.scalar = value;
  node.place = place;
  return node;
}

void apply_override(ConfigNode& root, const std::string& assignment) {
  const std::string shown = assignment.substr(0, longest_place);
  const bool printable = std::none_of(shown.begin(), shown.end(), [](unsigned char c) { return std::iscntrl(c) != 0; });
  const std::string place = fmt::format("--set {}", printable ? shown : quoted(shown));
  const auto equals = assignment.find('=');
  std::vector<std::string> parts;
  std::istringstream key(assignment.substr(0, equals));
  for (std::string part; std::getline(key, part, '.');) parts.push_back(part);
  const bool has_empty_part = std::any_of(parts.begin(), parts.end(), [](const auto& part) { return part.empty(); });
  if (equals == std::string::npos || parts.empty() || has_empty_part) {
    throw InputError(
        fmt::format("--set: found '{}', allowed KEY=VALUE with a dotted key, as in sun.zenith_deg=30", shown));
  }
  const std::string value = assignment.substr(equals + 1);
  if (parts.size() > max_toml_depth || first_line_too_deep(fmt::format("value = {}", value))) fail_too_deep(place);

  ConfigNode* node = &root;
  std::string path;
  for (const std::string& part : parts) {
    path += (path.empty() ? "" : ".") + part;
    if (node->kind == ConfigNode::Kind::array) {
      std::size_t index = 0;
      const auto [end, error] = std::from_chars(part.data(), part.data() + part.size(), index);
      if (error != std::errc() || end != part.data() + part.size() || index >= node->items.size()) {
        throw InputError(fmt::format("{}: {}: no such entry (found {}, allowed 0 to {})", place, path, part,
                                     static_cast<std::int64_t>(node->items.size()) - 1));
      }
      node = &node->items[index];
    } else if (node->kind == ConfigNode::Kind::table) {
      const auto known = std::find(node->keys.begin(), node->keys.end(), part);
      const auto index = static_cast<std::size_t>(known - node->keys.begin());
      if (known == node->keys.end()) {
        node->keys.push_back(part);
        node->items.emplace_back();
        node->items.back().place = place;
      }
      node = &node->items[index];
    } else {
      throw InputError(
          fmt::format("{}: {}: goes below a value (found {} above it, allowed a table)", place, path, describe(*node)));
    }
  }
  *node = parse_override_value(value, place);
}

}  // namespace

const ConfigNode* ConfigNode::find(const std::string& key) const {
  const auto found = std::find(keys.begin(), keys.end(), key);
  return found == keys.end() ? nullptr : &items[static_cast<std::size_t>(found - keys.begin())];
}

std::string describe_key(const std::string& key) { return shortened(key_text(key)); }

std::string describe(const ConfigNode& node) {
  if (node.kind == ConfigNode::Kind::table) return "a table";
  if (node.kind == ConfigNode::Kind::array) return fmt::format("an array of {}", node.items.size());
  return shortened(scalar_text(node.scalar));
}

ConfigTree read_config(const std::filesystem::path& path, std::span<const std::string> overrides) {
  ConfigTree tree;
  tree.text = read_text(path);
  check_depth(tree.text, path.string());
  try {
    const toml::table table = toml::parse(std::string_view(tree.text), std::string_view(path.native()));
    tree.root = convert(table, path.string());
  } catch (const toml::parse_error& error) {
    const auto& begin = error.source().begin;
    const std::string hint = toml_hint(error.description(), line_of(tree.text, begin.line), begin.column);
    throw InputError(fmt::format("{}:{}:{}: not valid TOML ({}){}", path.string(), begin.line, begin.column,
                                 error.description(), hint.empty() ? "" : "; " + hint));
  }
  tree.root.place = path.string();
  for (const std::string& assignment : overrides) apply_override(tree.root, assignment);
  if (!overrides.empty()) tree.text = toml_text(tree.root);
  return tree;
}

}  // namespace cloudbow
