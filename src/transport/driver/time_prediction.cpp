// Time of a solve, predicted from counts of its work.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "cloudbow/sphere/ordinate_set.hpp"
#include "cloudbow/transport/solve_seconds.hpp"
#include "cloudbow/transport/solver.hpp"
#include "transport/columns/columns.hpp"
#include "transport/driver/path_load.hpp"
#include "transport/driver/predicted_work.hpp"
#include "transport/gather/gather.hpp"
#include "transport/grid/lanes.hpp"
#include "transport/observers/camera_view.hpp"
#include "transport/observers/circumsolar.hpp"
#include "transport/observers/sight_line.hpp"

namespace cloudbow {

namespace {

// Whether ordinates may be marched along x and y too. Thick voxels, and few cells, are marched along z alone.
bool marches_sideways(const SolvePlan& plan, const Medium& medium) {
  constexpr double few_cells = 2000;
  constexpr double thick_voxel = 4. / 3;
  const BoxGrid& box = plan.problem().grid.box;
  return may_march_sideways(box, plan.options().independent_columns) && medium.cells >= few_cells &&
         medium.voxel_depth <= thick_voxel;
}

// Runs of cells that directions cross, each as often as it has segments.
class CellCrossing {
 public:
  CellCrossing(const BoxGrid& box, const Medium& medium, bool independent_columns, bool sideways)
      : medium_(medium), sideways_(sideways) {
    const bool still_x = independent_columns || (box.periodic && box.nx == 1);
    const bool still_y = independent_columns || (box.periodic && box.ny == 1);
    per_m_ = {still_x ? 0 : 1 / box.dx_m, still_y ? 0 : 1 / box.dy_m};
  }

  double runs(const Direction& travel) const {
    double sum = 0;
    for (const LevelWork& level : medium_.levels) {
      const double x = std::abs(travel.x()) * per_m_[0], y = std::abs(travel.y()) * per_m_[1];
      const double z = std::abs(travel.z()) / level.thickness_m;
      const bool sideways = sideways_ && std::max(x, y) > z && level.even;
      const double air = level.in_air && !sideways ? 0 : level.runs_of_air;
      sum += (x + y + z) / (sideways ? std::max(x, y) : z) * (level.runs + air);
    }
    return sum;
  }
  double runs(const std::vector<Direction>& travel) const {
    double sum = 0;
    for (const Direction& direction : travel) sum += runs(direction);
    return sum;
  }

