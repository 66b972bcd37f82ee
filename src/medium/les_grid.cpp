#include "les_grid.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string_view>
#include <utility>

namespace cloudbow {
namespace {

/// The lowest level last, and the reverse.
void reverse_levels(std::vector<double>& value, std::size_t columns) {
  const std::size_t levels = value.size() / columns;
  for (std::size_t k = 0; k < levels / 2; ++k) {
    const auto low = value.begin() + static_cast<std::ptrdiff_t>(k * columns);
    const auto high = value.begin() + static_cast<std::ptrdiff_t>((levels - 1 - k) * columns);
    std::swap_ranges(low, low + static_cast<std::ptrdiff_t>(columns), high);
  }
}

}  // namespace

LesGrid::LesGrid(LesFile& file, const NetcdfVariable& variable) : file_(file), axes_(file, variable) {
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

double LesGrid::point_m(std::size_t level, std::size_t column) const {
  return point_m_.empty() || !column_edge_m_.empty() ? height_m(level, column) : point_m_[level];
}

std::vector<float> LesGrid::read(const NetcdfVariable& variable, const char* what) const {
  return axes_.read<float>(variable, axes_[2].length, what);
}

void LesGrid::set_columns(const NetcdfVariable& variable) {
  const auto& given = file_.options.voxel_size_m;
  std::array<std::string, 2> problem;
  for (std::size_t a = 0; a < 2; ++a) {
    const LesAxes::Axis& axis = axes_[a];
    if (!axis.is_there || axis.length == 1) {
      problem[a] = "found one cell alone";
      if (given) size_m_[a] = (*given)[a];
      continue;
    }
    const NetcdfVariable* coordinate = coordinate_variable(file_, axes_, a);
    if (given && coordinate == nullptr) {
      size_m_[a] = (*given)[a];
      continue;
    }
    LesCoordinates centre = read_coordinates(file_, axes_, a, coordinate);
    axes_.set_reversed(a, centre.descend);
    is_count_[a] = centre.count_cells;
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
    if (axes_.is_reversed(a)) {
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
        "'{}' is a profile (found no axis but {}, allowed y and x beside it); name another with --variable, or "
        "give the width of its one column with --voxel-size-m; fields in the file: {}",
        variable.name, axes_[2].name, file_.fields_there());
  }
  for (std::size_t a = 0; a < 2; ++a) {
    if (!(size_m_[a] > 0)) {
      file_.fail("no coordinates of '{}' in metres ({}, allowed m, km); give --voxel-size-m",
                 axes_[a].name.empty() ? axis_names[a] : axes_[a].name, problem[a]);
    }
  }
}

/// Longitudes and latitudes, of the globe or of a rotated pole, become metres at the mean latitude.
void LesGrid::set_sizes_by_degrees() {
  constexpr double earth_m = 6371229;  // radius in ICON, COSMO and IFS
  constexpr double to_radian = std::numbers::pi / 180;
  if (size_m_[0] > 0 || size_m_[1] > 0) return;
  const NetcdfVariable *of_x = coordinate_variable(file_, axes_, 0), *of_y = coordinate_variable(file_, axes_, 1);
  if (of_x == nullptr || of_y == nullptr) return;
  const std::vector<double> longitude = read_degrees(file_, axes_, 0, *of_x),
                            latitude = read_degrees(file_, axes_, 1, *of_y);
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
    if (axes_.is_reversed(a)) file_.note("columns: the field is turned so that {} ascends", axis_names[a]);
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
      "km); give --voxel-size-m DX DY DZ");
}

void LesGrid::set_levels_of_equal_size(double size, const std::string& instead_of) {
  for (std::size_t k = 0; k <= axes_[2].length; ++k) z_edge_m_.push_back(static_cast<double>(k) * size);
  file_.note("levels: {} of {:.6g} m from the ground, {}, as --voxel-size-m says{}", axes_[2].length, size,
             axes_.is_reversed(2) ? "the file's last the lowest" : "the file's first the lowest", instead_of);
}

void LesGrid::set_levels() {
  const auto& given = file_.options.voxel_size_m;
  const bool has_one_level = axes_[2].length == 1;
  LesHeightSearch search = find_heights(file_, axes_);
  std::optional<LesHeights>& heights = search.heights;
  axes_.set_reversed(2, heights ? heights->value.front() > heights->value.back() : search.descend);
  is_count_[2] = heights && heights->count_cells;
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
        "no heights of '{}' in metres ({}, allowed m, km); give --voxel-size-m DX DY DZ, or --with FILE that has them",
        axes_[2].name, search.problem.empty() ? "found no variable of this name and length" : search.problem);
  }
  std::vector<double>& level = heights->value;
  if (level.size() == 1) {
    if (!given)
      file_.fail("'{}': one level alone does not say how thick it is (allowed with --voxel-size-m)", heights->name);
    const double half = 0.5 * (*given)[2];
    z_edge_m_ = {level[0] - half, level[0] + half};
    return;
  }
  if (axes_.is_reversed(2)) std::reverse(level.begin(), level.end());
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
    if (ground == nullptr || ground->length.size() < 2 || !axes_.holds(*ground) ||
        !factor_of(length_units, ground->units))
      continue;
    const std::vector<float> value = axes_.read<float>(*ground, 1, "ground");
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
void LesGrid::set_levels_of_columns(LesHeights& heights) {
  const std::size_t nz = axes_[2].length;
  std::vector<double>& height = heights.of_columns_m;
  if (axes_.is_reversed(2)) reverse_levels(height, columns());
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

}  // namespace cloudbow
