// Scenes at the g-points of a small gas model, made up, for tests.
#pragma once

#include <array>
#include <filesystem>
#include <string>
#include <vector>

#include "../medium/netcdf_builder.hpp"
#include "cloudbow/medium/gas_model.hpp"
#include "cloudbow/medium/vdb_file.hpp"
#include "temporary_folder.hpp"

namespace cloudbow::gas_scene {

inline constexpr std::size_t points = 4;
inline constexpr double stefan_boltzmann = 5.670374419e-8;
// Powers of two: sums of the shares are exact.
inline constexpr std::array<double, points> solar_irradiance{8, 4, 2, 2}, planck_share{.5, .25, .125, .125};
inline constexpr double first_planck_k = 150, planck_step_k = 50;
inline constexpr std::size_t planck_temperatures = 5;
inline constexpr double first_interval_cm1 = 6000, end_cm1 = 22000;  ///< one interval of 4000 cm-1 for each g-point

/// An ecCKD definition file of four g-points, the first and the last two of which are bands. `composite` and h2o
/// absorb, the later g-points more. G-point g has interval g of the spectrum alone.
inline std::filesystem::path make_model(const std::filesystem::path& path, GasModel::Light light) {
  NetcdfBuilder file(path);
  const std::vector<double> pressure{1, 1e3, 1e6};
  file.dimension("temperature", 2);
  file.dimension("pressure", pressure.size());
  file.dimension("g_point", points);
  file.dimension("wavenumber", points);
  file.dimension("temperature_planck", planck_temperatures);
  file.dimension("band", 2);
  file.text("", "constituent_id", "composite h2o");
  const auto variable = [&](const std::string& name, const std::vector<std::string>& dimensions,
                            const std::vector<double>& values) {
    file.variable(name, dimensions, "", values, NC_DOUBLE);
  };
  variable("pressure", {"pressure"}, pressure);
  variable("temperature", {"temperature", "pressure"}, {200, 200, 200, 300, 300, 300});
  const std::vector<std::string> of_table{"temperature", "pressure", "g_point"};
  const auto table = [&](double scale) {
    std::vector<double> values;
    for (std::size_t n = 0; n < 2 * pressure.size(); ++n) {
      for (std::size_t g = 0; g < points; ++g)
        values.push_back(scale * static_cast<double>(1 + 5 * g * g) * (1 + .1 * static_cast<double>(n)));
    }
    return values;
  };
  variable("composite_conc_dependence_code", {}, {0});
  variable("composite_molar_absorption_coeff", of_table, table(2e-8));
  variable("h2o_conc_dependence_code", {}, {1});
  variable("h2o_molar_absorption_coeff", of_table, table(3e-5));
  std::vector<double> lower, upper, fraction(points * points, 0.);
  const double step = (end_cm1 - first_interval_cm1) / points;
  for (std::size_t g = 0; g < points; ++g) {
    lower.push_back(first_interval_cm1 + static_cast<double>(g) * step);
    upper.push_back(lower.back() + step);
    fraction[g * points + g] = 1;
  }
  variable("wavenumber1", {"wavenumber"}, lower);
  variable("wavenumber2", {"wavenumber"}, upper);
  variable("gpoint_fraction", {"g_point", "wavenumber"}, fraction);
  variable("wavenumber1_band", {"band"}, {lower[0], lower[2]});
  variable("wavenumber2_band", {"band"}, {upper[1], upper[3]});
  variable("band_number", {"g_point"}, {0, 0, 1, 1});
  if (light == GasModel::Light::solar) {
    const std::vector<double> irradiance(solar_irradiance.begin(), solar_irradiance.end());
    variable("solar_irradiance", {"g_point"}, irradiance);
    variable("solar_spectral_irradiance", {"wavenumber"}, irradiance);
    variable("rayleigh_molar_scattering_coeff", {"g_point"}, {4e-8, 3e-8, 2e-8, 1e-8});
  } else {
    std::vector<double> temperature, flux;
    for (std::size_t t = 0; t < planck_temperatures; ++t) {
      const double kelvin = first_planck_k + planck_step_k * static_cast<double>(t);
      temperature.push_back(kelvin);
      for (const double share : planck_share)
        flux.push_back(share * stefan_boltzmann * kelvin * kelvin * kelvin * kelvin);
    }
    variable("temperature_planck", {"temperature_planck"}, temperature);
    variable("planck_function", {"temperature_planck", "g_point"}, flux);
  }
  return file.close();
}

/// k, k ssa and k ssa g are linear in wavenumber: a g-point has those of the middle of its interval.
inline double bulk_extinction(double wavenumber_cm1) { return .05 + 1e-5 * wavenumber_cm1; }

/// Droplets of 8 and 12 um radius with the same optics. They scatter .9 of what they take, with the asymmetry .8.
inline std::filesystem::path make_bulk_table(const std::filesystem::path& path) {
  NetcdfBuilder file(path);
  const std::vector<double> wavenumber{1000, 30000};
  file.dimension("effective_radius", 2);
  file.dimension("wavenumber", wavenumber.size());
  file.variable("wavenumber", {"wavenumber"}, "cm-1", wavenumber, NC_DOUBLE);
  file.variable("effective_radius", {"effective_radius"}, "um", {8, 12}, NC_DOUBLE);
  std::vector<double> extinction;
  for (int radius = 0; radius < 2; ++radius) {
    for (const double at : wavenumber) extinction.push_back(bulk_extinction(at));
  }
  const std::vector<std::string> dimensions{"effective_radius", "wavenumber"};
  file.variable("mass_extinction_coefficient", dimensions, "m2 g-1", extinction, NC_DOUBLE);
  file.variable("single_scattering_albedo", dimensions, "1", {.9, .9, .9, .9}, NC_DOUBLE);
  file.variable("asymmetry_factor", dimensions, "1", {.8, .8, .8, .8}, NC_DOUBLE);
  return file.close();
}

/// 4 x 3 x 4 cells of 100 x 100 x 50 m from 500 m upwards; two unlike towers in rows 1 and 2.
inline void make_cloud(const std::filesystem::path& path) {
  std::vector<float> dense(4 * 3 * 4, 0.F);
  const auto at = [&dense](int i, int j, int k) -> float& {
    return dense[static_cast<std::size_t>((k * 3 + j) * 4 + i)];
  };
  at(1, 1, 1) = at(1, 1, 2) = .02F;
  at(2, 1, 1) = .01F;
  write_cloud_vdb(path, make_cloud_field({4, 3, 4}, {100, 100, 50}, {0, 0, 500}, dense, "extinction"));
}

/// All files of the scenes, in a folder of the test.
struct Files {
  Files() {
    make_model(folder / "solar.nc", GasModel::Light::solar);
    make_model(folder / "longwave.nc", GasModel::Light::longwave);
    make_bulk_table(folder / "bulk.nc");
    make_cloud(folder / "cloud.vdb");
  }

