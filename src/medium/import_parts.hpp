// Parts that the importers share: a field on levels of any thickness, and words for messages.
#pragma once

#include <fmt/format.h>

#include <string>
#include <utility>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/cloud_import.hpp"

namespace cloudbow {

/// Water of a species beside the cloud's own, on its cells. Arrays [k][j][i].
struct LevelledSpecies {
  std::string grid;      ///< "ice_water_content"
  std::string quantity;  ///< the same
  std::string radius_grid;
  std::vector<float> density;              ///< g/m3, >= 0
  std::vector<float> effective_radius_um;  ///< empty, or > 0 in cells with density
};

/// A cloud as it stands in a file: nx x ny columns, nz levels. Arrays [k][j][i].
struct LevelledCloud {
  int nx = 1;
  int ny = 1;
  double dx_m = 0;
  double dy_m = 0;
  double x_min_m = 0;
  double y_min_m = 0;
  std::vector<double> z_edge_m;       ///< nz + 1, ascending; means over the columns if these differ
  std::vector<double> column_edge_m;  ///< empty, or [edge][j][i]: heights that differ from column to column, ascending
  std::string grid = "density";
  std::string quantity;
  std::string radius_grid = "reff";
  std::string source = "the file";              ///< variable or column of the quantity, with its unit, for messages
  std::string source_hint;                      ///< the option that sets another unit, for messages
  std::vector<float> density;                   ///< of the quantity, >= 0
  std::vector<float> effective_radius_um;       ///< empty, or > 0 in cells with density
  std::vector<float> single_scattering_albedo;  ///< empty, or 0 to 1
  std::vector<float> phase_index;               ///< empty, or from 1
  std::vector<float> temperature_k;             ///< empty, or > 0 in cells with density
  std::vector<std::vector<double>> moments;     ///< as in ImportedCloud
  std::vector<LevelledSpecies> others;
  std::vector<std::string> notes;

  int nz() const { return static_cast<int>(z_edge_m.size()) - 1; }
  std::size_t columns() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }
  std::size_t cell(int i, int j, int k) const {
    return (static_cast<std::size_t>(k) * static_cast<std::size_t>(ny) + static_cast<std::size_t>(j)) *
               static_cast<std::size_t>(nx) +
           static_cast<std::size_t>(i);
  }
  /// The edges are there: makes room for the densities.
  void allocate() { density.assign(columns() * static_cast<std::size_t>(nz()), 0.0F); }
};

template <class... Args>
[[noreturn]] void fail_import(const std::filesystem::path& file, fmt::format_string<Args...> text, Args&&... args) {
  throw InputError(fmt::format("{}: {}", file.string(), fmt::format(text, std::forward<Args>(args)...)));
}

/// More cells than this are taken for a mistake.
inline constexpr double max_import_cells = 4e9;

/// Checks counts that a file states, before memory is taken.
void check_import_size(const CloudImportOptions& options, double nx, double ny, double nz);

/// Edges of levels given by their centres: halfway between neighbours, the outermost as far out as in. They are not
/// below the ground at 0 if the centres are not. Centres ascend, at least two.
std::vector<double> edges_between(const std::vector<double>& centre);

/// Distance of equally spaced centres. @throws InputError if they are not, to 1e-3 of it.
double uniform_spacing(const std::filesystem::path& file, const std::string& axis, const std::vector<double>& centre);

/// Sets as many levels as there are, of the height that the user gives, from the ground; adds a note.
void set_levels_by_voxel_size(LevelledCloud& cloud, const CloudImportOptions& options);

/// @throws InputError if the cloud has numbers that no cloud has, which are wrong units most of the time.
void check_plausible(const LevelledCloud& cloud, const CloudImportOptions& options);

/// Onto uniform voxels, columns keeping their mass.
ImportedCloud to_uniform(LevelledCloud cloud, const CloudImportOptions& options);

LevelledCloud import_les(const CloudImportOptions& options);
LevelledCloud import_shdom(const CloudImportOptions& options);
LevelledCloud import_columns(const CloudImportOptions& options);
LevelledCloud import_optics_csv(const CloudImportOptions& options);
LevelledCloud import_at3d(const CloudImportOptions& options);
LevelledCloud import_mystic(const CloudImportOptions& options);
LevelledCloud import_numpy(const CloudImportOptions& options);

}  // namespace cloudbow
