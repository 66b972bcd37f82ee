// Finished scattering tables on disk, found again by everything that they were made from.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

#include "cloudbow/optics/scattering_table.hpp"

namespace cloudbow {

/// What a table takes long to find; the rest follows from it.
struct FittedValues {
  Eigen::MatrixXd points_from_ordinates;
  Eigen::VectorXd points_from_beam;
  FitReport report;
};

class TableCache {
 public:
  /// @param key text that holds every input of the table
  TableCache(std::filesystem::path directory, std::string key);

  /// Nothing where there is no such table, or a file that is damaged or belongs to another key.
  std::optional<FittedValues> load() const;
  /// Writes beside the target and renames, so that a reader never meets half a file. Failing is no error: the table is
  /// made again.
  void store(const FittedValues& values) const;

 private:
  std::filesystem::path file_;
  std::string key_;
};

}  // namespace cloudbow
