// Cost of columns without iteration, before anything is allocated.
#include <algorithm>
#include <vector>

#include "cloudbow/transport/output_fields.hpp"
#include "transport/columns/columns.hpp"
#include "transport/grid/lanes.hpp"

namespace cloudbow {

std::size_t columns_memory(const Problem& problem, const SolverOptions& options, bool in_double, int threads) {
  const BoxGrid& box = problem.grid.box;
  const std::size_t levels = box.z_edge_m.size();
  const std::size_t cells = box.columns() * static_cast<std::size_t>(box.nz());
  const std::size_t active = problem.grid.active_cells();
  const std::size_t real = in_double ? sizeof(double) : sizeof(float);
  const auto n = static_cast<std::size_t>(options.column_streams);
  const std::size_t fluxes = flux_levels(box, options).size();
  const std::size_t fields =
      4 * (3 * fluxes * box.columns() + static_cast<std::size_t>(cell_field_count(options)) * cells);
  const std::size_t batch = levels * lanes * real * (n * (n + 1) + 4 * n + 20 + 2 * problem.phase.size());
  const std::size_t grid = 4 * active * (1 + problem.phase.size() + (problem.grid.emits() ? 2 : 0));
  const std::size_t bookkeeping = 8 * active + 64 * box.columns();
  // Rays of a beam are summed in four shares, two beams one after the other.
  const std::size_t level_fluxes = 8 * levels * box.columns();
  const bool slanted = problem.sun && options.beam_crosses_columns;
  const std::size_t beams = slanted ? 6 * level_fluxes + 40 * (options.actinic ? cells : active) : 0;
  return grid + fields + std::max(beams, bookkeeping) + static_cast<std::size_t>(threads) * batch;
}

namespace {

// Share of the columns that differ in their optical depth from all others before them.
double distinct_share(const OpticalGrid& grid) {
  std::vector<double> depth(grid.box.columns(), 0.);
  grid.for_each_place([&](int k, std::size_t column, std::size_t cell) {
    depth[column] += grid.extinction(cell) * grid.box.thickness_m(k);
  });
  std::erase(depth, 0.);
  if (depth.empty()) return 0;
  const auto columns = static_cast<double>(depth.size());
  std::sort(depth.begin(), depth.end());
  return static_cast<double>(std::unique(depth.begin(), depth.end()) - depth.begin()) / columns;
}

}  // namespace

double columns_seconds(const Problem& problem, const SolverOptions& options, bool in_double, int threads) {
  // Measured with AVX2 on one core, for cells of optical depths of about one. Equal columns are solved once, unless the
  // beam crosses them.
  const double n = options.column_streams;
  const double seconds_a_cell = .2e-6 + n * n * (n + 4) * 1e-9 * (in_double ? 2 : 1);
  const double seconds_a_ray_and_cell = options.beam_crosses_columns ? 80e-9 * options.beam_rays : 0;
  const double distinct = options.beam_crosses_columns ? 1 : distinct_share(problem.grid);
  return static_cast<double>(problem.grid.active_cells()) * (distinct * seconds_a_cell + seconds_a_ray_and_cell) /
         threads;
}

}  // namespace cloudbow
