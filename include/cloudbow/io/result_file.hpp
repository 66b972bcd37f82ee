// The result file: HDF5 that is also netCDF-4 (docs/result-reference.md).
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "cloudbow/optics/planck.hpp"
#include "cloudbow/results/band_profile.hpp"
#include "cloudbow/results/error_estimate.hpp"
#include "cloudbow/results/heating_rate.hpp"
#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Report of a run to a target error or time (`/plan`).
struct TargetReport {
  std::optional<double> target_error;  ///< fraction
  std::string of;                      ///< "domain" or "columns": the fluxes that it is of
  std::optional<double> budget_seconds;
  std::string accuracy;       ///< the level that the result is by
  std::string levels_solved;  ///< all, in their order
  double predicted_error = 0;
  double predicted_seconds = 0;  ///< wall seconds of that level's solve and its coarse solves
  double seconds = 0;            ///< time of these
  double predicted_memory_bytes = 0;
  double seconds_in_all = 0;  ///< with the levels before
  bool met = true;            ///< the target, by the estimate, and the budget
};

/// Emission in one solution (`/thermal`). One of wavelength_um and band_um is there.
struct ThermalInfo {
  std::optional<PlanckFunction> planck;  ///< with brightness temperatures
  std::optional<double> wavelength_um;
  std::optional<std::array<double, 2>> band_um;
  std::string atmosphere;  ///< name of the file, "us-1976" or "inline"
  std::optional<double> surface_temperature_k;
  std::string surface_temperature_map;  ///< name of the file; empty: none
  std::string cloud_temperature_grid;   ///< empty: none
  std::optional<double> sky_temperature_k;
};

/// G-points of a sum over a gas model (`/spectral`).
struct SpectralInfo {
  std::string model;           ///< name of its file
  std::string light;           ///< "solar" or "longwave"
  std::string method;          ///< "few", "all" or "columns"
  int points = 0;              ///< of the model
  std::vector<int> solved;     ///< from 0
  std::vector<double> weight;  ///< of each: the result is the sum of weight times solution
  double residual = 0;         ///< of the choice, relative
};

/// A constituent of the clouds that has a name (`/cloud`). Means over the domain.
struct ConstituentInfo {
  std::string name;
  std::vector<double> optical_depth{};    ///< of each solution; empty: of a sum over g-points, which has none
  std::vector<double> water_path_g_m2{};  ///< of each solution; empty: the grid holds extinction
};

/// Position of the sun, by the definitions of CF.
struct SunPosition {
  double zenith_deg = 0;
  double bearing_deg = 0;  ///< clockwise from north, which is +y
};

struct ResultInfo {
  std::string title;
  std::string source;  ///< program name and version
  std::string history;
  std::string scene;  ///< the whole scene file as run
  /// Of each solution: phase functions that represent droplets which vary, and their error; empty if droplets do not
  /// vary.
  std::vector<std::int32_t> phase_classes{};
  std::vector<double> phase_class_error{};
  std::vector<double> wavelengths_um{};  ///< of each solution; empty: the scene has no spectrum, and one solution
  std::vector<ErrorEstimate> error_estimates{};  ///< of each solution, or none
  std::optional<TargetReport> target{};
  std::optional<SpectralInfo> spectral{};
  std::vector<BandProfile> bands{};    ///< of a sum over a gas model (`/bands`), or none
  std::vector<Solution> clear_sky{};   ///< of each solution the same without clouds, on other levels, or none
  std::vector<ThermalInfo> thermal{};  ///< of each solution, or none; all of one spectral unit
  std::vector<std::string> brightness_temperatures{};  ///< names of views and cameras; needs `thermal`
  std::vector<HeatingRate> heating_rates{};            ///< of each solution, or none
  std::vector<ConstituentInfo> constituents{};
  std::vector<std::vector<float>> cloud_optical_depth{};  ///< [y][x] of each solution, or none
  std::vector<std::vector<float>> cloud_extinction{};     ///< [z][y][x] 1/m of each solution, or none
  std::optional<double> cloud_optical_depth_um{};         ///< wavelength of both, if it is none of the solution's
  std::optional<double> circumsolar_deg{};  ///< half angle of the cone of circumsolar light, if that was requested
  std::optional<SunPosition> sun{};         ///< scalar coordinates, if there is a sun
  std::string run_key{};  ///< identifies the run among those of a sweep; empty: it belongs to no sweep
};

/// Writes beside the target under a temporary name, flushes, closes, fsyncs, renames: no incomplete file has the name,
/// and an older file is unchanged until the new one is complete.
/// @throws InputError naming the file if it can't be written (as check_writable of output_files.hpp, or disk full); the
/// temporary file is removed.
void write_result(const std::filesystem::path& file, const Solution& solution, const ResultInfo& info);

/// The solutions of a scene with a spectrum, all on the same grid: every variable has the dimension `wavelength` first.
/// @param independent_columns of each, the same scene as independent columns, at the same flux levels; or none
void write_result(const std::filesystem::path& file, std::span<const Solution> solutions, const ResultInfo& info,
                  std::span<const Solution> independent_columns = {});

}  // namespace cloudbow
