// A scene file, read and checked: its content, with defaults, before any cloud is opened.
#pragma once

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cloudbow/medium/atmosphere.hpp"
#include "cloudbow/medium/gas_model.hpp"
#include "cloudbow/medium/optical_grid.hpp"
#include "cloudbow/medium/vdb_file.hpp"
#include "cloudbow/optics/droplet_table.hpp"
#include "cloudbow/optics/phase_function.hpp"
#include "cloudbow/optics/planck.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Phase functions of which each voxel has one, by number.
struct ScenePhaseSet {
  std::filesystem::path file;
  std::vector<PhaseFunction> function;
  std::string index_grid;  ///< holds numbers from 1
};

/// A constituent of the clouds: [cloud], or one of [[cloud]].
struct SceneCloud {
  std::string name;  ///< as messages and results call it; empty: [cloud] without a name
  std::string key;   ///< of its table: "cloud", or "cloud.0", ...
  std::filesystem::path file;
  VdbReadOptions read;
  std::vector<std::string> more_grids;  ///< added to that of `read`
  std::string quantity;                 ///< "extinction" or one of water_contents(); empty: as in the grid's metadata
  std::optional<double> effective_radius_um;
  std::string effective_radius_grid;  ///< empty: none
  /// Given or from a mie table; absent if single_scattering_albedo_grid or the voxels' droplets give it.
  std::optional<double> single_scattering_albedo;
  std::string single_scattering_albedo_grid;  ///< empty: none
  std::string temperature_grid;               ///< [K]; empty: the voxels have the temperature of the air
  int phase_function = 0;  ///< index into Scene::phase_functions; unused if droplets or phase_set are used
  std::optional<double> extinction_m2_per_g;  ///< by a mie table at the one effective radius
  /// By bulk optics at a g-point: extinction over that at visible_um. An extinction grid is taken to be visible.
  std::optional<double> relative_extinction;
  static constexpr double visible_um = .55;
  /// A mie table whose effective radius varies from voxel to voxel (effective_radius_grid).
  std::shared_ptr<const DropletTable> droplets;
  /// By bulk optics: extinction of 1 g/m3 at visible_um, for each radius of `droplets`. Only output.optical_depth
  /// and output.extinction need it; else it is empty.
  std::vector<double> visible_m2_per_g;
  std::shared_ptr<const ScenePhaseSet> phase_set;  ///< in place of phase_function and droplets
};

struct ScenePhaseFunction {
  std::string name;
  PhaseFunction function;
  bool measured = false;  ///< given by moments or a table rather than by a formula
};

struct SceneDomain {
  bool periodic = true;
  std::optional<std::array<double, 3>> min_m;
  std::optional<std::array<double, 3>> max_m;
  int vertical_cells = 0;  ///< 0: as the optics need
};

struct SceneSun {
  double zenith_deg = 0;   ///< position of the sun
  double azimuth_deg = 0;  ///< counter-clockwise from +x
  double irradiance_w_m2 = 1;
};

/// The air by height.
struct SceneAtmosphere {
  Atmosphere air;
  std::string source;  ///< the name of the file, "us-1976" or "inline"
};

/// Emission of matter and ground, in one spectral interval. One of wavelength_um and band_um is there.
struct SceneThermal {
  std::function<double(double)> planck;        ///< Planck radiance at a temperature [K]
  std::optional<PlanckFunction> black_body{};  ///< the same with its inverse; none at a g-point
  std::optional<double> wavelength_um;
  std::optional<std::array<double, 2>> band_um;

  void set(const PlanckFunction& of) {
    planck = of;
    black_body = of;
  }
  /// Unit of fluxes: "W m-2 um-1" at a wavelength, "W m-2" over a band.
  std::string flux_units() const { return wavelength_um ? "W m-2 um-1" : "W m-2"; }
};

/// Light of all g-points of a gas model; there is one scene per g-point.
struct SceneBroadband {
  enum class Method {
    few,     ///< a few g-points, chosen by columns, stand for all
    all,     ///< each g-point in three dimensions
    columns  ///< each g-point as independent columns
  };
  std::shared_ptr<const GasModel> model;
  std::string file;  ///< name of the model's
  Method method = Method::few;
  double few_tolerance = 1e-3;       ///< largest residual of the choice
  int few_points = 0;                ///< at most so many are chosen; 0: as many as the tolerance needs
  int molecules_phase_function = 0;  ///< index into Scene::phase_functions
  double largest_air_error = cloudbow::largest_air_error;  ///< of blocks of air, in this g-point's own fluxes
};

