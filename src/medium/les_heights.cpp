#include "les_heights.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace cloudbow {
namespace {

/// Heights of levels from a field, the sum of two variables if there is a base. They may descend.
LesHeights field_of_heights(const LesFile& file, const LesAxes& axes, const std::string& name,
                            const NetcdfVariable& variable, const NetcdfVariable* base, double unit_m) {
  const std::size_t levels = variable.length[*axes.vertical_dimension(variable)], count = axes.columns();
  const auto values = [&](const NetcdfVariable& of) {
    std::vector<double> value = axes.read<double>(of, levels, "heights");
    for (const double z : value) {
      if (!std::isfinite(z)) file.fail("'{}': a height is not finite or missing (found {})", of.name, z);
    }
    return value;
  };
  std::vector<double> height = values(variable);
  if (base != nullptr) {
    const std::vector<double> more = values(*base);
    for (std::size_t n = 0; n < height.size(); ++n) height[n] += more[n];
  }
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
  LesHeights heights{name, {}, levels == axes[2].length + 1};
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
std::vector<double> edges_by_bounds(const LesFile& file, const LesAxes& axes, const NetcdfVariable& variable) {
  const auto unit = factor_of(length_units, variable.units);
  const NetcdfVariable* bounds = file.input.find(file.input.text_attribute(variable, "bounds"));
  const std::size_t levels = axes[2].length;
  if (!unit || bounds == nullptr || bounds->length != std::vector<std::size_t>{levels, 2}) return {};
  std::vector<double> bound = file.input.read(*bounds);
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

std::optional<LesHeights> heights_of_model(const LesFile& file, const LesAxes& axes) {
  for (const std::string& name : file.model == nullptr ? Names{} : file.model->heights) {
    const NetcdfVariable* of_cells = file.input.find(name);
    if (of_cells == nullptr || of_cells->length.size() < 2 || !axes.vertical_dimension(*of_cells)) continue;
    if (const auto unit = factor_of(length_units, of_cells->units))
      return field_of_heights(file, axes, name, *of_cells, nullptr, *unit);
  }
  return std::nullopt;
}

std::optional<LesHeights> heights_of_coordinate(LesFile& file, const LesAxes& axes, LesHeightSearch& search) {
  const NetcdfVariable* own = coordinate_variable(file, axes, 2);
  if (own == nullptr) return std::nullopt;
  LesCoordinates found = read_coordinates(file, axes, 2, own);
  if (found.value.empty()) {
    search.problem = found.problem;
    search.descend = found.descend;
    return std::nullopt;
  }
  std::vector<double> edges = edges_by_bounds(file, axes, *own);
  if (edges.empty()) return LesHeights{own->name, std::move(found.value), false, found.count_cells};
  const std::string bounds = file.input.text_attribute(*own, "bounds");
  return LesHeights{own->name + "' by its bounds '" + bounds, std::move(edges), true, found.count_cells};
}

std::optional<LesHeights> heights_of_other_variables(LesFile& file, const LesAxes& axes) {
  const NetcdfVariable *perturbation = file.input.find("PH"), *base = file.input.find("PHB");
  if (perturbation != nullptr && base != nullptr && perturbation->dimension == base->dimension &&
      axes.vertical_dimension(*perturbation)) {
    constexpr double wrf_gravity = 9.81;  // m/s2, by which WRF makes its geopotential
    return field_of_heights(file, axes, "(PH + PHB) / g", *perturbation, base, 1 / wrf_gravity);
  }
  for (const std::string& name : heights_names) {
    const NetcdfVariable* variable = file.input.find(name);
    if (variable == nullptr || !axes.vertical_dimension(*variable)) continue;
    if (variable->length.size() == 1 && variable->length[0] == axes[2].length) {
      LesCoordinates found = read_coordinates(file, axes, 2, variable);
      if (!found.value.empty()) return LesHeights{name, std::move(found.value), false, found.count_cells};
      continue;
    }
    constexpr double gravity = 9.80665;  // m/s2, of the geopotential in meteorology
    if (const auto unit = factor_of(length_units, variable->units))
      return field_of_heights(file, axes, name, *variable, nullptr, *unit);
    if (factor_of(geopotential_units, variable->units)) {
      file.note("heights: '{}' is the geopotential, divided by {} m/s2", name, gravity);
      return field_of_heights(file, axes, name, *variable, nullptr, 1 / gravity);
    }
  }
  return std::nullopt;
}

}  // namespace

LesHeightSearch find_heights(LesFile& file, const LesAxes& axes) {
  LesHeightSearch search;
  search.heights = heights_of_model(file, axes);
  if (!search.heights) search.heights = heights_of_coordinate(file, axes, search);
  if (!search.heights) search.heights = heights_of_other_variables(file, axes);
  return search;
}

}  // namespace cloudbow
