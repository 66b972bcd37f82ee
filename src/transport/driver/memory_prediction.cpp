// Memory of a solve, predicted before anything is allocated.
#include <algorithm>
#include <cmath>

#include "cloudbow/transport/solver.hpp"
#include "transport/columns/columns.hpp"
#include "transport/driver/path_load.hpp"
#include "transport/driver/predicted_work.hpp"
#include "transport/gather/gather.hpp"
#include "transport/observers/circumsolar.hpp"

namespace cloudbow {

namespace {

std::size_t grid_bytes(const Problem& problem) {
  return problem.grid.active_cells() * (1 + problem.phase.size()) * sizeof(float);
}

// Shares of a rank in arrays that ranks divide (docs/mpi.md, "Memory").
struct RankShare {
  double cells = 1;    // radiance, moments
  double octants = 1;  // slopes
  double points = 1;   // source at control points: those of the octants, and beside them

  explicit RankShare(int ranks) {
    if (ranks < 2) return;
    cells = 1. / ranks;
    octants = ranks >= 8 ? .125 : ranks >= 4 ? .25 : .5;
    points = std::pow(octants, .6);  // 28 and 18 of 42 with two and four ranks
  }
};

std::size_t part(double share, std::size_t bytes) {
  return static_cast<std::size_t>(share * static_cast<double>(bytes));
}

std::size_t memory_of_solve(const SolvePlan& plan, int ranks) {
  const Problem& problem = plan.problem();
  const SolverOptions& options = plan.options();
  // Files that OpenVDB must read take 33 MB more.
  constexpr std::size_t libraries = 24'500'000;
  check_paths(plan);
  const auto threads = static_cast<std::size_t>(threads_of(plan));
  const auto of_patterns = static_cast<std::size_t>(path_load(plan).bytes(static_cast<int>(threads)));
  if (plan.by_polar_streams()) {
    constexpr std::size_t program_of_columns = 22'000'000;
    return program_of_columns + of_patterns + columns_memory(problem, options, plan.in_double(), threads_of(plan));
  }
  const BoxGrid& box = problem.grid.box;
  // Columns on their own are solved by one rank.
  const bool is_shared = !options.independent_columns && !plan.is_one_column();
  const RankShare share(is_shared ? ranks : 1);
  const std::size_t active = plan.cells();
  const std::size_t real = plan.in_double() ? sizeof(double) : sizeof(float);
  const std::size_t phases = problem.phase.size();
  const auto ordinates = static_cast<std::size_t>(make_ordinate_set(options.directions).size());
  const auto points = static_cast<std::size_t>(options.control_points);
  // A cell of the grid; with its neighbours, its place along x and its share of the chunks; with its beam.
  const std::size_t grid = 4 * (1 + phases);
  const std::size_t cell = real * (5 + phases) + 24 + 4 + 10;
  // With the slopes of light of each octant, of the radiance and of the source, and that of the beam.
  const bool slopes = options.linear_source && !options.independent_columns && box.columns() > 1;
  const std::size_t system = real * (1 + phases) + 4 + (slopes ? real * 3 + part(share.octants, real * 48) : 0);
  const bool packed = options.half_precision_radiance && real == sizeof(float);
  const std::size_t stored = packed ? sizeof(std::uint16_t) : real;
  // Radiance at the ordinates, four sets of moments, four of these in eight sets more for the mixing, gradients; work
  // arrays of a direction on each thread. The low-order problem has a sixth of the cells if it is coarse.
  const std::size_t low_cell = real * (32 + 2 * 9 + 4 * 15) + 60;
  const bool coarse = coarsens(plan, medium_of(plan));
  const std::size_t iteration = part(share.cells, stored * ordinates + real * (4 * 9 + 8 * 4)) +
                                real * (7 + (packed ? 5 : 4) * threads) + (slopes ? real * (3 + 10 * threads) : 0) +
                                (coarse ? low_cell / 6 + real + 7 : low_cell);
  // Source at the points in the place of the radiance; first orders of scattering, gradients.
  const std::size_t gather =
      part(share.points, stored * std::max(ordinates, points)) + real * (9 + 2 * phases + 4 * threads + 8);
  const std::size_t radiance_field = options.radiance_field ? points * 4 + 12 : 0;
  // Fluxes and beams of the columns at each level.
  constexpr std::size_t place = 20;
  const std::size_t places = box.columns() * flux_levels(box, options).size();
  constexpr std::size_t messages = 25'000'000;  // of MPI
  const std::size_t program = libraries + (ranks > 1 ? messages : 0);
  // Scattering matrices of each phase function, as fitted, rounded and folded.
  const std::size_t tables = 3 * sizeof(double) * phases * ordinates * (points + ordinates);
  std::size_t pixels = 0;
  for (const Camera& camera : options.cameras) pixels += static_cast<std::size_t>(camera.width) * camera.height;
  for (const View& view : options.views) {
    pixels += view.width > 0 ? static_cast<std::size_t>(view.width) * view.height : box.columns();
  }
  // Memory then holds their source, the radiance at the ordinates and a second array. The source stays for images,
  // which add gradients and a copy of the data that lines read.
  const std::size_t seen = directions_seen(options, active);
  const std::size_t making_seen = seen > 0 ? stored * ordinates + real * (2 * seen + 2) : 0;
  const std::size_t showing = seen > 0 ? real * (seen + 12) : 0;
  // Radiance of the ground at the control points of its reflection, for the gather and for images. Also the light that
  // arrives there along the ordinates, and the light that leaves.
  constexpr std::size_t points_of_surface = 642;
  const std::size_t surface = problem.surface.brdf ? real * (2 * points_of_surface + 2 * ordinates) : 0;
  // The table of reflection is made, and let go, before the iteration.
  const std::size_t making_surface = problem.surface.brdf ? 27'000'000 : 0;
  const std::vector<int> inner = inner_levels(box, options);
  const std::size_t kept = slopes || !options.linear_source ? cells_of_largest_level(problem.grid) : active;
  const std::size_t levels_between =
      plan.in_double() ? level_gather_bytes<double>(box, kept, inner, options.gather_directions, threads_of(plan))
                       : level_gather_bytes<float>(box, kept, inner, options.gather_directions, threads_of(plan));
  const std::size_t of_cone =
      options.circumsolar_half_angle > 0
          ? circumsolar_bytes(active, phases, flux_levels(box, options).size() * box.columns(), real)
          : 0;
  // Radiance of independent columns at all interfaces, from which their fluxes are.
  const std::size_t passing = options.independent_columns ? real * ordinates * box.columns() * box.z_edge_m.size() : 0;
  const std::size_t held = grid + cell + system + radiance_field;
  const std::size_t working =
      std::max({active * std::max(iteration, making_seen) + passing, active * gather + levels_between + of_cone,
                active * (gather + showing) + pixels * sizeof(float), making_surface});
  const std::size_t solving = tables + of_patterns + active * held + working + box.columns() * surface;
  // Images on their way into the file.
  const std::size_t writing = active * (grid + radiance_field) + pixels * 3 * sizeof(float);
  return program + places * place + std::max(solving, writing);
}

}  // namespace

std::size_t predict_memory(const SolvePlan& plan, int ranks) {
  std::size_t bytes = memory_of_solve(plan, ranks);
  if (plan.added_levels() > 0) bytes += grid_bytes(plan.collapsed());
  if (plan.column_parts().any()) bytes += grid_bytes(plan.with_levels());
  if (plan.collapsed_axes().any()) {
    const BoxGrid& box = plan.whole().grid.box;
    // Fluxes and absorption of the whole, and on their way into the file.
    bytes += grid_bytes(plan.whole()) + 8 * box.columns() * static_cast<std::size_t>(box.nz()) * sizeof(float);
  }
  return bytes;
}

}  // namespace cloudbow
