#include "cloudbow/transport/solve_plan.hpp"

#include <algorithm>
#include <cmath>

#include "cloudbow/medium/grid_map.hpp"
#include "transport/driver/path_load.hpp"
#include "transport/driver/precision.hpp"
#include "transport/grid/threads.hpp"
#include "transport/reduction/subdivided_columns.hpp"
#include "transport/reduction/subdivided_levels.hpp"
#include "transport/reduction/uniform_axes.hpp"

namespace cloudbow {
namespace {

// Whether levels and columns are subdivided in the same way.
bool subdivided_alike(const SolvePlan& plan, const SolverOptions& options, bool by_polar_streams) {
  const SolverOptions& other = plan.whole_options();
  return options.max_level_optical_depth == other.max_level_optical_depth &&
         options.max_column_optical_depth == other.max_column_optical_depth &&
         options.max_column_parts == other.max_column_parts &&
         options.independent_columns == other.independent_columns &&
         options.fit.delta_m_order == other.fit.delta_m_order && by_polar_streams == plan.by_polar_streams();
}

// As many rays in a column as without parts, and no fewer than four in a part.
int beam_rays_of_part(int rays, SubdividedColumns parts) {
  const int across = static_cast<int>(std::lround(std::sqrt(rays)));
  const int fewer = std::min(parts.x, parts.y);
  const int of_part = std::min(across, std::max(2, (across + fewer - 1) / fewer));
  return of_part * of_part;
}

// Columns that exchange no light share no mean. Actinic flux and radiance fields need the light in each voxel.
bool needs_own_cells(const Problem& problem, const SolverOptions& options) {
  return !problem.grid.air.empty() && (options.independent_columns || options.actinic || options.radiance_field);
}

}  // namespace

bool solved_by_polar_streams(const Problem& problem, const SolverOptions& options) {
  return options.independent_columns && !problem.surface.brdf && !options.radiance_field && options.views.empty() &&
         options.cameras.empty() && options.circumsolar_half_angle == 0;
}

SolvePlan::SolvePlan(const Problem& problem, const SolverOptions& options) : whole_(&problem) { set(options, nullptr); }

SolvePlan SolvePlan::with(const SolverOptions& options) const {
  SolvePlan plan(whole_);
  plan.set(options, this);
  return plan;
}

void SolvePlan::set(const SolverOptions& options, const SolvePlan* other) {
  whole_options_ = options_ = options;
  options_.collapse_uniform_axes = false;
  const bool own_cells = needs_own_cells(*whole_, options);
  const bool same_axes = other != nullptr &&
                         other->whole_options_.collapse_uniform_axes == options.collapse_uniform_axes &&
                         needs_own_cells(*whole_, other->whole_options_) == own_cells;
  if (same_axes) {
    own_cells_ = other->own_cells_;
    collapsed_axes_ = other->collapsed_axes_;
    collapsed_ = other->collapsed_;
  } else {
    if (own_cells) {
      Problem with_own_cells = *whole_;
      with_own_cells.grid = without_air_blocks(whole_->grid);
      own_cells_ = std::make_shared<const Problem>(std::move(with_own_cells));
    }
    if (options.collapse_uniform_axes) collapsed_axes_ = uniform_axes(collapsed());
    if (collapsed_axes_.any()) collapsed_ = std::make_shared<const Problem>(collapse(collapsed(), collapsed_axes_));
  }
  if (collapsed_ && is_one_column()) options_.double_precision = true;  // costs nothing there
  by_polar_streams_ = solved_by_polar_streams(*whole_, options);

  const bool same_levels = same_axes && subdivided_alike(*other, options, by_polar_streams_);
  if (same_levels) {
    levels_ = other->levels_;
    subdivided_ = other->subdivided_;
    column_parts_ = other->column_parts_;
    in_parts_ = other->in_parts_;
    too_thick_for_float_ = other->too_thick_for_float_;
  } else {
    SolverOptions how = options_;
    if (by_polar_streams_) how.max_level_optical_depth = 0;  // they are exact at every depth
    levels_ = subdivide_thick_levels(collapsed(), how);
    if (added_levels() > 0) subdivided_ = std::make_shared<const Problem>(with_subdivided_levels(collapsed(), levels_));
    column_parts_ = subdivide_thick_columns(collapsed(), options_);
    if (column_parts_.any())
      in_parts_ = std::make_shared<const Problem>(with_subdivided_columns(with_levels(), column_parts_));
    too_thick_for_float_ = too_thick_for_float(problem().grid);
  }
  if (subdivided_) options_ = with_subdivided_levels(options_, levels_);

  if (in_parts_) options_.beam_rays = beam_rays_of_part(options_.beam_rays, column_parts_);
  const std::size_t columns = problem().grid.box.columns();
  cells_ =
      options.actinic ? columns * static_cast<std::size_t>(problem().grid.box.nz()) : problem().grid.active_cells();
  in_double_ = options_.double_precision || too_thick_for_float_ || beam_needs_double(problem(), options_) ||
               (!by_polar_streams_ && tolerance_needs_double(problem().grid, cells_, options_));
  threads_ = threads_for(std::max(cells_, columns), options.threads);
}

}  // namespace cloudbow
