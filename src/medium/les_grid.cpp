#include "les_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

#include "text_tokens.hpp"

namespace cloudbow {
namespace {

/// 0, 1, 2, ... or 1, 2, 3, ..., upwards or downwards: more likely numbers of cells than places. So are 0.5, 1.5, 2.5,
/// ... if no unit says that they are lengths.
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

/// The lowest level last, and the reverse.
void reverse_levels(std::vector<double>& value, std::size_t columns) {
  const std::size_t levels = value.size() / columns;
  for (std::size_t k = 0; k < levels / 2; ++k) {
    const auto low = value.begin() + static_cast<std::ptrdiff_t>(k * columns);
    const auto high = value.begin() + static_cast<std::ptrdiff_t>((levels - 1 - k) * columns);
    std::swap_ranges(low, low + static_cast<std::ptrdiff_t>(columns), high);
  }
}

/// The number that was meant: 0.42 for the float next to it, not 0.41999998688697815.
double decimal_of(float value) { return number_in(fmt::format("{}", value)).value_or(value); }

}  // namespace

LesGrid::LesGrid(LesFile& file, const NetcdfVariable& variable) : file_(file) {
  assign_axes(variable);
  check_time(variable);
  set_columns(variable);
  set_levels();
  check_counts();
}

LevelledCloud LesGrid::empty_cloud() const {
  LevelledCloud cloud;
  cloud.nx = static_cast<int>(axes_[0].length);
  cloud.ny = static_cast<int>(axes_[1].length);
  cloud.dx_m = size_m_[0];
  cloud.dy_m = size_m_[1];
  cloud.x_min_m = low_m_[0];
  cloud.y_min_m = low_m_[1];
  cloud.z_edge_m = z_edge_m_;
  return cloud;
}

double LesGrid::height_m(std::size_t level, std::size_t column) const {
  if (column_edge_m_.empty()) return 0.5 * (z_edge_m_[level] + z_edge_m_[level + 1]);
  const std::size_t n = column + columns() * level;
  return 0.5 * (column_edge_m_[n] + column_edge_m_[n + columns()]);
}

std::string LesGrid::cell_text(std::size_t n) const {
  const std::size_t nx = axes_[0].length, ny = axes_[1].length;
  return fmt::format("cell ({}, {}, {})", n % nx, n / nx % ny, n / nx / ny);
}

// -- axes ---------------------------------------------------------------------------------------------------------

void LesGrid::assign_axes(const NetcdfVariable& variable) {
  const std::size_t rank = variable.length.size();
  if (rank < 1 || rank > 4) {
    file_.fail(
        "'{}': wrong number of dimensions (found {}, allowed z; z, x; z, y, x; with or without time) cut one out, as "
        "'ncks -d' does",
        variable.name, rank);
  }
  std::vector<int> role(rank, -1);
  for (std::size_t n = 0; n < rank; ++n) role[n] = axis_of_dimension(variable.dimension[n]);
  // Names without meaning get the customary order: (time, z, y, x), the last of them first.
  for (std::size_t n = 0; n < rank; ++n) {
    if (role[n] >= 0) continue;
    const int customary = static_cast<int>(rank - 1 - n);
    const std::string lower = lower_case(variable.dimension[n]);
    if (lower == "ncells" || lower == "cell" || lower == "ncell" || lower == "cells") {
      file_.fail(
          "'{}': dimension '{}' counts the cells of an unstructured grid (allowed: y and x) bring the file onto "
          "longitudes and latitudes, as 'cdo remapcon,TARGET' does",
          variable.name, variable.dimension[n]);
    }
    if (rank < 3 || std::find(role.begin(), role.end(), customary) != role.end()) {
      file_.fail(
          "'{}': dimension '{}' is none that is known (allowed: say which with --x-axis, --y-axis, --z-axis, "
          "--time-axis)",
          variable.name, variable.dimension[n]);
    }
    role[n] = customary;
    file_.note("GUESSED axis: dimension '{}' is {}", variable.dimension[n],
               axis_names[static_cast<std::size_t>(customary)]);
  }
  for (std::size_t n = 0; n < rank; ++n) {
    auto& axis = axes_[static_cast<std::size_t>(role[n])];
    if (axis.is_there) {
      file_.fail("'{}': dimensions '{}' and '{}' are both taken for {} (allowed: say which with --{}-axis)",
                 variable.name, axis.name, variable.dimension[n], axis_names[static_cast<std::size_t>(role[n])],
                 axis_names[static_cast<std::size_t>(role[n])]);
    }
    axis = {true, variable.dimension[n], variable.length[n]};
  }
  if (!axes_[2].is_there)
    file_.fail("'{}': no vertical dimension (found only others; say which with --z-axis)", variable.name);
  for (std::size_t a = 0; a < 3; ++a) {
    if (axes_[a].is_there && axes_[a].length == 0)
      file_.fail("axis '{}' has length 0 (allowed: at least 1)", axes_[a].name);
  }
  check_import_size(file_.options, static_cast<double>(axes_[0].length), static_cast<double>(axes_[1].length),
                    static_cast<double>(axes_[2].length));
}

int LesGrid::axis_of_dimension(const std::string& dimension) const {
  const auto& given = file_.options.axes;
  for (std::size_t a = 0; a < 4; ++a) {
    if (!given[a].empty() && given[a] == dimension) return static_cast<int>(a);
  }
  const int guess = axis_of_name(dimension);
  return guess >= 0 && !given[static_cast<std::size_t>(guess)].empty() ? -1 : guess;
}

void LesGrid::check_time(const NetcdfVariable& variable) {
  const Axis& time = axes_[3];
  const std::size_t wanted = file_.options.time;
  if (!time.is_there) {
    if (wanted > 0) file_.fail("'{}' has no time axis (found --time {}, allowed 0)", variable.name, wanted);
    return;
  }
  if (time.length == 0)
    file_.fail("time axis '{}' has length 0: there is no field in the file (allowed: at least 1)", time.name);
  if (wanted >= time.length) {
    file_.fail("--time is beyond the time axis '{}' (found {}, allowed 0 to {})", time.name, wanted, time.length - 1);
  }
  if (time.length > 1) file_.note("time: {} of 0 to {} on '{}'", wanted, time.length - 1, time.name);
}

// -- coordinates --------------------------------------------------------------------------------------------------

const NetcdfVariable* LesGrid::coordinate_variable(std::size_t axis) const {
  const std::string letter = axis_names[axis];
  for (const std::string& name : {axes_[axis].name, letter, letter + "h"}) {  // CM1: xh, yh, zh on ni, nj, nk
    const NetcdfVariable* variable = file_.input.find(name);
    if (variable != nullptr && !variable->dimension.empty() && variable->dimension.back() == axes_[axis].name)
      return variable;
  }
  return nullptr;
}

LesGrid::Coordinates LesGrid::coordinates(std::size_t a, const NetcdfVariable* variable) {
  const Axis& axis = axes_[a];
  if (variable == nullptr) return {{}, fmt::format("found no variable of this name and length"), false};
  std::vector<std::size_t> start(variable->length.size(), 0), count = variable->length;
  if (count.size() == 2 && variable->dimension[0] == axes_[3].name) {  // levels that a file repeats at every time
    start[0] = file_.options.time;
    count[0] = 1;
  } else if (count.size() != 1) {
    return {{},
            fmt::format("'{}' is not a list of coordinates (found {} dimensions)", variable->name, count.size()),
            false};
  }
  if (count.back() != axis.length)
    return {{}, fmt::format("'{}' has {} values for {} cells", variable->name, count.back(), axis.length), false};
  std::vector<double> value = file_.input.read(*variable, start, count);
  for (double& number : value) {
    if (!std::isfinite(number))
      file_.fail("'{}': a coordinate is not finite or missing (found {})", variable->name, number);
    if (variable->is_float32) number = decimal_of(static_cast<float>(number));
  }
  const bool ascend = value.back() >= value.front();
  const std::string meaning = file_.meaning(*variable);
  const auto means = [&](const char* word) { return meaning.find(word) != std::string::npos; };
  const bool point_down = a == 2 && (lower_case(file_.input.text_attribute(*variable, "positive")) == "down" ||
                                     factor_of(pressure_units, variable->units) || means("sigma") || means("hybrid"));
  Coordinates found{{}, "", point_down ? ascend && value.size() > 1 : !ascend};
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
  is_count_[a] = counts_cells(value, true);
  const double extent = std::abs(value.back() - value.front());
  const bool seems_km = extent < 0.5 * static_cast<double>(value.size());
  const double unit = file_.factor(*variable, length_units, seems_km ? 1e3 : 1, seems_km ? "km" : "m");
  for (double& number : value) number *= unit;
  found.value = std::move(value);
  return found;
}

void LesGrid::set_columns(const NetcdfVariable& variable) {
  const auto& given = file_.options.voxel_size_m;
  std::array<std::string, 2> problem;
  for (std::size_t a = 0; a < 2; ++a) {
    const Axis& axis = axes_[a];
    if (!axis.is_there || axis.length == 1) {
      problem[a] = "found one cell alone";
      if (given) size_m_[a] = (*given)[a];
      continue;
    }
    const NetcdfVariable* coordinate = coordinate_variable(a);
    if (given && coordinate == nullptr) {
      size_m_[a] = (*given)[a];
      continue;
    }
    Coordinates centre = coordinates(a, coordinate);
    is_reversed_[a] = centre.descend;
    if (given) {
      size_m_[a] = (*given)[a];
      is_count_[a] = false;
      const bool differ = centre.value.empty() ||
                          std::abs(std::abs(centre.value[1] - centre.value[0]) - size_m_[a]) > 1e-3 * size_m_[a];
      if (differ) {
        file_.note("columns: {:.6g} m along {}, as --voxel-size-m says, in place of '{}'", size_m_[a], axis_names[a],
                   coordinate->name);
      }
      continue;
    }
    if (centre.value.empty()) {
      problem[a] = centre.problem;
      // WRF has no coordinates in metres.
      const bool is_wrf = axis.name == "west_east" || axis.name == "south_north" ||
                          (file_.model != nullptr && std::string_view(file_.model->name) == "wrf");
      const auto spacing = file_.input.global_number(a == 0 ? "DX" : "DY");
      if (!is_wrf || !spacing || !(*spacing > 0)) continue;
      size_m_[a] = *spacing;
      file_.note("columns: {:.6g} m along {}, as the file's attribute {} says", *spacing, axis_names[a],
                 a == 0 ? "DX" : "DY");
      continue;
    }
    if (is_reversed_[a]) {
      std::reverse(centre.value.begin(), centre.value.end());
      file_.note("columns: '{}' descends, the field is turned so that {} ascends", coordinate->name, axis_names[a]);
    }
    size_m_[a] = uniform_spacing(file_.options.file, axis.name, centre.value);
    low_m_[a] = centre.value.front() - 0.5 * size_m_[a];
  }
  if (!given) set_sizes_by_degrees();
  // A single row or column is as wide as the other way.
  for (std::size_t a = 0; a < 2; ++a) {
    if (size_m_[a] == 0 && axes_[a].length == 1) size_m_[a] = size_m_[1 - a];
  }
  if (!axes_[0].is_there && !axes_[1].is_there && !(size_m_[0] > 0)) {
    file_.fail(
        "'{}' is a profile (found no axis but {}, allowed y and x beside it) name another with --variable, or "
        "give the width of its one column with --voxel-size-m; fields in the file: {}",
        variable.name, axes_[2].name, file_.fields_there());
  }
  for (std::size_t a = 0; a < 2; ++a) {
    if (!(size_m_[a] > 0)) {
      file_.fail("no coordinates of '{}' in metres ({}, allowed m, km) give --voxel-size-m",
                 axes_[a].name.empty() ? axis_names[a] : axes_[a].name, problem[a]);
    }
  }
}

/// Values of an axis in degrees, ascending; empty if they are not degrees or not equally spaced.
std::vector<double> LesGrid::degrees(std::size_t a, const NetcdfVariable& variable) const {
  if (variable.length != std::vector<std::size_t>{axes_[a].length} || !factor_of(angle_units, variable.units))
    return {};
  std::vector<double> value = file_.input.read(variable);
  if (value.size() > 1 && value.front() > value.back()) std::reverse(value.begin(), value.end());
  // Numbers of 32 bits carry rounding that is large beside steps of a hundred metres.
  const double rounding = variable.is_float32 ? 2.5e-7 * std::max(std::abs(value.front()), std::abs(value.back())) : 0;
  const double step = (value.back() - value.front()) / std::max(1.0, static_cast<double>(value.size() - 1));
  for (std::size_t n = 1; n < value.size(); ++n) {
    if (!(step > 0) || !(std::abs(value[n] - value[n - 1] - step) <= 1e-3 * step + rounding)) return {};
  }
  return value;
}

/// Longitudes and latitudes, of the globe or of a rotated pole, become metres at the mean latitude.
void LesGrid::set_sizes_by_degrees() {
  constexpr double earth_m = 6371229;  // radius in ICON, COSMO and IFS
  constexpr double to_radian = std::numbers::pi / 180;
  if (size_m_[0] > 0 || size_m_[1] > 0) return;
  const NetcdfVariable *of_x = coordinate_variable(0), *of_y = coordinate_variable(1);
  if (of_x == nullptr || of_y == nullptr) return;
  const std::vector<double> longitude = degrees(0, *of_x), latitude = degrees(1, *of_y);
  if (longitude.size() < 2 || latitude.size() < 2) return;
  const double mean = 0.5 * (latitude.front() + latitude.back()), width = std::cos(mean * to_radian);
  const double narrowest = std::min(std::cos(latitude.front() * to_radian), std::cos(latitude.back() * to_radian));
  constexpr double allowed = 0.02;
  if (!(narrowest > (1 - allowed) * width)) {
    file_.fail(
        "'{}': columns differ in width by more than {} (found latitudes {:.6g} to {:.6g}) cut out a smaller domain, or "
        "give --voxel-size-m",
        of_y->name, allowed, latitude.front(), latitude.back());
  }
  const auto metres = [&](const std::vector<double>& value) {
    return (value.back() - value.front()) / static_cast<double>(value.size() - 1) * to_radian * earth_m;
  };
  size_m_ = {metres(longitude) * width, metres(latitude)};
  low_m_ = {0, 0};
  file_.note("columns: {:.6g} x {:.6g} m, from '{}' and '{}' in degrees at the mean latitude {:.6g}, from 0 on",
             size_m_[0], size_m_[1], of_x->name, of_y->name, mean);
  for (std::size_t a = 0; a < 2; ++a) {
    if (is_reversed_[a]) file_.note("columns: the field is turned so that {} ascends", axis_names[a]);
  }
}

/// Lengths that are 0, 1, 2, ... along all axes count cells, whatever the unit.
void LesGrid::check_counts() const {
  if (!is_count_[2]) return;
  for (std::size_t a = 0; a < 2; ++a) {
    if (axes_[a].length > 1 && !is_count_[a]) return;
  }
  file_.fail(
      "coordinates count cells (found 0, 1, 2, ... or 1, 2, 3, ... along all axes, allowed heights and places in m or "
      "km) give --voxel-size-m DX DY DZ");
}

// -- levels -------------------------------------------------------------------------------------------------------

/// "height_2" counts the same cells as "height" if there are as many.
static std::string stem_of(const std::string& name) {
  const auto end = name.find_last_not_of("0123456789");
  return end != std::string::npos && name[end] == '_' ? name.substr(0, end) : name;
}

int LesGrid::role_of(const NetcdfVariable& variable, std::size_t n) const {
  const std::string& name = variable.dimension[n];
  const std::size_t length = variable.length[n];
  for (std::size_t a = 0; a < axes_.size(); ++a) {
    if (axes_[a].is_there && axes_[a].name == name && axes_[a].length == length) return static_cast<int>(a);
  }
  if (stem_of(name) == stem_of(axes_[2].name) && length == axes_[2].length) return 2;
  return length == 1 ? single : -1;
}

/// The dimension that counts levels, or edges of levels; nothing if there is another that is no axis.
std::optional<std::size_t> LesGrid::vertical_dimension(const NetcdfVariable& variable) const {
  std::optional<std::size_t> vertical;
  for (std::size_t n = 0; n < variable.length.size(); ++n) {
    const int role = role_of(variable, n);
    if (role >= 0 && role != 2) continue;
    const bool may_be = role == 2 || variable.length[n] == axes_[2].length + 1;
    if (!may_be || vertical) return std::nullopt;
    vertical = n;
  }
  return vertical;
}

/// Heights of levels from a field, the sum of two variables if there is a base. They may descend.
LesGrid::Heights LesGrid::field_of_heights(const std::string& name, const NetcdfVariable& variable,
                                           const NetcdfVariable* base, double unit_m) const {
  const std::size_t levels = variable.length[*vertical_dimension(variable)], count = columns();
  const auto values = [&](const NetcdfVariable& of) {
    std::vector<double> value = gather<double>(of, levels, "heights");
    for (const double z : value) {
      if (!std::isfinite(z)) file_.fail("'{}': a height is not finite or missing (found {})", of.name, z);
    }
    return value;
  };
  std::vector<double> height = values(variable);
  if (base != nullptr) {
    const std::vector<double> more = values(*base);
    for (std::size_t n = 0; n < height.size(); ++n) height[n] += more[n];
  }
  if (is_reversed_[2]) reverse_levels(height, count);  // as it is in the file
  std::vector<double> mean(levels, 0);
  std::vector<bool> is_flat(levels, true);
  for (std::size_t k = 0; k < levels; ++k) {
    const auto begin = height.begin() + static_cast<std::ptrdiff_t>(k * count);
    const auto end = begin + static_cast<std::ptrdiff_t>(count);
    for (auto z = begin; z != end; ++z) mean[k] += *z / static_cast<double>(count);
    const auto [lowest, highest] = std::minmax_element(begin, end);
    const double spacing = levels == 1 || k == 0 ? INFINITY : std::abs(mean[k] - mean[k - 1]);
    // Flat to the rounding of 32-bit numbers, and of the sum of two.
    const double rounding = 2.5e-7 * std::max(std::abs(*lowest), std::abs(*highest));
    is_flat[k] = *highest - *lowest <= std::max(std::isfinite(spacing) ? 1e-6 * spacing : 0, rounding);
    if (*highest == *lowest) mean[k] = *lowest;  // without the rounding of the sum
  }
  Heights heights{name, {}, levels == axes_[2].length + 1};
  const bool are_flat = std::all_of(is_flat.begin(), is_flat.end(), [](bool flat) { return flat; });
  for (const double z : mean) {
    const bool is_decimal = base == nullptr && variable.is_float32 && are_flat;
    heights.value.push_back(unit_m * (is_decimal ? decimal_of(static_cast<float>(z)) : z));
  }
  if (are_flat || levels == 1) return heights;
  for (double& z : height) z *= unit_m;
  heights.of_columns_m = std::move(height);
  return heights;
}

/// Edges of cells, in m, by the attribute "bounds" of CF: lower and upper edge of each cell. Empty if the file has
/// none, or they do not meet.
std::vector<double> LesGrid::edges_by_bounds(const NetcdfVariable& variable) const {
  const auto unit = factor_of(length_units, variable.units);
  const NetcdfVariable* bounds = file_.input.find(file_.input.text_attribute(variable, "bounds"));
  const std::size_t levels = axes_[2].length;
  if (!unit || bounds == nullptr || bounds->length != std::vector<std::size_t>{levels, 2}) return {};
  std::vector<double> bound = file_.input.read(*bounds);
  for (double& z : bound) z = *unit * (bounds->is_float32 ? decimal_of(static_cast<float>(z)) : z);
  const bool is_turned = (bound[0] > bound[1]) != (bound.front() > bound.back());  // lower edge first, levels descend
  std::vector<double> edge{bound[is_turned ? 1 : 0]};
  for (std::size_t k = 0; k < levels; ++k) {
    const double begin = bound[2 * k + (is_turned ? 1 : 0)], end = bound[2 * k + (is_turned ? 0 : 1)];
    if (!(std::abs(begin - edge.back()) <= 1e-5 * std::abs(end - begin))) return {};
    edge.push_back(end);
  }
  return edge;
}

std::optional<LesGrid::Heights> LesGrid::find_heights() {
  const std::size_t levels = axes_[2].length;
  for (const std::string& name : file_.model == nullptr ? Names{} : file_.model->heights) {
    const NetcdfVariable* of_cells = file_.input.find(name);
    if (of_cells == nullptr || of_cells->length.size() < 2 || !vertical_dimension(*of_cells)) continue;
    if (const auto unit = factor_of(length_units, of_cells->units))
      return field_of_heights(name, *of_cells, nullptr, *unit);
  }
  if (const NetcdfVariable* own = coordinate_variable(2)) {
    Coordinates found = coordinates(2, own);
    if (!found.value.empty()) {
      std::vector<double> edges = edges_by_bounds(*own);
      if (!edges.empty())
        return Heights{own->name + "' by its bounds '" + file_.input.text_attribute(*own, "bounds"), std::move(edges),
                       true};
      return Heights{own->name, std::move(found.value), false};
    }
    height_problem_ = found.problem;
    is_reversed_[2] = found.descend;
  }
  const NetcdfVariable *perturbation = file_.input.find("PH"), *base = file_.input.find("PHB");
  if (perturbation != nullptr && base != nullptr && perturbation->dimension == base->dimension &&
      vertical_dimension(*perturbation)) {
    constexpr double wrf_gravity = 9.81;  // m/s2, by which WRF makes its geopotential
    return field_of_heights("(PH + PHB) / g", *perturbation, base, 1 / wrf_gravity);
  }
  for (const std::string& name : heights_names) {
    const NetcdfVariable* variable = file_.input.find(name);
    if (variable == nullptr || !vertical_dimension(*variable)) continue;
    if (variable->length.size() == 1 && variable->length[0] == levels) {
      Coordinates found = coordinates(2, variable);
      if (!found.value.empty()) return Heights{name, std::move(found.value), false};
      continue;
    }
    constexpr double gravity = 9.80665;  // m/s2, of the geopotential in meteorology
    if (const auto unit = factor_of(length_units, variable->units)) {
      return field_of_heights(name, *variable, nullptr, *unit);
    }
    if (factor_of(geopotential_units, variable->units)) {
      file_.note("heights: '{}' is the geopotential, divided by {} m/s2", name, gravity);
      return field_of_heights(name, *variable, nullptr, 1 / gravity);
    }
  }
  return std::nullopt;
}

void LesGrid::set_levels_of_equal_size(double size, const std::string& instead_of) {
  for (std::size_t k = 0; k <= axes_[2].length; ++k) z_edge_m_.push_back(static_cast<double>(k) * size);
  file_.note("levels: {} of {:.6g} m from the ground, {}, as --voxel-size-m says{}", axes_[2].length, size,
             is_reversed_[2] ? "the file's last the lowest" : "the file's first the lowest", instead_of);
}

void LesGrid::set_levels() {
  const auto& given = file_.options.voxel_size_m;
  const bool has_one_level = axes_[2].length == 1;
  std::optional<Heights> heights = find_heights();
  if (heights) is_reversed_[2] = heights->value.front() > heights->value.back();
  if (given && (!heights || file_.options.levels_by_voxel_size) && !(has_one_level && heights)) {
    is_count_[2] = false;
    const bool differ = heights && !heights->are_edges &&
                        std::abs(std::abs(heights->value[1] - heights->value[0]) - (*given)[2]) > 1e-3 * (*given)[2];
    set_levels_of_equal_size((*given)[2], !heights
                                              ? ""
                                              : fmt::format(", in place of '{}' ({:.6g} to {:.6g} m{})", heights->name,
                                                            heights->value.front(), heights->value.back(),
                                                            differ ? ", of other thickness" : ""));
    return;
  }
  if (!heights) {
    file_.fail(
        "no heights of '{}' in metres ({}, allowed m, km) give --voxel-size-m DX DY DZ, or --with FILE that has them",
        axes_[2].name, height_problem_.empty() ? "found no variable of this name and length" : height_problem_);
  }
  std::vector<double>& level = heights->value;
  if (level.size() == 1) {
    if (!given)
      file_.fail("'{}': one level alone does not say how thick it is (allowed with --voxel-size-m)", heights->name);
    const double half = 0.5 * (*given)[2];
    z_edge_m_ = {level[0] - half, level[0] + half};
    return;
  }
  if (is_reversed_[2]) std::reverse(level.begin(), level.end());
  for (std::size_t k = 1; k < level.size(); ++k) {
    if (!(level[k] > level[k - 1])) {
      file_.fail("'{}': levels are not monotonic (found {:.6g} m next to {:.6g} m, allowed ascending or descending)",
                 heights->name, level[k], level[k - 1]);
    }
  }
  z_edge_m_ = heights->are_edges ? level : edges_between(level);
  if (!heights->are_edges) point_m_ = level;
  file_.note("levels: '{}', {} {}", heights->name, level.size(),
             heights->are_edges ? "edges of cells" : "centres of cells that meet halfway");
  if (!heights->of_columns_m.empty()) {
    set_levels_of_columns(*heights);
  } else {
    report_terrain(heights->name);
  }
}

/// Levels of one height over ground of another: the model's terrain is lost.
void LesGrid::report_terrain(const std::string& heights) const {
  for (const char* name : {"ZS", "zs", "HGT", "HSURF", "topography_c", "orog"}) {
    const NetcdfVariable* ground = file_.input.find(name);
    if (ground == nullptr || ground->length.size() < 2 || !holds(*ground) || !factor_of(length_units, ground->units))
      continue;
    const std::vector<float> value = gather<float>(*ground, 1, "ground");
    const auto [low, high] = std::minmax_element(value.begin(), value.end());
    if (!(*high - *low > 1)) continue;
    file_.note(
        "CHECK the heights: the ground '{}' reaches from {:.6g} to {:.6g}, the levels '{}' are flat; --with FILE adds "
        "a "
        "field of heights",
        name, *low, *high, heights);
  }
}

/// Edges of the levels of every column.
void LesGrid::set_levels_of_columns(Heights& heights) {
  const std::size_t nz = axes_[2].length;
  std::vector<double>& height = heights.of_columns_m;
  if (is_reversed_[2]) reverse_levels(height, columns());
  for (std::size_t n = columns(); n < height.size(); ++n) {
    if (height[n] > height[n - columns()]) continue;
    const std::size_t column = n % columns();
    file_.fail(
        "'{}': levels of column ({}, {}) are not monotonic (found {:.6g} m next to {:.6g} m) correct the heights",
        heights.name, column % axes_[0].length, column / axes_[0].length, height[n], height[n - columns()]);
  }
  if (heights.are_edges) {
    column_edge_m_ = std::move(height);
  } else {
    column_edge_m_.resize(columns() * (nz + 1));
    std::vector<double> centre(nz);
    for (std::size_t c = 0; c < columns(); ++c) {
      for (std::size_t k = 0; k < nz; ++k) centre[k] = height[c + columns() * k];
      const std::vector<double> edge = edges_between(centre);
      for (std::size_t k = 0; k <= nz; ++k) column_edge_m_[c + columns() * k] = edge[k];
    }
  }
  const auto lowest_end = column_edge_m_.begin() + static_cast<std::ptrdiff_t>(columns());
  const auto [low, high] = std::minmax_element(column_edge_m_.begin(), lowest_end);
  file_.note("levels: heights differ from column to column, the lowest edge lies at {:.6g} to {:.6g} m", *low, *high);
}

// -- fields -------------------------------------------------------------------------------------------------------

bool LesGrid::holds(const NetcdfVariable& variable) const {
  for (std::size_t n = 0; n < variable.length.size(); ++n) {
    if (role_of(variable, n) < 0) return false;
  }
  return true;
}

double LesGrid::point_m(std::size_t level, std::size_t column) const {
  return point_m_.empty() || !column_edge_m_.empty() ? height_m(level, column) : point_m_[level];
}

LesGrid::Selection LesGrid::select(const NetcdfVariable& variable, std::size_t levels, const char* what) const {
  const std::size_t rank = variable.length.size();
  Selection selection{std::vector<std::size_t>(rank, 0), variable.length};
  std::size_t step = 1;
  for (std::size_t n = rank; n-- > 0;) {
    int role = role_of(variable, n);
    if (role < 0 && variable.length[n] == levels && levels == axes_[2].length + 1) role = 2;
    if (role < 0) {
      file_.fail("'{}' ({}): dimension '{}' is not one of the cloud's (allowed: some of those)", variable.name, what,
                 variable.dimension[n]);
    }
    if (role == 3) {
      selection.start[n] = file_.options.time;
      selection.count[n] = 1;
    } else if (role != single) {
      selection.stride[static_cast<std::size_t>(role)] = step;
      selection.dimension[static_cast<std::size_t>(role)] = n;
      step *= variable.length[n];
    }
  }
  return selection;
}

/// Values [k][j][i] of levels or their edges. The file is read in slabs, so that few numbers are there twice.
template <class T>
std::vector<T> LesGrid::gather(const NetcdfVariable& variable, std::size_t levels, const char* what) const {
  constexpr std::size_t most_numbers = 4000000;
  Selection selection = select(variable, levels, what);
  const std::array<std::size_t, 3> length{axes_[0].length, axes_[1].length, levels};
  std::size_t slab_axis = Selection::none;  // the axis that the file stores slowest
  for (std::size_t a = 0; a < 3; ++a) {
    if (selection.dimension[a] == Selection::none) continue;
    if (slab_axis == Selection::none || selection.dimension[a] < selection.dimension[slab_axis]) slab_axis = a;
  }
  std::vector<T> value(length[0] * length[1] * length[2]);
  const auto fill = [&](const std::vector<double>& stored, std::size_t slab_begin, std::size_t slab_end) {
    // Places of the cells in the slab by index; cells along an axis that the variable lacks have the same.
    std::array<std::vector<std::pair<std::size_t, std::size_t>>, 3> place;  // cell, value
    for (std::size_t a = 0; a < 3; ++a) {
      for (std::size_t n = 0; n < length[a]; ++n) {
        const bool has_axis = selection.dimension[a] != Selection::none;
        const std::size_t in_file = has_axis && is_reversed_[a] ? length[a] - 1 - n : n;
        if (a == slab_axis && (in_file < slab_begin || in_file >= slab_end)) continue;
        place[a].emplace_back(n, selection.stride[a] * (a == slab_axis ? in_file - slab_begin : in_file));
      }
    }
    for (const auto& [k, in_z] : place[2]) {
      for (const auto& [j, in_y] : place[1]) {
        T* const row = value.data() + (k * length[1] + j) * length[0];
        for (const auto& [i, in_x] : place[0]) row[i] = static_cast<T>(stored[in_z + in_y + in_x]);
      }
    }
  };
  if (slab_axis == Selection::none) {
    fill(file_.input.read(variable, selection.start, selection.count), 0, 0);
    return value;
  }
  const std::size_t d = selection.dimension[slab_axis];
  const std::size_t chunk = file_.input.chunk_length(variable, d);
  const std::size_t chunks = std::max<std::size_t>(1, most_numbers / selection.stride[slab_axis] / chunk);
  for (std::size_t begin = 0; begin < length[slab_axis]; begin += chunks * chunk) {
    const std::size_t end = std::min(length[slab_axis], begin + chunks * chunk);
    selection.start[d] = begin;
    selection.count[d] = end - begin;
    fill(file_.input.read(variable, selection.start, selection.count), begin, end);
  }
  return value;
}

std::vector<float> LesGrid::read(const NetcdfVariable& variable, const char* what) const {
  return gather<float>(variable, axes_[2].length, what);
}

}  // namespace cloudbow
