// Sums over the g-points of a small gas model. Truth: single solves of all g-points, added here.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>

#include "app/planning/broadband.hpp"
#include "broadband_tools.hpp"
#include "cloudbow/results/energy_fluxes.hpp"

namespace cloudbow {
namespace {

using namespace broadband_tools;
using testing::Each;
using testing::ElementsAre;

class BroadbandTest : public testing::TestWithParam<GasModel::Light> {
 protected:
  std::vector<Scene> scenes(const std::string& spectrum) {
    const bool is_solar = GetParam() == GasModel::Light::solar;
    return read_scenes(
        files_.write(gas_scene::cloud + settings + (is_solar ? gas_scene::solar : gas_scene::longwave) + spectrum));
  }

  gas_scene::Files files_;
};

template <class Value>
void add_to(std::vector<Value>& sum, const std::vector<Value>& of) {
  sum.resize(of.size());
  std::transform(sum.begin(), sum.end(), of.begin(), sum.begin(), std::plus<>());
}

TEST_P(BroadbandTest, AllIsTheSumOfSingleSolves) {
  const std::vector<Scene> all = scenes("method = \"all\"\n");
  const BroadbandRun found = run(all);
  Solution sum;
  double power = 0, absorbed = 0;
  for (const Solution& one : single_solves(all)) {
    add_to(sum.upwelling_flux, one.upwelling_flux);
    add_to(sum.downwelling_diffuse_flux, one.downwelling_diffuse_flux);
    add_to(sum.direct_flux, one.direct_flux);
    add_to(sum.absorbed_power, one.absorbed_power);
    add_to(sum.profile_upwelling_flux, one.profile_upwelling_flux);
    power += one.ledger.power;
    absorbed += energy_fluxes(one.ledger).absorbed;
  }
  ASSERT_EQ(found.solved.solutions.size(), 1U);
  const Solution& solution = found.solved.solutions[0];
  EXPECT_EQ(solution.upwelling_flux, sum.upwelling_flux);
  EXPECT_EQ(solution.downwelling_diffuse_flux, sum.downwelling_diffuse_flux);
  EXPECT_EQ(solution.direct_flux, sum.direct_flux);
  EXPECT_EQ(solution.absorbed_power, sum.absorbed_power);
  EXPECT_EQ(solution.profile_upwelling_flux, sum.profile_upwelling_flux);
  EXPECT_EQ(solution.ledger.power, power);
  EXPECT_NEAR(energy_fluxes(solution.ledger).absorbed, absorbed, 1e-12 * power);
  EXPECT_LT(std::abs(solution.ledger.residual), 1e-3) << "energy_tolerance, as of any solve";
  EXPECT_EQ(found.info.method, "all");
  EXPECT_EQ(found.info.points, static_cast<int>(gas_scene::points));
  EXPECT_EQ(found.info.light, GetParam() == GasModel::Light::solar ? "solar" : "longwave");
  EXPECT_THAT(found.info.solved, ElementsAre(0, 1, 2, 3));
  EXPECT_THAT(found.info.weight, Each(1.));
  EXPECT_EQ(found.info.residual, 0);
}

TEST_P(BroadbandTest, BandsAreSumsOfTheirPoints) {
  std::vector<Scene> wanted = scenes("method = \"all\"\n");
  EXPECT_THAT(run(wanted).bands, testing::IsEmpty());
  for (Scene& scene : wanted) scene.output.bands = true;
  const BroadbandRun found = run(wanted);
  ASSERT_EQ(found.bands.size(), 2U);
  EXPECT_THAT(found.bands[0].wavenumber_cm1, ElementsAre(6000, 14000));
  EXPECT_THAT(found.bands[1].wavenumber_cm1, ElementsAre(14000, 22000));
  const std::vector<Solution> single = single_solves(wanted);
  for (std::size_t b = 0; b < 2; ++b) {
    std::vector<double> up, down, direct;
    for (const Solution& one : {single[2 * b], single[2 * b + 1]}) {
      add_to(up, one.profile_upwelling_flux);
      add_to(down, one.profile_downwelling_diffuse_flux);
      add_to(direct, one.profile_direct_flux);
    }
    EXPECT_EQ(found.bands[b].upwelling_flux, up);
    EXPECT_EQ(found.bands[b].downwelling_diffuse_flux, down);
    EXPECT_EQ(found.bands[b].direct_flux, direct);
  }
}

TEST_P(BroadbandTest, BandsSumToTheWhole) {
  for (const char* method : {"method = \"all\"\n", "method = \"columns\"\n"}) {
    std::vector<Scene> wanted = scenes(method);
    for (Scene& scene : wanted) scene.output.bands = true;
    const BroadbandRun found = run(wanted);
    const Solution& whole = found.solved.solutions[0];
    ASSERT_EQ(found.bands.size(), 2U);
    const auto expect_sum = [&](std::vector<double> BandProfile::*part, const std::vector<double>& expected,
                                double rounding) {
      std::vector<double> sum;
      for (const BandProfile& band : found.bands) add_to(sum, band.*part);
      ASSERT_EQ(sum.size(), expected.size());
      for (std::size_t n = 0; n < sum.size(); ++n) EXPECT_NEAR(sum[n], expected[n], rounding);
    };
    const double of_double = 1e-14 * whole.ledger.power;
    expect_sum(&BandProfile::upwelling_flux, whole.profile_upwelling_flux, of_double);
    expect_sum(&BandProfile::downwelling_diffuse_flux, whole.profile_downwelling_diffuse_flux, of_double);
    expect_sum(&BandProfile::direct_flux, whole.profile_direct_flux, of_double);
    std::vector<double> absorbed;
    const std::size_t columns = whole.box.columns();
    float largest = 0;
    for (std::size_t n = 0; n < whole.absorbed_power.size(); ++n) {
      if (n % columns == 0) absorbed.push_back(0);
      absorbed.back() += whole.absorbed_power[n] / static_cast<double>(columns);
      largest = std::max(largest, std::abs(whole.absorbed_power[n]));
    }
    constexpr double of_float = 1e-6;
    expect_sum(&BandProfile::absorbed_power, absorbed, of_float * largest);
  }
}

// Of the cloud's grid: .02 per metre times 100 m and .01 times 50 m.
TEST_P(BroadbandTest, OpticalDepthIsNotSummed) {
  for (const char* method : {"method = \"columns\"\n", "few_points = 2\nfew_tolerance = 0.1\n"}) {
    std::vector<Scene> wanted = scenes(method);
    for (Scene& scene : wanted) scene.output.optical_depth = scene.output.extinction = true;
    const BroadbandRun found = run(wanted);
    ASSERT_EQ(found.solved.cloud_optical_depth.size(), 1U) << method;
    const std::vector<float>& depth = found.solved.cloud_optical_depth[0];
    ASSERT_EQ(depth.size(), 12U);
    EXPECT_FLOAT_EQ(depth[4 + 1], 2) << method;
    EXPECT_FLOAT_EQ(depth[4 + 2], .5) << method;
    EXPECT_FLOAT_EQ(std::accumulate(depth.begin(), depth.end(), 0.F), 2.5) << method;
    ASSERT_EQ(found.solved.cloud_extinction.size(), 1U) << method;
    EXPECT_FLOAT_EQ(*std::ranges::max_element(found.solved.cloud_extinction[0]), .02F) << method;
  }
}

TEST_P(BroadbandTest, FewWithAllPointsIsAll) {
  const BroadbandRun all = run(scenes("method = \"all\"\n"));
  const BroadbandRun few = run(scenes("few_tolerance = 1e-6\nfew_points = 4\n"));
  EXPECT_EQ(few.info.method, "few");
  ASSERT_THAT(few.info.solved, ElementsAre(0, 1, 2, 3));
  constexpr double rounding = 1e-6;  // of float; weights are not quite 1
  EXPECT_THAT(few.info.weight, Each(testing::DoubleNear(1, rounding)));
  const auto expect_near = [&](const std::vector<float>& a, const std::vector<float>& b) {
    const float largest = *std::max_element(b.begin(), b.end());
    for (std::size_t n = 0; n < b.size(); ++n) EXPECT_NEAR(a[n], b[n], rounding * largest);
  };
  expect_near(few.solved.solutions[0].upwelling_flux, all.solved.solutions[0].upwelling_flux);
  expect_near(few.solved.solutions[0].downwelling_diffuse_flux, all.solved.solutions[0].downwelling_diffuse_flux);
}

// The choice keeps the sum of weights, which counts power, to about the square of its residual.
TEST_P(BroadbandTest, FewKeepsPowerAndItsResidual) {
  const std::vector<Scene> given = scenes("few_tolerance = 0.1\nfew_points = 2\n");
  const BroadbandRun few = run(given), all = run(scenes("method = \"all\"\n"));
  EXPECT_LE(few.info.solved.size(), 2U);
  EXPECT_GT(few.info.residual, 0);
  const double power = all.solved.solutions[0].ledger.power;
  EXPECT_NEAR(few.solved.solutions[0].ledger.power / power, 1, 1e-2);
  const auto mean_up = [](const BroadbandRun& of) { return of.solved.solutions[0].profile_upwelling_flux.back(); };
  EXPECT_NEAR(mean_up(few) / mean_up(all), 1, 2 * few.info.residual);
}

// All twelve columns are sampled, by the same solver as the fields: so domain means are those of all g-points.
TEST_P(BroadbandTest, MeansOfIndependentColumnsAreThoseOfAll) {
  const auto independent_columns = [&](const std::string& spectrum) {
    std::vector<Scene> given = scenes(spectrum);
    for (Scene& scene : given) scene.solver.mode = SolveMode::independent_columns;
    return run(given);
  };
  const BroadbandRun few = independent_columns("few_tolerance = 0.1\nfew_points = 2\n"),
                     all = independent_columns("method = \"all\"\n");
  ASSERT_LE(few.info.solved.size(), 2U);
  const Solution &found = few.solved.solutions[0], &expected = all.solved.solutions[0];
  constexpr double rounding = 1e-6;  // of float, and of the largest flux
  const double power = expected.ledger.power;
  for (const auto profile : {&Solution::profile_upwelling_flux, &Solution::profile_downwelling_diffuse_flux,
                             &Solution::profile_direct_flux}) {
    ASSERT_EQ((found.*profile).size(), (expected.*profile).size());
    for (std::size_t level = 0; level < (expected.*profile).size(); ++level)
      EXPECT_NEAR((found.*profile)[level], (expected.*profile)[level], rounding * power) << level;
  }
  const EnergyFluxes of_few = energy_fluxes(found.ledger), of_all = energy_fluxes(expected.ledger);
  EXPECT_NEAR(of_few.upwelling_top, of_all.upwelling_top, rounding * power);
  EXPECT_NEAR(of_few.downwelling_bottom, of_all.downwelling_bottom, rounding * power);
  EXPECT_NEAR(of_few.direct_bottom, of_all.direct_bottom, rounding * power);
  EXPECT_NEAR(of_few.absorbed, of_all.absorbed, rounding * power);
  EXPECT_NEAR(of_few.surface_absorbed, of_all.surface_absorbed, rounding * power);
  EXPECT_NEAR(of_few.surface_emitted, of_all.surface_emitted, rounding * power);
  EXPECT_NEAR(of_few.incident, of_all.incident, rounding * power);
}

TEST_P(BroadbandTest, ThreadsLeaveTheBits) {
  const std::vector<Scene> given = scenes("few_tolerance = 0.01\nfew_points = 3\n");
  const BroadbandRun one = run(given, 1), two = run(given, 2);
  EXPECT_EQ(one.info.solved, two.info.solved);
  EXPECT_EQ(one.info.weight, two.info.weight);
  EXPECT_EQ(one.info.residual, two.info.residual);
  expect_same_bits(one.solved.solutions[0], two.solved.solutions[0]);
}

TEST_P(BroadbandTest, ColumnsAreIndependentColumnsOfAll) {
  const BroadbandRun columns = run(scenes("method = \"columns\"\n"));
  std::vector<Scene> by_mode = scenes("method = \"all\"\n");
  for (Scene& scene : by_mode) scene.solver.mode = SolveMode::independent_columns;
  expect_same_bits(columns.solved.solutions[0], run(by_mode).solved.solutions[0]);
  EXPECT_EQ(columns.info.method, "columns");
  EXPECT_EQ(columns.solved.solutions[0].report.mode, "independent-columns");
}

INSTANTIATE_TEST_SUITE_P(Light, BroadbandTest, testing::Values(GasModel::Light::solar, GasModel::Light::longwave),
                         [](const auto& of) { return of.param == GasModel::Light::solar ? "solar" : "longwave"; });

}  // namespace
}  // namespace cloudbow
