#include "transport/reduction/subdivided_levels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <type_traits>

#include "cloudbow/medium/grid_map.hpp"
#include "cloudbow/transport/output_fields.hpp"
#include "transport/reduction/fading_beam.hpp"

namespace cloudbow {
namespace {

constexpr double least_share_of_beam = .01;
constexpr int most_parts = 6;
constexpr double parts_of_most = 63;  // 1 + 2 + 4 + ... + 32
constexpr int most_parts_beside_sides = 3;
// Depth of a level with two equal parts, in depths of a first part. With 4 the reflectance of a stratocumulus at `fine`
// changes by .06 % of incident, with 2.5 by .02 %.
constexpr double thickest_of_equal = 2.5;

// Power that the beam loses in a level.
struct BeamInLevel {
  double share = 0;       // of the incident power
  double depth = 0;       // slant optical depth of the cells, mean by the power
  double side_depth = 0;  // vertical optical depth of the cells, mean by their extinction, if some have sides; else 0
  bool varies = false;    // some columns differ
};

std::vector<BeamInLevel> beam_in_levels(const Problem& problem, const SolverOptions& options) {
  const BoxGrid& box = problem.grid.box;
  const auto columns = static_cast<double>(box.columns());
  const double mu0 = fading_cosine(problem);
  struct Sums {
    double extinction = 0, squares = 0;
    double least = std::numeric_limits<double>::infinity(), most = 0;
  };
  std::vector<BeamInLevel> levels(box.nz());
  std::vector<Sums> sums(box.nz());
  follow_beam(problem, options, [&](int k, double extinction, double lost, double voxels) {
    const double share = voxels * lost / columns;
    levels[k].share += share;
    levels[k].depth += share * extinction * box.thickness_m(k) / mu0;
    sums[k].extinction += voxels * extinction;
    sums[k].squares += voxels * extinction * extinction;
    sums[k].least = std::min(sums[k].least, extinction);
    sums[k].most = std::max(sums[k].most, extinction);
  });
  for (int k = 0; k < box.nz(); ++k) {
    BeamInLevel& level = levels[k];
    if (level.share > 0) level.depth /= level.share;
    const bool has_sides = problem.grid.first_cell(k + 1) - problem.grid.first_cell(k) < box.columns();
    if (has_sides && sums[k].extinction > 0)
      level.side_depth = sums[k].squares / sums[k].extinction * box.thickness_m(k);
    level.varies = has_sides || sums[k].most > sums[k].least;
  }
  return levels;
}

// Share of the thickness at which each part ends, from above; the last is 1.
// @param equal two parts are equal, unless the level is too thick for that
std::vector<double> ends_of_parts(double depth, double largest, bool equal) {
  std::vector<double> ends;
  // No part is more than twice its neighbour: a thin one beside a very thick one would set the iteration off.
  double end = 0, part = std::max(largest, depth / parts_of_most);
  while (static_cast<int>(ends.size()) + 1 < most_parts && end + part * 1.5 < depth) {
    end += part;
    ends.push_back(end / depth);
    part *= 2;
  }
  if (equal && ends.size() == 1 && depth <= thickest_of_equal * largest) ends.front() = .5;
  ends.push_back(1);
  return ends;
}

// The same for levels that light enters through sides of the cloud: equal parts.
std::vector<double> ends_of_equal_parts(double depth, double largest) {
  const double wanted = largest > 0 ? std::ceil(depth / largest - 1e-9) : 1;
  const int parts = static_cast<int>(std::clamp(wanted, 1., static_cast<double>(most_parts_beside_sides)));
  std::vector<double> ends;
  for (int n = 1; n <= parts; ++n) ends.push_back(static_cast<double>(n) / parts);
  return ends;
}

template <class Value>
void keep_edges(const SubdividedLevels& cut, std::vector<Value>& of_edges) {
  if (of_edges.empty()) return;
  std::vector<Value> kept;
  for (std::size_t part = 0; part < cut.level.size(); ++part) {
    if (part == 0 || cut.level[part] != cut.level[part - 1]) kept.push_back(of_edges[part]);
  }
  kept.push_back(of_edges.back());
  of_edges = std::move(kept);
}

// Keeps the fluxes at levels of the whole, by its indices.
void keep_planes(const Problem& whole, const SubdividedLevels& cut, Solution& solution) {
  const std::size_t columns = whole.grid.box.columns();
  const std::vector<int> solved = std::move(solution.flux_level);
  solution.flux_level.clear();
  std::vector<std::size_t> kept;
  for (std::size_t plane = 0; plane < solved.size(); ++plane) {
    const auto part = static_cast<std::size_t>(solved[plane]);
    const bool is_top = part == cut.level.size();
    if (!is_top && part > 0 && cut.level[part] == cut.level[part - 1]) continue;
    kept.push_back(plane);
    solution.flux_level.push_back(is_top ? whole.grid.box.nz() : cut.level[part]);
  }
  for (const OutputField& of : output_fields()) {
    if (of.grid != OutputField::Grid::levels) continue;
    std::vector<float>* const field = &(solution.*of.values);
    if (field->empty()) continue;
    std::vector<float> planes;
    for (const std::size_t plane : kept) {
      const auto from = field->begin() + static_cast<std::ptrdiff_t>(plane * columns);
      planes.insert(planes.end(), from, from + static_cast<std::ptrdiff_t>(columns));
    }
    *field = std::move(planes);
  }
}

std::vector<double> share_of_level(const Problem& whole, const SubdividedLevels& cut) {
  std::vector<double> share;
  for (std::size_t part = 0; part < cut.level.size(); ++part)
    share.push_back((cut.z_edge_m[part + 1] - cut.z_edge_m[part]) / whole.grid.box.thickness_m(cut.level[part]));
  return share;
}

void mean_of_parts(const Problem& whole, const SubdividedLevels& cut, std::vector<float>& field) {
  if (field.empty()) return;
  const std::size_t columns = whole.grid.box.columns();
  const std::vector<double> share = share_of_level(whole, cut);
  std::vector<float> mean(columns * static_cast<std::size_t>(whole.grid.box.nz()));
  std::vector<double> sum(columns, 0.);
  for (std::size_t part = 0; part < cut.level.size(); ++part) {
    for (std::size_t c = 0; c < columns; ++c) sum[c] += share[part] * static_cast<double>(field[part * columns + c]);
    if (part + 1 < cut.level.size() && cut.level[part + 1] == cut.level[part]) continue;
    float* const to = mean.data() + static_cast<std::size_t>(cut.level[part]) * columns;
    for (std::size_t c = 0; c < columns; ++c) to[c] = static_cast<float>(sum[c]);
    std::fill(sum.begin(), sum.end(), 0.);
  }
  field = std::move(mean);
}

void mean_of_parts(const Problem& whole, const SubdividedLevels& cut, RadianceField& field) {
  const std::vector<double> share = share_of_level(whole, cut);
  const std::size_t points = field.direction.size();
  std::map<std::array<std::int32_t, 3>, std::size_t> place;  // by k, j, i: the order of cells
  std::vector<std::array<std::int32_t, 3>> voxel;
  for (const auto& [i, j, part] : field.voxel) place.try_emplace({cut.level[part], j, i}, 0);
  for (auto& [key, at] : place) {
    at = voxel.size();
    voxel.push_back({key[2], key[1], key[0]});
  }
  std::vector<double> sum(voxel.size() * points, 0.);
  for (std::size_t v = 0; v < field.voxel.size(); ++v) {
    const auto& [i, j, part] = field.voxel[v];
    double* const to = sum.data() + place.at({cut.level[part], j, i}) * points;
    for (std::size_t m = 0; m < points; ++m) to[m] += share[part] * static_cast<double>(field.radiance[v * points + m]);
  }
  field.voxel = std::move(voxel);
  field.radiance.assign(sum.begin(), sum.end());
}

// The Planck radiance of the parts of a level, linear in height; on entry each has that of the whole level.
void cut_emission(const BoxGrid& whole, const SubdividedLevels& cut, OpticalGrid& grid) {
  const auto cut_one = [&](int part, auto& planck, auto& step) {
    using Value = std::remove_reference_t<decltype(planck)>;
    const int k = cut.level[part];
    const double middle = .5 * (cut.z_edge_m[part] + cut.z_edge_m[part + 1]);
    const double place = (middle - .5 * (whole.z_edge_m[k] + whole.z_edge_m[k + 1])) / whole.thickness_m(k);
    planck = static_cast<Value>(planck + place * step);
    step = static_cast<Value>(step * grid.box.thickness_m(part) / whole.thickness_m(k));
  };
  for (int part = 0; part < grid.box.nz(); ++part) {
    for (std::size_t c = grid.first_cell(part); c < grid.first_cell(part + 1); ++c)
      cut_one(part, grid.planck[c], grid.planck_step[c]);
    if (!grid.layer_planck.empty()) cut_one(part, grid.layer_planck[part], grid.layer_planck_step[part]);
  }
}

}  // namespace

SubdividedLevels subdivide_thick_levels(const Problem& problem, const SolverOptions& options) {
  const BoxGrid& box = problem.grid.box;
  SubdividedLevels cut;
  const double largest = options.max_level_optical_depth;
  const bool looked_at = largest > 0 && has_fading_light(problem);
  const std::vector<BeamInLevel> beam =
      looked_at ? beam_in_levels(problem, options) : std::vector<BeamInLevel>(box.nz());
  for (int k = 0; k < box.nz(); ++k) {
    const bool thick = beam[k].share >= least_share_of_beam;
    std::vector<double> ends =
        thick ? ends_of_parts(beam[k].depth, largest,
                              beam[k].varies && may_march_sideways(box, options.independent_columns))
              : std::vector<double>{1};
    if (ends.size() == 1) ends = ends_of_equal_parts(beam[k].side_depth, options.max_column_optical_depth);
    for (std::size_t n = ends.size(); n-- > 0;) {
      cut.z_edge_m.push_back(n + 1 == ends.size() ? box.z_edge_m[k]
                                                  : box.z_edge_m[k + 1] - ends[n] * box.thickness_m(k));
      cut.level.push_back(k);
    }
  }
  cut.z_edge_m.push_back(box.z_edge_m.back());
  return cut;
}

Problem with_subdivided_levels(const Problem& problem, const SubdividedLevels& cut) {
  Problem fine{{}, problem.phase, problem.sun, problem.sky_radiance, problem.surface};
  GridMap map;
  map.box = problem.grid.box;
  map.box.z_edge_m = cut.z_edge_m;
  map.level = cut.level;
  for (const int k : cut.level) {
    for (int j = 0; j < map.box.ny; ++j) {
      for (const RowSpan& span : problem.grid.row(k, j)) {
        for (int n = 0; n < span.n; ++n) map.add(span.i + n, span.offset + static_cast<std::uint32_t>(n));
      }
      map.end_row();
    }
    map.add_air(problem.grid.air_of(k));
  }
  fine.grid = remap(problem.grid, std::move(map));
  if (fine.grid.emits()) cut_emission(problem.grid.box, cut, fine.grid);
  return fine;
}

SolverOptions with_subdivided_levels(const SolverOptions& options, const SubdividedLevels& cut) {
  SolverOptions fine = options;
  std::vector<int> edge;  // of the parts, for each of the whole
  for (std::size_t part = 0; part < cut.level.size(); ++part) {
    if (part == 0 || cut.level[part] != cut.level[part - 1]) edge.push_back(static_cast<int>(part));
  }
  edge.push_back(static_cast<int>(cut.level.size()));
  for (int& level : fine.listed_levels) level = edge[level];
  fine.max_level_optical_depth = 0;
  return fine;
}

void join_levels(const Problem& whole, const SubdividedLevels& cut, Solution& solution) {
  const BoxGrid& box = whole.grid.box;
  for (const OutputField& field : output_fields()) {
    if (field.profile != nullptr) keep_edges(cut, solution.*field.profile);
    if (field.grid == OutputField::Grid::cells) mean_of_parts(whole, cut, solution.*field.values);
  }
  keep_planes(whole, cut, solution);
  if (solution.radiance_field) mean_of_parts(whole, cut, *solution.radiance_field);
  solution.box = box;
  solution.report.active_voxels = whole.grid.active_cells();
}

}  // namespace cloudbow
