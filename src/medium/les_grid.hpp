// Axes, columns and levels of an LES file, and fields on them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "les_file.hpp"

namespace cloudbow {

class LesGrid {
 public:
  /// Axes are the dimensions of this variable.
  LesGrid(LesFile& file, const NetcdfVariable& variable);

  std::size_t length(std::size_t axis) const { return axes_[axis].length; }
  const std::vector<double>& z_edge_m() const { return z_edge_m_; }
  /// Sizes and corner of the columns, edges of the levels; not the fields.
  LevelledCloud empty_cloud() const;

  /// Whether the variable has no other dimensions.
  bool holds(const NetcdfVariable& variable) const;
  /// Values on all cells, in the order of LevelledCloud, from a variable that may lack any of the axes.
  std::vector<float> read(const NetcdfVariable& variable, const char* what) const;
  /// "cell (i, j, k)" of an index into these values.
  std::string cell_text(std::size_t n) const;

 private:
  struct Axis {
    bool is_there = false;
    std::string name{};
    std::size_t length = 1;
  };
  /// Heights of one level after the other as the file has them, in m.
  struct Heights {
    std::string name;
    std::vector<double> value;
    bool are_edges = false;
  };
  /// A list of coordinates, or why it cannot be one in metres.
  struct Coordinates {
    std::vector<double> value;
    std::string problem;
    bool descend = false;
  };

  void assign_axes(const NetcdfVariable& variable);
  int axis_of_dimension(const std::string& dimension) const;
  void check_time(const NetcdfVariable& variable);
  Coordinates coordinates(std::size_t axis, const NetcdfVariable* variable);
  const NetcdfVariable* coordinate_variable(std::size_t axis) const;
  void set_columns(const NetcdfVariable& variable);
  void set_levels();
  std::optional<Heights> find_heights();
  std::vector<double> edges_by_bounds(const NetcdfVariable& variable) const;
  std::vector<double> level_means(const NetcdfVariable& variable, const NetcdfVariable* base) const;
  std::optional<std::size_t> vertical_dimension(const NetcdfVariable& variable) const;
  void set_levels_of_equal_size(double size, const std::string& instead_of);
  void check_counts() const;

  LesFile& file_;
  std::array<Axis, 4> axes_{};
  std::array<bool, 3> is_reversed_{};
  std::array<bool, 3> is_count_{};  ///< coordinates 0, 1, 2, ... or 1, 2, 3, ... that were taken for metres
  std::string height_problem_;      ///< of the coordinate of the vertical axis
  std::array<double, 2> size_m_{};
  std::array<double, 2> low_m_{};
  std::vector<double> z_edge_m_;
};

}  // namespace cloudbow
