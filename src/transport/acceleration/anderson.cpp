#include "transport/acceleration/anderson.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>

#include "transport/system/ordinate_share.hpp"

namespace cloudbow {

template <class Real>
double ordered_dot(std::span<const Real> a, std::span<const Real> b, std::size_t sets, const OrdinateShare* share) {
  assert(a.size() == b.size());
  constexpr std::size_t block = OrdinateShare::block_cells;
  const std::size_t cells = a.size() / sets;
  const std::size_t blocks = (cells + block - 1) / block;
  std::vector<double> partial(sets * blocks, 0.);
  // Nothing throws here.
#pragma omp parallel for schedule(static)
  for (std::size_t k = 0; k < partial.size(); ++k) {
    const std::size_t first_of_set = k / blocks * cells;
    const std::size_t first = first_of_set + k % blocks * block;
    const std::size_t last = std::min(first_of_set + cells, first + block);
    double sum = 0;
#pragma omp simd reduction(+ : sum)
    for (std::size_t i = first; i < last; ++i) sum += static_cast<double>(a[i]) * static_cast<double>(b[i]);
    partial[k] = sum;
  }
  double sum = 0;
  for (std::size_t set = 0; set < sets; ++set) {
    const std::span<const double> own = std::span(partial).subspan(set * blocks, blocks);
    if (share == nullptr) {
      for (const double p : own) sum += p;
    } else {
      for (const double p : share->gather_blocks(own)) sum += p;
    }
  }
  return sum;
}

template <class Real>
void AndersonMixer<Real>::advance(std::span<Real> x, std::span<const Real> g) {
  const std::size_t n = x.size();
  std::vector<Real>&last_residual = history_.last_residual, &last_g = history_.last_g;
  auto &residual_change = history_.residual_change, &g_change = history_.g_change;
  if (history_.has_last) {
    std::vector<Real> dr, dg;
    if (static_cast<int>(residual_change.size()) == depth_) {  // the oldest make room
      dr = std::move(residual_change.front());
      dg = std::move(g_change.front());
      residual_change.pop_front();
      g_change.pop_front();
    }
    dr.resize(n);
    dg.resize(n);
#pragma omp parallel for simd schedule(static)
    for (std::size_t i = 0; i < n; ++i) {
      dr[i] = g[i] - x[i] - last_residual[i];
      dg[i] = g[i] - last_g[i];
    }
    residual_change.push_back(std::move(dr));
    g_change.push_back(std::move(dg));
  }
  history_.has_last = true;
  last_residual.resize(n);
  last_g.resize(n);
#pragma omp parallel for simd schedule(static)
  for (std::size_t i = 0; i < n; ++i) {
    last_residual[i] = g[i] - x[i];
    last_g[i] = x[i] = g[i];
  }
  const auto depth = static_cast<Eigen::Index>(residual_change.size());
  if (depth > 0) {
    Eigen::MatrixXd normal(depth, depth);
    Eigen::VectorXd right(depth);
    for (Eigen::Index i = 0; i < depth; ++i) {
      for (Eigen::Index j = 0; j <= i; ++j)
        normal(i, j) = normal(j, i) = ordered_dot<Real>(residual_change[i], residual_change[j], sets_, share_);
      right[i] = ordered_dot<Real>(residual_change[i], last_residual, sets_, share_);
    }
    normal.diagonal() *= 1 + 1e-7;  // keeps nearly dependent histories solvable
    const Eigen::VectorXd mix = normal.ldlt().solve(right);
    if (mix.allFinite()) {
      for (Eigen::Index i = 0; i < depth; ++i) {
        const Real share = static_cast<Real>(mix[i]);
        const std::vector<Real>& change = g_change[i];
#pragma omp parallel for simd schedule(static)
        for (std::size_t c = 0; c < n; ++c) x[c] -= share * change[c];
      }
    }
  }
}

template class AndersonMixer<float>;
template class AndersonMixer<double>;
template double ordered_dot<float>(std::span<const float>, std::span<const float>, std::size_t, const OrdinateShare*);
template double ordered_dot<double>(std::span<const double>, std::span<const double>, std::size_t,
                                    const OrdinateShare*);

}  // namespace cloudbow