  std::filesystem::path write(const std::string& text) const { return folder.write("scene.toml", text); }

  TemporaryFolder folder;
};

inline const std::string air =
    "[atmosphere]\nheight_m = [0, 1000, 5000, 20000]\npressure_pa = [1e5, 9e4, 5.5e4, 5.5e3]\n"
    "temperature_k = [290, 285, 260, 215]\nh2o = [1e-2, 8e-3, 2e-3, 1e-5]\n";
inline const std::string cloud =
    "[cloud]\nfile = \"cloud.vdb\"\neffective_radius_um = 10\nphase_function = \"drops\"\n"
    "[phase_function.drops]\ntype = \"bulk\"\nfile = \"bulk.nc\"\n";
inline const std::string sun = "[sun]\nzenith_deg = 40\nazimuth_deg = 30\nirradiance_w_m2 = 1360\n";
inline const std::string solar_spectrum = "[spectrum]\ngas_model = \"solar.nc\"\n";
inline const std::string longwave_spectrum = "[spectrum]\ngas_model = \"longwave.nc\"\n";

/// Without a cloud. They end with [spectrum], so that its keys may follow.
inline const std::string solar = air + sun + "[surface]\nalbedo = 0.1\n" + solar_spectrum;
inline const std::string longwave =
    air + "[thermal]\n[surface]\nalbedo = 0.05\ntemperature_k = 295\n" + longwave_spectrum;

}  // namespace cloudbow::gas_scene
