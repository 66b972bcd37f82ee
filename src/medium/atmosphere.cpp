#include "cloudbow/medium/atmosphere.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

constexpr double gas_constant = 287.05;  // J kg-1 K-1, of dry air

/// Interval of heights that holds a height, or is nearest to it, and the share of its upper end.
struct Location {
  std::size_t below;
  double share;  ///< outside 0 to 1 beyond the ends
};

Location locate(const std::vector<double>& heights, double height) {
  const auto above = std::upper_bound(heights.begin() + 1, heights.end() - 1, height);
  const auto below = static_cast<std::size_t>(above - heights.begin()) - 1;
  return {below, (height - heights[below]) / (heights[below + 1] - heights[below])};
}

// US Standard Atmosphere, 1976 (NOAA, NASA, USAF; NOAA-S/T 76-1562), tables 2 and 4.
constexpr double earth_radius_m = 6356766;
constexpr double standard_gravity = 9.80665;                 // m s-2
constexpr double standard_gas_constant = 8314.32 / 28.9644;  // J kg-1 K-1
constexpr double sea_level_kelvin = 288.15, sea_level_pascal = 101325;

struct StandardLayer {
  double base_m;  ///< geopotential
  double lapse;   ///< K per geopotential metre
};
constexpr std::array<StandardLayer, 7> standard_layers{
    {{0, -6.5e-3}, {11000, 0}, {20000, 1e-3}, {32000, 2.8e-3}, {47000, 0}, {51000, -2.8e-3}, {71000, -2e-3}}};

double geopotential_of(double height_m) { return earth_radius_m * height_m / (earth_radius_m + height_m); }
double height_of(double geopotential_m) { return earth_radius_m * geopotential_m / (earth_radius_m - geopotential_m); }

struct StandardAir {
  double kelvin, pascal;
};

/// Molecular-scale temperature: up to 80 km the temperature itself, and less than .1 K above it at 84.8 km.
StandardAir standard_air(double height_m) {
  const double geopotential = geopotential_of(height_m);
  StandardAir base{sea_level_kelvin, sea_level_pascal};
  for (std::size_t n = 0;; ++n) {
    const StandardLayer& layer = standard_layers[n];
    const bool is_last = n + 1 == standard_layers.size() || geopotential <= standard_layers[n + 1].base_m;
    const double rise = (is_last ? geopotential : standard_layers[n + 1].base_m) - layer.base_m;
    const double kelvin = base.kelvin + layer.lapse * rise;
    const double exponent = layer.lapse == 0 ? rise / base.kelvin : std::log(kelvin / base.kelvin) / layer.lapse;
    base = {kelvin, base.pascal * std::exp(-standard_gravity / standard_gas_constant * exponent)};
    if (is_last) return base;
  }
}

template <class... Args>
[[noreturn]] void fail(const std::string& where, fmt::format_string<Args...> text, Args&&... args) {
  throw InputError(fmt::format("{}: {}", where, fmt::format(text, std::forward<Args>(args)...)));
}

struct Range {
  double lowest, highest;
  const char* unit;
  bool contains(double value) const { return value >= lowest && value <= highest; }
};

constexpr Range heights_allowed{-1e4, 1e6, "m"}, pressures_allowed{1e-4, 120000, "Pa"}, kelvin_allowed{100, 400, "K"},
    fractions_allowed{0, 1, "mol/mol"};

void check_profile(const std::string& where, const std::vector<double>& heights, const std::string& name,
                   const std::vector<double>& value, const Range& allowed, const char* way_out) {
  if (value.size() != heights.size()) {
    fail(where, "{}: not as many values as heights (found {}, allowed {}); give one for each height", name,
         value.size(), heights.size());
  }
  for (std::size_t n = 0; n < value.size(); ++n) {
    if (allowed.contains(value[n])) continue;
    fail(where, "{}: out of range (found {:.6g} {} at {:.6g} m, allowed {} to {} {}) {}", name, value[n], allowed.unit,
         heights[n], allowed.lowest, allowed.highest, allowed.unit, way_out);
  }
}

