// What a solve will cost, before anything is allocated.
#include <omp.h>

#include <algorithm>
#include <cmath>

#include "cloudbow/transport/transport_system.hpp"

namespace cloudbow {

std::size_t predict_memory(const Problem& problem, const SolverOptions& options) {
  const std::size_t dense = problem.grid.box.columns() * static_cast<std::size_t>(problem.grid.box.nz());
  const std::size_t active = options.actinic ? dense : problem.grid.active_cells();
  const std::size_t real = runs_in_double(problem, options) ? sizeof(double) : sizeof(float);
  const std::size_t phases = problem.phase.size();
  const auto ordinates = static_cast<std::size_t>(make_ordinate_set(options.directions).size());
  const auto points = static_cast<std::size_t>(options.control_points);
  const auto threads = static_cast<std::size_t>(options.threads > 0 ? options.threads : omp_get_max_threads());
  // Grid, cells with their neighbours, and the beams.
  const std::size_t system =
      active * (4 * (1 + phases) + real * (1 + 2 * phases) + 3 * (8 + real) + 8 + 2 * real) + dense * 8;
  const std::size_t iteration = iteration_memory(active, dense, static_cast<int>(ordinates), real);
  // While the gather runs: radiance at the ordinates, source at the points, a direction's work arrays on each thread.
  const std::size_t gather =
      active * real * (ordinates + points + 4 * phases + 4 * threads + 4) + dense * (8 * 3 + 4 * 10 + 12);
  const std::size_t radiance_field = options.radiance_field ? active * (points * 4 + 12) : 0;
  constexpr std::size_t program = 60'000'000;  // libraries, tables, the cloud as read
  return program + system + std::max(iteration, gather) + radiance_field;
}

double predict_seconds(const Problem& problem, const SolverOptions& options) {
  // Segments a voxel and direction grow with the slant of the ordinates; constants measured with AVX2 on one core.
  constexpr double seconds_a_segment = 2.5e-9;
  constexpr double seconds_a_cell_and_direction = 6e-9;
  constexpr double seconds_a_multiply = 2.5e-11;
  constexpr int usual_sweeps = 10;
  const OrdinateSet ordinates = make_ordinate_set(options.directions);
  const BoxGrid& box = problem.grid.box;
  const double dz = (box.z_edge_m.back() - box.z_edge_m.front()) / box.nz();
  double segments = 0;
  for (const Direction& d : ordinates.direction)
    segments += 1 + (std::abs(d.x()) * dz / box.dx_m + std::abs(d.y()) * dz / box.dy_m) / std::abs(d.z());
  const double cells = static_cast<double>(options.actinic ? box.columns() * static_cast<std::size_t>(box.nz())
                                                           : problem.grid.active_cells());
  const double directions = ordinates.size();
  const double sweep = cells * (segments * seconds_a_segment + directions * seconds_a_cell_and_direction +
                                directions * directions * seconds_a_multiply);
  const double gather =
      cells * (3.5 * options.gather_directions) * (3 * seconds_a_segment + seconds_a_cell_and_direction);
  const int threads = options.threads > 0 ? options.threads : omp_get_max_threads();
  return (sweep * usual_sweeps + gather) / threads + .2;
}

}  // namespace cloudbow
