// A picture of what a cloud holds, column by column.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

namespace cloudbow {

struct ColumnPlot {
  std::string title;
  std::string name;  ///< of the values
  std::string unit;  ///< "g m-2", "1"
  std::array<int, 2> columns{};
  std::array<double, 2> column_size_m{};
  std::array<double, 2> min_m{};
  std::vector<double> value;  ///< [j][i]
};

/// A map with x to the right, y up and a scale of colours; if there is one row or column only, a curve. PNG, SVG or
/// PDF.
/// @throws InputError if the file can't be written.
void write_column_plot(const std::filesystem::path& file, const ColumnPlot& plot);

}  // namespace cloudbow