struct SceneRadiance {
  std::string name;        ///< letters, digits and _
  double zenith_deg = 0;   ///< position of the sensor, seen from the scene; above 90 below it
  double azimuth_deg = 0;  ///< counter-clockwise from +x
  int width = 0;           ///< pixels along x and y; 0: one per column
  int height = 0;
  bool brightness_temperature = false;  ///< wanted beside the radiance
};

enum class SolveMode { automatic, three_dimensional, independent_columns, independent_diffuse };

/// Settings of the scene itself; the rest comes from `accuracy`.
struct SceneSolver {
  SolveMode mode = SolveMode::automatic;
  std::string accuracy = "balanced";
  std::optional<int> control_points;
  std::optional<std::string> directions;
  std::optional<int> delta_m_order;
  std::optional<FitMethod> fit;
  std::optional<int> gather_directions;
  std::optional<int> beam_rays;
  std::optional<int> column_streams;
  std::optional<double> max_level_optical_depth;
  std::optional<double> max_column_optical_depth;
  std::optional<int> max_column_parts;
  AirCells air = AirCells::automatic;
  std::optional<double> tolerance;
  std::optional<double> class_tolerance;
  int max_sweeps = 200;
  bool half_precision_radiance = false;
};

/// Without views and cameras, which are Scene::radiances and Scene::cameras, and without indices of levels.
struct SceneOutput : OutputOptions {
  std::filesystem::path file;     ///< empty: the scene's name in the working directory
  std::vector<double> heights_m;  ///< ascending, if flux_levels is listed
  bool error_estimate = true;     ///< coarse solves estimate the errors of the fluxes
  bool errors = false;            ///< of single columns too
  bool heating_rate = false;      ///< of the air
  bool optical_depth = false;     ///< of the clouds, by column
  bool extinction = false;        ///< of the clouds, by cell
  bool bands = false;             ///< domain means by band of the gas model
};

struct Scene {
  std::filesystem::path path;
  std::vector<std::filesystem::path> inputs;  ///< the scene file and every file that it names as one to read
  std::string text;                           ///< the TOML as run
  std::string title;
  std::vector<std::string> notes;       ///< values guessed or corrected in reading, to be reported to the user
  std::optional<double> wavelength_um;  ///< if the scene has a spectrum: the wavelength of all numbers below
  std::optional<SceneBroadband> broadband;
  int gas_point = 0;                                ///< with broadband: the g-point of all numbers below
  std::vector<SceneCloud> clouds;                   ///< constituents on the same voxels
  std::vector<ScenePhaseFunction> phase_functions;  ///< those in use, each once
  std::vector<Layer> layers;
  SceneDomain domain;
  std::optional<SceneSun> sun;
  double sky_radiance = 0;
  std::optional<double> sky_temperature_k;  ///< in place of a radiance: sky_radiance is that of a black body
  Surface surface;                          ///< without its maps
  std::filesystem::path albedo_map;         ///< empty: none
  std::optional<SceneAtmosphere> atmosphere;
  std::optional<SceneThermal> thermal;
  std::optional<double> surface_temperature_k;  ///< as Surface::planck is of
  std::filesystem::path temperature_map;        ///< empty: none
  SceneSolver solver;
  std::vector<SceneRadiance> radiances;
  std::vector<Camera> cameras;               ///< named as radiances are, none twice
  std::vector<std::string> thermal_cameras;  ///< names of cameras whose brightness temperature is wanted
  SceneOutput output;
  std::map<std::string, std::string>
      place;  ///< "domain.min_m" to "FILE:LINE", for messages about errors that need the cloud to be found

  /// "FILE:LINE: KEY", or "FILE: KEY" if the key is not given.
  std::string where(const std::string& key) const;
};

/// The scene at each of its wavelengths, in the order of `spectrum.wavelengths_um`, or at each g-point of its gas
/// model. Without a spectrum it is one scene.
/// @param overrides "KEY=VALUE" as in read_config().
/// @throws InputError with file, line, key, what was found and what is allowed.
std::vector<Scene> read_scenes(const std::filesystem::path& path, std::span<const std::string> overrides = {});

/// The first of them.
Scene read_scene(const std::filesystem::path& path, std::span<const std::string> overrides = {});

}  // namespace cloudbow
