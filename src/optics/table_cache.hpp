// Fitted columns on disk, found again by everything that they were made from.
#pragma once

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

class TableCache {
 public:
  /// @param directory empty: nothing is found and nothing stored
  /// @param key text that holds every input of the columns
  TableCache(const std::filesystem::path& directory, std::string key);

  /// Nothing if there is no such entry, or something else of its name: a directory, a pipe, a file that is damaged or
  /// belongs to another key.
  std::optional<FittedColumns> load() const;
  /// A reader never sees an incomplete file. Failing is no error: the table is made again.
  void store(const FittedColumns& columns) const;

 private:
  std::filesystem::path file_;  // empty: no cache
  std::string key_;
};

}  // namespace cloudbow
