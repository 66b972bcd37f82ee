// Dimensions of a variable of an LES file as axes x, y, z and time. Fields on their cells.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "les_file.hpp"

namespace cloudbow {

class LesAxes {
 public:
  struct Axis {
    bool is_there = false;
    std::string name{};
    std::size_t length = 1;
  };

  /// @throws InputError if a dimension is no axis, two are the same, or the file has no such time.
  LesAxes(LesFile& file, const NetcdfVariable& variable);

  /// 0 to 3: x, y, z, time.
  const Axis& operator[](std::size_t axis) const { return axes_[axis]; }
  std::size_t columns() const { return axes_[0].length * axes_[1].length; }

  /// Values along x, y or z descend in the file; fields are reversed when they are read.
  bool is_reversed(std::size_t axis) const { return is_reversed_[axis]; }
  void set_reversed(std::size_t axis, bool reversed) { is_reversed_[axis] = reversed; }

  /// Whether the variable has no other dimensions.
  bool holds(const NetcdfVariable& variable) const;
  /// The dimension that counts levels, or edges of levels; nothing if there is another that is no axis.
  std::optional<std::size_t> vertical_dimension(const NetcdfVariable& variable) const;
  /// Values [k][j][i] of the levels, or of their edges. The variable may lack any of the axes.
  /// @param levels length of the vertical axis, or one more for edges; 1 for a field without levels
  /// @param what the field, for messages. T is float or double.
  template <class T>
  std::vector<T> read(const NetcdfVariable& variable, std::size_t levels, const char* what) const;

 private:
  /// Part of a variable that belongs to the cells: its indices in the file, and steps between values by axis.
  struct Selection {
    std::vector<std::size_t> start, count;
    std::array<std::size_t, 3> stride{0, 0, 0};
    std::array<std::size_t, 3> dimension{none, none, none};
    static constexpr std::size_t none = 99;
  };
  static constexpr int single = 4;  // the role of a dimension of length 1 that is no axis

  void assign(const NetcdfVariable& variable);
  void check_time(const NetcdfVariable& variable);
  int axis_of_dimension(const std::string& dimension) const;
  /// Axis of a dimension of a variable, `single`, or -1.
  int role_of(const NetcdfVariable& variable, std::size_t n) const;
  Selection select(const NetcdfVariable& variable, std::size_t levels, const char* what) const;

  LesFile& file_;
  std::array<Axis, 4> axes_{};
  std::array<bool, 3> is_reversed_{};
};

}  // namespace cloudbow
