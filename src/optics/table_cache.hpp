// Fitted columns on disk, found again by everything that they were made from.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "cloudbow/optics/scattering_table.hpp"

namespace cloudbow {

/// The part of a table that takes long to compute; the rest follows from it.
struct FittedColumns {
  Eigen::MatrixXd value;  ///< control points x columns
  FitReport report;       ///< of these columns: programmes, fallbacks, least value, error
};

/// Some hundred tables of the most accurate level.
inline constexpr std::uintmax_t most_cached_bytes = 500000000;

/// Removes tables from a folder until it holds no more than that many bytes of them. Those that were not used for the
/// longest time go first. Other files and tables that cannot be removed stay.
void bound_cache(const std::filesystem::path& directory, std::uintmax_t most_bytes);

class TableCache {
 public:
  /// @param directory empty: nothing is found and nothing stored
  /// @param key text that holds every input of the columns
  TableCache(const std::filesystem::path& directory, std::string key);

  /// Nothing if there is no such entry, or something else of its name: a directory, a pipe, a file that is damaged or
  /// belongs to another key.
  std::optional<FittedColumns> load() const;
  /// A reader never sees an incomplete file. Failing is no error: the table is made again. Tables that were not used
  /// for the longest time are removed if the folder holds more than most_cached_bytes of them.
  void store(const FittedColumns& columns) const;

 private:
  std::filesystem::path file_;  // empty: no cache
  std::string key_;
};

}  // namespace cloudbow
