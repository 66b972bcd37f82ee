#include "reference/doubling.hpp"

#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <utility>

#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow::reference {
namespace {

using Eigen::MatrixXd;
using Eigen::VectorXd;

/// Response of a slab: what comes out below and above for what goes in above (down) and below (up). The beams are
/// states of the downward light, after the diffuse ordinates.
struct Response {
  MatrixXd transmit_down, reflect_up;  // light that enters from above, leaves below; light from below, leaves below
  MatrixXd reflect_down, transmit_up;  // light that enters from above, leaves above; light from below, leaves above
};

Response doubled(const Response& r) {
  const auto down = static_cast<Eigen::Index>(r.transmit_down.rows()),
             up = static_cast<Eigen::Index>(r.transmit_up.rows());
  // Light to and fro between the two halves: a geometric series, summed by solving.
  const MatrixXd between_down =
      (MatrixXd::Identity(down, down) - r.reflect_up * r.reflect_down).lu().solve(r.transmit_down);
  const MatrixXd between_up = (MatrixXd::Identity(up, up) - r.reflect_down * r.reflect_up).lu().solve(r.transmit_up);
  return {r.transmit_down * between_down, r.reflect_up + r.transmit_down * (r.reflect_up * between_up),
          r.reflect_down + r.transmit_up * (r.reflect_down * between_down), r.transmit_up * between_up};
}

int doublings_for(double optical_depth) {
  // The starting slab is solved to second order in its depth, so that halving it once more gains a factor 4.
  return std::max(10, static_cast<int>(std::ceil(std::log2(optical_depth * 4096))));
}

}  // namespace

std::vector<SlabFluxes> solve_by_doubling(const Slab& slab) {
  std::vector<Eigen::Index> downward, upward;
  for (Eigen::Index d = 0; d < slab.mu.size(); ++d) (slab.mu[d] < 0 ? downward : upward).push_back(d);
  const auto diffuse_down = static_cast<Eigen::Index>(downward.size()), up = static_cast<Eigen::Index>(upward.size());
  const Eigen::Index beams = slab.beam_mu.size(), down = diffuse_down + beams, all = down + up;

  // |mu| dI/dtau = -extinction I + scatter I, with the beams as states that feed the others and are fed by none.
  std::vector<Eigen::Index> state = downward;
  state.insert(state.end(), upward.begin(), upward.end());
  const auto row_of = [&](Eigen::Index s) { return s < diffuse_down ? s : s + beams; };
  MatrixXd loss = MatrixXd::Identity(all, all);
  VectorXd cosine(all);
  for (Eigen::Index i = 0; i < static_cast<Eigen::Index>(state.size()); ++i) {
    cosine[row_of(i)] = std::abs(slab.mu[state[i]]);
    for (Eigen::Index j = 0; j < static_cast<Eigen::Index>(state.size()); ++j) {
      loss(row_of(i), row_of(j)) -= slab.scatter(state[i], state[j]);
    }
    for (Eigen::Index b = 0; b < beams; ++b) loss(row_of(i), diffuse_down + b) = -slab.beam_source(state[i], b);
  }
  for (Eigen::Index b = 0; b < beams; ++b) {
    cosine[diffuse_down + b] = slab.beam_mu[b];
    loss(diffuse_down + b, diffuse_down + b) = slab.beam_extinction;
  }

  const int doublings = doublings_for(slab.optical_depth);
  const MatrixXd half_step = std::ldexp(slab.optical_depth, -doublings - 1) * loss, slowness = cosine.asDiagonal();
  const MatrixXd thin = (slowness + half_step).lu().solve(slowness - half_step);
  Response response{thin.topLeftCorner(down, down), thin.topRightCorner(down, up), thin.bottomLeftCorner(up, down),
                    thin.bottomRightCorner(up, up)};
  for (int i = 0; i < doublings; ++i) response = doubled(response);

  std::vector<SlabFluxes> fluxes;
  for (Eigen::Index b = 0; b < beams; ++b) {
    const Eigen::Index from = diffuse_down + b;
    double out_up = 0, out_down = response.transmit_down(from, from) * slab.beam_mu[b];
    for (Eigen::Index i = 0; i < up; ++i) {
      out_up += slab.weight[upward[i]] * slab.mu[upward[i]] * response.reflect_down(i, from);
    }
    for (Eigen::Index i = 0; i < diffuse_down; ++i) {
      out_down -= slab.weight[downward[i]] * slab.mu[downward[i]] * response.transmit_down(i, from);
    }
    fluxes.push_back({out_up / slab.beam_mu[b], out_down / slab.beam_mu[b]});
  }
  return fluxes;
}

std::vector<SlabFluxes> plane_parallel_fluxes(const std::function<double(int)>& chi, std::span<const double> beam_mu,
                                              double optical_depth, double single_scattering_albedo) {
  constexpr int angles = 48, order = 2 * angles;
  const double ssa = single_scattering_albedo;
  // Exact for any phase function as far as these quadratures can tell: what they cannot resolve is forward light or
  // noise.
  const double f = std::max(0.0, chi(order));
  std::vector<double> moment(order);
  for (int l = 0; l < order; ++l) moment[l] = (chi(l) - f) / (1 - f);

  Slab slab;
  const GaussLegendre rule = make_gauss_legendre(angles);
  slab.mu.resize(2 * angles);
  slab.weight.resize(2 * angles);
  for (int i = 0; i < angles; ++i) {
    slab.mu[i] = -(1 + rule.node[i]) / 2;
    slab.mu[angles + i] = (1 + rule.node[i]) / 2;
    slab.weight[i] = slab.weight[angles + i] = std::numbers::pi * rule.weight[i];
  }
  slab.beam_mu = Eigen::Map<const VectorXd>(beam_mu.data(), static_cast<Eigen::Index>(beam_mu.size()));
  slab.optical_depth = (1 - ssa * f) * optical_depth;

  const auto legendre = [&](const VectorXd& mu) {
    MatrixXd p(mu.size(), order);
    p.col(0).setOnes();
    p.col(1) = mu;
    for (int l = 2; l < order; ++l) {
      p.col(l) = ((2 * l - 1) * mu.cwiseProduct(p.col(l - 1)) - (l - 1) * p.col(l - 2)) / l;
    }
    return p;
  };
  const MatrixXd at_ordinates = legendre(slab.mu), at_beams = legendre(-slab.beam_mu);
  VectorXd factor(order);
  for (int l = 0; l < order; ++l)
    factor[l] = (2 * l + 1) * moment[l] * ssa * (1 - f) / (1 - ssa * f) / (4 * std::numbers::pi);
  slab.scatter = at_ordinates * factor.asDiagonal() * at_ordinates.transpose() * slab.weight.asDiagonal();
  slab.beam_source = at_ordinates * factor.asDiagonal() * at_beams.transpose();
  return solve_by_doubling(slab);
}

}  // namespace cloudbow::reference
