#include "cloudbow/transport/folded_scattering.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace cloudbow {
namespace {

constexpr int tile = static_cast<int>(AngularField<float>::tile);
constexpr int width = 8;  // of the vectors below

template <class Real>
struct VectorOf {
  typedef Real type __attribute__((vector_size(width * sizeof(Real))));
};
template <class Real>
using Vector = typename VectorOf<Real>::type;

template <class Real>
[[gnu::always_inline]] inline void load(const Real* from, Vector<Real>& v) {
  std::memcpy(&v, from, sizeof v);
}
template <class Real>
[[gnu::always_inline]] inline void store(const Vector<Real>& v, Real* to) {
  std::memcpy(to, &v, sizeof v);
}

bool odd(unsigned bits) { return (std::popcount(bits) & 1) != 0; }

// product[r] = sum_k matrix(r, k) * from[k] for `rows` rows and a tile of cells; matrix by columns of `size`.
template <class Real, int rows>
[[gnu::always_inline]] inline void multiply_rows(const Real* matrix, int size, const Real* from, Real* product) {
  constexpr int vectors = 2;
  for (int c = 0; c < tile; c += vectors * width) {
    Vector<Real> sum[rows][vectors] = {};
    for (int k = 0; k < size; ++k) {
      Vector<Real> value[vectors];
      for (int v = 0; v < vectors; ++v) load(from + k * tile + c + v * width, value[v]);
      for (int r = 0; r < rows; ++r) {
        for (int v = 0; v < vectors; ++v) sum[r][v] += matrix[k * size + r] * value[v];
      }
    }
    for (int r = 0; r < rows; ++r) {
      for (int v = 0; v < vectors; ++v) store(sum[r][v], product + r * tile + c + v * width);
    }
  }
}

template <class Real>
void multiply(const std::vector<Real>& matrix, int size, const Real* from, Real* product) {
  int r = 0;
  for (; r + 4 <= size; r += 4) multiply_rows<Real, 4>(matrix.data() + r, size, from, product + r * tile);
  for (; r < size; ++r) multiply_rows<Real, 1>(matrix.data() + r, size, from, product + r * tile);
}

// Ordinates by octant; in each the same directions but for signs, in the same order. Empty where there is no such
// order.
std::vector<int> order_by_octant(const OrdinateSet& ordinates) {
  const int size = ordinates.size() / 8;
  if (size == 0 || ordinates.size() % 8 != 0) return {};
  std::vector<int> order;
  std::vector<Direction> positive;
  for (int d = 0; d < ordinates.size(); ++d) {
    const Direction& o = ordinates.direction[d];
    if (o.x() > 0 && o.y() > 0 && o.z() > 0) positive.push_back(o);
  }
  if (static_cast<int>(positive.size()) != size) return {};
  for (unsigned octant = 0; octant < 8; ++octant) {
    for (const Direction& p : positive) {
      const Direction wanted(octant & 1 ? -p.x() : p.x(), octant & 2 ? -p.y() : p.y(), octant & 4 ? -p.z() : p.z());
      int found = 0;
      while (found < ordinates.size() && (ordinates.direction[found] - wanted).norm() > 1e-9) ++found;
      if (found == ordinates.size()) return {};
      order.push_back(found);
    }
  }
  return order;
}

}  // namespace

