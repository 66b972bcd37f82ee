// Cost of a solve, computed before anything is allocated.
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "cloudbow/transport/solver.hpp"
#include "transport/columns/columns.hpp"
#include "transport/driver/path_load.hpp"
#include "transport/gather/gather.hpp"
#include "transport/observers/camera_view.hpp"
#include "transport/observers/circumsolar.hpp"
#include "transport/observers/sight_line.hpp"

namespace cloudbow {

namespace {

int threads_of(const SolvePlan& plan) { return plan.threads() > 0 ? plan.threads() : omp_get_max_threads(); }

std::size_t grid_bytes(const Problem& problem) {
  return problem.grid.active_cells() * (1 + problem.phase.size()) * sizeof(float);
}

// The same views in smaller images, which have the same contents.
std::vector<Camera> coarser(std::vector<Camera> cameras, int enough) {
  for (Camera& camera : cameras) {
    const double scale = std::min(1., static_cast<double>(enough) / std::max(camera.width, camera.height));
    camera.width = static_cast<int>(std::ceil(scale * camera.width));
    camera.height = static_cast<int>(std::ceil(scale * camera.height));
  }
  return cameras;
}

// Towards which the source is made for images.
std::size_t directions_seen(const SolverOptions& options, std::size_t cells) {
  const std::size_t of_cameras =
      options.cameras.empty() ? 0 : sight_points(coarser(options.cameras, 256), cells).travel.size();
  return options.views.size() + of_cameras + (options.circumsolar_half_angle > 0 ? 1 : 0);
}

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

// Flux levels between bottom and top.
std::vector<int> inner_levels(const BoxGrid& box, const SolverOptions& options) {
  std::vector<int> levels = flux_levels(box, options);
  std::erase_if(levels, [&box](int level) { return level == 0 || level == box.nz(); });
  return levels;
}

std::size_t memory_of_solve(const SolvePlan& plan) {
  const Problem& problem = plan.problem();
  const SolverOptions& options = plan.options();
  // Libraries; reading a cloud takes another one.
  constexpr std::size_t libraries = 20'000'000;
  constexpr std::size_t reading = 33'000'000;
  check_paths(plan);
  const auto threads = static_cast<std::size_t>(threads_of(plan));
  const auto of_patterns = static_cast<std::size_t>(path_load(plan).bytes(static_cast<int>(threads)));
  if (plan.by_polar_streams()) {
    constexpr std::size_t program_of_columns = 17'500'000;
    return program_of_columns + (problem.grid.box.columns() > 1 ? reading : 0) + of_patterns +
           columns_memory(problem, options, plan.in_double(), threads_of(plan));
  }
  const BoxGrid& box = problem.grid.box;
  const std::size_t dense = box.columns() * static_cast<std::size_t>(box.nz());
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
  const std::size_t system = real * (1 + phases) + 8 + (slopes ? real * 51 : 0);
  const bool packed = options.half_precision_radiance && real == sizeof(float);
  const std::size_t stored = packed ? sizeof(std::uint16_t) : real;
  // Radiance at the ordinates, four sets of moments, four of these in eight sets more for the mixing, gradients; work
  // arrays of a direction on each thread. The low-order problem has a sixth of the cells if they are many.
  const std::size_t low_cell = real * (32 + 2 * 9 + 4 * 15) + 60;
  const bool many = active >= 2000 && box.columns() > 1 && !options.independent_columns;
  const std::size_t iteration = stored * ordinates + real * (4 * 9 + 8 * 4 + 7 + (packed ? 5 : 4) * threads) +
                                (slopes ? real * (3 + 10 * threads) : 0) + (many ? low_cell / 6 + real + 7 : low_cell);
  // Source at the points in the place of the radiance; first orders of scattering, gradients.
  const std::size_t gather = stored * std::max(ordinates, points) + real * (9 + 2 * phases + 4 * threads + 8);
  const std::size_t radiance_field = options.radiance_field ? points * 4 + 12 : 0;
  // Fluxes, beams and bookkeeping of the box.
  constexpr std::size_t place = 48;
  const std::size_t program = libraries + (box.columns() > 1 ? reading : 0);
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
  const std::size_t levels_between =
      level_gather_bytes(box, active, inner_levels(box, options), options.gather_directions);
  const std::size_t of_cone =
      options.circumsolar_half_angle > 0
          ? circumsolar_bytes(active, phases, flux_levels(box, options).size() * box.columns(), real)
          : 0;
  const std::size_t held = grid + cell + system + radiance_field;
  const std::size_t working =
      std::max({active * std::max(iteration, making_seen), active * gather + levels_between + of_cone,
                active * (gather + showing) + pixels * sizeof(float), making_surface});
  const std::size_t solving = tables + of_patterns + active * held + working + box.columns() * surface;
  // Images on their way into the file.
  const std::size_t writing = active * (grid + radiance_field) + pixels * 3 * sizeof(float);
  return program + dense * place + std::max(solving, writing);
}

}  // namespace

std::size_t predict_memory(const SolvePlan& plan) {
  std::size_t bytes = memory_of_solve(plan);
  if (plan.added_levels() > 0) bytes += grid_bytes(plan.collapsed());
  if (plan.column_parts().any()) bytes += grid_bytes(plan.with_levels());
  if (plan.collapsed_axes().any()) {
    const BoxGrid& box = plan.whole().grid.box;
    // Fluxes and absorption of the whole, and on their way into the file.
    bytes += grid_bytes(plan.whole()) + 8 * box.columns() * static_cast<std::size_t>(box.nz()) * sizeof(float);
  }
  return bytes;
}

double predict_seconds(const SolvePlan& plan) {
  const Problem& problem = plan.problem();
  const SolverOptions& options = plan.options();
  if (plan.by_polar_streams()) return columns_seconds(problem, options, plan.in_double(), threads_of(plan));
  // Constants measured with AVX2 on one core. Many cells of a periodic field are marched along the axis of fewest
  // segments; elsewhere segments grow with the slant of the ordinates.
  constexpr double seconds_a_segment = 2.5e-9;
  constexpr double seconds_a_pair = 12e-9;         // of cell and ordinate: march, scattering, moments and correction
  constexpr double seconds_a_gather_pair = 12e-9;  // of cell and gather direction
  constexpr double seconds_a_ray_in_air = .7e-9;   // and level and ordinate, or gather direction
  constexpr double seconds_to_start = .1;
  constexpr int usual_sweeps = 11;
  const OrdinateSet ordinates = make_ordinate_set(options.directions);
  const BoxGrid& box = problem.grid.box;
  // Uniform levels are crossed in one segment.
  double height = 0, levels = 0, rays_in_air = 0;
  for (int k = 0; k < box.nz(); ++k) {
    if (problem.grid.air_of(k).count() > 0) rays_in_air += static_cast<double>(box.columns());
    if (box.is_uniform(k)) continue;
    height += box.thickness_m(k);
    ++levels;
  }
  const double dz = height / std::max(levels, 1.);
  const bool shortest_way = box.periodic && box.nx > 1 && box.ny > 1 && !options.independent_columns;
  double segments = 0;
  for (const Direction& d : ordinates.direction) {
    const double along_z = 1 + (std::abs(d.x()) * dz / box.dx_m + std::abs(d.y()) * dz / box.dy_m) / std::abs(d.z());
    segments += shortest_way ? std::min(along_z, 2.) : along_z;
  }
  const auto cells = static_cast<double>(plan.cells());
  const double sweep = cells * (segments * seconds_a_segment + ordinates.size() * seconds_a_pair) +
                       rays_in_air * segments * seconds_a_ray_in_air;
  // Down, with a quarter more about the sun, and up; between bottom and top as many, their light in bands.
  const double gather = plan.is_one_column() || options.independent_columns
                            ? 0
                            : (cells * seconds_a_gather_pair + rays_in_air * seconds_a_ray_in_air) *
                                  options.gather_directions * (2.25 + (inner_levels(box, options).empty() ? 0 : 3));
  // Cells that are higher than wide are crossed in more segments: on average one a face.
  const double tall = std::max(0., dz / box.dx_m + dz / box.dy_m - 2) * seconds_a_segment / seconds_a_gather_pair;
  return (sweep * usual_sweeps + gather * (1 + tall) + beam_seconds(problem, options, cells) +
          pixel_seconds(problem, options) + seen_seconds(options, cells, ordinates.size()) +
          circumsolar_seconds(options, cells)) /
             threads_of(plan) +
         surface_seconds(problem, ordinates.size()) + seconds_to_start;
}

}  // namespace cloudbow
