#include "transport/rays/ordinate_path.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

#include "cloudbow/core/parallel_errors.hpp"

namespace cloudbow {
namespace {

// Measured, in runs of cells crossed: looking whether a row of a block has cells at a segment; fetching and putting
// back a cell that has another place along x; eight rays in air; eight columns whose light goes into a march sideways
// and out of it.
constexpr double cost_of_a_look = .3;
constexpr double cost_of_a_turned_cell = .15;
constexpr double cost_of_rays_in_air = .25;
constexpr double cost_of_moved_rays = 2;

// A march along x or y has one ray per cell. A march along z has more rays per cell if the light is near the horizon.
// Thick voxels need several (docs/design-notes.md).
constexpr double thick_voxel = 4. / 3;

// Optical depth of a voxel from bottom to top, in some levels of one thickness: mean with the extinction as weight.
template <class Real>
double voxel_depth(const BoxGrid& box, const Cells<Real>& cells, LevelRange levels) {
  double sum = 0;
  double sum_of_squares = 0;
  for (int k = levels.first; k < levels.last; ++k) {
    for (std::uint32_t c = cells.rows.level_cell[k]; c < cells.rows.voxels_end(k); ++c) {
      const double extinction = static_cast<double>(cells.extinction[c]);
      sum += extinction;
      sum_of_squares += extinction * extinction;
    }
  }
  return sum > 0 ? sum_of_squares / sum * box.thickness_m(levels.first) : 0;
}

// Of rays that cross air one by one.
double rays_in_air(std::span<const Chunk> gaps) {
  double rays = 0;
  for (const Chunk& gap : gaps) rays += gap.n;
  return rays / lanes;
}

// Of those levels of a pattern that are in the range.
double cost_along_z(const BoxGrid& box, const PathPattern& pattern, const ActiveRows& rows, LevelRange levels) {
  double cost = 0;
  for (int step = 0; step < pattern.levels(); ++step) {
    const int level = pattern.level(step);
    if (level < levels.first || level >= levels.last) continue;
    const bool air_at_once = !rows.has_air() || (box.periodic && (rows.is_uniform(level) || rows.is_mostly_air(level)));
    const double in_air = air_at_once ? 0 : cost_of_rays_in_air * rays_in_air(rows.blocks_of(level));
    const int segments = static_cast<int>(pattern.level_begin[step + 1] - pattern.level_begin[step]);
    cost += segments * (static_cast<double>(rows.levels.of(level).size()) + in_air);
  }
  return cost;
}

template <class Real>
double sideways_cost(const SidewaysPath& path, const Cells<Real>& cells) {
  const TransposedCells<Real>& transposed = cells.transposed[path.axis];
  const LevelRange levels = path.levels;
  double cost = 0;
  for (int step = 0; step < path.pattern->levels(); ++step) {
    const int sheet = path.pattern->level(step);
    const double in_air = transposed.gaps.count == 0
                              ? 0
                              : cost_of_rays_in_air * rays_in_air(transposed.gaps.of(sheet, levels.first, levels.last));
    const int segments = static_cast<int>(path.pattern->level_begin[step + 1] - path.pattern->level_begin[step]);
    cost += segments * (static_cast<double>(transposed.sheets.of(sheet, levels.first, levels.last).size()) + in_air);
  }
  const double blocks = std::ceil(1. + (levels.last - levels.first) / static_cast<double>(path.block));
  const std::uint32_t turned =
      path.axis == 0 ? cells.rows.level_cell[levels.last] - cells.rows.level_cell[levels.first] : 0;
  return cost + cost_of_a_look * blocks * static_cast<double>(path.pattern->segments.size()) +
         cost_of_a_turned_cell * turned +
         cost_of_moved_rays * transposed.sheets.count * transposed.sheets.columns / lanes;
}

// Along one axis through a run, with the pattern of another run of this thickness if there is one.
std::optional<SidewaysPath> path_through(const BoxGrid& box, const Direction& travel, int axis, LevelRange run,
                                         std::vector<SidewaysPath>& known) {
  for (SidewaysPath& path : known) {
    if (path.axis != axis || !have_one_thickness(box, run.first, path.levels.first)) continue;
    path.levels = run;
    return path;
  }
  std::optional<SidewaysPath> path = make_sideways_path(box, travel, axis, run);
  if (path) known.push_back(*path);
  return path;
}

// The marches sideways that cost less than the march along z, from below. @param whole along z.
template <class Real>
std::vector<SidewaysPath> cheaper_sideways(const BoxGrid& box, const Cells<Real>& cells, const Direction& travel,
                                           const PathPattern& whole, const std::vector<LevelRange>& runs,
                                           double& cost) {
  std::vector<SidewaysPath> taken, known;
  for (const LevelRange& run : runs) {
    const double along_z = cost_along_z(box, whole, cells.rows, run);
    double least = along_z;
    std::optional<SidewaysPath> cheapest;
    for (int axis = 0; axis < 2; ++axis) {
      auto path = path_through(box, travel, axis, run, known);
      const double sideways = path ? sideways_cost(*path, cells) : least;
      if (sideways >= least) continue;
      least = sideways;
      cheapest = std::move(path);
    }
    if (!cheapest) continue;
    cost += least - along_z;
    taken.push_back(std::move(*cheapest));
  }
  return taken;
}

}  // namespace

template <class Real>
std::vector<OrdinatePath> make_ordinate_paths(const BoxGrid& box, const Cells<Real>& cells,
                                              const std::vector<Direction>& travel, bool independent_columns,
                                              ThickVoxels thick) {
  std::vector<OrdinatePath> paths(travel.size());
  const auto along_z = [&](const Direction& d, LevelRange levels) {
    const StartFraction start = start_for_centred_exit(box, d, independent_columns, levels);
    return make_path_pattern(box, d, start.x, start.y, independent_columns, levels);
  };
  std::vector<LevelRange> runs = cells.even_runs;
  if (thick == ThickVoxels::sampled)
    std::erase_if(runs, [&](const LevelRange& run) { return voxel_depth(box, cells, run) > thick_voxel; });
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t d = 0; d < travel.size(); ++d) {
    errors.run([&] {
      OrdinatePath& path = paths[d];
      path.upward = travel[d].z() > 0;
      PathPattern whole = along_z(travel[d], {0, box.nz()});
      path.cost = cost_along_z(box, whole, cells.rows, {0, box.nz()});
      path.sideways = cheaper_sideways(box, cells, travel[d], whole, runs, path.cost);
      if (path.sideways.empty()) {
        path.along_z.push_back(std::move(whole));
        return;
      }
      int below = 0;
      for (const SidewaysPath& run : path.sideways) {
        path.along_z.push_back(along_z(travel[d], {below, run.levels.first}));
        below = run.levels.last;
      }
      path.along_z.push_back(along_z(travel[d], {below, box.nz()}));
      if (path.upward) return;
      std::reverse(path.sideways.begin(), path.sideways.end());
      std::reverse(path.along_z.begin(), path.along_z.end());
    });
  }
  errors.rethrow();
  return paths;
}

template std::vector<OrdinatePath> make_ordinate_paths<float>(const BoxGrid&, const Cells<float>&,
                                                              const std::vector<Direction>&, bool, ThickVoxels);
template std::vector<OrdinatePath> make_ordinate_paths<double>(const BoxGrid&, const Cells<double>&,
                                                               const std::vector<Direction>&, bool, ThickVoxels);

}  // namespace cloudbow
