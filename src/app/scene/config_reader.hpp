// Typed, checked access to one table of a scene file. Every message reads "FILE:LINE: key: problem (found X, allowed
// Y)".
#pragma once

#include <array>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "app/scene/config_tree.hpp"

namespace cloudbow {

/// Numbers that a key allows. Infinity and nan never are.
struct NumberRange {
  const char* allowed;  ///< as messages say it
  double low;
  double high;
  bool low_included = true;
  bool high_included = true;

  bool contains(double value) const;
};

inline constexpr NumberRange finite{"any finite number", -1e300, 1e300};
inline constexpr NumberRange positive{"> 0", 0, 1e300, false, true};
inline constexpr NumberRange not_negative{">= 0", 0, 1e300};
inline constexpr NumberRange fraction{"0 to 1", 0, 1};

/// Which entry of lists that have one for each wavelength.
struct SpectralPlace {
  std::size_t index = 0;
  std::size_t count = 0;  ///< wavelengths of the scene; 0: it has no spectrum, and lists are errors
};

class ConfigReader {
 public:
  /// @param path the table's dotted name, empty for the root.
  ConfigReader(const ConfigNode& table, std::string path);

  /// Complains about the first key of the table that is none of `known`, and about those of `not_available`: their
  /// meaning is fixed, but nothing here can do it yet.
  void check_keys(const std::vector<std::string>& known, const std::vector<std::string>& not_available = {}) const;

  const ConfigNode* find(const std::string& key) const { return table_.find(key); }
  bool has(const std::string& key) const { return find(key) != nullptr; }
  const std::string& place() const { return table_.place; }
  /// The table's dotted name.
  const std::string& path() const { return path_; }
  /// Location of the key, or that of the table if the key is absent.
  const std::string& place_of(const std::string& key) const;

  /// Functions find_... return nothing if the key is absent; the others then throw InputError.
  std::optional<double> find_number(const std::string& key, const NumberRange& range) const;
  double number(const std::string& key, const NumberRange& range) const;
  bool flag(const std::string& key, bool otherwise) const;
  std::optional<int> find_integer(const std::string& key, int low, int high) const;
  /// A number for all wavelengths, or the entry of a list with one for each.
  std::optional<double> find_number(const std::string& key, const NumberRange& range, SpectralPlace at) const;
  double number(const std::string& key, const NumberRange& range, SpectralPlace at) const;
  std::optional<std::string> find_text(const std::string& key) const;
  std::string text(const std::string& key) const;
  /// As the spectral find_number(); all strings of the list, or the only one.
  std::vector<std::string> spectral_texts(const std::string& key, SpectralPlace at) const;
  /// One of `allowed`.
  std::optional<std::string> find_choice(const std::string& key, const std::vector<std::string>& allowed) const;
  std::optional<std::vector<double>> find_numbers(const std::string& key, const NumberRange& range) const;
  std::optional<std::array<double, 3>> find_triple(const std::string& key, const NumberRange& range) const;
  std::optional<std::vector<std::string>> find_texts(const std::string& key) const;
  std::optional<ConfigReader> find_table(const std::string& key) const;
  /// Returns the entries of an array of tables, named "key.0", "key.1", ...; none if the key is absent.
  std::vector<ConfigReader> tables(const std::string& key) const;

  [[noreturn]] void fail(const std::string& key, std::string_view problem, std::string_view found,
                         std::string_view allowed) const;
  [[noreturn]] void fail_missing(const std::string& key, std::string_view allowed) const;
  /// Runs `action` and puts the key's location in front of its InputError.
  void with_place(const std::string& key, const std::function<void()>& action) const;

  std::string full_name(const std::string& key) const { return (path_.empty() ? "" : path_ + ".") + describe_key(key); }

 private:
  double as_number(const std::string& key, const ConfigNode& node, const NumberRange& range) const;
  void check_spectral_list(const std::string& key, const ConfigNode& list, SpectralPlace at) const;

  const ConfigNode& table_;
  std::string path_;
};

}  // namespace cloudbow
