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
  if (start.starts_with("\x93NUMPY")) return "numpy";
  if (start.starts_with(" BDV")) {
    fail_import(file,
                "an OpenVDB file already (found nothing to import, allowed netCDF, text, or NumPy's .npy): a scene "
                "takes it as cloud.file, cloudbow cloud info describes it");
  }
  if (start.find('\0') != std::string::npos) {
    fail_import(file, "of an unknown kind (allowed: netCDF, HDF5 that netCDF-4 wrote, NumPy's .npy, text)");
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

Overlaps overlaps_of(const std::vector<double>& old_edge, double bottom, double size, int levels) {
  Overlaps overlaps;
  const int old_levels = static_cast<int>(old_edge.size()) - 1;
  // Edges meant to coincide: heights may have been 32-bit numbers, with sums and differences of these.
  const double highest = std::max(std::abs(old_edge.front()), std::abs(old_edge.back()));
  const double slack = std::min(1e-3 * size, std::max(1e-6 * size, 2.5e-7 * highest));
  for (int n = 0; n < levels; ++n) {
    const double low = bottom + n * size, high = bottom + (n + 1) * size;
    const auto above = std::upper_bound(old_edge.begin(), old_edge.end(), low + slack);
    int k = std::clamp(static_cast<int>(above - old_edge.begin()) - 1, 0, old_levels - 1);
    overlaps.first.push_back(k);
    overlaps.thickness_m.emplace_back();
    for (; k < old_levels && old_edge[k] < high - slack; ++k) {
      const double from = std::abs(old_edge[k] - low) <= slack ? low : std::max(low, old_edge[k]);
      const double to = std::abs(old_edge[k + 1] - high) <= slack ? high : std::min(high, old_edge[k + 1]);
      overlaps.thickness_m.back().push_back(std::max(0.0, to - from));
    }
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
  const auto begin = cloud.density.begin() + static_cast<std::ptrdiff_t>(cloud.cell(0, 0, k));
  return std::any_of(begin, begin + static_cast<std::ptrdiff_t>(cloud.columns()), [](float v) { return v > 0; });
}

/// Voxels are as high as the thinnest level with cloud unless the user sets their height. If all levels from the lowest
/// to the highest with cloud are of one height, the voxels are those levels. The clear air below and above them is then
/// rounded to whole voxels. Else voxels fill the domain.
UniformLevels choose_levels(const LevelledCloud& cloud, const CloudImportOptions& options) {
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
  const double fits = extent / size;
  const double count = std::abs(fits - std::round(fits)) < 1e-3 ? std::round(fits) : std::ceil(fits);
  check_import_size(options, cloud.nx, cloud.ny, std::max(1.0, count));
  const int levels = std::max(1, static_cast<int>(count));
  return {edge.front(), extent / levels, levels, false};
}

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

VoxelSums sums_of(const LevelledCloud& cloud, int i, int j, int first, const std::vector<double>& thickness) {
  VoxelSums sums;
  for (std::size_t n = 0; n < thickness.size(); ++n) {
    const std::size_t cell = cloud.cell(i, j, first + static_cast<int>(n));
    const double mass = cloud.density[cell] * thickness[n];
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
  if (nx * ny * nz > max_import_cells || nx > 1e6 || ny > 1e6 || nz > 1e6) {
    fail_import(options.file, "too large (found {} x {} x {} cells, allowed {:.0e} in all)", nx, ny, nz,
                max_import_cells);
  }
  // Five fields of floats, and two of doubles, of which one is being read.
  const double bytes_per_cell = options.temperature_grid ? 40 : 36;
  const double allowed =
      static_cast<double>(options.memory_limit_bytes > 0 ? options.memory_limit_bytes : available_memory_bytes() / 2);
  if (nx * ny * nz * bytes_per_cell > allowed) {
    fail_import(options.file, "too large for the memory (found {} x {} x {} cells, allowed {:.3g} in all)", nx, ny, nz,
                allowed / bytes_per_cell);
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
      fail_import(file, "'{}': not equally spaced and ascending (found {:.6g} after {:.6g}, allowed steps of {:.6g})",
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
  for (std::size_t k = 0; k + 1 < cloud.z_edge_m.size(); ++k) {
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
  if (options.minimum > 0) {
    for (float& value : cloud.density) value = value < options.minimum ? 0 : value;
  }
  if (std::none_of(cloud.density.begin(), cloud.density.end(), [](float value) { return value > 0; })) {
    fail_import(options.file, "no cloud (found no cell above {}, allowed at least one)", options.minimum);
  }

  check_plausible(cloud, options);

  const UniformLevels levels = choose_levels(cloud, options);
  const Overlaps overlaps = levels.as_they_are
                                ? one_to_one(levels.bottom_m, levels.size_m, levels.count)
                                : overlaps_of(cloud.z_edge_m, levels.bottom_m, levels.size_m, levels.count);
  if (!levels.as_they_are) {
    imported.notes.push_back(
        fmt::format("levels: {} from {:.6g} to {:.6g} m, resampled to {} of {:.6g} m from {:.6g} m", cloud.nz(),
                    cloud.z_edge_m.front(), cloud.z_edge_m.back(), levels.count, levels.size_m, levels.bottom_m));
  }
  CloudField& field = imported.field;
  field.cells = {cloud.nx, cloud.ny, levels.count};
  field.cell_size_m = {cloud.dx_m, cloud.dy_m, levels.size_m};
  field.min_m = {cloud.x_min_m, cloud.y_min_m, levels.bottom_m};
  field.quantity = cloud.quantity;

  VdbAuxiliary radius{"reff", "effective_radius", "um", {}};
  VdbAuxiliary albedo{"single_scattering_albedo", "single_scattering_albedo", "1", {}};
  VdbAuxiliary index{"phase_index", "phase_index", "1", {}};
  VdbAuxiliary temperature{"temperature", "temperature", "K", {}};
  std::size_t mixed = 0;
  RowSpanWriter rows(field);
  for (int k = 0; k < levels.count; ++k) {
    for (int j = 0; j < cloud.ny; ++j) {
      for (int i = 0; i < cloud.nx; ++i) {
        const VoxelSums sums = sums_of(cloud, i, j, overlaps.first[k], overlaps.thickness_m[k]);
        const auto value = static_cast<float>(sums.mass / levels.size_m);
        if (!(value > 0)) continue;
        rows.add(i, value);
        if (!cloud.effective_radius_um.empty()) {
          radius.value.push_back(static_cast<float>(sums.mass / sums.mass_over_radius));
        }
        if (!cloud.single_scattering_albedo.empty()) {
          albedo.value.push_back(std::min(1.0F, static_cast<float>(sums.scattering / sums.mass)));
        }
        if (!cloud.phase_index.empty()) index.value.push_back(sums.index);
        if (!cloud.temperature_k.empty())
          temperature.value.push_back(static_cast<float>(sums.mass_times_kelvin / sums.mass));
        if (sums.is_mixed) ++mixed;
      }
      rows.end_row();
    }
  }
  if (mixed > 0) {
    imported.notes.push_back(
        fmt::format("phase_index: {} of {} voxels hold parts of levels with different phase functions and take that of "
                    "the larger part; a --vertical-size-m whose voxels end where the levels do keeps them apart",
                    mixed, field.active_voxels()));
  }
  for (VdbAuxiliary* auxiliary : {&radius, &albedo, &index, &temperature}) {
    if (!auxiliary->value.empty()) imported.auxiliaries.push_back(std::move(*auxiliary));
  }
  return imported;
}

std::string cloud_import_format(const CloudImportOptions& options) {
  return options.format == "auto" ? detect_format(options.file, first_bytes(options.file)) : options.format;
}

ImportedCloud import_cloud(const CloudImportOptions& options) {
  const std::string format = cloud_import_format(options);
  if (options.temperature_grid && format != "les") {
    fail_import(options.file, "no temperature (found the format {}, allowed les) leave out --temperature-grid", format);
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
