#include "transport/grid/cells.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>
#include <utility>

namespace cloudbow {

std::size_t ActiveRows::largest_level() const {
  std::uint32_t largest = 0;
  for (int k = 0; k < nz; ++k) largest = std::max(largest, level_cell[k + 1] - level_cell[k]);
  return largest;
}

namespace {

void append_chunks(Sheets& sheets, std::uint32_t first_cell, int first_column, int row, int n) {
  for (int i = 0; i < n; i += lanes) {
    sheets.chunks.push_back(
        {first_cell + static_cast<std::uint32_t>(i), first_column + i, row, std::min(lanes, n - i)});
  }
}

}  // namespace

namespace {

// Gaps of each level in pieces that lie within a block.
void add_gaps(const OpticalGrid& grid, ActiveRows& active) {
  active.air = grid.air;
  active.places.assign(active.size(), 1);
  active.gaps.count = active.nz;
  active.gaps.rows = active.ny;
  active.gaps.columns = active.nx;
  std::vector<Chunk>& chunks = active.gaps.chunks;
  std::vector<std::uint32_t>& begin = active.gaps.begin;
  for (int k = 0; k < active.nz; ++k) {
    const AirBlocks& air = grid.air[k];
    std::fill_n(active.places.begin() + air.first_cell, air.count(), 0);
    begin.resize(static_cast<std::size_t>(k) * (active.ny + 1) + 1, static_cast<std::uint32_t>(chunks.size()));
    if (air.count() > 0) {
      grid.for_each_gap(k, [&](int j, int i, int n) {
        begin.resize(static_cast<std::size_t>(k) * (active.ny + 1) + j + 1, static_cast<std::uint32_t>(chunks.size()));
        for (const int end = i + n; i < end;) {
          const int last = std::min(end, (i / air.width_x + 1) * air.width_x);
          const std::uint32_t cell = air.cell(i, j);
          chunks.push_back({cell, i, j, last - i});
          active.places[cell] += static_cast<std::uint32_t>(last - i);
          i = last;
        }
      });
    }
    begin.resize(static_cast<std::size_t>(k + 1) * (active.ny + 1), static_cast<std::uint32_t>(chunks.size()));
  }
  active.first_gap.push_back(0);
  for (int k = 0; k < active.nz; ++k) {
    std::vector<Chunk>& all = active.gaps_by_block;
    if (grid.air[k].count() == 1 && !active.has_voxels(k)) {
      all.push_back({grid.air[k].first_cell, 0, 0, active.nx * active.ny});
    } else {
      const auto of_level = active.gaps.of(k);
      all.insert(all.end(), of_level.begin(), of_level.end());
      std::stable_sort(all.begin() + active.first_gap.back(), all.end(),
                       [](const Chunk& a, const Chunk& b) { return a.cell < b.cell; });
    }
    active.first_gap.push_back(static_cast<std::uint32_t>(all.size()));
  }
}

}  // namespace

ActiveRows active_rows(const OpticalGrid& grid) {
  ActiveRows active;
  active.nx = grid.box.nx;
  active.ny = grid.box.ny;
  active.nz = grid.box.nz();
  active.spans = grid.spans;
  active.level_row.push_back(0);
  active.level_cell.push_back(0);
  active.levels.count = active.nz;
  active.levels.rows = active.ny;
  active.levels.columns = active.nx;
  std::uint32_t cells = 0;
  for (int k = 0; k < active.nz; ++k) {
    for (int j = 0; j < active.ny; ++j) {
      active.levels.begin.push_back(static_cast<std::uint32_t>(active.levels.chunks.size()));
      const std::size_t row = static_cast<std::size_t>(k) * active.ny + j;
      const std::uint32_t first = grid.row_begin[row];
      const std::uint32_t last = grid.row_begin[row + 1];
      if (first == last) continue;
      active.rows.push_back({j, first, last});
      for (std::uint32_t s = first; s < last; ++s) {
        const RowSpan& span = grid.spans[s];
        append_chunks(active.levels, span.offset, span.i, j, span.n);
        cells += static_cast<std::uint32_t>(span.n);
      }
    }
    active.levels.begin.push_back(static_cast<std::uint32_t>(active.levels.chunks.size()));
    cells += static_cast<std::uint32_t>(grid.air_of(k).count());
    active.level_row.push_back(static_cast<std::uint32_t>(active.rows.size()));
    active.level_cell.push_back(cells);
  }
  if (!grid.air.empty()) add_gaps(grid, active);
  return active;
}

std::vector<std::uint32_t> dense_indices(const ActiveRows& rows) {
  std::vector<std::uint32_t> index(rows.size(), no_place);
  for (int k = 0; k < rows.nz; ++k) {
    for (std::uint32_t r = rows.level_row[k]; r < rows.level_row[k + 1]; ++r) {
      const ActiveRow& row = rows.rows[r];
      for (std::uint32_t s = row.first_span; s < row.last_span; ++s) {
        const RowSpan& span = rows.spans[s];
        const std::size_t first = (static_cast<std::size_t>(k) * rows.ny + row.j) * rows.nx + span.i;
        for (std::int32_t i = 0; i < span.n; ++i) index[span.offset + i] = static_cast<std::uint32_t>(first + i);
      }
    }
  }
  return index;
}

std::vector<std::uint32_t> dense_indices(const OpticalGrid& grid) {
  std::vector<std::uint32_t> index(grid.active_cells(), no_place);
  grid.for_each_span([&](int k, int j, const RowSpan& span) {
    const std::size_t first = (static_cast<std::size_t>(k) * grid.box.ny + j) * grid.box.nx + span.i;
    std::iota(index.begin() + span.offset, index.begin() + span.offset + span.n, static_cast<std::uint32_t>(first));
  });
  return index;
}

namespace {

constexpr std::uint32_t no_cell = 0xFFFFFFFF;
template <class Real>
constexpr Real thin_air = Real(1e-4);  // of the extinction of a neighbour

// Index of the active cell at each location of the box, no_cell if there is none.
std::vector<std::uint32_t> cell_at_place(const ActiveRows& rows) {
  std::vector<std::uint32_t> cell(static_cast<std::size_t>(rows.nx) * rows.ny * rows.nz, no_cell);
  const auto dense = dense_indices(rows);
  for (std::size_t c = 0; c < dense.size(); ++c) {
    if (dense[c] != no_place) cell[dense[c]] = static_cast<std::uint32_t>(c);
  }
  return cell;
}

// Runs of levels of one thickness, without empty levels at their ends.
std::vector<LevelRange> even_runs(const BoxGrid& box, const ActiveRows& rows) {
  std::vector<LevelRange> runs;
  for (int first = 0, last = 0; first < box.nz(); first = last) {
    last = first + 1;
    while (last < box.nz() && have_one_thickness(box, first, last)) ++last;
    LevelRange run{first, last};
    while (run.first < run.last && !rows.has_voxels(run.first)) ++run.first;
    while (run.first < run.last && !rows.has_voxels(run.last - 1)) --run.last;
    if (run.last - run.first > 1) runs.push_back(run);
  }
  return runs;
}

template <class Real>
bool varies_along(const Cells<Real>& cells, std::size_t axis) {
  for (int k = 0; k < cells.rows.nz; ++k) {
    for (std::uint32_t c = cells.rows.level_cell[k]; c < cells.rows.voxels_end(k); ++c) {
      const std::uint32_t next = cells.high[axis][c];
      if (next == c || cells.extinction[next] != cells.extinction[c]) return true;
      for (const auto& scattered : cells.scattered) {
        if (scattered[next] != scattered[c]) return true;
      }
    }
  }
  return false;
}

// Chunks along z, sheet by sheet along y.
Sheets sheets_along_y(const ActiveRows& rows, const Sheets& levels) {
  Sheets sheets;
  sheets.count = rows.ny;
  sheets.rows = rows.nz;
  sheets.columns = rows.nx;
  for (int j = 0; j < rows.ny; ++j) {
    for (int k = 0; k < rows.nz; ++k) {
      sheets.begin.push_back(static_cast<std::uint32_t>(sheets.chunks.size()));
      for (Chunk chunk : levels.of(k, j, j + 1)) {
        chunk.row = k;
        sheets.chunks.push_back(chunk);
      }
    }
    sheets.begin.push_back(static_cast<std::uint32_t>(sheets.chunks.size()));
  }
  sheets.chunks.resize(sheets.chunks.size() + Sheets::padding);
  return sheets;
}

// The gaps, sheet by sheet along x.
Sheets gaps_along_x(const ActiveRows& rows) {
  Sheets sheets;
  sheets.count = rows.nx;
  sheets.rows = rows.nz;
  sheets.columns = rows.ny;
  std::vector<std::vector<Chunk>> of_row(static_cast<std::size_t>(rows.nx) * rows.nz);  // [sheet][level]
  for (int k = 0; k < rows.nz; ++k) {
    for (const Chunk& chunk : rows.gaps.of(k)) {
      for (int i = chunk.column; i < chunk.column + chunk.n; ++i) {
        std::vector<Chunk>& row = of_row[static_cast<std::size_t>(i) * rows.nz + k];
        const bool extends =
            !row.empty() && row.back().cell == chunk.cell && row.back().column + row.back().n == chunk.row;
        if (!extends) row.push_back({chunk.cell, chunk.row, k, 0});
        ++row.back().n;
      }
    }
  }
  for (std::size_t row = 0; row < of_row.size(); ++row) {
    sheets.begin.push_back(static_cast<std::uint32_t>(sheets.chunks.size()));
    sheets.chunks.insert(sheets.chunks.end(), of_row[row].begin(), of_row[row].end());
    if ((row + 1) % rows.nz == 0) sheets.begin.push_back(static_cast<std::uint32_t>(sheets.chunks.size()));
  }
  return sheets;
}

// Sheets along x, and the cells level by level in the order i, j; those of the air in their own places.
std::pair<Sheets, std::vector<std::uint32_t>> sheets_along_x(const ActiveRows& rows) {
  std::vector<std::uint32_t> transposed(rows.size());
  std::vector<std::uint32_t> begin(static_cast<std::size_t>(rows.nz) * rows.nx + 1, 0);  // [k][i]
  std::vector<std::int32_t> row_of(rows.size());                                         // j of each turned cell
  for (int k = 0; k < rows.nz; ++k) {
    std::uint32_t* const of_level = begin.data() + static_cast<std::size_t>(k) * rows.nx;
    *of_level = rows.level_cell[k];
    for (const Chunk& chunk : rows.levels.of(k)) {
      for (int i = 0; i < chunk.n; ++i) ++of_level[chunk.column + i + 1];
    }
    for (int i = 0; i < rows.nx; ++i) of_level[i + 1] += of_level[i];
    std::vector<std::uint32_t> next(of_level, of_level + rows.nx);
    for (const Chunk& chunk : rows.levels.of(k)) {
      for (int i = 0; i < chunk.n; ++i) {
        const std::uint32_t place = next[chunk.column + i]++;
        transposed[place] = chunk.cell + static_cast<std::uint32_t>(i);
        row_of[place] = chunk.row;
      }
    }
    for (std::uint32_t c = rows.voxels_end(k); c < rows.level_cell[k + 1]; ++c) transposed[c] = c;
  }
  Sheets sheets;
  sheets.count = rows.nx;
  sheets.rows = rows.nz;
  sheets.columns = rows.ny;
  for (int i = 0; i < rows.nx; ++i) {
    for (int k = 0; k < rows.nz; ++k) {
      sheets.begin.push_back(static_cast<std::uint32_t>(sheets.chunks.size()));
      const std::size_t at = static_cast<std::size_t>(k) * rows.nx + i;
      const std::uint32_t end = i + 1 < rows.nx ? begin[at + 1] : rows.voxels_end(k);
      for (std::uint32_t first = begin[at]; first < end;) {
        std::uint32_t last = first + 1;
        while (last < end && row_of[last] == row_of[last - 1] + 1) ++last;
        append_chunks(sheets, first, row_of[first], k, static_cast<int>(last - first));
        first = last;
      }
    }
    sheets.begin.push_back(static_cast<std::uint32_t>(sheets.chunks.size()));
  }
  sheets.chunks.resize(sheets.chunks.size() + Sheets::padding);
  return {std::move(sheets), std::move(transposed)};
}

// Neighbours of the air, which are the same block above and below, and the share of each of its places.
template <class Real>
void add_air(const BoxGrid& box, Cells<Real>& cells) {
  const ActiveRows& rows = cells.rows;
  cells.share_of_place.assign(rows.size(), Real(1));
  const auto alike = [&](int k, int other) {
    return other >= 0 && other < rows.nz && rows.air[other].count() > 0 && rows.air[other].x == rows.air[k].x &&
           rows.air[other].y == rows.air[k].y;
  };
  for (int k = 0; k < rows.nz; ++k) {
    const AirBlocks& air = rows.air[k];
    double distance = 0;
    for (const int other : {k - 1, k + 1}) {
      if (alike(k, other)) distance += .5 * (box.thickness_m(k) + box.thickness_m(other)) / box.thickness_m(k);
    }
    for (std::uint32_t b = 0; b < static_cast<std::uint32_t>(air.count()); ++b) {
      const std::uint32_t c = air.first_cell + b;
      cells.share_of_place[c] = rows.places[c] > 0 ? Real(1) / static_cast<Real>(rows.places[c]) : Real(0);
      for (std::size_t axis = 0; axis < 3; ++axis) cells.low[axis][c] = cells.high[axis][c] = c;
      if (alike(k, k - 1)) cells.low[2][c] = rows.air[k - 1].first_cell + b;
      if (alike(k, k + 1)) cells.high[2][c] = rows.air[k + 1].first_cell + b;
      cells.scale[2][c] = distance > 0 ? static_cast<Real>(1 / distance) : Real(0);
    }
  }
}

}  // namespace

template <class Real>
VaryingAxes varying_axes(const Cells<Real>& cells) {
  return {cells.rows.nx > 1 && varies_along(cells, 0), cells.rows.ny > 1 && varies_along(cells, 1)};
}

template <class Real>
Cells<Real> make_cells(const OpticalGrid& grid, std::span<const double> forward_fraction, bool independent_columns,
                       std::size_t worth_shortcuts) {
  Cells<Real> cells;
  cells.rows = active_rows(grid);
  const std::size_t n = grid.active_cells();
  cells.extinction.assign(n + lane_padding, Real(0));
  cells.scattered.assign(grid.scattering.size(), std::vector<Real>(n));
  for (std::size_t c = 0; c < n; ++c) {
    double extinction = grid.absorption[c];
    for (std::size_t p = 0; p < grid.scattering.size(); ++p)
      extinction += (1 - forward_fraction[p]) * grid.scattering[p][c];
    cells.extinction[c] = static_cast<Real>(extinction);
    for (std::size_t p = 0; p < grid.scattering.size(); ++p) {
      const double scattered = (1 - forward_fraction[p]) * grid.scattering[p][c];
      cells.scattered[p][c] = extinction > 0 ? static_cast<Real>(scattered / extinction) : Real(0);
    }
  }

  if (grid.emits()) {
    cells.emitted.assign(n, Real(0));
    cells.emitted_step.assign(n, Real(0));
    for (std::size_t c = 0; c < n; ++c) {
      const double planck = grid.planck[c];
      if (!(planck > 0) || !(cells.extinction[c] > 0)) continue;
      cells.emitted[c] = static_cast<Real>(grid.absorption[c] / static_cast<double>(cells.extinction[c]) * planck);
      cells.emitted_step[c] = static_cast<Real>(std::clamp(grid.planck_step[c] / planck, -2., 2.));
    }
  }

  const BoxGrid& box = grid.box;
  const auto place = cell_at_place(cells.rows);
  const auto dense = dense_indices(cells.rows);
  for (int axis = 0; axis < 3; ++axis) {
    cells.low[axis].resize(n);
    cells.high[axis].resize(n);
    cells.scale[axis].resize(n);
  }
  const std::array<int, 3> count{box.nx, box.ny, box.nz()};
  for (std::size_t c = 0; c < n; ++c) {
    if (dense[c] == no_place) continue;
    const std::array<int, 3> at{static_cast<int>(dense[c] % box.nx), static_cast<int>(dense[c] / box.nx % box.ny),
                                static_cast<int>(dense[c] / (static_cast<std::size_t>(box.nx) * box.ny))};
    for (int axis = 0; axis < 3; ++axis) {
      const auto neighbour = [&](int step) -> std::uint32_t {
        std::array<int, 3> to = at;
        to[axis] += step;
        if (axis < 2 && (independent_columns || count[axis] == 1)) return no_cell;
        if (to[axis] < 0 || to[axis] >= count[axis]) {
          if (axis == 2 || !box.periodic) return no_cell;
          to[axis] = (to[axis] + count[axis]) % count[axis];
        }
        const std::uint32_t cell = place[(static_cast<std::size_t>(to[2]) * box.ny + to[1]) * box.nx + to[0]];
        // Air beside a cloud is no part of it: neither empty cells whose light is requested, nor hardly any matter.
        return cell != no_cell && cells.extinction[cell] <= thin_air<Real> * cells.extinction[c] ? no_cell : cell;
      };
      const std::uint32_t low = neighbour(-1);
      const std::uint32_t high = neighbour(+1);
      // Distance between the two places the difference is taken over, in this cell's own size.
      double distance = 0;
      const auto centre_distance = [&](int step) {
        if (axis < 2) return 1.;
        return .5 * (box.thickness_m(at[2]) + box.thickness_m(at[2] + step)) / box.thickness_m(at[2]);
      };
      if (low != no_cell) distance += centre_distance(-1);
      if (high != no_cell) distance += centre_distance(+1);
      // A cloud's side is lit or dark as a whole; extrapolating the gradient behind it overshoots. Top and base keep a
      // one-sided slope.
      if (axis < 2 && (low == no_cell || high == no_cell)) distance = 0;
      cells.low[axis][c] = low == no_cell ? static_cast<std::uint32_t>(c) : low;
      cells.high[axis][c] = high == no_cell ? static_cast<std::uint32_t>(c) : high;
      cells.scale[axis][c] = distance > 0 ? static_cast<Real>(1 / distance) : Real(0);
    }
  }
  if (cells.rows.has_air()) add_air(box, cells);
  const VaryingAxes varying = varying_axes(cells);
  cells.heterogeneous = n >= worth_shortcuts && !independent_columns && box.columns() > 1 &&
                        (varying.x || box.nx == 1) && (varying.y || box.ny == 1);
  if (cells.heterogeneous && may_march_sideways(box, independent_columns)) {
    cells.even_runs = even_runs(box, cells.rows);
    cells.transposed[1].sheets = sheets_along_y(cells.rows, cells.rows.levels);
    if (cells.rows.has_air()) {
      cells.transposed[1].gaps = sheets_along_y(cells.rows, cells.rows.gaps);
      cells.transposed[0].gaps = gaps_along_x(cells.rows);
    }
    auto& along_x = cells.transposed[0];
    std::tie(along_x.sheets, along_x.cell) = sheets_along_x(cells.rows);
    along_x.extinction.assign(n + lane_padding, Real(0));
    for (std::size_t c = 0; c < n; ++c) along_x.extinction[c] = cells.extinction[along_x.cell[c]];
  }
  return cells;
}

template VaryingAxes varying_axes<float>(const Cells<float>&);
template VaryingAxes varying_axes<double>(const Cells<double>&);
template Cells<float> make_cells<float>(const OpticalGrid&, std::span<const double>, bool, std::size_t);
template Cells<double> make_cells<double>(const OpticalGrid&, std::span<const double>, bool, std::size_t);

}  // namespace cloudbow
