// Gas models by ecCKD files that the tests make: each dependence on the mole fraction against its closed form.
#include <gmock/gmock.h>

#include <array>
#include <cmath>

#include "../app/temporary_folder.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/gas_model.hpp"
#include "cloudbow/optics/planck.hpp"
#include "ecckd_example.hpp"
#include "gas_test_tools.hpp"

namespace cloudbow {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

using namespace ecckd_example;

// -- The air between heights ------------------------------------------------------------------------------------------

Atmosphere small_air() {
  Atmosphere air;
  air.height_m = {0, 5000, 10000};
  air.pressure_pa = {1e5, 5e4, 2e4};
  air.temperature_k = {280, 250, 220};
  air.mole_fraction = {{"h2o", {1e-2, 1e-3, 1e-4}}, {"o3", {1e-8, 1e-7, 1e-6}}, {"ch4", {2e-6, 2e-6, 2e-6}}};
  return air;
}

TEST(GasOptics, OfLayersBetweenHeights) {
  const auto model = model_of();
  const Atmosphere air = small_air();
  const std::array<double, 3> edges{0, 4000, 7000};
  const auto optics = gas_optics(*model, air, edges);
  const double p1 = air.pressure_at(4000), p2 = air.pressure_at(7000), mean = (p1 + p2) / 2;
  // Of the second layer, whose mean pressure lies above 5000 m; pressure falls exponentially there.
  const double height = 5000 + 5000 * std::log(5e4 / mean) / std::log(2.5), share = (height - 5000) / 5000;
  ASSERT_GT(share, 0);
  const double kelvin = (air.temperature_at(4000) * p1 + air.temperature_at(7000) * p2) / (p1 + p2);
  const std::vector<std::vector<double>> fraction{
      {1e-3 + share * (1e-4 - 1e-3)}, {1e-7 + share * (1e-6 - 1e-7)}, {2e-6}};
  const auto expected = model->optics(std::array{p1, p2}, std::array{kelvin}, fraction);
  for (std::size_t g = 0; g < points; ++g) EXPECT_NEAR(optics.absorption[g][1] / expected.absorption[g][0], 1, 1e-12);
}

TEST(GasOptics, GoesOnBeyondTheProfile) {
  const auto model = model_of();
  const Atmosphere air = small_air();
  const std::array<double, 2> edges{12000, 15000};
  const double p1 = air.pressure_at(12000), p2 = air.pressure_at(15000);
  const auto expected =
      model->optics(std::array{p1, p2}, std::array{220.}, std::vector<std::vector<double>>{{1e-4}, {1e-6}, {2e-6}});
  EXPECT_NEAR(gas_optics(*model, air, edges).absorption[0][0] / expected.absorption[0][0], 1, 1e-12);
}

TEST(GasOptics, NamesAllGasesThatTheAirLacks) {
  const auto model = model_of();
  Atmosphere air = small_air();
  air.mole_fraction.erase("o3");
  air.mole_fraction.erase("ch4");
  const std::array<double, 2> edges{0, 1000};
  EXPECT_THAT(error_of([&] { gas_optics(*model, air, edges); }),
              AllOf(HasSubstr("lacks gases of the gas model: o3, ch4"), HasSubstr("found h2o"),
                    HasSubstr("allowed all of h2o, o3, ch4"), HasSubstr("one mole fraction")));
}

}  // namespace
}  // namespace cloudbow
