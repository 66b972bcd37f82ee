// Coordinates along one axis of an LES file.
#pragma once

#include <string>
#include <vector>

#include "les_axes.hpp"

namespace cloudbow {

/// A list of coordinates in metres, or why it cannot be one.
struct LesCoordinates {
  std::vector<double> value{};  ///< m, in the order of the file; empty if there is a problem
  std::string problem{};
  bool descend = false;      ///< along z: whether the last level is the lowest
  bool count_cells = false;  ///< 0, 1, 2, ... or 1, 2, 3, ... although the unit is a length
};

/// The variable with the name of the axis, of its letter, or as CM1 names them; null if there is none.
const NetcdfVariable* coordinate_variable(const LesFile& file, const LesAxes& axes, std::size_t axis);

/// Coordinates of x, y or z. Without a unit, values that are likely lengths are taken for m or km, with a note.
/// @param variable may be null. @throws InputError if a value is missing or not finite.
LesCoordinates read_coordinates(LesFile& file, const LesAxes& axes, std::size_t axis, const NetcdfVariable* variable);

/// Values of an axis in degrees, ascending; empty if they are not degrees or not equally spaced.
std::vector<double> read_degrees(const LesFile& file, const LesAxes& axes, std::size_t axis,
                                 const NetcdfVariable& variable);

/// The decimal number that was stored as a float: 0.42 and not 0.41999998688697815.
double decimal_of(float value);

}  // namespace cloudbow
