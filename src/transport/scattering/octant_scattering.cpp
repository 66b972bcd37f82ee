#include "transport/scattering/octant_scattering.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "cloudbow/core/parallel_errors.hpp"

namespace cloudbow {
namespace {

constexpr int tile = static_cast<int>(AngularField<float>::tile);

bool odd(unsigned bits) { return (std::popcount(bits) & 1) != 0; }

// product[r] = sum_k matrix(r, k) * from[k] for `rows` rows and n cells of a tile; matrix by columns of `size`.
template <class Real, int rows>
[[gnu::always_inline]] inline void multiply_rows(const Real* matrix, int size, const Real* from, int n, Real* product) {
  constexpr int vectors = sizeof(Real) == sizeof(float) ? 2 : 1;  // limit of the registers
  for (int c = 0; c < n; c += vectors * lanes) {
    Lanes<Real> sum[rows][vectors] = {};
    for (int k = 0; k < size; ++k) {
      Lanes<Real> value[vectors];
      for (int v = 0; v < vectors; ++v) load_lanes(from + k * tile + c + v * lanes, value[v]);
      for (int r = 0; r < rows; ++r) {
        for (int v = 0; v < vectors; ++v) sum[r][v] += matrix[k * size + r] * value[v];
      }
    }
    for (int r = 0; r < rows; ++r) {
      for (int v = 0; v < vectors; ++v) store_lanes(sum[r][v], product + r * tile + c + v * lanes);
    }
  }
}

template <class Real>
void multiply(const std::vector<Real>& matrix, int size, const Real* from, int n, Real* product) {
  int r = 0;
  for (; r + 4 <= size; r += 4) multiply_rows<Real, 4>(matrix.data() + r, size, from, n, product + r * tile);
  for (; r < size; ++r) multiply_rows<Real, 1>(matrix.data() + r, size, from, n, product + r * tile);
}

// Ordinates by octant; in each the same directions but for signs, in the same order. Empty if there is no such order.
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
std::optional<OctantScattering<Real>> OctantScattering<Real>::make(const OrdinateSet& ordinates,
                                                                   std::span<const DenseMatrix<Real>> matrix,
                                                                   const DenseMatrix<Real>& moment_weights,
                                                                   const DenseMatrix<Real>& correction_shape) {
  OctantScattering by_octant;
  by_octant.ordinate_ = order_by_octant(ordinates);
  if (by_octant.ordinate_.empty()) return std::nullopt;
  const int size = ordinates.size() / octants;
  by_octant.octant_size_ = size;
  const auto at = [&](unsigned octant, int b) { return by_octant.ordinate_[octant * size + b]; };
  std::vector<double> weight(size);
  for (int b = 0; b < size; ++b) weight[b] = ordinates.weight[at(0, b)];

  // Tables are symmetric but for the rounding of their fits, to some 1e-6 of their largest entry.
  constexpr double asymmetry = 1e-4;
  for (const DenseMatrix<Real>& full : matrix) {
    const double largest = static_cast<double>(full.cwiseAbs().maxCoeff());
    std::array<Eigen::MatrixXd, octants> between;  // from octant 0 to octant g, mean over the equivalent pairs
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
    auto& sectors = by_octant.matrix_.emplace_back();
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
      if (size_of > 1e-5) by_octant.moments_[s].push_back(std::move(moment));
    }
  }
  return by_octant;
}

namespace {

// A tile of eight rows, to[sector] = sum over octants of (-1)^(bits in common) from[octant]; its own inverse but for
// the factor of eight, which the matrices carry.
template <bool prefetch, class Real>
[[gnu::always_inline]] inline void transform(const Real* const (&from)[8], Real* const (&to)[8]) {
  for (int c = 0; c < tile; c += lanes) {
    Lanes<Real> x[8];
    for (int o = 0; o < 8; ++o) load_lanes(from[o] + c, x[o]);
    // More streams than the processor prefetches by itself: the next tile's are prefetched here.
    if (prefetch && c * sizeof(Real) % 64 == 0) {
      for (int o = 0; o < 8; ++o) __builtin_prefetch(from[o] + tile + c);
    }
    for (int bit = 1; bit < 8; bit <<= 1) {
      for (int o = 0; o < 8; ++o) {
        if (o & bit) continue;
        const Lanes<Real> sum = x[o] + x[o | bit];
        x[o | bit] = x[o] - x[o | bit];
        x[o] = sum;
      }
    }
    for (int o = 0; o < 8; ++o) store_lanes(x[o], to[o] + c);
  }
}

// to += scale * from, or to = scale * from
template <bool add, class Real>
[[gnu::always_inline]] inline void accumulate(const Real* __restrict scale, const Real* __restrict from, int n,
                                              Real* __restrict to) {
  for (int c = 0; c < n; ++c) to[c] = add ? to[c] + scale[c] * from[c] : scale[c] * from[c];
}

template <class Real>
[[gnu::always_inline]] inline void add_scaled(Real scale, const Real* __restrict from, int n, Real* __restrict to) {
  for (int c = 0; c < n; ++c) to[c] += scale * from[c];
}

}  // namespace

template <class Real>
void OctantScattering<Real>::fold(const AngularField<Real>& field, std::size_t first, Real* by_octant) const {
  for (int b = 0; b < octant_size_; ++b) {
    const Real* from[octants];
    Real* to[octants];
    for (int o = 0; o < octants; ++o) {
      to[o] = by_octant + (o * octant_size_ + b) * tile;
      from[o] = field.stored_row(ordinate_[o * octant_size_ + b]).read(first, tile, to[o]);
    }
    if (field.packed()) {
      transform<false>(from, to);
    } else {
      transform<true>(from, to);
    }
  }
}

// Moments of n cells from `first` on, among those of `cells`, as sums over the octants.
template <class Real>
void OctantScattering<Real>::add_moments(std::span<const Real> moments, std::size_t cells, std::size_t first, int n,
                                         Real scale, Real* by_octant) const {
  const int count = static_cast<int>(moments.size() / cells);
  for (int s = 0; s < octants; ++s) {
    for (const SectorMoment& moment : moments_[s]) {
      if (moment.moment >= count) continue;
      const Real* const change = moments.data() + moment.moment * cells + first;
      for (int b = 0; b < octant_size_; ++b)
        add_scaled(scale * moment.shape[b], change, n, by_octant + (s * octant_size_ + b) * tile);
    }
  }
}

template <class Real>
void OctantScattering<Real>::scatter_in_place(AngularField<Real>& field, const Cells<Real>& cells,
                                              const ScatteringTerms<Real>& terms) const {
  const std::size_t tiles = (field.cells + tile - 1) / tile;
  const int sector_values = octant_size_ * tile;
  const bool scatters = !terms.dark || !terms.correction.empty();
  ParallelErrors errors;
#pragma omp parallel
  {
    std::vector<Real> radiance, source, product;
    errors.run([&] {
      radiance.resize(static_cast<std::size_t>(field.rows) * tile);
      source.resize(radiance.size());
      product.resize(static_cast<std::size_t>(sector_values));
    });
#pragma omp for schedule(static)
    for (std::size_t t = 0; t < tiles; ++t) {
      errors.run([&] {
        const std::size_t first = t * tile;
        const int n = static_cast<int>(std::min<std::size_t>(tile, field.cells - first));
        if (terms.dark) {
          std::fill(radiance.begin(), radiance.end(), Real(0));
        } else {
          fold(field, first, radiance.data());
        }
        const std::size_t first_of_all = field.first_cell + first;
        add_moments(terms.correction, field.cells, first, n, Real(1), radiance.data());
        bool any = false;
        for (std::size_t p = 0; scatters && p < matrix_.size(); ++p) {
          const Real* const share = cells.scattered[p].data() + first_of_all;
          if (std::all_of(share, share + n, [](Real x) { return x == 0; })) continue;
          for (int s = 0; s < octants; ++s) {
            multiply(matrix_[p][s], octant_size_, radiance.data() + s * sector_values, n, product.data());
            for (int b = 0; b < octant_size_; ++b) {
              Real* const to = source.data() + s * sector_values + b * tile;
              if (any) {
                accumulate<true>(share, product.data() + b * tile, n, to);
              } else {
                accumulate<false>(share, product.data() + b * tile, n, to);
              }
            }
          }
          any = true;
        }
        if (!any) std::fill(source.begin(), source.end(), Real(0));
        add_moments(terms.emission, field.all_cells, first_of_all, n, Real(1) / octants, source.data());
        for (int b = 0; b < octant_size_; ++b) {
          const Real* from[octants];
          Real* to[octants];
          for (int o = 0; o < octants; ++o) {
            Real* const own = source.data() + (o * octant_size_ + b) * tile;
            from[o] = own;
            to[o] = field.packed() ? own : field.row(ordinate_[o * octant_size_ + b]) + first;
          }
          transform<false>(from, to);
          for (const BeamSource<Real>& beam : terms.beam) {
            for (int o = 0; o < octants; ++o)
              add_scaled(beam.direction[ordinate_[o * octant_size_ + b]], beam.intensity.data() + first_of_all, n,
                         to[o]);
          }
          for (int o = 0; field.packed() && o < octants; ++o)
            field.store(ordinate_[o * octant_size_ + b], first, static_cast<std::size_t>(n), to[o]);
        }
      });
    }
  }
  errors.rethrow();
}

template <class Real>
void OctantScattering<Real>::moments_of(const AngularField<Real>& radiance, std::span<Real> moments) const {
  const std::size_t tiles = (radiance.cells + tile - 1) / tile;
  ParallelErrors errors;
#pragma omp parallel
  {
    std::vector<Real> by_octant;
    errors.run([&] { by_octant.resize(static_cast<std::size_t>(radiance.rows) * tile); });
#pragma omp for schedule(static)
    for (std::size_t t = 0; t < tiles; ++t) {
      errors.run([&] {
        const std::size_t first = t * tile;
        const int n = static_cast<int>(std::min<std::size_t>(tile, radiance.cells - first));
        fold(radiance, first, by_octant.data());
        const std::size_t own = radiance.cells;
        Real* const of_tile = moments.data() + first;
        const std::size_t count = moments.size() / own;
        for (std::size_t m = 0; m < count; ++m) std::fill_n(of_tile + m * own, n, Real(0));
        for (int s = 0; s < octants; ++s) {
          for (const SectorMoment& moment : moments_[s]) {
            Real* const to = of_tile + moment.moment * own;
            for (int b = 0; b < octant_size_; ++b)
              add_scaled(moment.weight[b], by_octant.data() + (s * octant_size_ + b) * tile, n, to);
          }
        }
      });
    }
  }
  errors.rethrow();
}

template class OctantScattering<float>;
template class OctantScattering<double>;

}  // namespace cloudbow
