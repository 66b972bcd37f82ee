#include "transport/scattering/scattering.hpp"

#include <algorithm>
#include <array>

#include "cloudbow/core/parallel_errors.hpp"

namespace cloudbow {
namespace {

// Cells per tile: its D rows fit the second-level cache beside the matrix. Tiles are fixed, so sums do not depend on
// the number of threads.
constexpr std::size_t tile_cells = 128;

template <class Real>
using Tile = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;

template <class Real>
void load(const AngularField<Real>& field, std::size_t first, std::size_t n, Tile<Real>& tile) {
  for (int d = 0; d < static_cast<int>(tile.rows()); ++d) {
    Real* const to = tile.data() + d * tile.cols();
    const Real* const from = field.stored_row(d).read(first, n, to);
    if (from != to) std::copy_n(from, n, to);
  }
}

template <class Real>
void store(const Tile<Real>& tile, std::size_t first, std::size_t n, AngularField<Real>& field) {
  for (int d = 0; d < static_cast<int>(tile.rows()); ++d) {
    const Real* const from = tile.data() + d * tile.cols();
    if (field.packed()) {
      field.store(d, first, n, from);
    } else {
      std::copy_n(from, n, field.row(d) + first);
    }
  }
}

// sum_p scattered_p * (matrix_p * radiance), leaving out phase functions that scatter nothing in this tile.
template <class Real>
void scatter_tile(std::span<const DenseMatrix<Real>> matrix, const Cells<Real>& cells, std::size_t first, std::size_t n,
                  const Tile<Real>& radiance, Tile<Real>& product, Tile<Real>& source) {
  source.setZero();
  for (std::size_t p = 0; p < matrix.size(); ++p) {
    const Real* const share = cells.scattered[p].data() + first;
    if (std::all_of(share, share + n, [](Real s) { return s == 0; })) continue;
    product.noalias() = matrix[p] * radiance;
    for (Eigen::Index d = 0; d < product.rows(); ++d) {
      const Real* __restrict const from = product.data() + d * product.cols();
      Real* __restrict const to = source.data() + d * source.cols();
      for (std::size_t c = 0; c < n; ++c) to[c] += share[c] * from[c];
    }
  }
}

// tile.row(d) += scale * from
template <class Real>
void add_scaled(Real scale, const Real* __restrict from, std::size_t n, Tile<Real>& tile, Eigen::Index d) {
  Real* __restrict const to = tile.data() + d * tile.cols();
  for (std::size_t c = 0; c < n; ++c) to[c] += scale * from[c];
}

// Tile by tile: radiance [from_rows], changed by prepare(first, n, tile), scatters. The source [to_rows], changed by
// finish(first, n, tile), goes to `to`, which may be the array of the radiance itself. Both count all cells.
template <class Real, class Prepare, class Finish>
void scatter_tiles(const AngularField<Real>& from, int from_rows, AngularField<Real>& to, int to_rows,
                   std::span<const DenseMatrix<Real>> matrix, const Cells<Real>& cells, const Prepare& prepare,
                   const Finish& finish) {
  const std::size_t tiles = (from.cells + tile_cells - 1) / tile_cells;
  ParallelErrors errors;
#pragma omp parallel
  {
    Tile<Real> radiance, product, source;
    errors.run([&] {
      radiance.setZero(from_rows, tile_cells);
      product.resize(to_rows, tile_cells);
      source.resize(to_rows, tile_cells);
    });
#pragma omp for schedule(static)
    for (std::size_t tile = 0; tile < tiles; ++tile) {
      errors.run([&] {
        const std::size_t first = tile * tile_cells;
        const std::size_t n = std::min(tile_cells, from.cells - first);
        load(from, first, n, radiance);
        prepare(from.first_cell + first, n, radiance);
        scatter_tile(matrix, cells, from.first_cell + first, n, radiance, product, source);
        finish(from.first_cell + first, n, source);
        store(source, first, n, to);
      });
    }
  }
  errors.rethrow();
}

template <class Real>
void as_it_is(std::size_t, std::size_t, Tile<Real>&) {}

}  // namespace

template <class Real>
DenseMatrix<Real> rounded_conservatively(const Eigen::MatrixXd& matrix, std::span<const double> weight) {
  DenseMatrix<Real> rounded(matrix.rows(), matrix.cols());
  for (Eigen::Index j = 0; j < matrix.cols(); ++j) {
    double carry = 0;  // part of the integral lost by rounding so far
    for (Eigen::Index i = 0; i < matrix.rows(); ++i) {
      const double wanted = matrix(i, j) + carry / weight[i];
      rounded(i, j) = matrix(i, j) == 0 ? Real(0) : static_cast<Real>(wanted);
      carry += weight[i] * (matrix(i, j) - static_cast<double>(rounded(i, j)));
    }
  }
  return rounded;
}

template <class Real>
void scatter_in_place(AngularField<Real>& field, std::span<const DenseMatrix<Real>> matrix, const Cells<Real>& cells,
                      const ScatteringTerms<Real>& terms, const DenseMatrix<Real>& shape) {
  const auto add_moments = [&](std::span<const Real> moments, std::size_t cells_of, std::size_t first, std::size_t n,
                               Tile<Real>& tile) {
    const int count = static_cast<int>(moments.size() / cells_of);
    for (int d = 0; d < field.rows; ++d) {
      for (int m = 0; m < count; ++m) add_scaled(shape(d, m), moments.data() + m * cells_of + first, n, tile, d);
    }
  };
  const auto correct = [&](std::size_t first, std::size_t n, Tile<Real>& radiance) {
    if (terms.dark) radiance.setZero();
    add_moments(terms.correction, field.cells, first - field.first_cell, n, radiance);
  };
  const auto add_sources = [&](std::size_t first, std::size_t n, Tile<Real>& source) {
    add_moments(terms.emission, field.all_cells, first, n, source);
    for (const BeamSource<Real>& b : terms.beam) {
      for (int d = 0; d < field.rows; ++d) add_scaled(b.direction[d], b.intensity.data() + first, n, source, d);
    }
  };
  scatter_tiles(field, field.rows, field, field.rows, matrix, cells, correct, add_sources);
}

template <class Real>
AngularField<Real> scatter_to(int rows, AngularField<Real> radiance, std::span<const DenseMatrix<Real>> matrix,
                              const Cells<Real>& cells) {
  const int from_rows = radiance.rows;
  radiance.set_rows(std::max(rows, from_rows));
  scatter_tiles(radiance, from_rows, radiance, rows, matrix, cells, as_it_is<Real>, as_it_is<Real>);
  radiance.set_rows(rows);
  return radiance;
}

template <class Real>
AngularField<Real> scatter_towards(const AngularField<Real>& radiance, std::span<const DenseMatrix<Real>> matrix,
                                   const Cells<Real>& cells) {
  const int rows = matrix.empty() ? 0 : static_cast<int>(matrix.front().rows());
  AngularField<Real> source(rows, radiance.cells);
  source.first_cell = radiance.first_cell;
  source.all_cells = radiance.all_cells;
  scatter_tiles(radiance, radiance.rows, source, rows, matrix, cells, as_it_is<Real>, as_it_is<Real>);
  return source;
}

template <class Real>
void moments_of(const AngularField<Real>& radiance, const DenseMatrix<Real>& weights, std::span<Real> moments) {
  const std::size_t tiles = (radiance.cells + tile_cells - 1) / tile_cells;
  // Nothing throws here.
#pragma omp parallel for schedule(static)
  for (std::size_t tile = 0; tile < tiles; ++tile) {
    const std::size_t first = tile * tile_cells;
    const std::size_t n = std::min(tile_cells, radiance.cells - first);
    Real* const of_tile = moments.data() + first;
    for (Eigen::Index m = 0; m < weights.rows(); ++m) std::fill_n(of_tile + m * radiance.cells, n, Real(0));
    std::array<Real, tile_cells> room{};
    for (int d = 0; d < radiance.rows; ++d) {
      const Real* __restrict const from = radiance.stored_row(d).read(first, n, room.data());
      for (Eigen::Index m = 0; m < weights.rows(); ++m) {
        Real* __restrict const to = of_tile + m * radiance.cells;
        const Real weight = weights(m, d);
        for (std::size_t c = 0; c < n; ++c) to[c] += weight * from[c];
      }
    }
  }
}

template <class Real>
using Matrices = std::span<const DenseMatrix<Real>>;

#define CLOUDBOW_INSTANTIATE(Real)                                                                                  \
  template DenseMatrix<Real> rounded_conservatively<Real>(const Eigen::MatrixXd&, std::span<const double>);         \
  template void scatter_in_place<Real>(AngularField<Real>&, Matrices<Real>, const Cells<Real>&,                     \
                                       const ScatteringTerms<Real>&, const DenseMatrix<Real>&);                     \
  template AngularField<Real> scatter_to<Real>(int, AngularField<Real>, Matrices<Real>, const Cells<Real>&);        \
  template AngularField<Real> scatter_towards<Real>(const AngularField<Real>&, Matrices<Real>, const Cells<Real>&); \
  template void moments_of<Real>(const AngularField<Real>&, const DenseMatrix<Real>&, std::span<Real>)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow
