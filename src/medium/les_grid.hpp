// Axes, columns and levels of an LES file, and fields on them.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "les_file.hpp"

namespace cloudbow {

class LesGrid {
 public:
  /// Axes are the dimensions of this variable.
  LesGrid(LesFile& file, const NetcdfVariable& variable);

  std::size_t length(std::size_t axis) const { return axes_[axis].length; }
  std::size_t columns() const { return axes_[0].length * axes_[1].length; }
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
  /// Heights of one level after the other as the file has them, in m; means over the columns if these differ.
  struct Heights {
    std::string name;
    std::vector<double> value;
    bool are_edges = false;
    std::vector<double> of_columns_m{};  ///< [level][j][i] in the order of the file, if columns differ
  };
  /// Part of a variable that belongs to the cells: its place in the file, and steps between values by axis.
  struct Selection {
    std::vector<std::size_t> start, count;
    std::array<std::size_t, 3> stride{0, 0, 0};
    std::array<std::size_t, 3> dimension{none, none, none};
    static constexpr std::size_t none = 99;
  };
  static constexpr int single = 4;  // the role of a dimension of length 1 that is no axis
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
  Heights field_of_heights(const std::string& name, const NetcdfVariable& variable, const NetcdfVariable* base,
                           double unit_m) const;
  void set_levels_of_columns(Heights& heights);
  void report_terrain(const std::string& heights) const;
  void set_sizes_by_degrees();
  std::vector<double> degrees(std::size_t axis, const NetcdfVariable& variable) const;
  /// Axis of a dimension of a variable, `single`, or -1.
  int role_of(const NetcdfVariable& variable, std::size_t n) const;
  Selection select(const NetcdfVariable& variable, std::size_t levels, const char* what) const;
  template <class T>
  std::vector<T> gather(const NetcdfVariable& variable, std::size_t levels, const char* what) const;
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
  std::vector<double> point_m_;        ///< by level, empty if the file has edges alone
  std::vector<double> column_edge_m_;  ///< as in LevelledCloud
};

}  // namespace cloudbow