template <class Real>
std::optional<FoldedScattering<Real>> FoldedScattering<Real>::make(const OrdinateSet& ordinates,
                                                                   std::span<const DenseMatrix<Real>> matrix,
                                                                   const DenseMatrix<Real>& moment_weights,
                                                                   const DenseMatrix<Real>& correction_shape) {
  FoldedScattering folded;
  folded.ordinate_ = order_by_octant(ordinates);
  if (folded.ordinate_.empty()) return std::nullopt;
  const int size = ordinates.size() / octants;
  folded.octant_size_ = size;
  const auto at = [&](unsigned octant, int b) { return folded.ordinate_[octant * size + b]; };
  std::vector<double> weight(size);
  for (int b = 0; b < size; ++b) weight[b] = ordinates.weight[at(0, b)];

  // Tables are symmetric but for the rounding of their fits, to some 1e-6 of their largest entry.
  constexpr double asymmetry = 1e-4;
  for (const DenseMatrix<Real>& full : matrix) {
    const double largest = static_cast<double>(full.cwiseAbs().maxCoeff());
    std::array<Eigen::MatrixXd, octants> between;  // from octant 0 to octant g, mean over the pairs alike
    for (auto& m : between) m = Eigen::MatrixXd::Zero(size, size);
    for (unsigned to = 0; to < octants; ++to) {
      for (unsigned from = 0; from < octants; ++from) {
        for (int b = 0; b < size; ++b) {
          for (int c = 0; c < size; ++c) {
            const double value = static_cast<double>(full(at(to, b), at(from, c)));
            if (std::abs(value - static_cast<double>(full(at(to ^ from, b), at(0, c)))) > asymmetry * largest)
              return std::nullopt;
            between[to ^ from](b, c) += value / octants;
          }
        }
      }
    }
    auto& sectors = folded.matrix_.emplace_back();
    for (unsigned s = 0; s < octants; ++s) {
      Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(size, size);
      for (unsigned g = 0; g < octants; ++g) sum += (odd(s & g) ? -1. : 1.) / octants * between[g];
      // The even sector carries the integral.
      const DenseMatrix<Real> rounded =
          s == 0 ? rounded_conservatively<Real>(sum, weight) : DenseMatrix<Real>(sum.template cast<Real>());
      for (int c = 0; c < size; ++c) {
        for (int b = 0; b < size; ++b) sectors[s].push_back(rounded(b, c));
      }
    }
  }

  for (int m = 0; m < moment_weights.rows(); ++m) {
    for (unsigned s = 0; s < octants; ++s) {
      SectorMoment moment{m, std::vector<Real>(size), std::vector<Real>(size)};
      double size_of = 0;
      for (int b = 0; b < size; ++b) {
        double w = 0, shape = 0;
        for (unsigned o = 0; o < octants; ++o) {
          const double sign = odd(s & o) ? -1 : 1;
          w += sign * static_cast<double>(moment_weights(m, at(o, b))) / octants;
          shape += sign * static_cast<double>(correction_shape(at(o, b), m));
        }
        moment.weight[b] = static_cast<Real>(w);
        moment.shape[b] = static_cast<Real>(shape);
        size_of = std::max({size_of, std::abs(w) / weight[b], std::abs(shape)});
      }
      if (size_of > 1e-5) folded.moments_[s].push_back(std::move(moment));
    }
  }
  return folded;
}

// x[sector] = sum over octants of (-1)^(bits in common) x[octant]; its own inverse but for the factor of eight, which
// the matrices carry.
template <class Real>
template <class LoadVector, class StoreVector>
[[gnu::always_inline]] inline void FoldedScattering<Real>::transform(int octant_size, const LoadVector& load_vector,
                                                                     const StoreVector& store_vector) {
  for (int b = 0; b < octant_size; ++b) {
    for (int c = 0; c < tile; c += width) {
      Vector<Real> x[octants];
      for (int o = 0; o < octants; ++o) load_vector(o * octant_size + b, c, x[o]);
      for (int bit = 1; bit < octants; bit <<= 1) {
        for (int o = 0; o < octants; ++o) {
          if (o & bit) continue;
          const Vector<Real> sum = x[o] + x[o | bit];
          x[o | bit] = x[o] - x[o | bit];
          x[o] = sum;
        }
      }
      for (int o = 0; o < octants; ++o) store_vector(o * octant_size + b, c, x[o]);
    }
  }
}

template <class Real>
void FoldedScattering<Real>::fold(const AngularField<Real>& field, std::size_t first, Real* folded) const {
  const int* const ordinate = ordinate_.data();
  transform(
      octant_size_, [&](int row, int c, Vector<Real>& v) { load(field.row(ordinate[row]) + first + c, v); },
      [&](int row, int c, const Vector<Real>& v) { store(v, folded + row * tile + c); });
}

