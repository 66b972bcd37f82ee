#include "cloudbow/transport/cells.hpp"

#include <algorithm>

namespace cloudbow {

std::size_t ActiveRows::largest_level() const {
  std::uint32_t largest = 0;
  for (int k = 0; k < nz; ++k) largest = std::max(largest, level_cell[k + 1] - level_cell[k]);
  return largest;
}

ActiveRows active_rows(const OpticalGrid& grid) {
  ActiveRows active;
  active.nx = grid.box.nx;
  active.ny = grid.box.ny;
  active.nz = grid.box.nz();
  active.spans = grid.spans;
  active.level_row.push_back(0);
  active.level_cell.push_back(0);
  std::uint32_t cells = 0;
  for (int k = 0; k < active.nz; ++k) {
    for (int j = 0; j < active.ny; ++j) {
      const std::size_t row = static_cast<std::size_t>(k) * active.ny + j;
      const std::uint32_t first = grid.row_begin[row];
      const std::uint32_t last = grid.row_begin[row + 1];
      if (first == last) continue;
      active.rows.push_back({j, first, last});
      for (std::uint32_t s = first; s < last; ++s) cells += static_cast<std::uint32_t>(grid.spans[s].n);
    }
    active.level_row.push_back(static_cast<std::uint32_t>(active.rows.size()));
    active.level_cell.push_back(cells);
  }
  return active;
}

std::vector<std::uint32_t> dense_indices(const ActiveRows& rows) {
  std::vector<std::uint32_t> index(rows.size());
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

namespace {

constexpr std::uint32_t no_cell = 0xFFFFFFFF;

// Index of the active cell at each place of the box, no_cell where there is none.
std::vector<std::uint32_t> cell_at_place(const ActiveRows& rows) {
  std::vector<std::uint32_t> cell(static_cast<std::size_t>(rows.nx) * rows.ny * rows.nz, no_cell);
  const auto dense = dense_indices(rows);
  for (std::size_t c = 0; c < dense.size(); ++c) cell[dense[c]] = static_cast<std::uint32_t>(c);
  return cell;
}

}  // namespace

template <class Real>
Cells<Real> make_cells(const OpticalGrid& grid, std::span<const double> forward_fraction, bool vertical) {
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
    const std::array<int, 3> at{static_cast<int>(dense[c] % box.nx), static_cast<int>(dense[c] / box.nx % box.ny),
                                static_cast<int>(dense[c] / (static_cast<std::size_t>(box.nx) * box.ny))};
    for (int axis = 0; axis < 3; ++axis) {
      const auto neighbour = [&](int step) -> std::uint32_t {
        std::array<int, 3> to = at;
        to[axis] += step;
        if (axis < 2 && (vertical || count[axis] == 1)) return no_cell;
        if (to[axis] < 0 || to[axis] >= count[axis]) {
          if (axis == 2 || !box.periodic) return no_cell;
          to[axis] = (to[axis] + count[axis]) % count[axis];
        }
        return place[(static_cast<std::size_t>(to[2]) * box.ny + to[1]) * box.nx + to[0]];
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
  return cells;
}

template Cells<float> make_cells<float>(const OpticalGrid&, std::span<const double>, bool);
template Cells<double> make_cells<double>(const OpticalGrid&, std::span<const double>, bool);

}  // namespace cloudbow
