// Small problems, and options of few directions, for tests that solve them.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <cmath>
#include <filesystem>
#include <numbers>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "cloudbow/transport/solver.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {

// Tables are made once a process and never taken from an older one.
class FitCache {
 public:
  FitCache()
      : directory_(std::filesystem::path(testing::TempDir()) / ("cloudbow_test_solver_" + std::to_string(getpid()))) {
    std::filesystem::create_directories(directory_);
  }
  ~FitCache() {
    std::error_code ignored;
    std::filesystem::remove_all(directory_, ignored);
  }
  FitCache(const FitCache&) = delete;
  FitCache& operator=(const FitCache&) = delete;
  const std::filesystem::path& directory() const { return directory_; }

 private:
  std::filesystem::path directory_;
};

// Coarse, so that dozens of problems take seconds: the properties tested here hold at any accuracy.
inline SolverOptions coarse() {
  static const FitCache cache;
  SolverOptions options = coarse_options();
  options.fit.cache_directory = cache.directory();
  options.flux_levels = FluxLevels::boundaries;
  return options;
}

inline Problem problem_of(OpticalGrid grid, const PhaseFunction& phase, double mu0 = .6, double azimuth_deg = 37) {
  Problem problem;
  problem.grid = std::move(grid);
  problem.phase = {phase};
  problem.sun = Sun{travel_along(-mu0, azimuth_deg), 1.};
  return problem;
}

inline Problem random_problem(bool periodic, double largest, double single_scattering_albedo, double surface_albedo) {
  const BoxGrid box = make_box(6, 5, 4, periodic);
  Problem problem = problem_of(make_grid(box, random_extinction(box, largest, 1), single_scattering_albedo),
                               PhaseFunction::henyey_greenstein(.85));
  problem.surface.albedo = surface_albedo;
  return problem;
}

// One homogeneous layer as a column of its own.
inline Problem slab(double optical_depth, double single_scattering_albedo, const PhaseFunction& phase, double mu0) {
  const Layer layer{0, 1000, optical_depth, single_scattering_albedo, 0};
  return problem_of(
      make_optical_grid(nullptr, {}, {layer}, {0, 0, 0}, {1, 1, 1000}, true, 1, {0.}, LevelOptions::layers_only()),
      phase, mu0);
}

inline double mean_of_level(const std::vector<float>& flux, const BoxGrid& box, std::size_t level) {
  const auto first = flux.begin() + static_cast<std::ptrdiff_t>(level * box.columns());
  return std::accumulate(first, first + static_cast<std::ptrdiff_t>(box.columns()), 0.) /
         static_cast<double>(box.columns());
}

inline void expect_finite_and_closed(const Solution& solution, double closure) {
  EXPECT_TRUE(solution.report.converged) << solution.report.sweeps << " sweeps, error "
                                         << solution.report.estimated_error;
  EXPECT_LE(std::abs(solution.ledger.residual), closure);
  for (const auto* field : {&solution.upwelling_flux, &solution.downwelling_diffuse_flux, &solution.direct_flux}) {
    for (const float f : *field) {
      ASSERT_TRUE(std::isfinite(f));
      ASSERT_GE(f, 0);
    }
  }
}

}  // namespace cloudbow