 private:
  const Medium& medium_;
  bool sideways_;
  std::array<double, 2> per_m_{};
};

// Time of the direct beams: each of their rays crosses every row of its level in each segment.
double beam_seconds(const Problem& problem, const SolverOptions& options, double cells) {
  constexpr int beams = 4;  // the iteration's, the true one, and those of the gather between
  constexpr double seconds_a_run = 30e-9;
  constexpr double seconds_to_make_a_segment = 30e-9;
  const BoxGrid& box = problem.grid.box;
  const double runs_a_level = cells / box.nz() / std::min(lanes, box.nx);
  return beams * options.beam_rays * beam_segments(problem, options) *
         (runs_a_level * seconds_a_run + seconds_to_make_a_segment);
}

// Optical depth per metre of the domain, on average.
double mean_extinction(const OpticalGrid& grid) {
  double sum = 0;
  grid.for_each_cell([&](int, std::size_t cell, std::uint32_t voxels) { sum += voxels * grid.extinction(cell); });
  return sum / (static_cast<double>(grid.box.columns()) * grid.box.nz());
}

// Cells along a line of sight until it leaves or is opaque; in clouds with gaps it is longer than by their mean.
double cells_crossed(const BoxGrid& box, double extinction, const Eigen::Vector3d& eye, const Direction& line) {
  constexpr double deepest = 20;
  double enter = 0, leave = std::numeric_limits<double>::infinity();
  sight::clip(eye.z(), line.z(), box.z_edge_m.front(), box.z_edge_m.back(), enter, leave);
  if (!box.periodic) {
    sight::clip(eye.x(), line.x(), box.x_min_m, box.x_min_m + box.nx * box.dx_m, enter, leave);
    sight::clip(eye.y(), line.y(), box.y_min_m, box.y_min_m + box.ny * box.dy_m, enter, leave);
  }
  const double across = std::abs(line.x()) / box.dx_m + std::abs(line.y()) / box.dy_m;
  const double most = sight::most_domains * std::max(box.nx, box.ny) / std::max(across, 1e-30);
  const double length = std::min({leave - enter, deepest / extinction, most});
  const double height = box.z_edge_m.back() - box.z_edge_m.front();
  return std::max(0., length) * (across + std::abs(line.z()) * box.nz() / height);
}

// Time of lines of sight through pixels.
double pixel_seconds(const Problem& problem, const SolverOptions& options) {
  constexpr double seconds_a_line = .4e-6;
  constexpr double seconds_a_cell = 8e-9;
  constexpr double seconds_a_cell_with_matter = 30e-9;
  if (options.cameras.empty() && options.views.empty()) return 0;
  const BoxGrid& box = problem.grid.box;
  const double extinction = mean_extinction(problem.grid);
  const double filled =
      static_cast<double>(problem.grid.active_cells()) / (static_cast<double>(box.columns()) * box.nz());
  const double of_cell = seconds_a_cell + filled * seconds_a_cell_with_matter;
  double seconds = 0;
  for (const Camera& camera : options.cameras) {
    const Camera sample = coarser({camera}, 16).front();
    double lines = 0, cells = 0;
    for (int row = 0; row < sample.height; ++row) {
      for (int column = 0; column < sample.width; ++column) {
        for_lines_of_sight(sample, row, column, [&](const Direction& line) {
          ++lines;
          cells += cells_crossed(box, extinction, camera.position_m, line);
        });
      }
    }
    const double each = static_cast<double>(camera.width) * camera.height / (sample.width * sample.height);
    seconds += each * (lines * seconds_a_line + cells * of_cell);
  }
  for (const View& view : options.views) {
    const double plane = view.travel.z() > 0 ? box.z_edge_m.back() : box.z_edge_m.front();
    const Eigen::Vector3d eye(box.x_min_m + box.nx * box.dx_m / 2, box.y_min_m + box.ny * box.dy_m / 2, plane);
    const double lines = static_cast<double>(view.width) * view.height * options.beam_rays;
    seconds += lines * (seconds_a_line + of_cell * cells_crossed(box, extinction, eye, -view.travel));
  }
  return seconds;
}

// Time of the source along lines of sight: scattered twice from all ordinates, and marched.
double seen_seconds(const SolverOptions& options, double cells, int ordinates) {
  constexpr double seconds_a_product = .1e-9;
  constexpr double seconds_to_march = 12e-9;
  return cells * static_cast<double>(directions_seen(options, static_cast<std::size_t>(cells))) *
         (2 * ordinates * seconds_a_product + seconds_to_march);
}

// Time of marches through the cone about the sun: two for each ray.
double circumsolar_seconds(const SolverOptions& options, double cells) {
  constexpr double seconds_a_cell_and_march = 12e-9;
  if (options.circumsolar_half_angle == 0) return 0;
  const double across = options.independent_columns ? 1 : circumsolar_rays_across(options);
  return 2 * circumsolar_rings * circumsolar_azimuths * across * across * cells * seconds_a_cell_and_march;
}

// Time of a table of reflection, from functions of two directions.
double surface_seconds(const Problem& problem, int ordinates) {
  constexpr double seconds_to_sample = .04;
  constexpr double seconds_an_ordinate = .35e-3;
  return problem.surface.brdf ? seconds_to_sample + ordinates * seconds_an_ordinate : 0;
}

// Seconds of pieces of work, measured with AVX2 on one core on scenes of configs/. A run is of up to eight neighbouring
// cells; a pair is of a cell and an ordinate, or a direction of the gather.
struct Pace {
  // Sweeps. A march costs per run that an ordinate crosses, and in double precision per cell of it too.
  double run, cell_of_run;
  double pair;           // source and slopes
  double constant_pair;  // source without slopes
  // Scattering: per pair, for each ordinate that light comes from, and for each phase function beyond the first.
  double scattering, scattering_from_ordinate, other_phase_function;
  // The low-order correction, in its own cells, and the moments of all cells.
  double low_run, low_pair, diffusion_cell, moments_of_cell;
  // The final gather at bottom and top.
  double gather_run, gather_pair, gather_column;
  // At the levels between: planes are of column, level and direction; blur is of column, level and set of directions.
  double level_pair, level_plane, level_blur;
};
constexpr Pace in_float{.run = 9.3e-9,
                        .cell_of_run = 0,
                        .pair = 6.4e-9,
                        .constant_pair = 3.7e-9,
                        .scattering = 1.2e-9,
                        .scattering_from_ordinate = 1.8e-12,
                        .other_phase_function = 3e-10,
                        .low_run = 1.3e-8,
                        .low_pair = 7.4e-9,
                        .diffusion_cell = 4e-7,
                        .moments_of_cell = 0,
                        .gather_run = 1.25e-8,
                        .gather_pair = 9e-10,
                        .gather_column = 2.2e-6,
                        .level_pair = 9e-9,
                        .level_plane = 7e-10,
                        .level_blur = 3e-8};
constexpr Pace in_doubles{.run = 5.3e-8,
                          .cell_of_run = 9.3e-9,
                          .pair = 0,
                          .constant_pair = 0,
                          .scattering = 2.7e-9,
                          .scattering_from_ordinate = 5.6e-11,
                          .other_phase_function = 0,
                          .low_run = 0,
                          .low_pair = 3.1e-8,
                          .diffusion_cell = 0,
                          .moments_of_cell = 8.6e-7,
                          .gather_run = 5e-8,
                          .gather_pair = 4e-9,
                          .gather_column = 4.4e-6,
                          .level_pair = 3.6e-8,
                          .level_plane = 2e-9,
                          .level_blur = 6e-8};

// Sweeps that find the slopes of the light take about twice the time.
constexpr double more_for_slopes = 3;

// Whether the light finds its own slopes (source_iteration.cpp).
bool finds_slopes(const SolvePlan& plan) {
  const SolverOptions& options = plan.options();
  return options.linear_source && !options.independent_columns && plan.problem().grid.box.columns() > 1;
}

// Measured on scenes of configs/ at all levels.
double sweeps_of(const SolvePlan& plan) {
  constexpr double a_digit = 3;  // of the tolerance
  constexpr double thermal = .6;
  const double digits = std::max(0., -std::log10(plan.options().tolerance) - 2);
  const double sweeps = (finds_slopes(plan) ? 8.5 : 4.5) + a_digit * digits;
  return plan.problem().sun ? sweeps : thermal * sweeps;
}

// Planes of many columns do not fit into the caches. Without this factor, made cumulus at `draft` took 1.6 times the
// predicted seconds with 4e5 columns, and 2.4 times with 4e6. Machines differ: one with slower arithmetic took 1.2
// times as long per voxel with 4e6 columns as with 4e5, this one 1.5 times.
double growth_beyond_caches(const BoxGrid& box) {
  constexpr double columns_in_caches = 3e4;
  constexpr double growth_per_decade = .3;
  return 1 + growth_per_decade * std::max(0., std::log10(static_cast<double>(box.columns()) / columns_in_caches));
}

double sweep_seconds(const SolvePlan& plan, const Medium& medium, const OrdinateSet& ordinates, double sweeps) {
  constexpr const char* low_directions = "double-gauss-4x8";
  constexpr double low_sweeps = 4.6;          // for each sweep
  constexpr double thin_for_diffusion = 2.5;  // as in low_order_correction.cpp
  const Pace& pace = plan.in_double() ? in_doubles : in_float;
  const SolverOptions& options = plan.options();
  const CellCrossing crossing(plan.problem().grid.box, medium, options.independent_columns,
                              marches_sideways(plan, medium));
  const double cells_of_run = medium.runs() > 0 ? medium.cells / medium.runs() : 0;
  const double pairs = ordinates.size() * medium.cells;
  const double march =
      crossing.runs(ordinates.direction) * (pace.run + pace.cell_of_run * std::min<double>(cells_of_run, lanes)) +
      pairs * (options.linear_source ? pace.pair : pace.constant_pair);
  const double phase_functions = static_cast<double>(plan.problem().phase.size());
  const double scattering = pairs * (pace.scattering + pace.scattering_from_ordinate * ordinates.size() +
                                     pace.other_phase_function * std::max(0., phase_functions - 1));
  const OrdinateSet low = make_ordinate_set(low_directions);
  const double low_order = low_sweeps * (coarsens(plan, medium) ? coarse_cells_per_cell : 1) *
                           (crossing.runs(low.direction) * pace.low_run +
                            medium.cells * (low.size() * pace.low_pair +
                                            (medium.transport_depth > thin_for_diffusion ? pace.diffusion_cell : 0)));
  const double slopes = finds_slopes(plan) ? 1 + more_for_slopes / sweeps : 1;
  return march * slopes + scattering + low_order + medium.cells * pace.moments_of_cell;
}

// The final gather: down, with a quarter more about the sun, and up, as many; and those of the forward peak.
double gather_seconds(const SolvePlan& plan, const Medium& medium) {
  constexpr double to_start = 1.5e-3;
  const SolverOptions& options = plan.options();
  const Problem& problem = plan.problem();
  if (plan.is_one_column()) return 0;
  if (options.independent_columns) {  // their fluxes are those of the ordinates
    constexpr double ordinate_and_interface = 1e-8;
    return ordinate_and_interface * static_cast<double>(problem.grid.box.columns() * problem.grid.box.z_edge_m.size()) *
           make_ordinate_set(options.directions).size();
  }
  const Pace& pace = plan.in_double() ? in_doubles : in_float;
  const BoxGrid& box = problem.grid.box;
  const double count = options.gather_directions;
  const double about_sun =
      problem.sun ? (box.periodic ? .5 : .25) * count + std::max(std::min(128., count), count / 4) : 0;
  const double directions = 2 * count + about_sun;
  constexpr int sampled = 64;
  double runs = 0;
  const CellCrossing along_z(box, medium, false, false);
  for (const GatherDirection& direction : gather_directions(sampled, true, std::nullopt))
    runs += along_z.runs(direction.travel) / sampled;
  const auto columns = static_cast<double>(box.columns());
  const double ends =
      directions * (runs * pace.gather_run + medium.cells * pace.gather_pair) + columns * pace.gather_column;
  const auto levels = static_cast<double>(inner_levels(box, options).size());
  if (levels == 0) return to_start + ends;
  const double sets = problem.sun ? 3 : 2;
  return to_start + ends + directions * (medium.cells * pace.level_pair + columns * box.nz() * pace.level_plane) +
         sets * columns * levels * pace.level_blur;
}

}  // namespace

SolveSeconds predict_phases(const SolvePlan& plan) {
  constexpr double seconds_of_cell = 2e-7;  // neighbours and paths
  const Problem& problem = plan.problem();
  const SolverOptions& options = plan.options();
  const double threads = threads_of(plan);
  if (plan.by_polar_streams()) return {columns_seconds(problem, options, plan.in_double(), threads_of(plan))};
  const Medium medium = medium_of(plan);
  const OrdinateSet ordinates = make_ordinate_set(options.directions);
  SolveSeconds seconds;
  seconds.before_sweeps = (beam_seconds(problem, options, medium.cells) + medium.cells * seconds_of_cell) / threads +
                          surface_seconds(problem, ordinates.size());
  seconds.sweeps = sweeps_of(plan);
  const double growth = growth_beyond_caches(problem.grid.box);
  seconds.sweep = growth * sweep_seconds(plan, medium, ordinates, seconds.sweeps) / threads;
  seconds.after_sweeps =
      (growth * gather_seconds(plan, medium) + pixel_seconds(problem, options) +
       seen_seconds(options, medium.cells, ordinates.size()) + circumsolar_seconds(options, medium.cells)) /
      threads;
  return seconds;
}

double predict_seconds(const SolvePlan& plan) { return predict_phases(plan).total(); }

}  // namespace cloudbow
