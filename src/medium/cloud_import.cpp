#include "cloudbow/medium/cloud_import.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>

#include "cloudbow/core/available_memory.hpp"
#include "import_parts.hpp"
#include "row_spans.hpp"

namespace cloudbow {
namespace {

std::string first_bytes(const std::filesystem::path& file) {
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) fail_import(file, "no such file");
  if (!std::filesystem::is_regular_file(status)) {
    fail_import(file, "not a file (found a {})",
                std::filesystem::is_directory(status) ? "directory" : "device or pipe");
  }
  std::ifstream stream(file, std::ios::binary);
  if (!stream) fail_import(file, "cannot be opened for reading (check its permissions)");
  std::string bytes(4096, '\0');
  stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
  bytes.resize(static_cast<std::size_t>(stream.gcount()));
  return bytes;
}

std::string detect_format(const std::filesystem::path& file, const std::string& start) {
  if (start.empty()) fail_import(file, "the file is empty");
  if (start.starts_with("CDF") || start.starts_with("\x89HDF")) return "les";
  if (start.find('\0') != std::string::npos) {
    fail_import(file, "of an unknown kind (allowed: netCDF, HDF5 that netCDF-4 wrote, text)");
  }
  const std::string first_line = start.substr(0, start.find('\n'));
  if (first_line.find("property file") != std::string::npos || first_line.find("LWC file") != std::string::npos ||
      first_line.find("particle") != std::string::npos) {
    return "shdom";
  }
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
  const double slack = 1e-6 * size;  // edges meant to coincide
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

/// As high as the thinnest level with cloud unless the user says otherwise. Where all levels from the lowest to the
/// highest with cloud are of one height the voxels are those levels, and the clear air below and above them is rounded
/// to whole voxels; else voxels fill the domain.
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
  static const std::vector<std::string> formats{"auto", "les", "shdom", "columns", "optics-csv"};
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
  if (nx * ny * nz > kMaxImportCells || nx > 1e6 || ny > 1e6 || nz > 1e6) {
    fail_import(options.file, "too large (found {} x {} x {} cells, allowed {:.0e} in all)", nx, ny, nz,
                kMaxImportCells);
  }
  constexpr double bytes_per_cell = 24;  // four fields of floats, and one of doubles while a file is read
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
      fail_import(file, "'{}': not equally spaced and ascending (found {} after {}, allowed steps of {:.6g})", axis,
                  centre[n], centre[n - 1], std::abs(spacing));
    }
  }
  return spacing;
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

  const UniformLevels levels = choose_levels(cloud, options);
  const Overlaps overlaps = overlaps_of(cloud.z_edge_m, levels.bottom_m, levels.size_m, levels.count);
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

  VdbCompanion radius{"reff", "effective_radius", "um", {}};
  VdbCompanion albedo{"single_scattering_albedo", "single_scattering_albedo", "1", {}};
  VdbCompanion index{"phase_index", "phase_index", "1", {}};
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
  for (VdbCompanion* companion : {&radius, &albedo, &index}) {
    if (!companion->value.empty()) imported.companions.push_back(std::move(*companion));
  }
  return imported;
}

ImportedCloud import_cloud(const CloudImportOptions& options) {
  const std::string start = first_bytes(options.file);
  const std::string format = options.format == "auto" ? detect_format(options.file, start) : options.format;
  if (format == "les") return to_uniform(import_les(options), options);
  if (format == "shdom") return to_uniform(import_shdom(options), options);
  if (format == "columns") return to_uniform(import_columns(options), options);
  if (format == "optics-csv") return to_uniform(import_optics_csv(options), options);
  throw InputError(
      fmt::format("--format: unknown (found \"{}\", allowed auto, les, shdom, columns, optics-csv)", format));
}

}  // namespace cloudbow
