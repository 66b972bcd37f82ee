#include "transport/system/source_slopes.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "cloudbow/core/parallel_errors.hpp"
#include "transport/rays/march.hpp"
#include "transport/rays/slope_fit.hpp"

namespace cloudbow {
namespace {

constexpr std::size_t block_cells = 1024;  // a thread's share of loops over cells

// A march along x has the axes (y, z, x), one along y the axes (x, z, y).
Eigen::Matrix3d in_axes_of_box(const Eigen::Matrix3d& spread, int axis) {
  const std::array<int, 3> place = axis == 0 ? std::array{1, 2, 0} : std::array{0, 2, 1};
  Eigen::Matrix3d turned;
  for (int a = 0; a < 3; ++a) {
    for (int b = 0; b < 3; ++b) turned(place[a], place[b]) = spread(a, b);
  }
  return turned;
}

}  // namespace

template <class Real>
SlopeTables<Real>::SlopeTables(const BoxGrid& box, const Cells<Real>& cells, const OrdinateSet& ordinates,
                               const std::vector<OrdinatePath>& paths, std::span<const DenseMatrix<Real>> scattering,
                               Slope<Real> beam, VaryingAxes varying)
    : ordinates_(ordinates), run_of_level_(static_cast<std::size_t>(box.nz()), -1), beam_(std::move(beam)) {
  for (std::size_t run = 0; run < cells.even_runs.size(); ++run) {
    const LevelRange& levels = cells.even_runs[run];
    std::fill(run_of_level_.begin() + levels.first, run_of_level_.begin() + levels.last, static_cast<int>(run));
  }
  for (int d = 0; d < ordinates.size(); ++d) {
    Spread& spread = spread_[octant_of(ordinates.direction[d])];
    const double weight = ordinates.weight[d];
    spread.weight += weight;
    spread.by_level.resize(box.nz(), Eigen::Matrix3d::Zero());
    spread.by_sheet.resize(cells.even_runs.size());
    const auto of_varying = [varying](Eigen::Matrix3d of_box) {
      if (!varying.x) of_box.row(0).setZero(), of_box.col(0).setZero();
      if (!varying.y) of_box.row(1).setZero(), of_box.col(1).setZero();
      return of_box;
    };
    for (const PathPattern& pattern : paths[d].along_z) {
      for (int step = 0; step < pattern.levels(); ++step)
        spread.by_level[pattern.level(step)] += weight * of_varying(spread_of_places(pattern, step));
    }
    for (const SidewaysPath& path : paths[d].sideways) {
      auto& by_sheet = spread.by_sheet[run_of_level_[path.levels.first]][path.axis];
      by_sheet.resize(path.axis == 0 ? box.nx : box.ny, Eigen::Matrix3d::Zero());
      for (int step = 0; step < path.pattern->levels(); ++step)
        by_sheet[path.pattern->level(step)] +=
            weight * of_varying(in_axes_of_box(spread_of_places(*path.pattern, step), path.axis));
    }
  }
  for (const DenseMatrix<Real>& matrix : scattering) {
    auto& table = between_.emplace_back();
    for (auto& row : table) row.fill(Real(0));
    for (int to = 0; to < ordinates.size(); ++to) {
      const int octant = octant_of(ordinates.direction[to]);
      const Real share = static_cast<Real>(ordinates.weight[to] / spread_[octant].weight);
      for (int from = 0; from < ordinates.size(); ++from)
        table[octant][octant_of(ordinates.direction[from])] += share * matrix(to, from);
    }
  }
}

template <class Real>
LightSlopes<Real> SlopeTables<Real>::none(std::size_t cells) const {
  LightSlopes<Real> slopes;
  for (auto* of : {&slopes.of_octant, &slopes.of_radiance}) {
    for (auto& octant : *of) {
      for (auto& axis : octant) axis.assign(cells + lane_padding, Real(0));
    }
  }
  return slopes;
}

template <class Real>
void SlopeTables<Real>::team_fit(const ActiveRows& rows, int octant, const Slope<Real>& moment,
                                 Slope<Real>& slope) const {
  const Spread& spread = spread_[octant];
  const std::array<std::vector<Eigen::Matrix3d>, 2> none;
  const auto by_sheet_of = [&](int k) -> const std::array<std::vector<Eigen::Matrix3d>, 2>& {
    return run_of_level_[k] < 0 ? none : spread.by_sheet[run_of_level_[k]];
  };
  const auto apply = [&](const Eigen::Matrix<Real, 3, 3>& inverse, std::uint32_t c) {
    const Eigen::Matrix<Real, 3, 1> g = inverse * Eigen::Matrix<Real, 3, 1>(moment[0][c], moment[1][c], moment[2][c]);
    for (int axis = 0; axis < 3; ++axis) slope[axis][c] = g[axis];
  };
  // Blocks of air have a slope along z alone. On average over their places, rays along x and y cross all sheets.
  const auto fit_air = [&](int k) {
    double along_z = spread.by_level[k](2, 2);
    for (const auto& by_sheet : by_sheet_of(k)) {
      double sum = 0;
      for (const Eigen::Matrix3d& of_sheet : by_sheet) sum += of_sheet(2, 2);
      if (!by_sheet.empty()) along_z += sum / static_cast<double>(by_sheet.size());
    }
    const Real inverse = along_z > 0 ? static_cast<Real>(1 / along_z) : Real(0);
    for (std::uint32_t c = rows.voxels_end(k); c < rows.level_cell[k + 1]; ++c) {
      slope[0][c] = slope[1][c] = 0;
      slope[2][c] = moment[2][c] * inverse;
    }
  };
  // Nothing throws here.
#pragma omp for schedule(static)
  for (int k = 0; k < rows.nz; ++k) {
    fit_air(k);
    const auto& [along_x, along_y] = by_sheet_of(k);
    if (along_x.empty() && along_y.empty()) {
      const Eigen::Matrix<Real, 3, 3> inverse =
          regular_inverse(spread.by_level[k], spread.weight).template cast<Real>();
      for (std::uint32_t c = rows.level_cell[k]; c < rows.voxels_end(k); ++c) apply(inverse, c);
      continue;
    }
    for (std::uint32_t r = rows.level_row[k]; r < rows.level_row[k + 1]; ++r) {
      const ActiveRow& row = rows.rows[r];
      Eigen::Matrix3d of_row = spread.by_level[k];
      if (!along_y.empty()) of_row += along_y[row.j];
      for (std::uint32_t s = row.first_span; s < row.last_span; ++s) {
        const RowSpan& span = rows.spans[s];
        for (std::int32_t i = 0; i < span.n; ++i) {
          Eigen::Matrix3d of_cell = of_row;
          if (!along_x.empty()) of_cell += along_x[span.i + i];
          apply(regular_inverse(of_cell, spread.weight).template cast<Real>(),
                span.offset + static_cast<std::uint32_t>(i));
        }
      }
    }
  }
}

template <class Real>
void SlopeTables<Real>::scatter(const Cells<Real>& cells, const AngularField<Real>& radiance,
                                LightSlopes<Real>& slopes) const {
  const std::size_t n = radiance.cells;
  ParallelErrors errors;
#pragma omp parallel
  {
    // Mean radiance by octant; the source that it makes, and its slopes along x, y, z.
    constexpr int quantities = 4;
    using Block = std::array<Real, block_cells>;
    std::vector<Block> mean, scattered;
    Block room;
    errors.run([&] {
      mean.resize(octants);
      scattered.resize(quantities * octants);
    });
#pragma omp for schedule(static)
    for (std::size_t first = 0; first < n; first += block_cells) {
      errors.run([&] {
        const std::size_t count = std::min(block_cells, n - first);
        const std::size_t first_of_all = radiance.first_cell + first;
        for (Block& octant : mean) std::fill_n(octant.begin(), count, Real(0));
        for (int d = 0; d < ordinates_.size(); ++d) {
          const int octant = octant_of(ordinates_.direction[d]);
          const Real share = static_cast<Real>(ordinates_.weight[d] / spread_[octant].weight);
          const Real* __restrict const from = radiance.stored_row(d).read(first, count, room.data());
          Real* __restrict const to = mean[octant].data();
          for (std::size_t c = 0; c < count; ++c) to[c] += share * from[c];
        }
        for (Block& block : scattered) std::fill_n(block.begin(), count, Real(0));
        for (std::size_t p = 0; p < between_.size(); ++p) {
          const Real* __restrict const albedo = cells.scattered[p].data() + first_of_all;
          for (int quantity = 0; quantity < quantities; ++quantity) {
            for (int to = 0; to < octants; ++to) {
              Real* __restrict const sum = scattered[octants * quantity + to].data();
              for (int from = 0; from < octants; ++from) {
                const Real share = between_[p][to][from];
                const Real* __restrict const light =
                    quantity == 0 ? mean[from].data() : slopes.of_radiance[from][quantity - 1].data() + first;
                for (std::size_t c = 0; c < count; ++c) sum[c] += share * albedo[c] * light[c];
              }
            }
          }
        }
        for (int q = 0; q < octants; ++q) {
          const Real* __restrict const here = scattered[q].data();
          const Real* __restrict const x = scattered[octants + q].data();
          const Real* __restrict const y = scattered[2 * octants + q].data();
          const Real* __restrict const z = scattered[3 * octants + q].data();
          Real* __restrict const to_x = slopes.of_octant[q][0].data() + first;
          Real* __restrict const to_y = slopes.of_octant[q][1].data() + first;
          Real* __restrict const to_z = slopes.of_octant[q][2].data() + first;
          for (std::size_t c = 0; c < count; ++c) {
            const Real relative = limited_inverse(x[c], y[c], z[c], here[c]);
            to_x[c] = x[c] * relative;
            to_y[c] = y[c] * relative;
            to_z[c] = z[c] * relative;
          }
        }
      });
    }
  }
  errors.rethrow();
}

template <class Real>
void make_relative(const Slope<Real>& beam, const CellEmission<Real>& emission, std::span<const Real> source,
                   std::span<const Real> from_beam, Slope<Real>& slope) {
  for (std::size_t c = 0; c < source.size(); ++c) {
    const Real b = from_beam[c];
    const Real x = slope[0][c] + beam[0][c] * b;
    const Real y = slope[1][c] + beam[1][c] * b;
    Real z = slope[2][c] + beam[2][c] * b;
    if (emission.source != nullptr) z += emission.step[c] * emission.source[c];
    const Real relative = limited_inverse(x, y, z, source[c]);
    slope[0][c] = x * relative;
    slope[1][c] = y * relative;
    slope[2][c] = z * relative;
  }
}

namespace {

template <bool emits, class Real>
void mix(const Slope<Real>& multiple, const Slope<Real>& beam, const CellEmission<Real>& emission, std::size_t first,
         std::size_t n, const Real* __restrict source, const Real* __restrict from_beam, Slope<Real>& slope) {
  const Real* __restrict const emitted = emits ? emission.source + first : nullptr;
  const Real* __restrict const step = emits ? emission.step + first : nullptr;
  const Real* __restrict const mx = multiple[0].data() + first;
  const Real* __restrict const my = multiple[1].data() + first;
  const Real* __restrict const mz = multiple[2].data() + first;
  const Real* __restrict const bx = beam[0].data() + first;
  const Real* __restrict const by = beam[1].data() + first;
  const Real* __restrict const bz = beam[2].data() + first;
  Real* __restrict const to_x = slope[0].data();
  Real* __restrict const to_y = slope[1].data();
  Real* __restrict const to_z = slope[2].data();
#pragma omp simd
  for (std::size_t c = 0; c < n; ++c) {
    const Real b = from_beam[c];
    Real rest = source[c] - b;
    if constexpr (emits) rest -= emitted[c];
    const Real x = mx[c] * rest + bx[c] * b;
    const Real y = my[c] * rest + by[c] * b;
    Real z = mz[c] * rest + bz[c] * b;
    if constexpr (emits) z += step[c] * emitted[c];
    // A truncated phase function can be negative in some directions; slopes relative to it are the same.
    const Real size = limited_inverse(x, y, z, std::abs(source[c]));
    const Real relative = source[c] < 0 ? -size : size;
    to_x[c] = x * relative;
    to_y[c] = y * relative;
    to_z[c] = z * relative;
  }
}

}  // namespace

template <class Real>
void mix_slopes(const Slope<Real>& multiple, const Slope<Real>& beam, const CellEmission<Real>& emission,
                std::size_t first, std::size_t n, const Real* source, const Real* from_beam, Slope<Real>& slope) {
  for (auto& axis : slope) axis.resize(std::max(axis.size(), n + lane_padding));
  if (emission.source != nullptr) {
    mix<true>(multiple, beam, emission, first, n, source, from_beam, slope);
  } else {
    mix<false>(multiple, beam, emission, first, n, source, from_beam, slope);
  }
}

#define CLOUDBOW_INSTANTIATE(Real)                                                                               \
  template class SlopeTables<Real>;                                                                              \
  template void make_relative<Real>(const Slope<Real>&, const CellEmission<Real>&, std::span<const Real>,        \
                                    std::span<const Real>, Slope<Real>&);                                        \
  template void mix_slopes<Real>(const Slope<Real>&, const Slope<Real>&, const CellEmission<Real>&, std::size_t, \
                                 std::size_t, const Real*, const Real*, Slope<Real>&)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow
