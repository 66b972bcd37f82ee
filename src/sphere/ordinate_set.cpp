#include "cloudbow/sphere/ordinate_set.hpp"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cassert>
#include <charconv>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "cloudbow/core/error.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"
#include "cloudbow/sphere/icosphere.hpp"
#include "cloudbow/sphere/spherical_harmonics.hpp"

namespace cloudbow {
namespace {

constexpr double pi = std::numbers::pi;
constexpr int max_polar_angles = 64;
constexpr int max_azimuths = 128;

[[noreturn]] void fail(std::string_view name) {
  throw InputError(fmt::format(
      "ordinate set: there is no \"{}\" (allowed: double-gauss-NxK and reduced-double-gauss-NxK with N even, "
      "2 to {}, and K a multiple of 4, 4 to {}; control-points-M with M = 42, 162 or 642)",
      name, max_polar_angles, max_azimuths));
}

/// The rest of the name after the prefix, if it has the prefix.
std::optional<std::string_view> after(std::string_view name, std::string_view prefix) {
  if (!name.starts_with(prefix)) return std::nullopt;
  return name.substr(prefix.size());
}

std::optional<int> to_int(std::string_view text) {
  int value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

/// "NxK", checked.
std::pair<int, int> polar_angles_and_azimuths(std::string_view name, std::string_view counts) {
  const auto cross = counts.find('x');
  if (cross == std::string_view::npos) fail(name);
  const auto n = to_int(counts.substr(0, cross)), k = to_int(counts.substr(cross + 1));
  if (!n || !k || *n < 2 || *n > max_polar_angles || *n % 2 || *k < 4 || *k > max_azimuths || *k % 4) fail(name);
  return {*n, *k};
}

std::vector<Eigen::Matrix3d> octant_reflections() {
  std::vector<Eigen::Matrix3d> group;
  for (const double x : {1.0, -1.0}) {
    for (const double y : {1.0, -1.0}) {
      for (const double z : {1.0, -1.0}) group.emplace_back(Eigen::Vector3d(x, y, z).asDiagonal());
    }
  }
  return group;
}

/// Gauss-Legendre on each half range of mu, so that half-range fluxes are exact; azimuths offset by half a step, so
/// that no ordinate lies in a coordinate plane. Quadrants are reflections of the first to the bit.
OrdinateSet make_double_gauss(int polar_angles, int max_azimuth_count, bool reduced) {
  OrdinateSet set;
  const GaussLegendre rule = make_gauss_legendre(polar_angles / 2);
  for (const double hemisphere : {-1.0, 1.0}) {
    for (std::size_t i = 0; i < rule.node.size(); ++i) {
      const double mu = (1 + rule.node[i]) / 2, sine = std::sqrt(1 - mu * mu);
      // Near the pole the parallel is short: the spacing along it is kept about the same.
      const int azimuths = reduced ? std::max(4, 4 * static_cast<int>(std::ceil(max_azimuth_count * sine / 4 - 0.25)))
                                   : max_azimuth_count;
      for (int k = 0; k < azimuths; ++k) {
        const int quarter = azimuths / 4, quadrant = k / quarter;
        const bool left = quadrant == 1 || quadrant == 2, front = quadrant >= 2;
        const int step = quadrant % 2 ? quarter - 1 - k % quarter : k % quarter;
        const double azimuth = (step + 0.5) * 2 * pi / azimuths;
        set.direction.emplace_back((left ? -1 : 1) * sine * std::cos(azimuth),
                                   (front ? -1 : 1) * sine * std::sin(azimuth), hemisphere * mu);
        set.weight.push_back(rule.weight[i] / 2 * 2 * pi / azimuths);
      }
    }
  }
  set.symmetry = octant_reflections();
  return set;
}

/// Label of each vertex's orbit under the group.
std::vector<int> orbits(const std::vector<Direction>& vertex, const std::vector<Eigen::Matrix3d>& group) {
  std::vector<int> orbit(vertex.size(), -1);
  int count = 0;
  for (std::size_t i = 0; i < vertex.size(); ++i) {
    if (orbit[i] >= 0) continue;
    for (const auto& g : group) {
      const Direction image = g * vertex[i];
      for (std::size_t j = 0; j < vertex.size(); ++j) {
        if (image.dot(vertex[j]) > 1 - 1e-9) orbit[j] = count;
      }
    }
    ++count;
  }
  return orbit;
}

OrdinateSet make_control_point_set(int count) {
  const int subdivisions = count == 42 ? 1 : count == 162 ? 2 : 3;
  const Icosphere sphere = make_icosphere(subdivisions);
  const std::vector<double> weight = icosphere_weights(subdivisions);
  const Eigen::Matrix3d rotation = control_point_frame_rotation();

  OrdinateSet set;
  for (const bool downward : {true, false}) {
    for (std::size_t i = 0; i < sphere.vertex.size(); ++i) {
      const Direction turned = rotation * sphere.vertex[i];
      if ((turned.z() < 0) != downward) continue;
      set.direction.push_back(turned);
      set.weight.push_back(weight[i]);
    }
  }
  for (const auto& g : icosahedral_group()) set.symmetry.emplace_back(rotation * g * rotation.transpose());
  set.is_control_points = true;
  return set;
}

/// Degree up to which every harmonic is integrated to rounding.
int measured_exactness_degree(const OrdinateSet& set) {
  constexpr int highest = 64;
  constexpr double tolerance = 1e-10;  // rounding is 1e-13
  const Eigen::Map<const Eigen::VectorXd> weight(set.weight.data(), set.size());
  for (int degree = 8, exact = 0; degree <= highest; degree *= 2) {
    Eigen::VectorXd integral = Eigen::VectorXd::Zero((degree + 1) * (degree + 1));
    constexpr int block = 128;  // bounds the memory that the harmonics take
    for (int first = 0; first < set.size(); first += block) {
      const int count = std::min(block, set.size() - first);
      integral += real_spherical_harmonics(std::span(set.direction).subspan(first, count), degree) *
                  weight.segment(first, count);
    }
    for (; exact < degree; ++exact) {
      const int l = exact + 1;
      if (integral.segment(harmonic_index(l, -l), 2 * l + 1).cwiseAbs().maxCoeff() > tolerance) return exact;
    }
  }
  return highest;
}

}  // namespace

Eigen::Matrix3d control_point_frame_rotation() {
  return Eigen::Quaterniond(0.2067, 0.1056, 0.9465, 0.2242).normalized().toRotationMatrix();
}

// Weights equal on each icosahedral orbit. A quadrature with the group's symmetry is exact for every harmonic if it is
// exact for the invariant ones. These exist only at degrees 0, 6, 10, 12, ... (Sobolev 1962): one equation per orbit.
// The invariant of a degree is taken as a Legendre polynomial about a vertex, summed over the orbit.
std::vector<double> icosphere_weights(int subdivisions) {
  assert(subdivisions >= 0 && subdivisions <= 3);
  constexpr int invariant_degrees[] = {0, 6, 10, 12, 16, 18, 20, 22, 24, 26};
  const Icosphere sphere = make_icosphere(subdivisions);
  const std::vector<int> orbit = orbits(sphere.vertex, icosahedral_group());
  const int count = 1 + *std::max_element(orbit.begin(), orbit.end());
  Eigen::MatrixXd equations = Eigen::MatrixXd::Zero(count, count);
  for (std::size_t i = 0; i < orbit.size(); ++i) {
    const double x = std::clamp(sphere.vertex[i].dot(sphere.vertex.front()), -1.0, 1.0);
    for (int e = 0; e < count; ++e) equations(e, orbit[i]) += std::legendre(invariant_degrees[e], x);
  }
  Eigen::VectorXd right = Eigen::VectorXd::Zero(count);
  right[0] = 4 * pi;
  const Eigen::VectorXd solution = equations.fullPivLu().solve(right);
  std::vector<double> weight;
  for (const int o : orbit) weight.push_back(solution[o]);
  return weight;
}

OrdinateSet make_ordinate_set(std::string_view name) {
  OrdinateSet set;
  if (const auto product = after(name, "double-gauss-")) {
    const auto [n, k] = polar_angles_and_azimuths(name, *product);
    set = make_double_gauss(n, k, false);
  } else if (const auto reduced = after(name, "reduced-double-gauss-")) {
    const auto [n, k] = polar_angles_and_azimuths(name, *reduced);
    set = make_double_gauss(n, k, true);
  } else if (const auto points = after(name, "control-points-")) {
    const auto count = to_int(*points);
    if (count != 42 && count != 162 && count != 642) fail(name);
    set = make_control_point_set(*count);
  } else {
    fail(name);
  }
  set.name = name;
  set.exactness_degree = measured_exactness_degree(set);
  return set;
}

}  // namespace cloudbow
