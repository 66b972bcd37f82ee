#include "transport/acceleration/coarsening.hpp"

#include <algorithm>
#include <cmath>

namespace cloudbow {
namespace {

// Largest optical depth for transport scattering of a coarse cell, mean over the cells by their extinction. Beyond it,
// light that stays within the cell would not be corrected.
constexpr double thickest = 1.5;

// Levels in pairs if both have the same thickness: the coarse level of each.
std::vector<int> paired_levels(const BoxGrid& box) {
  std::vector<int> coarse(box.nz());
  int next = 0;
  for (int k = 0; k < box.nz(); ++next) {
    coarse[k] = next;
    const bool paired =
        k + 1 < box.nz() && std::abs(box.thickness_m(k + 1) - box.thickness_m(k)) <= 1e-6 * box.thickness_m(k);
    if (paired) coarse[k + 1] = next;
    k += paired ? 2 : 1;
  }
  return coarse;
}

// Blocks of air of a coarse level, from those of its one or two levels. Gaps beside clouds within a coarse cell count
// as empty: a correction need not be finer.
// @param level of the coarse levels, by level; @param by columns of a coarse column along x and y.
template <class Real>
void add_air(const Cells<Real>& cells, const std::vector<float>& absorption, const BoxGrid& box,
             const std::vector<int>& level, int of, std::array<int, 2> by, Coarsening<Real>& coarse) {
  OpticalGrid& grid = coarse.grid;
  const auto first = static_cast<std::uint32_t>(grid.absorption.size());
  AirBlocks shape;
  const auto for_each_level = [&](const auto& use) {
    for (int k = 0; k < box.nz(); ++k) {
      const AirBlocks& air = cells.rows.air[k];
      if (level[k] == of && air.count() > 0) use(k, air, box.thickness_m(k) / grid.box.thickness_m(of));
    }
  };
  // The finer blocks of two levels.
  for_each_level([&](int, const AirBlocks& air, double) {
    if (air.count() > shape.count()) shape = {first, air.x, air.y, air.width_x / by[0], air.width_y / by[1]};
  });
  grid.air.push_back(shape);
  const auto count = static_cast<std::size_t>(shape.count());
  grid.absorption.resize(first + count, 0.F);
  for (auto& scattering : grid.scattering) scattering.resize(first + count, 0.F);
  std::vector<double> sum(count, 0.);
  const auto for_each_block = [&](const auto& use) {
    for_each_level([&](int k, const AirBlocks& air, double height) {
      for (std::uint32_t b = 0; b < count; ++b) {
        const int x = std::min(static_cast<int>(b) % shape.x * air.x / shape.x, air.x - 1);
        const int y = std::min(static_cast<int>(b) / shape.x * air.y / shape.y, air.y - 1);
        const std::uint32_t c = air.first_cell + static_cast<std::uint32_t>(y * air.x + x);
        use(k, b, c, static_cast<double>(cells.extinction[c]) * height, height);
      }
    });
  };
  for_each_block([&](int, std::uint32_t b, std::uint32_t c, double extinction, double height) {
    sum[b] += extinction;
    grid.absorption[first + b] += static_cast<float>(static_cast<double>(absorption[c]) * height);
    for (std::size_t p = 0; p < grid.scattering.size(); ++p)
      grid.scattering[p][first + b] += static_cast<float>(static_cast<double>(cells.scattered[p][c]) * extinction);
  });
  for_each_block([&](int k, std::uint32_t b, std::uint32_t c, double extinction, double) {
    coarse.coarse_cell[c] = first + b;
    const bool above = k > 0 && level[k - 1] == of;
    const bool below = k + 1 < box.nz() && level[k + 1] == of;
    coarse.quarters[c] = {0, 0, static_cast<std::int8_t>(above ? 1 : below ? -1 : 0)};
    coarse.share[c] = sum[b] > 0 ? static_cast<Real>(extinction / sum[b]) : Real(0);
  });
}

}  // namespace

template <class Real>
std::optional<Coarsening<Real>> coarsen(const TransportSystem<Real>& system) {
  const Cells<Real>& cells = *system.cells;
  const BoxGrid& box = system.box;
  if (!cells.heterogeneous) return std::nullopt;
  const int by_x = box.nx % 2 == 0 ? 2 : 1;
  const int by_y = box.ny % 2 == 0 ? 2 : 1;
  const std::vector<int> level = paired_levels(box);

  Coarsening<Real> coarse;
  BoxGrid& to = coarse.grid.box;
  to = box;
  to.uniform.clear();
  to.nx /= by_x;
  to.ny /= by_y;
  to.dx_m *= by_x;
  to.dy_m *= by_y;
  to.z_edge_m = {box.z_edge_m.front()};
  for (int k = 0; k < box.nz(); ++k) {
    if (k + 1 == box.nz() || level[k + 1] != level[k]) to.z_edge_m.push_back(box.z_edge_m[k + 1]);
  }
  if (by_x * by_y == 1 && to.nz() == box.nz()) return std::nullopt;
  for (const AirBlocks& air : cells.rows.air) {
    if (air.count() > 0 && (air.width_x % by_x != 0 || air.width_y % by_y != 0)) return std::nullopt;
  }

  const auto dense = dense_indices(cells.rows);
  const std::size_t n = cells.size();
  std::vector<std::uint32_t> place(n);
  std::vector<double> volume(n);  // in parts of the coarse cell's
  double depth = 0;
  double extinction_sum = 0;
  for (std::size_t c = 0; c < n; ++c) {
    if (dense[c] == no_place) continue;  // of the air: below
    const int i = static_cast<int>(dense[c] % box.nx) / by_x;
    const int j = static_cast<int>(dense[c] / box.nx % box.ny) / by_y;
    const int k = static_cast<int>(dense[c] / box.columns());
    place[c] = static_cast<std::uint32_t>((static_cast<std::size_t>(level[k]) * to.ny + j) * to.nx + i);
    volume[c] = box.thickness_m(k) / to.thickness_m(level[k]) / (by_x * by_y);
    double transport = 0;
    for (std::size_t p = 0; p < cells.scattered.size(); ++p) {
      transport +=
          static_cast<double>(cells.scattered[p][c] * cells.extinction[c]) * (1 - system.truncated_asymmetry[p]);
    }
    const double extinction = static_cast<double>(cells.extinction[c]);
    depth += extinction * transport * std::max({to.dx_m, to.dy_m, to.thickness_m(level[k])});
    extinction_sum += extinction;
  }

  if (depth > thickest * extinction_sum) return std::nullopt;

  // Sums over each coarse place, then those places that hold anything, in order.
  const std::size_t places = to.columns() * static_cast<std::size_t>(to.nz());
  const std::size_t functions = cells.scattered.size();
  std::vector<double> extinction(places, 0.), absorption(places, 0.);
  std::vector<std::vector<double>> scattering(functions, std::vector<double>(places, 0.));
  std::vector<char> held(places, 0);
  for (std::size_t c = 0; c < n; ++c) {
    if (dense[c] == no_place) continue;
    const double here = static_cast<double>(cells.extinction[c]) * volume[c];
    held[place[c]] = 1;
    extinction[place[c]] += here;
    absorption[place[c]] += static_cast<double>(system.absorption[c]) * volume[c];
    for (std::size_t p = 0; p < functions; ++p)
      scattering[p][place[c]] += static_cast<double>(cells.scattered[p][c]) * here;
  }
  coarse.coarse_cell.resize(n);
  coarse.quarters.resize(n);
  coarse.share.resize(n);
  coarse.grid.scattering.resize(functions);
  coarse.grid.layer_absorption.assign(to.nz(), 0.);
  coarse.grid.layer_scattering.assign(functions, coarse.grid.layer_absorption);
  std::vector<std::uint32_t> cell_at(places, 0);
  for (std::size_t row = 0; row < places / to.nx; ++row) {
    coarse.grid.row_begin.push_back(static_cast<std::uint32_t>(coarse.grid.spans.size()));
    bool in_span = false;
    for (int i = 0; i < to.nx; ++i) {
      const std::size_t at = row * to.nx + i;
      const bool active = held[at] != 0;
      if (active) {
        cell_at[at] = static_cast<std::uint32_t>(coarse.grid.absorption.size());
        if (!in_span) coarse.grid.spans.push_back({i, 0, cell_at[at]});
        ++coarse.grid.spans.back().n;
        coarse.grid.absorption.push_back(static_cast<float>(absorption[at]));
        for (std::size_t p = 0; p < functions; ++p)
          coarse.grid.scattering[p].push_back(static_cast<float>(scattering[p][at]));
      }
      in_span = active;
    }
    if (cells.rows.has_air() && (row + 1) % static_cast<std::size_t>(to.ny) == 0)
      add_air(cells, system.absorption, box, level, static_cast<int>(row / to.ny), {by_x, by_y}, coarse);
  }
  coarse.grid.row_begin.push_back(static_cast<std::uint32_t>(coarse.grid.spans.size()));
  mark_uniform_levels(coarse.grid);

  for (std::size_t c = 0; c < n; ++c) {
    if (dense[c] == no_place) continue;
    coarse.coarse_cell[c] = cell_at[place[c]];
    const int k = static_cast<int>(dense[c] / box.columns());
    const auto side = [](bool halved, bool upper) { return static_cast<std::int8_t>(halved ? (upper ? 1 : -1) : 0); };
    const bool above = k > 0 && level[k - 1] == level[k];
    const bool below = k + 1 < box.nz() && level[k + 1] == level[k];
    coarse.quarters[c] = {side(by_x == 2, dense[c] % box.nx % 2 == 1),
                          side(by_y == 2, dense[c] / box.nx % box.ny % 2 == 1), side(above || below, above)};
    const double all = extinction[place[c]];
    coarse.share[c] = all > 0 ? static_cast<Real>(static_cast<double>(cells.extinction[c]) * volume[c] / all) : Real(0);
  }
  return coarse;
}

template std::optional<Coarsening<float>> coarsen<float>(const TransportSystem<float>&);
template std::optional<Coarsening<double>> coarsen<double>(const TransportSystem<double>&);

}  // namespace cloudbow
