#include "transport/driver/predicted_work.hpp"

#include <omp.h>

#include <algorithm>
#include <cmath>

#include "cloudbow/optics/delta_m.hpp"
#include "transport/grid/lanes.hpp"
#include "transport/observers/camera_view.hpp"

namespace cloudbow {

int threads_of(const SolvePlan& plan) { return plan.threads() > 0 ? plan.threads() : omp_get_max_threads(); }

std::vector<Camera> coarser(std::vector<Camera> cameras, int enough) {
  for (Camera& camera : cameras) {
    const double scale = std::min(1., static_cast<double>(enough) / std::max(camera.width, camera.height));
    camera.width = static_cast<int>(std::ceil(scale * camera.width));
    camera.height = static_cast<int>(std::ceil(scale * camera.height));
  }
  return cameras;
}

std::size_t directions_seen(const SolverOptions& options, std::size_t cells) {
  const std::size_t of_cameras =
      options.cameras.empty() ? 0 : sight_points(coarser(options.cameras, 256), cells).travel.size();
  return options.views.size() + of_cameras + (options.circumsolar_half_angle > 0 ? 1 : 0);
}

std::vector<int> inner_levels(const BoxGrid& box, const SolverOptions& options) {
  std::vector<int> levels = flux_levels(box, options);
  std::erase_if(levels, [&box](int level) { return level == 0 || level == box.nz(); });
  return levels;
}

namespace {

// @param all_voxels are cells
std::vector<LevelWork> work_in_levels(const OpticalGrid& grid, bool all_voxels) {
  constexpr double cost_of_rays_in_air = .25;  // in runs of cells, as in ordinate_path.cpp
  const BoxGrid& box = grid.box;
  const double rows = box.ny;
  std::vector<LevelWork> levels(box.nz());
  std::vector<double> voxels(box.nz(), 0.);
  grid.for_each_span([&](int k, int, const RowSpan& span) {
    const int runs = (span.n + lanes - 1) / lanes;
    levels[k].runs += runs;
    voxels[k] += span.n;
  });
  const auto columns = static_cast<double>(box.columns());
  for (int k = 0; k < box.nz(); ++k) {
    LevelWork& level = levels[k];
    level.thickness_m = box.thickness_m(k);
    const auto is_like = [&](int other) { return other >= 0 && other < box.nz() && have_one_thickness(box, k, other); };
    level.even = is_like(k - 1) || is_like(k + 1);
    const int runs_of_row = (box.nx + lanes - 1) / lanes;
    if (all_voxels) level.runs = rows * runs_of_row;
    const int blocks = grid.air_of(k).count();
    if (blocks == 0) continue;
    if (!box.is_uniform(k)) level.runs_of_air = cost_of_rays_in_air * (columns - voxels[k]) / lanes;
    level.in_air = box.periodic && (box.is_uniform(k) || (blocks == 1 && 2 * (columns - voxels[k]) >= columns));
  }
  return levels;
}

void set_depths(const Problem& problem, int delta_m_order, Medium& medium) {
  const OpticalGrid& grid = problem.grid;
  const BoxGrid& box = grid.box;
  std::vector<double> kept, kept_for_transport;  // of the scattering by each phase function
  for (const PhaseFunction& phase : problem.phase) {
    const DeltaM scaled = delta_m(phase, delta_m_order);
    kept.push_back(1 - scaled.forward_fraction);
    kept_for_transport.push_back(kept.back() * (1 - scaled.truncated.asymmetry_parameter()));
  }
  std::vector<double> depth(box.columns(), 0.);
  double sum = 0, of_voxels = 0, of_coarse = 0;
  grid.for_each_place([&](int k, std::size_t column, std::size_t cell) {
    double extinction = grid.absorption[cell], transport = 0;
    for (std::size_t p = 0; p < kept.size(); ++p) {
      extinction += kept[p] * grid.scattering[p][cell];
      transport += kept_for_transport[p] * grid.scattering[p][cell];
    }
    const double thickness = box.thickness_m(k);
    sum += extinction;
    of_voxels += extinction * extinction * thickness;
    of_coarse += extinction * transport * 2 * std::max({box.dx_m, box.dy_m, thickness});
    depth[column] += transport * thickness;
  });
  if (sum == 0) return;
  medium.voxel_depth = of_voxels / sum;
  medium.coarse_depth = of_coarse / sum;
  double depths = 0, squares = 0;
  for (const double d : depth) {
    depths += d;
    squares += d * d;
  }
  if (depths > 0) medium.transport_depth = squares / depths;
}

}  // namespace

Medium medium_of(const SolvePlan& plan) {
  const OpticalGrid& grid = plan.problem().grid;
  Medium medium;
  medium.cells = static_cast<double>(plan.cells());
  medium.levels = work_in_levels(grid, plan.cells() > grid.active_cells());
  set_depths(plan.problem(), plan.options().fit.delta_m_order, medium);
  return medium;
}

bool coarsens(const SolvePlan& plan, const Medium& medium) {
  constexpr double few_cells = 2000;
  constexpr double thickest = 1.5;  // as in coarsening.cpp
  return medium.cells >= few_cells && plan.problem().grid.box.columns() > 1 && !plan.options().independent_columns &&
         medium.coarse_depth <= thickest;
}

double Medium::runs() const {
  double sum = 0;
  for (const LevelWork& level : levels) sum += level.runs;
  return sum;
}

std::size_t cells_of_largest_level(const OpticalGrid& grid) {
  std::size_t largest = 0;
  for (int k = 0; k < grid.box.nz(); ++k) largest = std::max(largest, grid.first_cell(k + 1) - grid.first_cell(k));
  return largest;
}

}  // namespace cloudbow
