#include "les_coordinates.hpp"

#include <algorithm>
#include <cmath>

#include "text_tokens.hpp"

namespace cloudbow {
namespace {

/// 0, 1, 2, ... or 1, 2, 3, ..., upwards or downwards: more likely numbers of cells than positions. So are 0.5, 1.5,
/// 2.5, ... if no unit says that they are lengths.
bool counts_cells(const std::vector<double>& value, bool has_unit) {
  if (value.size() < 2) return false;
  const double least = std::min(value.front(), value.back());
  if (least != 0 && least != 1 && (has_unit || least != 0.5)) return false;
  const double step = value.back() > value.front() ? 1 : -1;
  for (std::size_t n = 1; n < value.size(); ++n) {
    if (value[n] - value[n - 1] != step) return false;
  }
  return true;
}

}  // namespace

double decimal_of(float value) { return number_in(fmt::format("{}", value)).value_or(value); }

const NetcdfVariable* coordinate_variable(const LesFile& file, const LesAxes& axes, std::size_t axis) {
  const std::string letter = axis_names[axis];
  for (const std::string& name : {axes[axis].name, letter, letter + "h"}) {  // CM1: xh, yh, zh on ni, nj, nk
    const NetcdfVariable* variable = file.input.find(name);
    if (variable != nullptr && !variable->dimension.empty() && variable->dimension.back() == axes[axis].name)
      return variable;
  }
  return nullptr;
}

LesCoordinates read_coordinates(LesFile& file, const LesAxes& axes, std::size_t a, const NetcdfVariable* variable) {
  const LesAxes::Axis& axis = axes[a];
  if (variable == nullptr) return {.problem = "found no variable of this name and length"};
  std::vector<std::size_t> start(variable->length.size(), 0), count = variable->length;
  if (count.size() == 2 && variable->dimension[0] == axes[3].name) {  // levels that a file repeats at every time
    start[0] = file.options.time;
    count[0] = 1;
  } else if (count.size() != 1) {
    return {.problem =
                fmt::format("'{}' is not a list of coordinates (found {} dimensions)", variable->name, count.size())};
  }
  if (count.back() != axis.length)
    return {.problem = fmt::format("'{}' has {} values for {} cells", variable->name, count.back(), axis.length)};
  std::vector<double> value = file.input.read(*variable, start, count);
  for (double& number : value) {
    if (!std::isfinite(number))
      file.fail("'{}': a coordinate is not finite or missing (found {})", variable->name, number);
    if (variable->is_float32) number = decimal_of(static_cast<float>(number));
  }
  const bool ascend = value.back() >= value.front();
  const std::string meaning = file.meaning(*variable);
  const auto means = [&](const char* word) { return meaning.find(word) != std::string::npos; };
  const bool point_down = a == 2 && (lower_case(file.input.text_attribute(*variable, "positive")) == "down" ||
                                     factor_of(pressure_units, variable->units) || means("sigma") || means("hybrid"));
  LesCoordinates found{.descend = point_down ? ascend && value.size() > 1 : !ascend};
  const auto known = factor_of(length_units, variable->units);
  if (!known && !variable->units.empty()) {
    found.problem = fmt::format("'{}' is in '{}' and not in a unit of length", variable->name, variable->units);
  } else if (point_down) {
    found.problem = fmt::format("'{}' grows downwards by its attributes", variable->name);
  } else if (!known && counts_cells(value, false)) {
    found.problem = fmt::format("'{}' has no unit and counts cells: {}, {}, ...", variable->name, value[0], value[1]);
  } else if (!known && a < 2 && axis_is_angle(variable->name)) {
    found.problem = fmt::format("'{}' has no unit and is an angle by its name", variable->name);
  } else if (!known && a == 2 && std::max(value.front(), value.back()) <= 1) {
    found.problem = fmt::format("'{}' has no unit and values up to 1", variable->name);
  }
  if (!found.problem.empty()) return found;
  found.count_cells = counts_cells(value, true);
  const double extent = std::abs(value.back() - value.front());
  const bool seems_km = extent < 0.5 * static_cast<double>(value.size());
  const double unit = file.factor(*variable, length_units, seems_km ? 1e3 : 1, seems_km ? "km" : "m");
  for (double& number : value) number *= unit;
  found.value = std::move(value);
  return found;
}

std::vector<double> read_degrees(const LesFile& file, const LesAxes& axes, std::size_t a,
                                 const NetcdfVariable& variable) {
  if (variable.length != std::vector<std::size_t>{axes[a].length} || !factor_of(angle_units, variable.units)) return {};
  std::vector<double> value = file.input.read(variable);
  if (value.size() > 1 && value.front() > value.back()) std::reverse(value.begin(), value.end());
  // Numbers of 32 bits carry rounding that is large beside steps of a hundred metres.
  const double rounding = variable.is_float32 ? 2.5e-7 * std::max(std::abs(value.front()), std::abs(value.back())) : 0;
  const double step = (value.back() - value.front()) / std::max(1.0, static_cast<double>(value.size() - 1));
  for (std::size_t n = 1; n < value.size(); ++n) {
    if (!(step > 0) || !(std::abs(value[n] - value[n - 1] - step) <= 1e-3 * step + rounding)) return {};
  }
  return value;
}

}  // namespace cloudbow
