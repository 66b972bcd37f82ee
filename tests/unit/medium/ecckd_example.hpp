// A small ecCKD gas model, made up, as a file for tests.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "netcdf_builder.hpp"

namespace cloudbow::ecckd_example {

// Tables of 3 pressures (1e3, 1e4, 1e5 Pa), 3 temperatures (20 K apart) and 2 g-points. Their entries are linear in
// ln p and T, so interpolation gives them exactly.
inline constexpr std::size_t pressures = 3, temperatures = 3, points = 2, fractions = 3;
inline constexpr double lowest_pressure = 1e3, kelvin_step = 20;
inline constexpr std::array<double, fractions> h2o_fraction{1e-4, 1e-3, 1e-2};
inline constexpr double ch4_reference = 2e-6;

inline double first_kelvin(double log10_pressure) { return 200 + 10 * log10_pressure; }

/// Molar absorption, m2 mol-1, of g-point g.
inline double coefficient(double scale, double log10_pressure, double kelvin, double g) {
  return scale * (1 + g) * (1 + 0.3 * log10_pressure + 0.01 * (kelvin - 200));
}

struct Recipe {
  std::string leave_out = {};  ///< a variable
  std::string constituents = "composite h2o o3 ch4";
  std::vector<double> pressure = {1e3, 1e4, 1e5};
  double ch4_code = 3;
  std::array<double, 4> fraction = {0.25, 0.75, 0.5, 0.5};  ///< [points][intervals]
  double least_absorption = 0;                              ///< replaces the first entry of o3
  bool is_solar = false;
  std::optional<double> second_band = {};  ///< band of the second g-point; none: the file has no bands
};

/// The g-points are 1/4 : 3/4 and 1/2 : 1/2 of intervals 100 and 200 cm-1 wide, so their widths W follow from
/// W1/4 + W2/2 = 100, 3 W1/4 + W2/2 = 200.
inline constexpr double width_1 = 200, width_2 = 100;

inline std::filesystem::path make_file(const std::filesystem::path& path, const Recipe& recipe = {}) {
  NetcdfBuilder file(path);
  file.dimension("temperature", temperatures);
  file.dimension("pressure", recipe.pressure.size());
  file.dimension("g_point", points);
  file.dimension("h2o_mole_fraction", fractions);
  file.dimension("wavenumber", 2);
  file.dimension("temperature_planck", 3);
  if (recipe.second_band) file.dimension("band", 2);
  const auto variable = [&](const std::string& of, const std::vector<std::string>& dimensions,
                            const std::vector<double>& values) {
    if (of != recipe.leave_out) file.variable(of, dimensions, "", values, NC_DOUBLE);
  };
  if (!recipe.constituents.empty()) file.text("", "constituent_id", recipe.constituents);

  variable("pressure", {"pressure"}, recipe.pressure);
  std::vector<double> kelvin;
  for (std::size_t t = 0; t < temperatures; ++t) {
    for (std::size_t p = 0; p < recipe.pressure.size(); ++p)
      kelvin.push_back(first_kelvin(static_cast<double>(p)) + kelvin_step * static_cast<double>(t));
  }
  variable("temperature", {"temperature", "pressure"}, kelvin);

  const auto table = [&](double scale) {
    std::vector<double> values;
    for (std::size_t t = 0; t < temperatures; ++t) {
      for (std::size_t p = 0; p < recipe.pressure.size(); ++p) {
        for (std::size_t g = 0; g < points; ++g) {
          values.push_back(coefficient(scale, static_cast<double>(p), kelvin[t * recipe.pressure.size() + p],
                                       static_cast<double>(g)));
        }
      }
    }
    return values;
  };
  const std::vector<std::string> of_table{"temperature", "pressure", "g_point"};
  variable("composite_conc_dependence_code", {}, {0});
  variable("composite_molar_absorption_coeff", of_table, table(1e-6));
  variable("o3_conc_dependence_code", {}, {1});
  std::vector<double> o3 = table(10);
  o3[0] += recipe.least_absorption;
  variable("o3_molar_absorption_coeff", of_table, o3);
  variable("ch4_conc_dependence_code", {}, {recipe.ch4_code});
  variable("ch4_reference_mole_fraction", {}, {ch4_reference});
  variable("ch4_molar_absorption_coeff", of_table, table(5));
  variable("h2o_conc_dependence_code", {}, {2});
  variable("h2o_mole_fraction", {"h2o_mole_fraction"}, {h2o_fraction.begin(), h2o_fraction.end()});
  std::vector<double> h2o;
  for (std::size_t n = 0; n < fractions; ++n) {
    const std::vector<double> of_fraction = table(1 + static_cast<double>(n));  // linear in log x
    h2o.insert(h2o.end(), of_fraction.begin(), of_fraction.end());
  }
  variable("h2o_molar_absorption_coeff", {"h2o_mole_fraction", "temperature", "pressure", "g_point"}, h2o);

  variable("wavenumber1", {"wavenumber"}, {600, 700});
  variable("wavenumber2", {"wavenumber"}, {700, 900});
  variable("gpoint_fraction", {"g_point", "wavenumber"}, {recipe.fraction.begin(), recipe.fraction.end()});
  if (recipe.second_band) {
    variable("wavenumber1_band", {"band"}, {600, 800});
    variable("wavenumber2_band", {"band"}, {800, 900});
    variable("band_number", {"g_point"}, {0, *recipe.second_band});
  }
  if (recipe.is_solar) {
    variable("solar_irradiance", {"g_point"}, {30, 10});
    variable("solar_spectral_irradiance", {"wavenumber"}, {15, 25});
    variable("rayleigh_molar_scattering_coeff", {"g_point"}, {1e-6, 2e-6});
  } else {
    variable("temperature_planck", {"temperature_planck"}, {200, 250, 300});
    variable("planck_function", {"temperature_planck", "g_point"}, {1, 2, 3, 5, 7, 9});
  }
  return file.close();
}

}  // namespace cloudbow::ecckd_example
