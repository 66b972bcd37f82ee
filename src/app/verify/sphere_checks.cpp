// Interpolation between control points, and quadrature by ordinates.
#include <cmath>
#include <numbers>

#include "app/verify/checks.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"

namespace cloudbow {
namespace {

constexpr std::array<int, 4> point_counts{12, 42, 162, 642};
constexpr std::array<Interpolation, 2> interpolations{Interpolation::spherical_area, Interpolation::planar};

// Directions spread evenly: equal steps in z, the golden angle in azimuth.
std::vector<Direction> spread_directions(int count) {
  const double golden_angle = pi * (3 - std::sqrt(5.));
  std::vector<Direction> directions;
  for (int n = 0; n < count; ++n) {
    const double z = 1 - (2 * n + 1.) / count;
    const double sine = std::sqrt(1 - z * z);
    directions.emplace_back(sine * std::cos(n * golden_angle), sine * std::sin(n * golden_angle), z);
  }
  return directions;
}

double sum_of_weights() {
  Worst worst;
  for (const int count : point_counts) {
    const ControlPoints points(count);
    for (const Interpolation interpolation : interpolations) {
      for (const Direction& direction : spread_directions(1000)) {
        const auto weight = points.stencil(direction, interpolation).weight;
        worst.meet(weight[0] + weight[1] + weight[2], 1);
      }
    }
  }
  return worst.value();
}

double values_at_control_points() {
  Worst worst;
  for (const int count : point_counts) {
    const ControlPoints points(count);
    for (const Interpolation interpolation : interpolations) {
      for (int m = 0; m < points.size(); ++m) {
        // The function that is 1 at this point and 0 at the others.
        const Stencil stencil = points.stencil(points.directions()[m], interpolation);
        double value = 0;
        for (std::size_t n = 0; n < 3; ++n) value += stencil.index[n] == m ? stencil.weight[n] : 0;
        worst.meet(value, 1);
      }
    }
  }
  return worst.value();
}

// L'Huilier's theorem, from the sides: another formula than the one in use.
double area_by_sides(const Direction& a, const Direction& b, const Direction& c) {
  const auto side = [](const Direction& u, const Direction& v) { return 2 * std::asin((u - v).norm() / 2); };
  const double x = side(b, c), y = side(c, a), z = side(a, b);
  const double s = (x + y + z) / 2;
  const double product = std::tan(s / 2) * std::tan((s - x) / 2) * std::tan((s - y) / 2) * std::tan((s - z) / 2);
  return 4 * std::atan(std::sqrt(std::max(product, 0.)));
}

double weights_as_areas() {
  const ControlPoints points(162);
  Worst worst;
  for (const Direction& p : spread_directions(1000)) {
    const Stencil stencil = points.stencil(p);
    const Direction a = points.directions()[stencil.index[0]], b = points.directions()[stencil.index[1]],
                    c = points.directions()[stencil.index[2]];
    const std::array<double, 3> area{area_by_sides(p, b, c), area_by_sides(a, p, c), area_by_sides(a, b, p)};
    for (std::size_t n = 0; n < 3; ++n) worst.meet(stencil.weight[n], area[n] / (area[0] + area[1] + area[2]));
  }
  return worst.value();
}

// The interpolant of the position itself points along the direction: the definition of planar barycentric coordinates.
double planar_weights_of_positions() {
  const ControlPoints points(162);
  Worst worst;
  for (const Direction& p : spread_directions(1000)) {
    const Stencil stencil = points.stencil(p, Interpolation::planar);
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    for (std::size_t n = 0; n < 3; ++n) position += stencil.weight[n] * points.directions()[stencil.index[n]];
    worst.meet((position.normalized() - p).norm());
  }
  return worst.value();
}

// Integral of x^a y^b z^c over the sphere.
double integral_of_monomial(int a, int b, int c) {
  if (a % 2 != 0 || b % 2 != 0 || c % 2 != 0) return 0;
  return 2 * std::exp(std::lgamma((a + 1) / 2.) + std::lgamma((b + 1) / 2.) + std::lgamma((c + 1) / 2.) -
                      std::lgamma((a + b + c + 3) / 2.));
}

// Those of the ladder of accuracies, and control points as ordinates.
std::vector<OrdinateSet> ordinate_sets() {
  std::vector<OrdinateSet> sets;
  for (const char* name : {"double-gauss-6x8", "double-gauss-8x16", "double-gauss-12x24", "reduced-double-gauss-12x20",
                           "control-points-162"})
    sets.push_back(make_ordinate_set(name));
  return sets;
}

double moments_by_quadrature() {
  Worst worst;
  for (const OrdinateSet& set : ordinate_sets()) {
    const int degree = std::min(set.exactness_degree, 8);
    for (int a = 0; a <= degree; ++a) {
      for (int b = 0; a + b <= degree; ++b) {
        for (int c = 0; a + b + c <= degree; ++c) {
          double sum = 0;
          for (int d = 0; d < set.size(); ++d) {
            const Direction& direction = set.direction[d];
            sum += set.weight[d] * std::pow(direction.x(), a) * std::pow(direction.y(), b) * std::pow(direction.z(), c);
          }
          worst.meet(sum, integral_of_monomial(a, b, c));
        }
      }
    }
  }
  return worst.value();
}

double flux_through_a_hemisphere() {
  Worst worst;
  for (const OrdinateSet& set : ordinate_sets()) {
    if (set.is_control_points) continue;  // their weights serve the whole sphere alone
    double up = 0, down = 0;
    for (int d = 0; d < set.size(); ++d) (set.direction[d].z() > 0 ? up : down) += set.weight[d] * set.direction[d].z();
    worst.meet(up, pi);
    worst.meet(down, -pi);
  }
  return worst.value();
}

}  // namespace

std::vector<PhysicalCheck> sphere_checks() {
  // Some ten roundings of numbers about 1, near-cancellation in small triangles included, are below 1e-11; an error in
  // a formula is not.
  constexpr double rounding = 1e-11;
  return {
      {"interpolation-sum", "weights of the three control points around a direction sum to 1", "1", rounding,
       sum_of_weights},
      {"interpolation-vertices", "interpolation gives back the values at the control points", "1", rounding,
       values_at_control_points},
      // L'Huilier's formula takes square roots of rounding in slivers.
      {"interpolation-areas", "weights are the areas of spherical triangles, by another formula", "1", 1e-7,
       weights_as_areas},
      {"interpolation-position", "planar weights interpolate a direction to itself", "1", rounding,
       planar_weights_of_positions},
      // Weights of the sets are stated to 1e-10.
      {"quadrature-moments", "ordinates integrate monomials over the sphere as exactly as they say", "sr", 2e-10,
       moments_by_quadrature},
      {"quadrature-half-range", "uniform radiance 1 sends the flux pi up, and down", "sr", 2e-10,
       flux_through_a_hemisphere},
  };
}

}  // namespace cloudbow
