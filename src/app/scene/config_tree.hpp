// A TOML file as a tree, each node with its line in the file. The command line can replace values.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <variant>
#include <vector>

namespace cloudbow {

struct ConfigNode {
  enum class Kind { scalar, array, table };
  struct OtherScalar {
    std::string text;  ///< a date or time, which no scene uses
  };
  using Scalar = std::variant<OtherScalar, bool, std::int64_t, double, std::string>;

  Kind kind = Kind::table;
  Scalar scalar;
  std::vector<std::string> keys;  ///< of a table, in the order of the file; keys[n] names items[n]
  std::vector<ConfigNode> items;  ///< of an array or a table
  std::string place;              ///< "FILE:LINE" or "--set KEY=VALUE"; how messages begin

  const ConfigNode* find(const std::string& key) const;
};

struct ConfigTree {
  ConfigNode root;
  std::string text;  ///< TOML of the same content: the file itself, or written anew if something was set
};

/// @param overrides "KEY=VALUE" with a dotted key ("sun.zenith_deg=30", "layer.0.optical_depth=2"); the value is TOML,
/// else a string. Missing tables of the key are created; entries of arrays must exist. @throws InputError if the file
/// cannot be read or is not TOML (with line and column); if an override cannot be applied.
ConfigTree read_config(const std::filesystem::path& path, std::span<const std::string> overrides);

/// The value of an override: TOML if it is one value, else a string. @throws InputError if it is nested too deeply.
ConfigNode config_value(const std::string& value, const std::string& place);

/// A node as messages show it: a number, a string in quotes, "a table", "an array of 3".
std::string describe(const ConfigNode& node);
/// A key as messages show it: as TOML writes it, shortened.
std::string describe_key(const std::string& key);

}  // namespace cloudbow
