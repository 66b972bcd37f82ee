#include "reference/doubling.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>

namespace cloudbow::reference {
namespace {

using Eigen::Index;

template <class Real>
ResponseOf<Real> doubled(const ResponseOf<Real>& r) {
  const Index down = r.transmit_down.rows(), up = r.transmit_up.rows();
  // Multiple reflections between the two equal parts: a geometric series, summed by solving.
  const Matrix<Real> between_down =
      (Matrix<Real>::Identity(down, down) - r.reflect_up * r.reflect_down).lu().solve(r.transmit_down);
  const Matrix<Real> between_up =
      (Matrix<Real>::Identity(up, up) - r.reflect_down * r.reflect_up).lu().solve(r.transmit_up);
  return {r.transmit_down * between_down, r.reflect_up + r.transmit_down * (r.reflect_up * between_up),
          r.reflect_down + r.transmit_up * (r.reflect_down * between_down), r.transmit_up * between_up};
}

template <class Real>
Matrix<Real> exponential(const Matrix<Real>& a) {
  Matrix<Real> sum = Matrix<Real>::Identity(a.rows(), a.cols()), term = sum;
  for (int n = 1; term.cwiseAbs().maxCoeff() > std::numeric_limits<Real>::epsilon() / 8; ++n) {
    term = term * a / Real(n);
    sum += term;
  }
  return sum;
}

/// Response of a slab so thin that light of every direction is transmitted. It is solved as an initial value problem
/// from top to bottom, then sorted by incident and outgoing light. `change` is d/dtau of all states, the `down` ones
/// first.
template <class Real>
ResponseOf<Real> thin_slab(const Matrix<Real>& change, Index down, Real optical_depth) {
  const Index up = change.rows() - down;
  const Matrix<Real> through = exponential<Real>(optical_depth * change);
  const Matrix<Real> transmit_up = through.bottomRightCorner(up, up).inverse();
  const Matrix<Real> reflect_down = -transmit_up * through.bottomLeftCorner(up, down);
  const Matrix<Real> reflect_up = through.topRightCorner(down, up) * transmit_up;
  return {through.topLeftCorner(down, down) + through.topRightCorner(down, up) * reflect_down, reflect_up, reflect_down,
          transmit_up};
}

template <class Real>
Index count_downward(const Vector<Real>& mu) {
  const Index count = (mu.array() < 0).count();
  assert((mu.head(count).array() < 0).all());
  return count;
}

}  // namespace

template <class Real>
ResponseOf<Real> response_by_doubling(const SlabOf<Real>& slab) {
  const Index diffuse_down = count_downward(slab.mu), ordinates = slab.mu.size(), up = ordinates - diffuse_down;
  const Index beams = slab.beam_mu.size(), planck = diffuse_down + beams;
  const Index down = planck + (slab.emission.size() > 0 ? 2 : 0), all = down + up;

  // mu dI/dtau = -extinction I + scatter I, downwards, with the beams and the Planck radiance as states: they are
  // sources of the others and have no source.
  const auto row_of = [&](Index ordinate) {
    return ordinate < diffuse_down ? ordinate : ordinate + down - diffuse_down;
  };
  Matrix<Real> change = -Matrix<Real>::Identity(all, all);
  Vector<Real> cosine(all);
  for (Index i = 0; i < ordinates; ++i) {
    cosine[row_of(i)] = -slab.mu[i];
    for (Index j = 0; j < ordinates; ++j) change(row_of(i), row_of(j)) += slab.scatter(i, j);
    for (Index b = 0; b < beams; ++b) change(row_of(i), diffuse_down + b) = slab.beam_source(i, b);
  }
  for (Index b = 0; b < beams; ++b) {
    cosine[diffuse_down + b] = slab.beam_mu[b];
    change(diffuse_down + b, diffuse_down + b) = -slab.beam_extinction;
  }
  if (down > planck) {
    for (Index i = 0; i < ordinates; ++i) change(row_of(i), planck) = slab.emission[i];
    cosine[planck] = cosine[planck + 1] = 1;
    change(planck, planck) = change(planck + 1, planck + 1) = 0;
    change(planck, planck + 1) = 1;
  }
  change = cosine.cwiseInverse().asDiagonal() * change;

  const Real thin = cosine.cwiseAbs().minCoeff() / 2;
  const int doublings = static_cast<int>(std::ceil(std::log2(std::max<Real>(1, slab.optical_depth / thin))));
  ResponseOf<Real> response = thin_slab<Real>(change, down, std::ldexp(slab.optical_depth, -doublings));
  for (int i = 0; i < doublings; ++i) response = doubled(response);
  return response;
}

template <class Real>
std::vector<SlabFluxes> solve_by_doubling(const SlabOf<Real>& slab) {
  const ResponseOf<Real> response = response_by_doubling(slab);
  const Index diffuse_down = count_downward(slab.mu), up = slab.mu.size() - diffuse_down;
  const Index beams = slab.beam_mu.size();
  const Vector<Real> flux = slab.weight.cwiseProduct(slab.mu.cwiseAbs());
  const Vector<Real> flux_up = flux.tail(up);
  Vector<Real> flux_down = Vector<Real>::Zero(diffuse_down + beams);
  flux_down.head(diffuse_down) = flux.head(diffuse_down);
  // Response to light that the surface reflects: isotropic from below.
  const Real from_below = flux_up.sum(), albedo = slab.surface_albedo;
  const Real comes_back = (flux_down.transpose() * response.reflect_up).sum() / from_below;
  const Real gets_out = (flux_up.transpose() * response.transmit_up).sum() / from_below;
  flux_down.tail(beams) = slab.beam_mu;

  std::vector<SlabFluxes> fluxes;
  for (Index b = 0; b < beams; ++b) {
    const Index from = diffuse_down + b;
    const Real incident = slab.beam_mu[b];
    const Real arriving = flux_down.dot(response.transmit_down.col(from)) / incident / (1 - albedo * comes_back);
    const Real reflected = flux_up.dot(response.reflect_down.col(from)) / incident + albedo * arriving * gets_out;
    fluxes.push_back({static_cast<double>(reflected), static_cast<double>(arriving)});
  }
  return fluxes;
}

#define CLOUDBOW_INSTANTIATE(Real)                                           \
  template ResponseOf<Real> response_by_doubling<Real>(const SlabOf<Real>&); \
  template std::vector<SlabFluxes> solve_by_doubling<Real>(const SlabOf<Real>&)
CLOUDBOW_INSTANTIATE(double);
CLOUDBOW_INSTANTIATE(long double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow::reference
