// Gas models: the choice of a reader, and the optics of the air between heights.
#include "cloudbow/medium/gas_model.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <utility>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/sandbox.hpp"
#include "ecckd_model.hpp"

namespace cloudbow {
namespace {

void check_gases(const GasModel& model, const Atmosphere& atmosphere) {
  const auto listed = [](const std::vector<std::string>& gases) {
    return gases.empty() ? std::string("none") : fmt::format("{}", fmt::join(gases, ", "));
  };
  std::vector<std::string> there, lacking;
  for (const auto& [gas, fraction] : atmosphere.mole_fraction) there.push_back(gas);
  for (const std::string& gas : model.gases()) {
    if (!atmosphere.mole_fraction.contains(gas)) lacking.push_back(gas);
  }
  if (lacking.empty()) return;
  throw InputError(
      fmt::format("lacks gases of the gas model: {} (found {}, allowed all of {}); give each as a profile "
                  "or as one mole "
                  "fraction; 0 leaves it out",
                  listed(lacking), listed(there), listed(model.gases())));
}

/// Height of a pressure, whose logarithm is linear between the heights of the profile.
double height_of_pressure(const Atmosphere& atmosphere, double pressure_pa) {
  const std::vector<double>&pressure = atmosphere.pressure_pa, &height = atmosphere.height_m;
  const auto above = std::upper_bound(pressure.begin() + 1, pressure.end() - 1, pressure_pa, std::greater<>());
  const auto n = static_cast<std::size_t>(above - pressure.begin());
  const double share = std::log(pressure[n - 1] / pressure_pa) / std::log(pressure[n - 1] / pressure[n]);
  return height[n - 1] + share * (height[n] - height[n - 1]);
}

/// Linear in height; beyond the ends the nearest value.
double fraction_at(const Atmosphere& atmosphere, const std::vector<double>& fraction, double height_m) {
  const std::vector<double>& height = atmosphere.height_m;
  const auto above = std::upper_bound(height.begin() + 1, height.end() - 1, height_m);
  const auto n = static_cast<std::size_t>(above - height.begin());
  const double share = std::clamp((height_m - height[n - 1]) / (height[n] - height[n - 1]), 0., 1.);
  return (1 - share) * fraction[n - 1] + share * fraction[n];
}

}  // namespace

GasModel::Bands GasModel::bands() const {
  return {{spectrum().lower.front()}, {spectrum().upper.back()}, std::vector<int>(static_cast<std::size_t>(points()))};
}

std::unique_ptr<GasModel> read_gas_model(const std::filesystem::path& file) {
  return make_ecckd_model(after_sandbox(file, {.library = "netCDF"}, [&] { return read_ecckd(file); }));
}

GasModel::LayerOptics gas_optics(const GasModel& model, const Atmosphere& atmosphere, std::span<const double> edges_m) {
  assert(edges_m.size() >= 2);
  check_gases(model, atmosphere);
  const std::size_t layers = edges_m.size() - 1;
  std::vector<double> pressure(edges_m.size()), temperature(layers);
  for (std::size_t n = 0; n <= layers; ++n) pressure[n] = atmosphere.pressure_at(edges_m[n]);
  for (std::size_t n = 0; n < layers; ++n) {
    temperature[n] = (atmosphere.temperature_at(edges_m[n]) * pressure[n] +
                      atmosphere.temperature_at(edges_m[n + 1]) * pressure[n + 1]) /
                     (pressure[n] + pressure[n + 1]);
  }
  std::vector<std::vector<double>> fraction;
  for (const std::string& gas : model.gases()) {
    const std::vector<double>& profile = atmosphere.mole_fraction.at(gas);
    std::vector<double>& of_layers = fraction.emplace_back(layers);
    for (std::size_t n = 0; n < layers; ++n) {
      const double height = height_of_pressure(atmosphere, (pressure[n] + pressure[n + 1]) / 2);
      of_layers[n] = fraction_at(atmosphere, profile, height);
    }
  }
  return model.optics(pressure, temperature, fraction);
}

}  // namespace cloudbow
