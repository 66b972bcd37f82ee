// Light of one solve as the first guess of another. Truth: the light itself, and the solve without it.
#include <gtest/gtest.h>

#include "solve_test_tools.hpp"
#include "transport/iteration/first_guess.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {
namespace {

Problem cloud() { return random_problem(true, 2, .99, .1); }

template <class Real>
TransportSystem<Real> system_of(const Problem& problem, const SolverOptions& options) {
  return make_system<Real>(problem, discretise(problem.phase, problem.sun->travel, options), options);
}

template <class Real>
double largest_difference(const std::vector<Real>& one, const std::vector<Real>& other, std::size_t count) {
  double largest = 0;
  for (std::size_t c = 0; c < count; ++c)
    largest = std::max(largest, std::abs(static_cast<double>(one[c]) - static_cast<double>(other[c])));
  return largest;
}

template <class Real>
void expect_kept() {
  const Problem problem = cloud();
  const TransportSystem<Real> system = system_of<Real>(problem, coarse());
  const IterationResult<Real> truth = iterate_source<Real>(system, {1e-4, 1e-4, 50}, {});
  IterationResult<Real> given = truth;
  CellLight light = cell_light(system, SolvePlan(problem, coarse()), std::move(given));
  EXPECT_EQ(&light.plan->problem(), &problem);
  FirstGuess<Real> guess = first_guess(system, problem.sun, std::move(light));
  EXPECT_FALSE(light.plan);
  const double resolution = 4 * std::numeric_limits<float>::epsilon() * truth.moments[0];
  EXPECT_LT(largest_difference(guess.moments, truth.moments, truth.moments.size()), 10 * resolution);
  ASSERT_TRUE(guess.slopes);
  EXPECT_TRUE(guess.slopes->fitted);
  const std::vector<Real>&kept = guess.slopes->of_octant[3][1], &found = truth.slopes->of_octant[3][1];
  EXPECT_LT(largest_difference(kept, found, system.cells->size()), 1e-6);

  const IterationOptions options{1e-2, 1e-3, 50};
  const IterationResult<Real> again = iterate_source<Real>(system, options, {}, nullptr, nullptr, guess);
  EXPECT_TRUE(again.report.converged);
  EXPECT_LT(again.report.sweeps, iterate_source<Real>(system, options, {}).report.sweeps);
  EXPECT_FALSE(again.fluxes.profile_up.empty());
  EXPECT_NEAR(again.ledger.reflectance, truth.ledger.reflectance, 1e-3);
}

TEST(FirstGuess, OfTheSameSolveIsItsLight) {
  expect_kept<float>();
  expect_kept<double>();
}

// The two beams contain different parts of the forward peak: the diffuse light differs much, all light little.
TEST(FirstGuess, OfAnotherTruncationHasItsOwnBeam) {
  const Problem problem = cloud();
  SolverOptions other = coarse();
  other.fit.delta_m_order = 4;
  other.fit.beam_delta_m_order = 4;
  const TransportSystem<double> system = system_of<double>(problem, coarse());
  const TransportSystem<double> another = system_of<double>(problem, other);
  const IterationOptions exact{1e-5, 1e-5, 50};
  const std::vector<double> truth = iterate_source<double>(another, exact, {}).moments;
  IterationResult<double> solved = iterate_source<double>(system, exact, {});
  const std::size_t n = system.cells->size();
  const double of_diffuse = largest_difference(solved.moments, truth, n);
  const FirstGuess<double> guess =
      first_guess(another, problem.sun, cell_light(system, SolvePlan(problem, coarse()), std::move(solved)));
  EXPECT_LT(largest_difference(guess.moments, truth, n), .5 * of_diffuse);
}

TEST(FirstGuess, OfAConstantSourceHasNoSlopes) {
  const Problem problem = cloud();
  SolverOptions constant = coarse();
  constant.linear_source = false;
  const TransportSystem<float> linear_system = system_of<float>(problem, coarse());
  const TransportSystem<float> system = system_of<float>(problem, constant);
  const IterationOptions exact{1e-4, 1e-4, 50};
  CellLight light =
      cell_light(linear_system, SolvePlan(problem, coarse()), iterate_source<float>(linear_system, exact, {}));
  EXPECT_FALSE(light.slopes.empty());
  const IterationResult<float> solved =
      iterate_source<float>(system, exact, {}, nullptr, nullptr, first_guess(system, problem.sun, std::move(light)));
  EXPECT_FALSE(solved.slopes);
  EXPECT_NEAR(solved.ledger.reflectance, iterate_source<float>(system, exact, {}).ledger.reflectance, 1e-4);
  light = cell_light(system, SolvePlan(problem, coarse()), IterationResult<float>(solved));
  EXPECT_TRUE(light.slopes.empty());
  const FirstGuess<float> guess = first_guess(linear_system, problem.sun, std::move(light));
  EXPECT_FALSE(guess.slopes);
}

// A cell in which the beam of the new solve is more than all light of the other.
TEST(FirstGuess, IsNotNegative) {
  const Problem problem = cloud();
  const TransportSystem<double> system = system_of<double>(problem, coarse());
  const std::size_t n = system.cells->size();
  CellLight light{SolvePlan(problem, coarse()), std::vector<float>(low_moments * n, 1e-6F), {}};
  const FirstGuess<double> guess = first_guess(system, problem.sun, std::move(light));
  ASSERT_GT(*std::min_element(system.beam.irradiance.begin(), system.beam.irradiance.end()), 1e-6);
  EXPECT_EQ(largest_difference(guess.moments, std::vector<double>(low_moments * n), low_moments * n), 0);
}

}  // namespace
}  // namespace cloudbow
