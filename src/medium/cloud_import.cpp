#include "cloudbow/medium/cloud_import.hpp"

#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <sstream>

#include "cloudbow/core/available_memory.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/core/text_case.hpp"
#include "import_parts.hpp"
#include "row_spans.hpp"
#include "text_tokens.hpp"

namespace cloudbow {
namespace {

constexpr std::size_t bytes_to_look_at = 4096;

std::string first_bytes(const std::filesystem::path& file) {
  std::ifstream stream = open_input(file, "a cloud as netCDF, HDF5 or text");
  std::string bytes(bytes_to_look_at, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

/// Numbers of the first lines that are no comments.
std::vector<std::vector<double>> first_numbers(const std::string& start, std::size_t lines) {
  std::vector<std::vector<double>> numbers;
  std::istringstream stream(start);
  for (std::string line; numbers.size() < lines && std::getline(stream, line);) {
    if (is_comment(line)) continue;
    numbers.emplace_back();
    for (const std::string_view word : split_words(line)) {
      const auto number = number_in(word);
      if (!number) break;
      numbers.back().push_back(*number);
    }
  }
  numbers.resize(lines);
  return numbers;
}

/// Sizes, spacing, as many heights, then names of columns that begin with x,y,z.
bool is_at3d(const std::string& start) {
  const auto line = first_numbers(start, 3);
  return line[0].size() == 3 && line[1].size() == 2 && static_cast<double>(line[2].size()) == line[0][2] &&
         start.find("\nx,y,z,") != std::string::npos;
}

/// Sizes and a flag, then two spacings and one height more than levels; these may go beyond the bytes that are looked
/// at.
bool is_mystic(const std::string& start) {
  const auto line = first_numbers(start, 3);
  const auto& head = line[0];
  if (head.size() != 4 || !(head[0] >= 1 && head[1] >= 1 && head[2] >= 1 && head[3] >= 1 && head[3] <= 3)) return false;
  const bool has_heights = static_cast<double>(line[1].size()) == head[2] + 3;
  return has_heights ? line[2].size() >= 5 : start.size() == bytes_to_look_at && line[1].size() > 100;
}

std::string detect_format(const std::filesystem::path& file, const std::string& start) {
  if (start.empty()) fail_import(file, "the file is empty");
  if (start.starts_with("CDF") || start.starts_with("\x89HDF")) return "les";
  if (start.starts_with("\x93NUMPY") || start.starts_with("PK\x03\x04")) return "numpy";
  if (start.starts_with(" BDV")) {
    fail_import(file,
                "an OpenVDB file already (found nothing to import, allowed netCDF, text, or NumPy's .npy): a scene "
                "takes it as cloud.file, cloudbow cloud info describes it");
  }
  if (start.starts_with("GRIB")) {
    fail_import(file, "a GRIB file (found no netCDF) convert it first, as 'cdo -f nc4 copy' or 'grib_to_netcdf' do");
  }
  if (start.find('\0') != std::string::npos) {
    fail_import(file, "of an unknown kind (allowed: netCDF, HDF5, NumPy's .npy and .npz, text)");
  }
  const std::string first_line = start.substr(0, start.find('\n'));
  const std::string lower = lower_case(first_line);
  for (const char* words : {"property file", "lwc file", "particle"}) {
    if (lower.find(words) != std::string::npos) return "shdom";
  }
  if (is_at3d(start)) return "at3d";
  if (is_mystic(start)) return "mystic";
  if (start.find("extinction") != std::string::npos && start.find(',') != std::string::npos) return "optics-csv";
  return "columns";
}

/// Share of every old level in the new ones: new level n takes from old levels first[n] on, thickness by thickness.
struct Overlaps {
  std::vector<int> first;
  std::vector<std::vector<double>> thickness_m;
};

/// Edges of old and new levels that are meant to coincide: heights may have been 32-bit numbers, with sums and
/// differences of these.
double slack_of_edges(double lowest, double highest, double size) {
  const double farthest = std::max(std::abs(lowest), std::abs(highest));
  return std::min(1e-3 * size, std::max(1e-6 * size, 2.5e-7 * farthest));
}

/// Part of an old level in the new one, edges that nearly coincide taken as one.
double thickness_in_common(double old_low, double old_high, double low, double high, double slack) {
  const double from = std::abs(old_low - low) <= slack ? low : std::max(low, old_low);
  const double to = std::abs(old_high - high) <= slack ? high : std::min(high, old_high);
  return std::max(0.0, to - from);
}

Overlaps overlaps_of(const std::vector<double>& old_edge, double bottom, double size, int levels) {
  Overlaps overlaps;
  const int old_levels = static_cast<int>(old_edge.size()) - 1;
  const double slack = slack_of_edges(old_edge.front(), old_edge.back(), size);
  for (int n = 0; n < levels; ++n) {
    const double low = bottom + n * size, high = bottom + (n + 1) * size;
    const auto above = std::upper_bound(old_edge.begin(), old_edge.end(), low + slack);
    int k = std::clamp(static_cast<int>(above - old_edge.begin()) - 1, 0, old_levels - 1);
    overlaps.first.push_back(k);
    overlaps.thickness_m.emplace_back();
    for (; k < old_levels && old_edge[k] < high - slack; ++k)
      overlaps.thickness_m.back().push_back(thickness_in_common(old_edge[k], old_edge[k + 1], low, high, slack));
  }
  return overlaps;
}

Overlaps one_to_one(double bottom, double size, int levels) {
  Overlaps overlaps;
  for (int n = 0; n < levels; ++n) {
    overlaps.first.push_back(n);
    overlaps.thickness_m.push_back({bottom + (n + 1) * size - (bottom + n * size)});
  }
  return overlaps;
}

/// Levels that differ by no more than the rounding of 32-bit heights are uniform as they are.
bool levels_are_uniform(const std::vector<double>& edge) {
  const int n = static_cast<int>(edge.size()) - 1;
  const double size = (edge.back() - edge.front()) / n;
  for (int k = 0; k <= n; ++k) {
    if (std::abs(edge[k] - edge.front() - k * size) > 1e-3 * size) return false;
  }
  return true;
}

struct UniformLevels {
  double bottom_m;
  double size_m;
  int count;
  bool as_they_are;
};

bool has_cloud(const LevelledCloud& cloud, int k) {
  const auto first = static_cast<std::ptrdiff_t>(cloud.cell(0, 0, k));
  const auto last = first + static_cast<std::ptrdiff_t>(cloud.columns());
  const auto is_there = [&](const std::vector<float>& density) {
    return std::any_of(density.begin() + first, density.begin() + last, [](float v) { return v > 0; });
  };
  return is_there(cloud.density) || std::any_of(cloud.others.begin(), cloud.others.end(),
                                                [&](const auto& other) { return is_there(other.density); });
}

UniformLevels levels_that_fill(const LevelledCloud& cloud, const CloudImportOptions& options, double bottom,
                               double extent, double size) {
  const double fits = extent / size;
  const double count = std::abs(fits - std::round(fits)) < 1e-3 ? std::round(fits) : std::ceil(fits);
  check_import_size(options, cloud.nx, cloud.ny, std::max(1.0, count));
  const int levels = std::max(1, static_cast<int>(count));
  return {bottom, extent / levels, levels, false};
}

/// Voxels of columns with heights of their own fill the box from the lowest edge to the highest. Unless the user sets
/// their height they are as high as the thinnest cell with cloud.
UniformLevels choose_levels_over_terrain(const LevelledCloud& cloud, const CloudImportOptions& options) {
  const std::vector<double>& edge = cloud.column_edge_m;
  const std::size_t columns = cloud.columns(), cells = cloud.density.size();
  const auto top_begin = edge.begin() + static_cast<std::ptrdiff_t>(cells);
  const double bottom = *std::min_element(edge.begin(), edge.begin() + static_cast<std::ptrdiff_t>(columns));
  const double extent = *std::max_element(top_begin, edge.end()) - bottom;
  double size = options.vertical_size_m;
  if (size <= 0) {
    size = extent;
    for (std::size_t n = 0; n < cells; ++n) {
      const bool is_cloudy = cloud.density[n] > 0 || std::any_of(cloud.others.begin(), cloud.others.end(),
                                                                 [n](const auto& o) { return o.density[n] > 0; });
      if (is_cloudy) size = std::min(size, edge[n + columns] - edge[n]);
    }
  }
  return levels_that_fill(cloud, options, bottom, extent, size);
}

/// Voxels are as high as the thinnest level with cloud unless the user sets their height. If all levels from the lowest
/// to the highest with cloud are of one height, the voxels are those levels. The clear air below and above them is then
/// rounded to whole voxels. Else voxels fill the domain.
UniformLevels choose_levels(const LevelledCloud& cloud, const CloudImportOptions& options) {
  if (!cloud.column_edge_m.empty()) return choose_levels_over_terrain(cloud, options);
  const std::vector<double>& edge = cloud.z_edge_m;
  const double extent = edge.back() - edge.front();
  if (options.vertical_size_m <= 0 && levels_are_uniform(edge)) {
    return {edge.front(), extent / cloud.nz(), cloud.nz(), true};
  }
  int first = 0, last = cloud.nz() - 1;
  while (!has_cloud(cloud, first)) ++first;
  while (!has_cloud(cloud, last)) --last;
  double size = options.vertical_size_m;
  if (size <= 0) {
    size = extent;
    for (int k = first; k <= last; ++k) {
      if (has_cloud(cloud, k)) size = std::min(size, edge[k + 1] - edge[k]);
    }
    const std::vector<double> of_cloud(edge.begin() + first, edge.begin() + last + 2);
    if (levels_are_uniform(of_cloud)) {
      size = (of_cloud.back() - of_cloud.front()) / (last + 1 - first);
      const double below = std::round((of_cloud.front() - edge.front()) / size);
      const double count = below + (last + 1 - first) + std::round((edge.back() - of_cloud.back()) / size);
      check_import_size(options, cloud.nx, cloud.ny, count);
      return {of_cloud.front() - below * size, size, static_cast<int>(count), false};
    }
  }
  return levels_that_fill(cloud, options, edge.front(), extent, size);
}

/// Levels that a voxel takes from, the first of them and the thickness of its part in each.
struct VoxelParts {
  int first;
  const std::vector<double>& thickness_m;
};

/// Gives the parts of the voxels, which must be asked for in ascending order of k.
class PartsOfVoxels {
 public:
  PartsOfVoxels(const LevelledCloud& cloud, const UniformLevels& levels) : cloud_(cloud), levels_(levels) {
    if (!cloud.column_edge_m.empty()) {
      next_.assign(cloud.columns(), 0);
    } else {
      overlaps_ = levels.as_they_are ? one_to_one(levels.bottom_m, levels.size_m, levels.count)
                                     : overlaps_of(cloud.z_edge_m, levels.bottom_m, levels.size_m, levels.count);
    }
  }

  VoxelParts of(int i, int j, int k) {
    if (cloud_.column_edge_m.empty()) return {overlaps_.first[k], overlaps_.thickness_m[k]};
    const std::size_t columns = cloud_.columns(), column = cloud_.cell(i, j, 0);
    const auto edge = [&](int n) { return cloud_.column_edge_m[column + columns * static_cast<std::size_t>(n)]; };
    const double low = levels_.bottom_m + k * levels_.size_m, high = levels_.bottom_m + (k + 1) * levels_.size_m;
    const double slack = slack_of_edges(edge(0), edge(cloud_.nz()), levels_.size_m);
    int& first = next_[column];
    while (first < cloud_.nz() && edge(first + 1) <= low + slack) ++first;
    thickness_.clear();
    for (int n = first; n < cloud_.nz() && edge(n) < high - slack; ++n)
      thickness_.push_back(thickness_in_common(edge(n), edge(n + 1), low, high, slack));
    return {first, thickness_};
  }

 private:
  const LevelledCloud& cloud_;
  const UniformLevels& levels_;
  Overlaps overlaps_;
  std::vector<int> next_;  // by column: the lowest level that reaches above the voxels so far
  std::vector<double> thickness_;
};

/// Sums over the levels in one voxel; what each is for stands with ImportedCloud.
struct VoxelSums {
  double mass = 0;
  double mass_over_radius = 0;
  double scattering = 0;
  double mass_times_kelvin = 0;
  double largest_mass = 0;
  float index = 0;
  bool is_mixed = false;
};

VoxelSums sums_of(const LevelledCloud& cloud, int i, int j, const VoxelParts& parts) {
  VoxelSums sums;
  for (std::size_t n = 0; n < parts.thickness_m.size(); ++n) {
    const std::size_t cell = cloud.cell(i, j, parts.first + static_cast<int>(n));
    const double mass = cloud.density[cell] * parts.thickness_m[n];
    if (mass <= 0) continue;
    sums.mass += mass;
    if (!cloud.effective_radius_um.empty()) sums.mass_over_radius += mass / cloud.effective_radius_um[cell];
    if (!cloud.single_scattering_albedo.empty()) sums.scattering += mass * cloud.single_scattering_albedo[cell];
    if (!cloud.temperature_k.empty()) sums.mass_times_kelvin += mass * cloud.temperature_k[cell];
    if (cloud.phase_index.empty()) continue;
    sums.is_mixed = sums.is_mixed || (sums.index != 0 && sums.index != cloud.phase_index[cell]);
    if (mass > sums.largest_mass) {
      sums.largest_mass = mass;
      sums.index = cloud.phase_index[cell];
    }
  }
  return sums;
}

CloudField empty_field(const LevelledCloud& cloud, const UniformLevels& levels, const std::string& quantity) {
  CloudField field;
  field.cells = {cloud.nx, cloud.ny, levels.count};
  field.cell_size_m = {cloud.dx_m, cloud.dy_m, levels.size_m};
  field.min_m = {cloud.x_min_m, cloud.y_min_m, levels.bottom_m};
  field.quantity = quantity;
  return field;
}

/// Lowest and highest edge of the levels with cloud.
std::pair<double, double> heights_of_cloud(const LevelledCloud& cloud) {
  int first = 0, last = cloud.nz() - 1;
  while (first < last && !has_cloud(cloud, first)) ++first;
  while (last > first && !has_cloud(cloud, last)) --last;
  if (cloud.column_edge_m.empty()) return {cloud.z_edge_m[first], cloud.z_edge_m[last + 1]};
  const auto edges = [&](int k) {
    const auto begin = cloud.column_edge_m.begin() + static_cast<std::ptrdiff_t>(cloud.cell(0, 0, k));
    return std::minmax_element(begin, begin + static_cast<std::ptrdiff_t>(cloud.columns()));
  };
  return {*edges(first).first, *edges(last + 1).second};
}

/// Calls a function with i, j, k, the parts of the voxel, and the writer of its row; not for voxels beyond the cloud.
template <class Function>
void fill_rows(CloudField& field, const LevelledCloud& cloud, const UniformLevels& levels, Function function) {
  PartsOfVoxels parts(cloud, levels);
  RowSpanWriter rows(field);
  const auto [lowest, highest] = heights_of_cloud(cloud);
  for (int k = 0; k < levels.count; ++k) {
    const bool is_clear =
        levels.bottom_m + (k + 2) * levels.size_m < lowest || levels.bottom_m + (k - 1) * levels.size_m > highest;
    for (int j = 0; j < cloud.ny; ++j) {
      for (int i = 0; i < cloud.nx && !is_clear; ++i) function(i, j, k, parts, rows);
      rows.end_row();
    }
  }
}

/// Water of another species on its own voxels.
VdbCloudGrid uniform_species(const LevelledCloud& cloud, const LevelledSpecies& species, const UniformLevels& levels) {
  VdbCloudGrid grid{species.grid, empty_field(cloud, levels, species.quantity), {}};
  VdbAuxiliary radius{species.radius_grid, "effective_radius", "um", {}};
  fill_rows(grid.field, cloud, levels, [&](int i, int j, int k, PartsOfVoxels& parts, RowSpanWriter& rows) {
    const VoxelParts part = parts.of(i, j, k);
    double sum = 0, sum_over_radius = 0;
    for (std::size_t n = 0; n < part.thickness_m.size(); ++n) {
      const std::size_t cell = cloud.cell(i, j, part.first + static_cast<int>(n));
      const double mass = species.density[cell] * part.thickness_m[n];
      if (mass <= 0) continue;
      sum += mass;
      if (!species.effective_radius_um.empty()) sum_over_radius += mass / species.effective_radius_um[cell];
    }
    const auto value = static_cast<float>(sum / levels.size_m);
    if (!(value > 0)) return;
    rows.add(i, value);
    if (!species.effective_radius_um.empty()) radius.value.push_back(static_cast<float>(sum / sum_over_radius));
  });
  if (!radius.value.empty()) grid.auxiliaries.push_back(std::move(radius));
  return grid;
}

/// Temperature in all voxels that hold water of any species, the mean by the mass of all.
VdbCloudGrid uniform_temperature(const LevelledCloud& cloud, const UniformLevels& levels) {
  VdbCloudGrid grid{"temperature", empty_field(cloud, levels, "temperature"), {}};
  fill_rows(grid.field, cloud, levels, [&](int i, int j, int k, PartsOfVoxels& parts, RowSpanWriter& rows) {
    const VoxelParts part = parts.of(i, j, k);
    double mass = 0, mass_times_kelvin = 0;
    for (std::size_t n = 0; n < part.thickness_m.size(); ++n) {
      const std::size_t cell = cloud.cell(i, j, part.first + static_cast<int>(n));
      double water = cloud.density[cell];
      for (const LevelledSpecies& other : cloud.others) water += other.density[cell];
      if (!(water * part.thickness_m[n] > 0)) continue;
      mass += water * part.thickness_m[n];
      mass_times_kelvin += water * part.thickness_m[n] * cloud.temperature_k[cell];
    }
    if (static_cast<float>(mass / levels.size_m) > 0) rows.add(i, static_cast<float>(mass_times_kelvin / mass));
  });
  return grid;
}

bool has_any_above_zero(const std::vector<float>& value) {
  return std::any_of(value.begin(), value.end(), [](float v) { return v > 0; });
}

}  // namespace

const std::vector<std::string>& cloud_import_formats() {
  static const std::vector<std::string> formats{"auto",       "les",  "shdom",  "columns",
                                                "optics-csv", "at3d", "mystic", "numpy"};
  return formats;
}

double effective_radius_of_droplets(double liquid_g_m3, double droplets_per_m3, double radius_ratio_cubed) {
  constexpr double water_g_m3 = 1e6;
  return 1e6 * std::cbrt(3 * liquid_g_m3 / (4 * std::numbers::pi * water_g_m3 * radius_ratio_cubed * droplets_per_m3));
}

void check_import_size(const CloudImportOptions& options, double nx, double ny, double nz) {
  if (!(nx >= 1 && ny >= 1 && nz >= 1)) {
    fail_import(options.file, "no cells (found {} x {} x {}, allowed at least 1 along each axis)", nx, ny, nz);
  }
  if (nx != std::floor(nx) || ny != std::floor(ny) || nz != std::floor(nz)) {
    fail_import(options.file, "parts of cells (found {} x {} x {}, allowed whole numbers along each axis)", nx, ny, nz);
  }
  if (nx * ny * nz > max_import_cells || nx > 1e6 || ny > 1e6 || nz > 1e6) {
    fail_import(options.file, "too large (found {} x {} x {} cells, allowed {:.0e} in all)", nx, ny, nz,
                max_import_cells);
  }
  // Five fields of floats and one of doubles; water and radius of further species.
  const double bytes_per_cell = (options.temperature_grid ? 32 : 28) + 8 * static_cast<double>(options.species.size());
  const double allowed =
      static_cast<double>(options.memory_limit_bytes > 0 ? options.memory_limit_bytes : available_memory_bytes() / 2);
  if (nx * ny * nz * bytes_per_cell > allowed) {
    fail_import(options.file,
                "too large for the memory (found {} x {} x {} cells, allowed {:.3g} in all); cut out a part, or give "
                "--vertical-size-m",
                nx, ny, nz, allowed / bytes_per_cell);
  }
}

std::vector<double> edges_between(const std::vector<double>& centre) {
  std::vector<double> edge{1.5 * centre[0] - 0.5 * centre[1]};
  for (std::size_t n = 1; n < centre.size(); ++n) edge.push_back(0.5 * (centre[n - 1] + centre[n]));
  edge.push_back(1.5 * centre[centre.size() - 1] - 0.5 * centre[centre.size() - 2]);
  if (centre[0] >= 0) edge[0] = std::max(0.0, edge[0]);
  return edge;
}

double uniform_spacing(const std::filesystem::path& file, const std::string& axis, const std::vector<double>& centre) {
  const double spacing = (centre.back() - centre.front()) / static_cast<double>(centre.size() - 1);
  for (std::size_t n = 1; n < centre.size(); ++n) {
    const double step = centre[n] - centre[n - 1];
    if (!(spacing > 0) || !(std::abs(step - spacing) <= 1e-3 * spacing)) {
      fail_import(file,
                  "'{}': not equally spaced and ascending (found {:.6g} after {:.6g}, allowed steps of {:.6g}); "
                  "interpolate, or give "
                  "--voxel-size-m",
                  axis, centre[n], centre[n - 1], std::abs(spacing));
    }
  }
  return spacing;
}

void set_levels_by_voxel_size(LevelledCloud& cloud, const CloudImportOptions& options) {
  const double size = (*options.voxel_size_m)[2];
  cloud.notes.push_back(
      fmt::format("levels: {} of {:.6g} m from the ground, as --voxel-size-m says, in place of the "
                  "file's {:.6g} to {:.6g} m",
                  cloud.nz(), size, cloud.z_edge_m.front(), cloud.z_edge_m.back()));
  for (std::size_t k = 0; k < cloud.z_edge_m.size(); ++k) cloud.z_edge_m[k] = static_cast<double>(k) * size;
}

void check_plausible(const LevelledCloud& cloud, const CloudImportOptions& options) {
  constexpr double thinnest = 1e-3, thickest = 5000;      // m
  constexpr double most_water = 20;                       // g/m3
  constexpr double smallest_um = 0.1, largest_um = 5000;  // effective radius
  constexpr double rim = 1e-3;                            // of the densest cell: less may be traces with any radius
  int highest = cloud.nz() - 1;                           // above the cloud levels may be as thick as they like
  while (highest > 0 && !has_cloud(cloud, highest)) --highest;
  for (std::size_t k = 0; k <= static_cast<std::size_t>(highest); ++k) {
    const double thickness = cloud.z_edge_m[k + 1] - cloud.z_edge_m[k];
    if (thickness >= thinnest && thickness <= thickest) continue;
    fail_import(options.file,
                "level {} is {:.6g} m thick, from {:.6g} to {:.6g} m (allowed {} to {} m): are the heights in the unit "
                "that the file says? --voxel-size-m DX DY DZ says it otherwise",
                k, thickness, cloud.z_edge_m[k], cloud.z_edge_m[k + 1], thinnest, thickest);
  }
  const float densest = cloud.density.empty() ? 0 : *std::max_element(cloud.density.begin(), cloud.density.end());
  const auto cell_text = [&cloud](std::size_t n) {
    const auto nx = static_cast<std::size_t>(cloud.nx), ny = static_cast<std::size_t>(cloud.ny);
    return fmt::format("cell ({}, {}, {})", n % nx, n / nx % ny, n / nx / ny);
  };
  for (std::size_t n = 0; n < cloud.density.size(); ++n) {
    if (cloud.quantity == "liquid_water_content" && cloud.density[n] > most_water) {
      fail_import(options.file,
                  "{}: {} holds {:.6g} g/m3 of liquid water (allowed up to {} g/m3): is it in the unit that the file "
                  "says?{}",
                  cloud.source, cell_text(n), cloud.density[n], most_water, cloud.source_hint);
    }
    for (const LevelledSpecies& other : cloud.others) {
      if (other.density[n] <= most_water) continue;
      fail_import(options.file, "{}: {} holds {:.6g} g/m3 (allowed up to {} g/m3): is its unit right in the file?",
                  other.quantity, cell_text(n), other.density[n], most_water);
    }
    if (cloud.effective_radius_um.empty() || cloud.density[n] <= rim * densest) continue;
    const double radius = cloud.effective_radius_um[n];
    if (radius >= smallest_um && radius <= largest_um) continue;
    fail_import(
        options.file,
        "{} has an effective radius of {:.6g} um (allowed {} to {} um): are radius, or water and droplet number, "
        "in the units that the file says?",
        cell_text(n), radius, smallest_um, largest_um);
  }
}

ImportedCloud to_uniform(LevelledCloud cloud, const CloudImportOptions& options) {
  ImportedCloud imported;
  imported.notes = std::move(cloud.notes);
  imported.moments = std::move(cloud.moments);
  const auto drop_least = [&](std::vector<float>& density) {
    if (options.minimum <= 0) return;
    for (float& value : density) value = value < options.minimum ? 0 : value;
  };
  drop_least(cloud.density);
  for (LevelledSpecies& other : cloud.others) drop_least(other.density);
  std::erase_if(cloud.others, [&](const LevelledSpecies& other) {
    if (has_any_above_zero(other.density)) return false;
    imported.notes.push_back(fmt::format("{}: none at this time, no grid", other.quantity));
    return true;
  });
  const bool has_main = has_any_above_zero(cloud.density);
  if (!has_main && cloud.others.empty()) {
    if (options.may_be_clear) return imported;
    fail_import(options.file, "no cloud (found no cell above {}, allowed at least one)", options.minimum);
  }
  check_plausible(cloud, options);
  const UniformLevels levels = choose_levels(cloud, options);
  if (!levels.as_they_are) {
    imported.notes.push_back(
        fmt::format("levels: {} from {:.6g} to {:.6g} m, resampled to {} of {:.6g} m from {:.6g} m{}", cloud.nz(),
                    cloud.z_edge_m.front(), cloud.z_edge_m.back(), levels.count, levels.size_m, levels.bottom_m,
                    cloud.column_edge_m.empty() ? "" : ", column by column; voxels below the terrain are clear"));
  }
  CloudField& field = imported.field;
  field = empty_field(cloud, levels, cloud.quantity);
  imported.grid = cloud.grid;

  VdbAuxiliary radius{cloud.radius_grid, "effective_radius", "um", {}};
  VdbAuxiliary albedo{"single_scattering_albedo", "single_scattering_albedo", "1", {}};
  VdbAuxiliary index{"phase_index", "phase_index", "1", {}};
  VdbAuxiliary temperature{"temperature", "temperature", "K", {}};
  const bool has_common_temperature = !cloud.temperature_k.empty() && !cloud.others.empty();
  std::size_t mixed = 0;
  fill_rows(field, cloud, levels, [&](int i, int j, int k, PartsOfVoxels& parts, RowSpanWriter& rows) {
    const VoxelSums sums = sums_of(cloud, i, j, parts.of(i, j, k));
    const auto value = static_cast<float>(sums.mass / levels.size_m);
    if (!(value > 0)) return;
    rows.add(i, value);
    if (!cloud.effective_radius_um.empty())
      radius.value.push_back(static_cast<float>(sums.mass / sums.mass_over_radius));
    if (!cloud.single_scattering_albedo.empty())
      albedo.value.push_back(std::min(1.0F, static_cast<float>(sums.scattering / sums.mass)));
    if (!cloud.phase_index.empty()) index.value.push_back(sums.index);
    if (!cloud.temperature_k.empty() && !has_common_temperature)
      temperature.value.push_back(static_cast<float>(sums.mass_times_kelvin / sums.mass));
    if (sums.is_mixed) ++mixed;
  });
  if (mixed > 0) {
    imported.notes.push_back(
        fmt::format("phase_index: {} of {} voxels hold parts of levels with different phase functions and take that of "
                    "the larger part; a --vertical-size-m whose voxels end with the levels keeps them apart",
                    mixed, field.active_voxels()));
  }
  for (VdbAuxiliary* auxiliary : {&radius, &albedo, &index, &temperature}) {
    if (!auxiliary->value.empty()) imported.auxiliaries.push_back(std::move(*auxiliary));
  }
  for (const LevelledSpecies& other : cloud.others) imported.others.push_back(uniform_species(cloud, other, levels));
  if (has_common_temperature) imported.others.push_back(uniform_temperature(cloud, levels));
  if (!has_main) {  // the first of the others takes its place
    imported.notes.push_back(fmt::format("{}: none at this time, no grid", cloud.quantity));
    VdbCloudGrid& first = imported.others.front();
    imported.grid = std::move(first.grid);
    imported.field = std::move(first.field);
    imported.auxiliaries = std::move(first.auxiliaries);
    imported.others.erase(imported.others.begin());
  }
  return imported;
}

std::string cloud_import_format(const CloudImportOptions& options) {
  return options.format == "auto" ? detect_format(options.file, first_bytes(options.file)) : options.format;
}

ImportedCloud import_cloud(const CloudImportOptions& options) {
  const std::string format = cloud_import_format(options);
  if (options.temperature_grid && format != "les") {
    fail_import(options.file, "no temperature (found the format {}, allowed les); leave out --temperature-grid",
                format);
  }
  if (format == "les") return to_uniform(import_les(options), options);
  if (format == "shdom") return to_uniform(import_shdom(options), options);
  if (format == "columns") return to_uniform(import_columns(options), options);
  if (format == "optics-csv") return to_uniform(import_optics_csv(options), options);
  if (format == "at3d") return to_uniform(import_at3d(options), options);
  if (format == "mystic") return to_uniform(import_mystic(options), options);
  if (format == "numpy") return to_uniform(import_numpy(options), options);
  throw InputError(
      fmt::format("--format: unknown (found \"{}\", allowed {})", format, fmt::join(cloud_import_formats(), ", ")));
}

}  // namespace cloudbow