/// Air rests on air: pressure falls by a factor e within 3 to 12 km. Farther from it are wrong units only.
void check_weight(const Atmosphere& of, const std::string& where) {
  const double thickness = of.height_m.back() - of.height_m.front();
  const double falls = std::log(of.pressure_pa.front() / of.pressure_pa.back());
  constexpr double least_scale_m = 1000, largest_scale_m = 1e5;
  constexpr double telling_fall = .1, telling_thickness_m = 1e4;  // rounded numbers do not reach these
  const bool is_low = falls > telling_fall && thickness < least_scale_m * falls;
  if (is_low || (thickness > telling_thickness_m && thickness > largest_scale_m * falls)) {
    fail(where,
         "pressure: contradicts the heights (found a fall by e in {:.4g} m, allowed in {} to {} m) in km? give m",
         thickness / falls, least_scale_m, largest_scale_m);
  }
  constexpr double highest_known_m = 30000, largest_factor = 3;
  if (of.height_m.front() < -1000 || of.height_m.front() > highest_known_m) return;
  const double usual = standard_air(of.height_m.front()).pascal;
  if (of.pressure_pa.front() * largest_factor > usual) return;
  fail(where, "pressure: too low for its height (found {:.6g} Pa at {:.6g} m, allowed from {:.3g} Pa) in hPa? give Pa",
       of.pressure_pa.front(), of.height_m.front(), usual / largest_factor);
}

}  // namespace

double Atmosphere::temperature_at(double height) const {
  const auto [below, share] = locate(height_m, height);
  const double above = std::clamp(share, 0., 1.);
  return (1 - above) * temperature_k[below] + above * temperature_k[below + 1];
}

double Atmosphere::pressure_at(double height) const {
  const auto [below, share] = locate(height_m, height);
  return pressure_pa[below] * std::pow(pressure_pa[below + 1] / pressure_pa[below], share);
}

double Atmosphere::density_at(double height) const {
  return pressure_at(height) / (gas_constant * temperature_at(height));
}

Atmosphere us_standard_1976() {
  constexpr int lowest = -1000, fine_to = 20000, highest = 84800;
  constexpr int fine_step = 250, coarse_step = 500;
  std::vector<double> height;
  for (int z = lowest; z < highest; z += z < fine_to ? fine_step : coarse_step) height.push_back(z);
  height.push_back(highest);
  // The profile has kinks at the bases.
  for (const StandardLayer& layer : standard_layers) {
    if (layer.base_m > 0) height.push_back(height_of(layer.base_m));
  }
  std::sort(height.begin(), height.end());
  Atmosphere atmosphere;
  for (const double z : height) {
    const StandardAir air = standard_air(z);
    atmosphere.height_m.push_back(z);
    atmosphere.pressure_pa.push_back(air.pascal);
    atmosphere.temperature_k.push_back(air.kelvin);
  }
  return atmosphere;
}

void check_atmosphere(const Atmosphere& of, const std::string& where) {
  const std::vector<double>& height = of.height_m;
  if (height.size() < 2) {
    fail(where, "height: too few (found {}, allowed at least 2); give the lowest and the highest at least",
         height.size());
  }
  check_profile(where, height, "height", height, heights_allowed, "heights are those above the sea");
  for (std::size_t n = 1; n < height.size(); ++n) {
    if (height[n] > height[n - 1]) continue;
    fail(where, "height: not in order (found {:.6g} m after {:.6g} m, allowed ascending heights); sort them", height[n],
         height[n - 1]);
  }
  check_profile(where, height, "pressure", of.pressure_pa, pressures_allowed, "in hPa or mb? give Pa");
  for (std::size_t n = 1; n < height.size(); ++n) {
    if (of.pressure_pa[n] < of.pressure_pa[n - 1]) continue;
    fail(where,
         "pressure: not in order (found {:.6g} Pa at {:.6g} m, {:.6g} Pa at {:.6g} m, allowed falling with height); "
         "sort them",
         of.pressure_pa[n - 1], height[n - 1], of.pressure_pa[n], height[n]);
  }
  check_profile(where, height, "temperature", of.temperature_k, kelvin_allowed, "in degrees Celsius? give K");
  for (const auto& [gas, fraction] : of.mole_fraction) {
    check_profile(where, height, gas, fraction, fractions_allowed,
                  "a mole fraction is moles of the gas per mole of air");
  }
  check_weight(of, where);
}

}  // namespace cloudbow
