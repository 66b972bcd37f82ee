#include "transport/reduction/thick_levels.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

#include "cloudbow/optics/delta_m.hpp"
#include "cloudbow/transport/columns.hpp"
#include "transport/grid/cells.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {
namespace {

constexpr double least_share_of_beam = .01;
constexpr int most_parts = 6;
constexpr double parts_of_most = 63;  // 1 + 2 + 4 + ... + 32

// What the beam leaves in a level.
struct BeamInLevel {
  double share = 0;  // of the incident power
  double depth = 0;  // slant optical depth of the cells, mean by the power
};

// Columns by themselves, which is close enough to choose levels by.
std::vector<BeamInLevel> beam_in_levels(const Problem& problem, const SolverOptions& options) {
  std::vector<double> forward_fraction;
  for (const PhaseFunction& phase : problem.phase)
    forward_fraction.push_back(delta_m(phase, options.fit.delta_m_order).forward_fraction);
  const std::vector<double> extinction = scaled_extinction<double>(problem.grid, forward_fraction);
  const BoxGrid& box = problem.grid.box;
  const ActiveRows rows = active_rows(problem.grid);
  const std::vector<std::uint32_t> dense = dense_indices(rows);
  const std::size_t columns = box.columns();
  const double mu0 = -problem.sun->travel.z();
  std::vector<double> beam(columns, 1 / static_cast<double>(columns));
  std::vector<BeamInLevel> levels(box.nz());
  for (int k = box.nz() - 1; k >= 0; --k) {
    BeamInLevel& level = levels[k];
    for (std::uint32_t c = rows.level_cell[k]; c < rows.level_cell[k + 1]; ++c) {
      double& in = beam[dense[c] % columns];
      const double depth = extinction[c] * box.thickness_m(k) / mu0;
      const double left = -std::expm1(-depth) * in;
      in -= left;
      level.share += left;
      level.depth += left * depth;
    }
    if (level.share > 0) level.depth /= level.share;
  }
  return levels;
}

// Share of the thickness at which each part ends, from above; the last is 1.
std::vector<double> ends_of_parts(double depth, double largest) {
  std::vector<double> ends;
  // No part is more than twice its neighbour: a thin one beside a very thick one would set the iteration off.
  double end = 0, part = std::max(largest, depth / parts_of_most);
  while (static_cast<int>(ends.size()) + 1 < most_parts && end + part * 1.5 < depth) {
    end += part;
    ends.push_back(end / depth);
    part *= 2;
  }
  ends.push_back(1);
  return ends;
}

template <class Value>
void keep_edges(const CutLevels& cut, std::vector<Value>& of_edges) {
  if (of_edges.empty()) return;
  std::vector<Value> kept;
  for (std::size_t part = 0; part < cut.level.size(); ++part) {
    if (part == 0 || cut.level[part] != cut.level[part - 1]) kept.push_back(of_edges[part]);
  }
  kept.push_back(of_edges.back());
  of_edges = std::move(kept);
}

// Of the fluxes those at levels of the whole, by its indices.
void keep_planes(const Problem& whole, const CutLevels& cut, Solution& solution) {
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
  for (auto* field : {&solution.upwelling_flux, &solution.downwelling_diffuse_flux, &solution.direct_flux}) {
    std::vector<float> planes;
    for (const std::size_t plane : kept) {
      const auto from = field->begin() + static_cast<std::ptrdiff_t>(plane * columns);
      planes.insert(planes.end(), from, from + static_cast<std::ptrdiff_t>(columns));
    }
    *field = std::move(planes);
  }
}

std::vector<double> share_of_level(const Problem& whole, const CutLevels& cut) {
  std::vector<double> share;
  for (std::size_t part = 0; part < cut.level.size(); ++part)
    share.push_back((cut.z_edge_m[part + 1] - cut.z_edge_m[part]) / whole.grid.box.thickness_m(cut.level[part]));
  return share;
}

void mean_of_parts(const Problem& whole, const CutLevels& cut, std::vector<float>& field) {
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

void mean_of_parts(const Problem& whole, const CutLevels& cut, RadianceField& field) {
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

}  // namespace

CutLevels cut_thick_levels(const Problem& problem, const SolverOptions& options) {
  const BoxGrid& box = problem.grid.box;
  CutLevels cut;
  const double largest = options.largest_level_depth;
  const bool looked_at = largest > 0 && problem.sun && !solved_without_azimuths(problem, options);
  const std::vector<BeamInLevel> beam =
      looked_at ? beam_in_levels(problem, options) : std::vector<BeamInLevel>(box.nz());
  for (int k = 0; k < box.nz(); ++k) {
    const bool thick = beam[k].share >= least_share_of_beam;
    const std::vector<double> ends = thick ? ends_of_parts(beam[k].depth, largest) : std::vector<double>{1};
    for (std::size_t n = ends.size(); n-- > 0;) {
      cut.z_edge_m.push_back(n + 1 == ends.size() ? box.z_edge_m[k]
                                                  : box.z_edge_m[k + 1] - ends[n] * box.thickness_m(k));
      cut.level.push_back(k);
    }
  }
  cut.z_edge_m.push_back(box.z_edge_m.back());
  return cut;
}

Problem with_cut_levels(const Problem& problem, const CutLevels& cut) {
  Problem fine{{}, problem.phase, problem.sun, problem.sky_radiance, problem.surface};
  const OpticalGrid& from = problem.grid;
  OpticalGrid& to = fine.grid;
  to.box = from.box;
  to.box.z_edge_m = cut.z_edge_m;
  to.scattering.resize(from.scattering.size());
  to.layer_scattering.resize(from.layer_scattering.size());
  const int ny = from.box.ny;
  for (const int k : cut.level) {
    to.layer_absorption.push_back(from.layer_absorption[k]);
    for (std::size_t p = 0; p < to.layer_scattering.size(); ++p)
      to.layer_scattering[p].push_back(from.layer_scattering[p][k]);
    for (int row = k * ny; row < (k + 1) * ny; ++row) {
      to.row_begin.push_back(static_cast<std::uint32_t>(to.spans.size()));
      for (std::uint32_t s = from.row_begin[row]; s < from.row_begin[row + 1]; ++s) {
        const RowSpan& span = from.spans[s];
        to.spans.push_back({span.i, span.n, static_cast<std::uint32_t>(to.absorption.size())});
        const auto copy = [&span](const std::vector<float>& of, std::vector<float>& into) {
          into.insert(into.end(), of.begin() + span.offset, of.begin() + span.offset + span.n);
        };
        copy(from.absorption, to.absorption);
        for (std::size_t p = 0; p < to.scattering.size(); ++p) copy(from.scattering[p], to.scattering[p]);
      }
    }
  }
  to.row_begin.push_back(static_cast<std::uint32_t>(to.spans.size()));
  return fine;
}

SolverOptions with_cut_levels(const SolverOptions& options, const CutLevels& cut) {
  SolverOptions fine = options;
  std::vector<int> edge;  // of the parts, for each of the whole
  for (std::size_t part = 0; part < cut.level.size(); ++part) {
    if (part == 0 || cut.level[part] != cut.level[part - 1]) edge.push_back(static_cast<int>(part));
  }
  edge.push_back(static_cast<int>(cut.level.size()));
  for (int& level : fine.listed_levels) level = edge[level];
  fine.largest_level_depth = 0;
  return fine;
}

void join_levels(const Problem& whole, const CutLevels& cut, Solution& solution) {
  const BoxGrid& box = whole.grid.box;
  for (auto* profile :
       {&solution.profile_upwelling_flux, &solution.profile_downwelling_diffuse_flux, &solution.profile_direct_flux})
    keep_edges(cut, *profile);
  keep_planes(whole, cut, solution);
  for (auto* field : {&solution.absorbed_power, &solution.actinic_flux}) mean_of_parts(whole, cut, *field);
  if (solution.radiance_field) mean_of_parts(whole, cut, *solution.radiance_field);
  solution.box = box;
  solution.report.active_voxels = whole.grid.active_cells();
}

}  // namespace cloudbow
