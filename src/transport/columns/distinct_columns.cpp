#include "transport/columns/distinct_columns.hpp"

#include <algorithm>
#include <numeric>
#include <unordered_map>
#include <utility>

#include "cloudbow/medium/grid_map.hpp"
#include "transport/grid/cells.hpp"
#include "transport/rays/direct_beam.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {

ColumnCells column_cells(const OpticalGrid& grid) {
  const BoxGrid& box = grid.box;
  ColumnCells columns;
  columns.begin.assign(box.columns() + 1, 0);
  columns.cell.resize(grid.active_cells());
  columns.level_cell.push_back(0);
  columns.level_cell.resize(box.nz() + 1, 0);
  grid.for_each_span([&](int k, int j, const RowSpan& span) {
    const std::size_t column = static_cast<std::size_t>(j) * box.nx + span.i;
    for (int i = 0; i < span.n; ++i) ++columns.begin[column + i + 1];
    columns.level_cell[k + 1] += static_cast<std::uint32_t>(span.n);
  });
  std::partial_sum(columns.begin.begin(), columns.begin.end(), columns.begin.begin());
  std::partial_sum(columns.level_cell.begin(), columns.level_cell.end(), columns.level_cell.begin());
  std::vector<std::uint32_t> next(columns.begin.begin(), columns.begin.end() - 1);
  grid.for_each_span([&](int, int j, const RowSpan& span) {
    const std::size_t column = static_cast<std::size_t>(j) * box.nx + span.i;
    for (int i = 0; i < span.n; ++i) columns.cell[next[column + i]++] = span.offset + static_cast<std::uint32_t>(i);
  });
  return columns;
}

namespace {

std::vector<double> fractions(const PolarStreams& streams, double PolarStreams::Scattering::*of) {
  std::vector<double> f;
  for (const auto& phase : streams.phase) f.push_back(phase.*of);
  return f;
}

}  // namespace

std::optional<SlantedBeam> slanted_beam(const Problem& problem, const SolverOptions& options,
                                        const PolarStreams& streams) {
  if (!problem.sun || !options.beam_crosses_columns) return std::nullopt;
  SolverOptions crossing = options;
  crossing.independent_columns = false;
  if (options.actinic && problem.grid.active_cells() < problem.grid.box.columns() * problem.grid.box.nz()) {
    Problem full = problem;
    full.grid = with_empty_cells(problem.grid);
    return slanted_beam(full, options, streams);
  }
  const ActiveRows rows = active_rows(problem.grid);
  DirectBeam<float> scattering =
      beam_with<float>(problem, rows, fractions(streams, &PolarStreams::Scattering::beam_fraction), crossing);
  DirectBeam<float> sharp =
      beam_with<float>(problem, rows, std::vector<double>(problem.phase.size(), 0.), crossing, {false});
  return SlantedBeam{std::move(scattering.irradiance), options.actinic,      std::move(scattering.level_flux),
                     std::move(sharp.level_flux),      scattering.side_gain, scattering.side_loss};
}

namespace {

class Likeness {
 public:
  Likeness(const Problem& problem, const ColumnCells& columns, const std::optional<SlantedBeam>& beam)
      : grid_(problem.grid), columns_(columns), surface_(problem.surface), beam_(beam) {}

  std::uint64_t hash(std::size_t column) const {
    std::uint64_t sum = 0x9E3779B97F4A7C15;
    const auto mix = [&sum](std::uint64_t value) {
      sum = (sum ^ value) * 0xD6E8FEB86659FD93;
      sum ^= sum >> 32;
    };
    visit(column, [&](std::size_t level, float value) {
      mix(level << 32 | __builtin_bit_cast(std::uint32_t, value));
      return true;
    });
    return sum;
  }

  bool alike(std::size_t a, std::size_t b) const {
    if (columns_.of(a).size() != columns_.of(b).size()) return false;
    std::vector<std::pair<std::size_t, float>> of_a;
    visit(a, [&](std::size_t level, float value) {
      of_a.emplace_back(level, value);
      return true;
    });
    std::size_t place = 0;
    bool same = true;
    visit(b, [&](std::size_t level, float value) {
      same = place < of_a.size() && of_a[place] == std::pair(level, value);
      ++place;
      return same;
    });
    return same && place == of_a.size();
  }

 private:
  // Passes every number that a column's fluxes depend on; ends when `take` returns false.
  template <class Take>
  void visit(std::size_t column, const Take& take) const {
    for (const auto* map : {&surface_.albedo_map, &surface_.planck_map}) {
      if (!map->empty() && !take(0, (*map)[column])) return;
    }
    if (beam_) {
      const auto take_levels = [&](const auto& of_box) {
        for (std::size_t c = column; c < of_box.size(); c += grid_.box.columns()) {
          if (!take(0, static_cast<float>(of_box[c]))) return false;
        }
        return true;
      };
      if (!take_levels(beam_->carried) || !take_levels(beam_->direct)) return;
      // A shadow may cross one column entirely between two levels.
      if (beam_->everywhere && !take_levels(beam_->irradiance)) return;
    }
    std::size_t level = 0;
    for (const std::uint32_t cell : columns_.of(column)) {
      while (columns_.level_cell[level + 1] <= cell) ++level;
      if (!take(level, grid_.absorption[cell])) return;
      for (const auto& scattering : grid_.scattering) {
        if (!take(level, scattering[cell])) return;
      }
      if (grid_.emits() && !(take(level, grid_.planck[cell]) && take(level, grid_.planck_step[cell]))) return;
      if (beam_ && !take(level, static_cast<float>(beam_->at(cell, level * grid_.box.columns() + column)))) return;
    }
  }

  const OpticalGrid& grid_;
  const ColumnCells& columns_;
  const Surface& surface_;
  const std::optional<SlantedBeam>& beam_;
};
}  // namespace

DistinctColumns distinct_columns(const Problem& problem, const ColumnCells& cells,
                                 const std::optional<SlantedBeam>& beam) {
  const std::size_t columns = problem.grid.box.columns();
  const Likeness likeness(problem, cells, beam);
  std::vector<std::uint64_t> hash(columns);
  // Nothing throws here.
#pragma omp parallel for schedule(static)
  for (std::size_t c = 0; c < columns; ++c) hash[c] = likeness.hash(c);
  DistinctColumns distinct;
  distinct.next.resize(columns);
  std::iota(distinct.next.begin(), distinct.next.end(), 0U);
  std::unordered_multimap<std::uint64_t, std::uint32_t> last;  // of each kind
  last.reserve(columns);
  for (std::uint32_t c = 0; c < columns; ++c) {
    auto [place, end] = last.equal_range(hash[c]);
    while (place != end && !likeness.alike(place->second, c)) ++place;
    if (place == end) {
      distinct.first.push_back(c);
      last.emplace(hash[c], c);
    } else {
      distinct.next[place->second] = c;
      place->second = c;
    }
  }
  // Columns of similar height share a batch.
  std::stable_sort(distinct.first.begin(), distinct.first.end(),
                   [&](std::uint32_t a, std::uint32_t b) { return cells.of(a).size() > cells.of(b).size(); });
  return distinct;
}

}  // namespace cloudbow