template <class Real>
void FoldedScattering<Real>::scatter_in_place(AngularField<Real>& field, const Cells<Real>& cells,
                                              std::span<const BeamSource<Real>> beam,
                                              std::span<const Real> correction) const {
  const std::size_t tiles = (field.cells + tile - 1) / tile;
  const int rows = field.rows;
  const int sector_values = octant_size_ * tile;
#pragma omp parallel
  {
    std::vector<Real> radiance(static_cast<std::size_t>(rows) * tile), source(radiance.size()), product(sector_values);
#pragma omp for schedule(static)
    for (std::size_t t = 0; t < tiles; ++t) {
      const std::size_t first = t * tile;
      const int n = static_cast<int>(std::min<std::size_t>(tile, field.cells - first));
      fold(field, first, radiance.data());
      if (!correction.empty()) {
        for (int s = 0; s < octants; ++s) {
          for (const SectorMoment& moment : moments_[s]) {
            const Real* __restrict const change = correction.data() + moment.moment * field.cells + first;
            for (int b = 0; b < octant_size_; ++b) {
              Real* __restrict const to = radiance.data() + s * sector_values + b * tile;
              const Real shape = moment.shape[b];
              for (int c = 0; c < n; ++c) to[c] += shape * change[c];
            }
          }
        }
      }
      bool any = false;
      for (std::size_t p = 0; p < matrix_.size(); ++p) {
        const Real* __restrict const share = cells.scattered[p].data() + first;
        if (std::all_of(share, share + n, [](Real x) { return x == 0; })) continue;
        for (int s = 0; s < octants; ++s) {
          multiply(matrix_[p][s], octant_size_, radiance.data() + s * sector_values, product.data());
          for (int b = 0; b < octant_size_; ++b) {
            const Real* __restrict const from = product.data() + b * tile;
            Real* __restrict const to = source.data() + s * sector_values + b * tile;
            if (any) {
              for (int c = 0; c < n; ++c) to[c] += share[c] * from[c];
            } else {
              for (int c = 0; c < n; ++c) to[c] = share[c] * from[c];
            }
          }
        }
        any = true;
      }
      if (!any) std::fill(source.begin(), source.end(), Real(0));
      transform(
          octant_size_, [&](int row, int c, Vector<Real>& v) { load(source.data() + row * tile + c, v); },
          [&](int row, int c, const Vector<Real>& v) { store(v, field.row(ordinate_[row]) + first + c); });
      for (const BeamSource<Real>& b : beam) {
        const Real* __restrict const intensity = b.intensity.data() + first;
        for (int d = 0; d < rows; ++d) {
          Real* __restrict const to = field.row(d) + first;
          const Real scale = b.direction[d];
          for (int c = 0; c < n; ++c) to[c] += scale * intensity[c];
        }
      }
    }
  }
}

template <class Real>
void FoldedScattering<Real>::moments_of(const AngularField<Real>& radiance, std::span<Real> moments) const {
  const std::size_t tiles = (radiance.cells + tile - 1) / tile;
#pragma omp parallel
  {
    std::vector<Real> folded(static_cast<std::size_t>(radiance.rows) * tile);
#pragma omp for schedule(static)
    for (std::size_t t = 0; t < tiles; ++t) {
      const std::size_t first = t * tile;
      const int n = static_cast<int>(std::min<std::size_t>(tile, radiance.cells - first));
      fold(radiance, first, folded.data());
      const std::size_t count = moments.size() / radiance.cells;
      for (std::size_t m = 0; m < count; ++m) std::fill_n(moments.data() + m * radiance.cells + first, n, Real(0));
      for (int s = 0; s < octants; ++s) {
        for (const SectorMoment& moment : moments_[s]) {
          Real* __restrict const to = moments.data() + moment.moment * radiance.cells + first;
          for (int b = 0; b < octant_size_; ++b) {
            const Real* __restrict const from = folded.data() + (s * octant_size_ + b) * tile;
            const Real weight = moment.weight[b];
            for (int c = 0; c < n; ++c) to[c] += weight * from[c];
          }
        }
      }
    }
  }
}

template class FoldedScattering<float>;
template class FoldedScattering<double>;

}  // namespace cloudbow
