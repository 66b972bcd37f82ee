// Columns and levels of an LES file, chosen from its coordinates, heights and the options, and fields on them.
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "les_heights.hpp"

namespace cloudbow {

class LesGrid {
 public:
  /// Axes are the dimensions of this variable.
  LesGrid(LesFile& file, const NetcdfVariable& variable);

  std::size_t length(std::size_t axis) const { return axes_[axis].length; }
  std::size_t columns() const { return axes_.columns(); }
  /// Length of the time axis, 1 if there is none.
  std::size_t times() const { return axes_[3].is_there ? axes_[3].length : 1; }
  const std::string& vertical_name() const { return axes_[2].name; }
  /// Whether heights differ from column to column.
  bool has_levels_of_columns() const { return !column_edge_m_.empty(); }
  /// Middle of the cell of a level and a column, i + nx j.
  double height_m(std::size_t level, std::size_t column) const;
  /// Height for which the file has the values of the cell: of its own coordinate, else the middle.
  double point_m(std::size_t level, std::size_t column) const;
  /// LevelledCloud::column_edge_m; heights are not known afterwards.
  std::vector<double> take_column_edges() { return std::move(column_edge_m_); }
  /// Sizes and corner of the columns, edges of the levels; not the fields.
  LevelledCloud empty_cloud() const;

  /// Whether the variable has no other dimensions.
  bool holds(const NetcdfVariable& variable) const { return axes_.holds(variable); }
  /// Values on all cells, in the order of LevelledCloud, from a variable that may lack any of the axes.
  std::vector<float> read(const NetcdfVariable& variable, const char* what) const;
  /// "cell (i, j, k)" of an index into these values.
  std::string cell_text(std::size_t n) const;

 private:
  void set_columns(const NetcdfVariable& variable);
  void set_sizes_by_degrees();
  void set_levels();
  void set_levels_of_equal_size(double size, const std::string& instead_of);
  void set_levels_of_columns(LesHeights& heights);
  void report_terrain(const std::string& heights) const;
  void check_counts() const;

  LesFile& file_;
  LesAxes axes_;
  std::array<bool, 3> is_count_{};  ///< coordinates 0, 1, 2, ... or 1, 2, 3, ... that were taken for metres
  std::array<double, 2> size_m_{};
  std::array<double, 2> low_m_{};
  std::vector<double> z_edge_m_;
  std::vector<double> point_m_;        ///< by level, empty if the file has edges alone
  std::vector<double> column_edge_m_;  ///< as in LevelledCloud
};

}  // namespace cloudbow
