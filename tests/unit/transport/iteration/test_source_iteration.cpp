// Iterations that leave the way to the solution. Truth: the iteration that did not, or a problem without a solution.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <map>
#include <stdexcept>
#include <string>
#include <vector>

#include "transport/iteration/iteration_state.hpp"
#include "transport/iteration/step_watch.hpp"
#include "transport/system/transport_system.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

Problem thick_cloud() {
  const BoxGrid box = make_box(5, 4, 6);
  Problem problem;
  problem.grid = make_grid(box, random_extinction(box, 6, 3), .999);
  problem.phase = {PhaseFunction::henyey_greenstein(.8)};
  problem.sun = Sun{travel_along(-.6, 37), 1.};
  return problem;
}

template <class Real>
TransportSystem<Real> system_of(const Problem& problem) {
  const SolverOptions options = coarse_options();
  return make_system<Real>(problem, discretise(problem.phase, problem.sun->travel, options), options);
}

// Keeps each state between two sweeps. On the way back it can spoil the history of mixing.
class Spoiling : public Checkpoints {
 public:
  struct Stopped {};
  int stop_after = 0;
  double factor = 1;
  std::vector<double> steps;

  Found find(const StateKey&) override { return arrays_.empty() ? Found::nothing : Found::same_problem; }
  void load(const StateArray& array) override {
    const std::vector<std::vector<char>>& rows = arrays_.at(array.name);
    for (std::size_t r = 0; r < rows.size(); ++r) std::memcpy(array.rows[r], rows[r].data(), rows[r].size());
    if (factor == 1) return;
    if (array.name.starts_with("iterate_change") || array.name == "scattering_moments") {
      auto* const values = static_cast<double*>(array.rows[0]);
      for (std::size_t n = 0; n < array.length; ++n) values[n] *= n % 2 == 0 ? factor : -factor;
    }
  }
  void refuse(const std::string& problem) override { throw std::invalid_argument(problem); }
  void loaded(int) override {}
  bool due() override { return true; }
  void save(const StateKey&, std::span<const StateArray> state) override {
    arrays_.clear();
    for (const StateArray& array : state) {
      arrays_.try_emplace(array.name);
      for (const void* row : array.rows) {
        const char* const bytes = static_cast<const char*>(row);
        arrays_[array.name].emplace_back(bytes, bytes + array.length * array.value_bytes);
      }
      if (array.name == "steps") {
        const auto* const values = static_cast<const double*>(array.rows[0]);
        steps.assign(values, values + array.length);
      }
    }
    if (static_cast<int>(steps.size()) == stop_after) throw Stopped{};
  }

 private:
  std::map<std::string, std::vector<std::vector<char>>> arrays_;
};

TEST(SourceIteration, ComesBackAfterARestart) {
  const TransportSystem<double> system = system_of<double>(thick_cloud());
  const IterationOptions options{1e-6, 1e-6, 100};
  const IterationResult<double> truth = iterate_source(system, options, {});
  ASSERT_TRUE(truth.report.converged);
  Spoiling spoiling;
  spoiling.stop_after = 5;
  EXPECT_THROW(iterate_source(system, options, {}, &spoiling), Spoiling::Stopped);
  spoiling.stop_after = 0;
  spoiling.factor = 1e6;  // light of a million suns, half of it negative
  Spoiling interrupted = spoiling;
  const IterationResult<double> back = iterate_source(system, options, {}, &spoiling);
  EXPECT_TRUE(StepWatch::of(spoiling.steps, 0).restarted);
  EXPECT_TRUE(back.report.converged);
  // Slopes of light depend on the way, by less than 1e-4.
  EXPECT_NEAR(back.ledger.reflectance, truth.ledger.reflectance, 2e-4);
  EXPECT_NEAR(back.ledger.transmittance, truth.ledger.transmittance, 2e-4);

  // The same bits if the iteration stops after the restart and goes on.
  interrupted.stop_after = 5 + StepWatch::patience + 2;
  EXPECT_THROW(iterate_source(system, options, {}, &interrupted), Spoiling::Stopped);
  EXPECT_TRUE(StepWatch::of(interrupted.steps, 0).restarted);
  interrupted.stop_after = 0;
  interrupted.factor = 1;
  const IterationResult<double> resumed = iterate_source(system, options, {}, &interrupted);
  EXPECT_EQ(resumed.report.sweeps, back.report.sweeps);
  EXPECT_EQ(resumed.moments, back.moments);
}

// Its last sweep has no correction: the step is predicted. With checkpoints the correction is made, so that the last
// step is another and the light the same.
TEST(SourceIteration, ACoarseSolveIsWithinItsTolerance) {
  int predicted = 0;
  for (const double extinction : {.3, 1., 6., 20.}) {
    Problem problem = thick_cloud();
    problem.grid = make_grid(problem.grid.box, random_extinction(problem.grid.box, extinction, 3), .999);
    const TransportSystem<double> system = system_of<double>(problem);
    const std::vector<double> truth = iterate_source(system, {1e-8, 1e-8, 200}, {}).moments;
    const IterationResult<double> coarse = iterate_source(system, {.015, 1e-3, 200}, {});
    EXPECT_TRUE(coarse.report.converged);
    const std::size_t n = system.cells->size();
    double error = 0, size = 0;
    for (std::size_t c = 0; c < n; ++c) {
      error += std::pow(coarse.moments[c] - truth[c], 2);
      size += truth[c] * truth[c];
    }
    EXPECT_LT(std::sqrt(error / size), coarse.report.estimated_error) << extinction;
    EXPECT_LE(coarse.report.estimated_error, .015);
    Spoiling kept;
    const IterationResult<double> corrected = iterate_source(system, {.015, 1e-3, 200}, {}, &kept);
    if (corrected.report.sweeps != coarse.report.sweeps) continue;
    EXPECT_EQ(corrected.moments, coarse.moments);
    if (corrected.report.estimated_error != coarse.report.estimated_error) ++predicted;
  }
  EXPECT_GT(predicted, 0);
}

TEST(SourceIteration, RefusesWhatHasNoSolution) {
  // Each scattering makes three photons of one, in a medium from which light hardly escapes: it grows without end.
  TransportSystem<double> system = system_of<double>(thick_cloud());
  auto cells = std::make_shared<Cells<double>>(*system.cells);
  for (double& share : cells->scattered[0]) share *= 3;
  system.cells = cells;
  EXPECT_THROW(iterate_source(system, {1e-6, 1e-6, 200}, {}), std::runtime_error);
}

TEST(SourceIteration, EndsWhereItStalls) {
  // A tolerance below the resolution of float: after about 15 sweeps nothing becomes better.
  const TransportSystem<float> system = system_of<float>(thick_cloud());
  const IterationResult<float> result = iterate_source(system, {1e-9, 1e-9, 200}, {});
  EXPECT_FALSE(result.report.converged);
  EXPECT_TRUE(result.report.stalled);
  EXPECT_LT(result.report.sweeps, 60);
  EXPECT_LT(result.report.estimated_error, 1e-4);
  EXPECT_FALSE(result.fluxes.profile_up.empty());  // the last sweep recorded
}

}  // namespace
}  // namespace cloudbow
