// Clouds that others simulated, brought onto uniform voxels: LES output (netCDF), SHDOM's files, text (docs/formats.md,
// "Clouds to import").
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/medium/cloud_field.hpp"
#include "cloudbow/medium/vdb_file.hpp"

namespace cloudbow {

struct CloudImportOptions {
  std::filesystem::path file;
  std::string format = "auto";  ///< one of cloud_import_formats()
  /// Horizontal cell sizes instead of the file's; the vertical one counts if the file gives no levels, or with
  /// levels_by_voxel_size.
  std::optional<std::array<double, 3>> voxel_size_m;
  bool levels_by_voxel_size = false;          ///< levels are of this size from the ground, whatever the file says
  std::optional<std::array<int, 2>> columns;  ///< nx, ny of the domain if a text file does not say
  double vertical_size_m = 0;                 ///< of the uniform cells; 0: the thinnest level with cloud
  double minimum = 0;                         ///< cells with less than this of the quantity count as clear air
  /// "extinction" or "liquid_water_content". Of text columns, in 1/m or g/m3; empty: the former. Of LES files, which of
  /// the two is imported; empty: liquid water if there is any.
  std::string quantity;

  // LES files; names that are empty are guessed.
  std::string model = "auto";                 ///< whose layout the file has: one of les_model_names(), or "auto"
  std::vector<std::filesystem::path> with{};  ///< files with variables that the first one lacks
  std::filesystem::path profile{};            ///< density, or pressure and temperature, by height
  /// "liquid", "ice", "rain", "snow", "graupel", or "all" that the file has; empty: liquid water alone.
  std::vector<std::string> species{};
  bool may_be_clear = false;        ///< a field without any cloud is no error: one moment of a series
  std::string variable;             ///< liquid water
  std::string units;                ///< of it, instead of the file's
  std::size_t time = 0;             ///< index on the time axis
  std::array<std::string, 4> axes;  ///< dimensions x, y, z, time
  std::string air_density;          ///< a variable, or a number [kg/m3], or "us-1976": the standard atmosphere
  std::string pressure;             ///< with temperature, in place of air density
  std::string base_pressure{};      ///< is added to the pressure, which then is a perturbation
  std::string temperature;
  std::string potential_temperature{};  ///< in place of temperature
  bool temperature_grid = false;        ///< brings the temperature as a grid; LES files alone have one
  std::string droplet_number;           ///< for the effective radius
  std::string effective_radius;         ///< in place of droplet number
  double droplet_number_cm3 = 0;        ///< the same everywhere, in place of a variable; 0: none
  /// (r_volume / r_effective)^3 of the droplets' spectrum; 0.8 is that of maritime stratocumulus (Martin, Johnson &
  /// Spice 1994, doi 10.1175/1520-0469(1994)051<1823:TMAPOE>2.0.CO;2)
  double radius_ratio_cubed = 0.8;

  std::string fill = "error";  ///< LES files: what cells with missing water are: "error", or "clear" air

  /// Largest memory that the cells may take; 0: half of the machine's.
  std::uint64_t memory_limit_bytes = 0;
};

const std::vector<std::string>& cloud_import_formats();

/// Models whose layouts `model` may name, without "auto".
const std::vector<std::string>& les_model_names();

/// Length of the time axis of an LES file, 1 if it has none. @throws InputError as import_cloud
std::size_t count_times(const CloudImportOptions& options);

/// That of the options, or what the file's first bytes say: one of cloud_import_formats(), not "auto".
/// @throws InputError for a file of another kind
std::string cloud_import_format(const CloudImportOptions& options);

struct ImportedCloud {
  std::string grid = "density";           ///< name of the field's grid
  CloudField field;                       ///< without columns if there is no cloud (may_be_clear)
  std::vector<VdbAuxiliary> auxiliaries;  ///< "reff", "single_scattering_albedo", "phase_index", "temperature"
  /// Other species, each on the voxels that it fills, in the same box; then the temperature of all their voxels.
  std::vector<VdbCloudGrid> others;
  std::vector<std::vector<double>> moments;  ///< [phase function][l] if the file holds them, without the factor 2l+1
  std::vector<std::string> notes;            ///< findings and guesses, for the user to check
};

/// Reads the file and resamples its levels to uniform voxels so that every column keeps its mass, to 1e-6. Heights may
/// differ from column to column. Species and temperature have voxels of the same box. Each voxel is the
/// mean of the levels in it by thickness. Temperature is the mean by mass. An effective radius is the mean that keeps
/// mass and mass / radius, an albedo the one that keeps scattering.
/// @throws InputError naming file and variable, line or cell: missing or damaged file, missing variable or axis, unit
/// not known, time index beyond the axis; levels or columns not monotonic or not uniform, NaN, negative or no cloud;
/// numbers that no cloud has: air density outside 0.01 to 2 kg/m3, pressure outside 100 to 120000 Pa, temperature
/// outside 150 to 350 K; liquid water above 20 g/m3, effective radius outside 0.1 um to 5 mm; levels thinner than 1 mm
/// or thicker than 5 km, cloud below the ground.
ImportedCloud import_cloud(const CloudImportOptions& options);

/// r_e [um] = 1e6 (3 L / (4 pi rho_w k N))^(1/3). L [g/m3] is the water, N the droplets per m3, k = radius_ratio_cubed.
double effective_radius_of_droplets(double liquid_g_m3, double droplets_per_m3, double radius_ratio_cubed);

}  // namespace cloudbow
