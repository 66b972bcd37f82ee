#include "transport/rays/ordinate_path.hpp"

#include <algorithm>
#include <cmath>

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

double runs_crossed(const PathPattern& pattern, const Sheets& sheets, int first_row, int last_row) {
  double runs = 0;
  for (int step = 0; step < pattern.levels(); ++step) {
    const int segments = static_cast<int>(pattern.level_begin[step + 1] - pattern.level_begin[step]);
    runs += segments * static_cast<double>(sheets.of(pattern.level(step), first_row, last_row).size());
  }
  return runs;
}

// Of rays that cross air one by one.
double rays_in_air(std::span<const Chunk> gaps) {
  double rays = 0;
  for (const Chunk& gap : gaps) rays += gap.n;
  return rays / lanes;
}

double cost_along_z(const BoxGrid& box, const PathPattern& pattern, const ActiveRows& rows) {
  double in_air = 0;
  for (int step = 0; rows.has_air() && step < pattern.levels(); ++step) {
    const int level = pattern.level(step);
    if (box.periodic && (rows.is_uniform(level) || rows.is_mostly_air(level))) continue;
    in_air += (pattern.level_begin[step + 1] - pattern.level_begin[step]) * rays_in_air(rows.blocks_of(level));
  }
  return runs_crossed(pattern, rows.levels, 0, rows.levels.rows) + cost_of_rays_in_air * in_air;
}

template <class Real>
double sideways_cost(const SidewaysPath& path, const TransposedCells<Real>& transposed, std::size_t cells) {
  const Sheets& sheets = transposed.sheets;
  double in_air = 0;
  for (int step = 0; transposed.gaps.count > 0 && step < path.pattern.levels(); ++step) {
    const int segments = static_cast<int>(path.pattern.level_begin[step + 1] - path.pattern.level_begin[step]);
    in_air += segments * rays_in_air(transposed.gaps.of(path.pattern.level(step), path.levels.first, path.levels.last));
  }
  const double blocks = std::ceil(1. + (path.levels.last - path.levels.first) / static_cast<double>(path.block));
  return runs_crossed(path.pattern, sheets, path.levels.first, path.levels.last) + cost_of_rays_in_air * in_air +
         cost_of_a_look * blocks * static_cast<double>(path.pattern.segments.size()) +
         (path.axis == 0 ? cost_of_a_turned_cell * static_cast<double>(cells) : 0.) +
         cost_of_moved_rays * sheets.count * sheets.columns / lanes;
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
  const LevelRange even = cells.even_levels;
  const bool along_z_alone =
      even.first >= even.last || (thick == ThickVoxels::sampled && voxel_depth(box, cells, even) > thick_voxel);
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
  for (std::size_t d = 0; d < travel.size(); ++d) {
    errors.run([&] {
      OrdinatePath& path = paths[d];
      path.upward = travel[d].z() > 0;
      path.along_z.push_back(along_z(travel[d], {0, box.nz()}));
      path.cost = cost_along_z(box, path.along_z.front(), cells.rows);
      if (along_z_alone) return;
      const LevelRange below{0, even.first};
      const LevelRange above{even.last, box.nz()};
      for (int axis = 0; axis < 2; ++axis) {
        auto sideways = make_sideways_path(box, travel[d], axis, even);
        if (!sideways) continue;
        std::vector<PathPattern> rest{along_z(travel[d], path.upward ? below : above),
                                      along_z(travel[d], path.upward ? above : below)};
        double cost = sideways_cost(*sideways, cells.transposed[axis], cells.size());
        for (const auto& pattern : rest) cost += cost_along_z(box, pattern, cells.rows);
        if (cost >= path.cost) continue;
        path.cost = cost;
        path.along_z = std::move(rest);
        path.sideways = std::move(sideways);
      }
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
