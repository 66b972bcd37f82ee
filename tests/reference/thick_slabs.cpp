#include "reference/thick_slabs.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>

#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow::reference::thick_slabs {
namespace {

template <class Real>
using Matrix = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
template <class Real>
using Vector = Eigen::Matrix<Real, Eigen::Dynamic, 1>;

/// Response of a slab: what comes out below and above for what goes in above (down) and below (up). The beams are
/// states of the downward light, after the diffuse ordinates.
template <class Real>
struct Response {
  Matrix<Real> transmit_down, reflect_up;  // light that enters from above, leaves below; light from below, leaves below
  Matrix<Real> reflect_down, transmit_up;  // light that enters from above, leaves above; light from below, leaves above
};

template <class Real>
Response<Real> doubled(const Response<Real>& r) {
  const Eigen::Index down = r.transmit_down.rows(), up = r.transmit_up.rows();
  // Light to and fro between the two halves: a geometric series, summed by solving.
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

/// Of a slab so thin that light of every direction gets through: solved as an initial value problem from top to bottom,
/// then sorted by what goes in and what comes out. `change` is d/dtau of all states, the `down` ones first.
template <class Real>
Response<Real> thin_slab(const Matrix<Real>& change, Eigen::Index down, Real optical_depth) {
  const Eigen::Index up = change.rows() - down;
  const Matrix<Real> through = exponential<Real>(optical_depth * change);
  const Matrix<Real> transmit_up = through.bottomRightCorner(up, up).inverse();
  const Matrix<Real> reflect_down = -transmit_up * through.bottomLeftCorner(up, down);
  const Matrix<Real> reflect_up = through.topRightCorner(down, up) * transmit_up;
  return {through.topLeftCorner(down, down) + through.topRightCorner(down, up) * reflect_down, reflect_up, reflect_down,
          transmit_up};
}

template <class Real>
std::vector<SlabFluxes> solve(const SlabOf<Real>& slab) {
  std::vector<Eigen::Index> downward, upward;
  for (Eigen::Index d = 0; d < slab.mu.size(); ++d) (slab.mu[d] < 0 ? downward : upward).push_back(d);
  const auto diffuse_down = static_cast<Eigen::Index>(downward.size()), up = static_cast<Eigen::Index>(upward.size());
  const Eigen::Index beams = slab.beam_mu.size(), down = diffuse_down + beams, all = down + up;

  // mu dI/dtau = -extinction I + scatter I, downwards, with the beams as states that feed the others and are fed by
  // none.
  std::vector<Eigen::Index> state = downward;
  state.insert(state.end(), upward.begin(), upward.end());
  const auto row_of = [&](Eigen::Index s) { return s < diffuse_down ? s : s + beams; };
  Matrix<Real> change = -Matrix<Real>::Identity(all, all);
  Vector<Real> cosine(all);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(state.size()); ++i) {
    cosine[row_of(i)] = -slab.mu[state[i]];
    for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(state.size()); ++j) {
      change(row_of(i), row_of(j)) += slab.scatter(state[i], state[j]);
    }
    for (Eigen::Index b = 0; b < beams; ++b) change(row_of(i), diffuse_down + b) = slab.beam_source(state[i], b);
  }
  for (Eigen::Index b = 0; b < beams; ++b) {
    cosine[diffuse_down + b] = slab.beam_mu[b];
    change(diffuse_down + b, diffuse_down + b) = -slab.beam_extinction;
  }
  change = cosine.cwiseInverse().asDiagonal() * change;

  const Real thin = cosine.cwiseAbs().minCoeff() / 2;
  const int doublings = static_cast<int>(std::ceil(std::log2(std::max<Real>(1, slab.optical_depth / thin))));
  const Real thickness = std::ldexp(slab.optical_depth, -doublings);
  Response<Real> response = thin_slab<Real>(change, down, thickness);
  for (int i = 0; i < doublings; ++i) response = doubled(response);

  // Fluxes that leave, as functionals of the states.
  Vector<Real> flux_up(up), flux_down = Vector<Real>::Zero(down);
  for (Eigen::Index i = 0; i < up; ++i) flux_up[i] = slab.weight[upward[i]] * slab.mu[upward[i]];
  for (Eigen::Index i = 0; i < diffuse_down; ++i) flux_down[i] = -slab.weight[downward[i]] * slab.mu[downward[i]];
  // What becomes of light that the surface reflects: isotropic from below.
  const Real from_below = flux_up.sum(), albedo = slab.surface_albedo;
  const Real comes_back = (flux_down.transpose() * response.reflect_up).sum() / from_below;
  const Real gets_out = (flux_up.transpose() * response.transmit_up).sum() / from_below;
  for (Eigen::Index b = 0; b < beams; ++b) flux_down[diffuse_down + b] = slab.beam_mu[b];

