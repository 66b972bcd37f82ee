#include "reference/plane_parallel.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow::reference {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::VectorXd;
using std::numbers::pi;

constexpr double last_mode = 1e-8;  // of the incident flux: azimuth modes below it end the series

/// A node of the Gauss-Legendre rule, known as a double, and its weight: one step of Newton's method.
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

/// Directions of a solution: Gauss angles in each half range, and views among them with no weight, which receive light
/// and send none.
template <class Real>
struct Angles {
  Vector<Real> mu, weight;  // downward first; weights in sr
  Index half = 0;           // of them downward, in the same order as upward
};

template <class Real>
Angles<Real> make_angles(int count, std::span<const double> views) {
  const GaussLegendre rule = make_gauss_legendre(count);
  Angles<Real> angles;
  angles.half = count + static_cast<Index>(views.size());
  angles.mu.resize(2 * angles.half);
  angles.weight.setZero(2 * angles.half);
  for (Index i = 0; i < angles.half; ++i) {
    const bool is_view = i >= count;
    const auto [node, weight] = is_view ? std::pair<Real, Real>{} : in_full(count, Real(rule.node[i]));
    const Real mu = is_view ? Real(views[i - count]) : (1 + node) / 2;
    angles.mu[i] = -mu;
    angles.mu[angles.half + i] = mu;
    angles.weight[i] = angles.weight[angles.half + i] = std::numbers::pi_v<Real> * weight;
  }
  return angles;
}

/// Associated Legendre functions of degree m to order - 1 (columns; below m nought) at mu, normalised so that their
/// products are the azimuth modes of a Legendre series: sqrt((l-m)!/(l+m)!) P_l^m.
template <class Real>
Matrix<Real> associated_legendre(const Vector<Real>& mu, int order, int m) {
  Matrix<Real> p = Matrix<Real>::Zero(mu.size(), order);
  if (m >= order) return p;
  Vector<Real> sectoral = Vector<Real>::Ones(mu.size());
  for (int k = 1; k <= m; ++k) {
    const Vector<Real> sine = (1 - mu.array().square()).sqrt().matrix();
    sectoral = std::sqrt(Real(2 * k - 1) / Real(2 * k)) * sectoral.cwiseProduct(sine);
  }
  p.col(m) = sectoral;
  if (m + 1 < order) p.col(m + 1) = std::sqrt(Real(2 * m + 1)) * mu.cwiseProduct(sectoral);
  for (int l = m + 2; l < order; ++l) {
    const Real a = std::sqrt(Real(l - 1) * Real(l - 1) - Real(m) * Real(m));
    const Real b = std::sqrt(Real(l) * Real(l) - Real(m) * Real(m));
    p.col(l) = (Real(2 * l - 1) * mu.cwiseProduct(p.col(l - 1)) - a * p.col(l - 2)) / b;
  }
  return p;
}

/// The layer, delta-scaled at `order` moments, for azimuth mode m.
template <class Real>
SlabOf<Real> make_slab(const PlaneParallelLayer& layer, const Angles<Real>& angles, const Vector<Real>& beam_mu,
                       int order, int m) {
  const Real ssa = layer.single_scattering_albedo, f = std::max(0.0, layer.moments(order));
  Vector<Real> factor(order);
  for (int l = 0; l < order; ++l)
    factor[l] = Real(2 * l + 1) * (layer.moments(l) - f) * ssa / (1 - ssa * f) / (4 * std::numbers::pi_v<Real>);
  const Matrix<Real> p = associated_legendre(angles.mu, order, m);
  const Matrix<Real> p_beam = associated_legendre<Real>(-beam_mu, order, m);

  SlabOf<Real> slab;
  slab.mu = angles.mu;
  slab.weight = angles.weight;
  slab.scatter = p * factor.asDiagonal() * p.transpose() * angles.weight.asDiagonal();
  slab.beam_mu = beam_mu;
  slab.beam_source = Real(m == 0 ? 1 : 2) * p * factor.asDiagonal() * p_beam.transpose();
  slab.optical_depth = (1 - ssa * f) * layer.optical_depth;
  const bool emits = m == 0 && (layer.planck_top != 0 || layer.planck_bottom != 0);
  if (emits) slab.emission = Vector<Real>::Constant(angles.mu.size(), (1 - ssa) / (1 - ssa * f));
  return slab;
}

