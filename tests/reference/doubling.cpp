#include "reference/doubling.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cassert>
#include <cmath>

namespace cloudbow::reference {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;

Response doubled(const Response& r) {
  const Index down = r.transmit_down.rows(), up = r.transmit_up.rows();
  // Light to and fro between the two halves: a geometric series, summed by solving.
  const MatrixXd between_down =
      (MatrixXd::Identity(down, down) - r.reflect_up * r.reflect_down).lu().solve(r.transmit_down);
  const MatrixXd between_up = (MatrixXd::Identity(up, up) - r.reflect_down * r.reflect_up).lu().solve(r.transmit_up);
  return {r.transmit_down * between_down, r.reflect_up + r.transmit_down * (r.reflect_up * between_up),
          r.reflect_down + r.transmit_up * (r.reflect_down * between_down), r.transmit_up * between_up};
}

int doublings_for(double optical_depth) {
  // The starting slab is solved to second order in its depth, so that halving it once more gains a factor 4.
  return optical_depth > 0 ? std::max(10, static_cast<int>(std::ceil(std::log2(optical_depth * 4096)))) : 0;
}

Index count_downward(const VectorXd& mu) {
  const Index count = (mu.array() < 0).count();
  assert((mu.head(count).array() < 0).all());
  return count;
}

}  // namespace

Response response_by_doubling(const Slab& slab) {
  const Index diffuse_down = count_downward(slab.mu), ordinates = slab.mu.size(), up = ordinates - diffuse_down;
  const Index beams = slab.beam_mu.size(), down = diffuse_down + beams, all = down + up;

  // |mu| dI/dtau = -extinction I + scatter I, with the beams as states that feed the others and are fed by none.
  const auto row_of = [&](Index ordinate) { return ordinate < diffuse_down ? ordinate : ordinate + beams; };
  MatrixXd loss = MatrixXd::Identity(all, all);
  VectorXd cosine(all);
  for (Index i = 0; i < ordinates; ++i) {
    cosine[row_of(i)] = std::abs(slab.mu[i]);
    for (Index j = 0; j < ordinates; ++j) loss(row_of(i), row_of(j)) -= slab.scatter(i, j);
    for (Index b = 0; b < beams; ++b) loss(row_of(i), diffuse_down + b) = -slab.beam_source(i, b);
  }
  for (Index b = 0; b < beams; ++b) {
    cosine[diffuse_down + b] = slab.beam_mu[b];
    loss(diffuse_down + b, diffuse_down + b) = slab.beam_extinction;
  }

  const int doublings = doublings_for(slab.optical_depth);
  const MatrixXd half_step = std::ldexp(slab.optical_depth, -doublings - 1) * loss, slowness = cosine.asDiagonal();
  const MatrixXd thin = (slowness + half_step).lu().solve(slowness - half_step);
  Response response{thin.topLeftCorner(down, down), thin.topRightCorner(down, up), thin.bottomLeftCorner(up, down),
                    thin.bottomRightCorner(up, up)};
  for (int i = 0; i < doublings; ++i) response = doubled(response);
  return response;
}

std::vector<SlabFluxes> solve_by_doubling(const Slab& slab) {
  const Response response = response_by_doubling(slab);
  const Index diffuse_down = count_downward(slab.mu), up = slab.mu.size() - diffuse_down;
  const VectorXd flux = slab.weight.cwiseProduct(slab.mu.cwiseAbs());
  std::vector<SlabFluxes> fluxes;
  for (Index b = 0; b < slab.beam_mu.size(); ++b) {
    const Index from = diffuse_down + b;
    const double out_up = flux.tail(up).dot(response.reflect_down.col(from));
    const double out_down = flux.head(diffuse_down).dot(response.transmit_down.col(from).head(diffuse_down)) +
                            response.transmit_down(from, from) * slab.beam_mu[b];
    fluxes.push_back({out_up / slab.beam_mu[b], out_down / slab.beam_mu[b]});
  }
  return fluxes;
}

}  // namespace cloudbow::reference