  std::vector<SlabFluxes> fluxes;
  for (Eigen::Index b = 0; b < beams; ++b) {
    const Eigen::Index from = diffuse_down + b;
    const Real incident = flux_down[from];
    const Real arriving = flux_down.dot(response.transmit_down.col(from)) / incident / (1 - albedo * comes_back);
    const Real reflected = flux_up.dot(response.reflect_down.col(from)) / incident + albedo * arriving * gets_out;
    fluxes.push_back({static_cast<double>(reflected), static_cast<double>(arriving)});
  }
  return fluxes;
}

/// A node of the Gauss-Legendre rule, known in 64 bits, and its weight: one step of Newton's method.
template <class Real>
std::pair<Real, Real> in_full(int n, Real x) {
  Real below = 1, p = x;
  for (int l = 2; l <= n; ++l) {
    const Real next = ((2 * l - 1) * x * p - (l - 1) * below) / l;
    below = p;
    p = next;
  }
  const Real slope = n * (below - x * p) / (1 - x * x);
  // At a root the slope changes by 2 x / (1 - x^2) of itself per unit of x.
  const Real step = -p / slope, node = x + step, slope_there = slope * (1 + 2 * x * step / (1 - x * x));
  return {node, 2 / ((1 - node * node) * slope_there * slope_there)};
}

template <class Real>
std::vector<SlabFluxes> solve_plane_parallel(const std::function<double(int)>& chi, std::span<const double> beam_mu,
                                             double optical_depth, double single_scattering_albedo,
                                             double surface_albedo, int angles) {
  const int order = 2 * angles;
  const Real ssa = single_scattering_albedo;
  // Exact for any phase function as far as these quadratures can tell: what they cannot resolve is forward light or
  // noise.
  const Real f = std::max(0.0, chi(order));

  SlabOf<Real> slab;
  slab.mu.resize(2 * angles);
  slab.weight.resize(2 * angles);
  const GaussLegendre rule = make_gauss_legendre(angles);
  for (int i = 0; i < angles; ++i) {
    const auto [node, weight] = in_full(angles, Real(rule.node[i]));
    slab.mu[i] = -(1 + node) / 2;
    slab.mu[angles + i] = (1 + node) / 2;
    slab.weight[i] = slab.weight[angles + i] = std::numbers::pi_v<Real> * weight;
  }
  slab.beam_mu.resize(static_cast<Eigen::Index>(beam_mu.size()));
  std::copy(beam_mu.begin(), beam_mu.end(), slab.beam_mu.begin());
  slab.optical_depth = (1 - ssa * f) * optical_depth;
  slab.surface_albedo = surface_albedo;

  const auto legendre = [&](const Vector<Real>& mu) {
    Matrix<Real> p(mu.size(), order);
    p.col(0).setOnes();
    p.col(1) = mu;
    for (int l = 2; l < order; ++l) {
      p.col(l) = (Real(2 * l - 1) * mu.cwiseProduct(p.col(l - 1)) - Real(l - 1) * p.col(l - 2)) / Real(l);
    }
    return p;
  };
  const Matrix<Real> at_ordinates = legendre(slab.mu), at_beams = legendre(-slab.beam_mu);
  Vector<Real> factor(order);
  for (int l = 0; l < order; ++l)
    factor[l] = Real(2 * l + 1) * (chi(l) - f) * ssa / (1 - ssa * f) / (4 * std::numbers::pi_v<Real>);
  slab.scatter = at_ordinates * factor.asDiagonal() * at_ordinates.transpose() * slab.weight.asDiagonal();
  slab.beam_source = at_ordinates * factor.asDiagonal() * at_beams.transpose();
  return solve(slab);
}

}  // namespace

std::vector<SlabFluxes> solve_by_doubling(const Slab& slab) { return solve(slab); }

std::vector<SlabFluxes> plane_parallel_fluxes(const std::function<double(int)>& chi, std::span<const double> beam_mu,
                                              double optical_depth, double single_scattering_albedo,
                                              double surface_albedo, int angles) {
  const bool delicate = optical_depth > 100 && single_scattering_albedo > 0.99;
  const auto solve_in = delicate ? solve_plane_parallel<long double> : solve_plane_parallel<double>;
  return solve_in(chi, beam_mu, optical_depth, single_scattering_albedo, surface_albedo, angles);
}

}  // namespace cloudbow::reference::thick_slabs
