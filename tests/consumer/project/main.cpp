// A sheet of cloud under the sun, solved by the public headers; with a file, what it holds.
#include <cmath>
#include <cstdio>
#include <exception>

#include "cloudbow/medium/optical_grid.hpp"
#include "cloudbow/medium/vdb_file.hpp"
#include "cloudbow/transport/solution.hpp"

int main(int argc, char** argv) try {
  cloudbow::Layer sheet;
  sheet.bottom_m = 500;
  sheet.top_m = 1000;
  sheet.optical_depth = 8;

  cloudbow::Problem problem;
  problem.grid = cloudbow::make_optical_grid(nullptr, {}, {sheet}, {0, 0, 0}, {1, 1, 1000}, /*periodic=*/true,
                                             /*phase_functions=*/1, {0.0}, cloudbow::LevelOptions::layers_only());
  problem.phase = {cloudbow::PhaseFunction::rayleigh()};
  problem.sun = cloudbow::Sun{cloudbow::Direction(std::sin(0.5), 0, -std::cos(0.5)), 1000};

  cloudbow::SolverOptions options;
  options.control_points = 42;
  const cloudbow::Solution solution = cloudbow::solve(problem, options);
  std::printf("reflectance %.6f, residual %.1e\n", solution.ledger.reflectance, solution.ledger.residual);
  if (argc > 1) {
    std::printf("voxels %zu\n", cloudbow::read_cloud_vdb(argv[1]).active_voxels());
  }
  return std::abs(solution.ledger.residual) < 1e-4 ? 0 : 1;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 2;
}