/// A slice between two planes, or the ground: its response without the states of emission, and the light it emits.
struct Slice {
  const Response* response;
  VectorXd emitted_down, emitted_up;
};

/// Slices of all layers, top first. The Planck radiance is linear through the slices of a layer.
std::vector<Slice> make_slices(const std::vector<PlaneParallelLayer>& layers, std::vector<Response>& responses,
                               const std::vector<double>& scaled_depth, int count) {
  std::vector<Slice> slices;
  for (std::size_t n = 0; n < layers.size(); ++n) {
    Response& r = responses[n];
    const Index states = r.reflect_up.cols() + 1, emission = r.transmit_down.cols() - states;  // one beam
    MatrixXd down = MatrixXd::Zero(states, 2), up = MatrixXd::Zero(states - 1, 2);
    if (emission > 0) {
      down = r.transmit_down.topRightCorner(states, 2);
      up = r.reflect_down.rightCols(2);
      r = {r.transmit_down.topLeftCorner(states, states).eval(), r.reflect_up.topRows(states).eval(),
           r.reflect_down.leftCols(states).eval(), r.transmit_up};
    }
    const double difference = (layers[n].planck_bottom - layers[n].planck_top) / count;
    for (int s = 0; s < count; ++s) {
      const Eigen::Vector2d planck(layers[n].planck_top + s * difference,
                                   scaled_depth[n] > 0 ? difference / scaled_depth[n] : 0);
      slices.push_back({&r, down * planck, up * planck});
    }
  }
  return slices;
}

/// Light at the planes between slices, top first: states as in Response.
struct Light {
  std::vector<VectorXd> down, up;
};

/// Adding: what lies below a plane reflects and emits as a whole, plane by plane from the ground up; then light comes
/// down.
Light add(const std::vector<Slice>& slices, const MatrixXd& ground, const VectorXd& emitted_by_ground,
          const VectorXd& incident) {
  const std::size_t planes = slices.size();
  const auto to_and_fro = [&](std::size_t k, const MatrixXd& below) -> MatrixXd {
    const MatrixXd& reflect_up = slices[k].response->reflect_up;
    return MatrixXd::Identity(reflect_up.rows(), reflect_up.rows()) - reflect_up * below;
  };
  std::vector<MatrixXd> below(planes + 1);
  std::vector<VectorXd> glow(planes + 1);  // upward through the plane, of what lies below it, under a dark sky
  below[planes] = ground;
  glow[planes] = emitted_by_ground;
  for (std::size_t k = planes; k-- > 0;) {
    const Response& r = *slices[k].response;
    const auto between = to_and_fro(k, below[k + 1]).lu();
    below[k] = r.reflect_down + r.transmit_up * (below[k + 1] * between.solve(r.transmit_down));
    const VectorXd down = between.solve(slices[k].emitted_down + r.reflect_up * glow[k + 1]);
    glow[k] = slices[k].emitted_up + r.transmit_up * (below[k + 1] * down + glow[k + 1]);
  }
  Light light;
  light.down.push_back(incident);
  light.up.push_back(below[0] * incident + glow[0]);
  for (std::size_t k = 0; k < planes; ++k) {
    const Response& r = *slices[k].response;
    light.down.push_back(
        to_and_fro(k, below[k + 1])
            .lu()
            .solve(r.transmit_down * light.down.back() + slices[k].emitted_down + r.reflect_up * glow[k + 1]));
    light.up.push_back(below[k + 1] * light.down.back() + glow[k + 1]);
  }
  return light;
}

