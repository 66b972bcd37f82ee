// Functions that the tests of gas models share.
#pragma once

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <memory>
#include <string>

#include "../app/temporary_folder.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/gas_model.hpp"
#include "ecckd_example.hpp"

namespace cloudbow::ecckd_example {

inline constexpr double gravity = 9.80665, air_molar_mass = 28.970e-3;

inline std::unique_ptr<GasModel> model_of(const Recipe& recipe = {}) {
  const TemporaryFolder folder;
  return read_gas_model(make_file(folder / "model.nc", recipe));
}

inline double air_of(double p1, double p2) { return std::abs(p2 - p1) / (gravity * air_molar_mass); }

/// One layer at 1e4 Pa of air at 230 K with these mole fractions of h2o, o3, ch4.
inline GasModel::LayerOptics one_layer(const GasModel& model, std::array<double, 3> x, double kelvin = 230,
                                       double pressure = 1e4) {
  const std::array<double, 2> edges{0.5 * pressure, 1.5 * pressure};
  const std::vector<std::vector<double>> fraction{{x[0]}, {x[1]}, {x[2]}};
  return model.optics(edges, std::array<double, 1>{kelvin}, fraction);
}

inline std::string error_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

inline std::string error_of(const Recipe& recipe) {
  return error_of([&] { model_of(recipe); });
}

}  // namespace cloudbow::ecckd_example