/// Light of azimuth mode m.
Light solve_mode(const PlaneParallelScene& scene, const PlaneParallelEffort& effort, const Angles<double>& angles,
                 int m) {
  const VectorXd sun = VectorXd::Constant(1, scene.sun_mu);
  std::vector<Response> responses;
  std::vector<double> scaled_depth;
  for (PlaneParallelLayer layer : scene.layers) {
    layer.optical_depth /= effort.slices;
    const Slab slab = make_slab(layer, angles, sun, 2 * effort.angles, m);
    responses.push_back(response_by_doubling(slab));
    scaled_depth.push_back(slab.optical_depth);
  }
  VectorXd emitted_by_ground = VectorXd::Zero(angles.half);
  MatrixXd ground = MatrixXd::Zero(angles.half, angles.half + 1);
  VectorXd incident = VectorXd::Zero(angles.half + 1);
  incident[angles.half] = scene.irradiance;
  if (m == 0) {
    const VectorXd flux = angles.weight.head(angles.half).cwiseProduct(angles.mu.head(angles.half).cwiseAbs());
    ground.leftCols(angles.half).rowwise() = scene.surface_albedo / pi * flux.transpose();
    ground.col(angles.half).setConstant(scene.surface_albedo / pi * scene.sun_mu);
    incident.head(angles.half).setConstant(scene.sky_radiance);
    emitted_by_ground.setConstant((1 - scene.surface_albedo) * scene.surface_planck);
  }
  return add(make_slices(scene.layers, responses, scaled_depth, effort.slices), ground, emitted_by_ground, incident);
}

}  // namespace

PlaneParallelSolution solve_plane_parallel(const PlaneParallelScene& scene, const PlaneParallelEffort& effort) {
  const Angles<double> angles = make_angles<double>(effort.angles, effort.view_mu);
  const Index half = angles.half, views = static_cast<Index>(effort.view_mu.size());
  const VectorXd flux = angles.weight.head(half).cwiseProduct(angles.mu.head(half).cwiseAbs());
  const Light light = solve_mode(scene, effort, angles, 0);

  PlaneParallelSolution solution;
  double depth = 0;
  for (std::size_t k = 0; k < light.up.size(); ++k) {
    if (k > 0) depth += scene.layers[(k - 1) / effort.slices].optical_depth / effort.slices;
    const double direct = scene.sun_mu * scene.irradiance * std::exp(-depth / scene.sun_mu);
    const double down = flux.dot(light.down[k].head(half)) + scene.sun_mu * light.down[k][half];
    solution.levels.push_back({depth, flux.dot(light.up[k]), down - direct, direct});
  }

  const auto azimuths = static_cast<Index>(effort.view_azimuth_deg.size());
  solution.radiance_up_top = light.up.front().tail(views).replicate(1, azimuths);
  solution.radiance_down_bottom = light.down.back().segment(half - views, views).replicate(1, azimuths);
  // Without sunlight there is the mean over azimuth alone.
  const double negligible = last_mode * (scene.sun_mu * scene.irradiance + pi * scene.sky_radiance);
  int faint = 0;
  for (int m = 1; views > 0 && scene.irradiance != 0 && m < 2 * effort.angles && faint < 2; ++m) {
    const Light mode = solve_mode(scene, effort, angles, m);
    const VectorXd up = mode.up.front().tail(views), down = mode.down.back().segment(half - views, views);
    for (Index a = 0; a < azimuths; ++a) {
      const double cosine = std::cos(m * effort.view_azimuth_deg[a] * pi / 180);
      solution.radiance_up_top.col(a) += cosine * up;
      solution.radiance_down_bottom.col(a) += cosine * down;
    }
    // Even modes alone vanish for some functions.
    faint = std::max(up.cwiseAbs().maxCoeff(), down.cwiseAbs().maxCoeff()) < negligible ? faint + 1 : 0;
  }
  return solution;
}

std::vector<SlabFluxes> plane_parallel_fluxes(const Moments& moments, std::span<const double> beam_mu,
                                              double optical_depth, double single_scattering_albedo,
                                              double surface_albedo, int angles) {
  const auto solve = [&]<class Real>(Real) {
    Vector<Real> suns(static_cast<Index>(beam_mu.size()));
    std::copy(beam_mu.begin(), beam_mu.end(), suns.begin());
    SlabOf<Real> slab = make_slab<Real>({optical_depth, single_scattering_albedo, moments},
                                        make_angles<Real>(angles, {}), suns, 2 * angles, 0);
    slab.surface_albedo = surface_albedo;
    return solve_by_doubling(slab);
  };
  const bool delicate = optical_depth > 100 && single_scattering_albedo > 0.99;
  return delicate ? solve(0.0L) : solve(0.0);
}

}  // namespace cloudbow::reference
