// Phase functions and their representation on control points.
#include <cmath>
#include <numbers>

#include "app/scene/accuracy.hpp"
#include "app/verify/checks.hpp"

namespace cloudbow {
namespace {

constexpr double asymmetry = .85;

// Integral of P mu^k over the sphere, divided by 4 pi: Simpson's rule in the scattering angle.
double moment_of_values(const PhaseFunction& phase, int k) {
  constexpr int steps = 4000;
  double sum = 0;
  for (int n = 0; n <= steps; ++n) {
    const double angle = pi * n / steps;
    const double factor = n == 0 || n == steps ? 1 : n % 2 == 1 ? 4 : 2;
    sum += factor * phase(std::cos(angle)) * std::pow(std::cos(angle), k) * std::sin(angle);
  }
  return sum * pi / steps / 3 / 2;
}

double norms_and_asymmetries() {
  Worst worst;
  for (const auto& [phase, g] : {std::pair(PhaseFunction::isotropic(), 0.), std::pair(PhaseFunction::rayleigh(), 0.),
                                 std::pair(PhaseFunction::henyey_greenstein(asymmetry), asymmetry),
                                 std::pair(PhaseFunction::henyey_greenstein(-.4), -.4),
                                 std::pair(PhaseFunction::double_henyey_greenstein(.8, -.5, .9), .9 * .8 - .1 * .5),
                                 std::pair(PhaseFunction::legendre({1, .5, .2}), .5)}) {
    worst.meet(moment_of_values(phase, 0), 1);
    worst.meet(moment_of_values(phase, 1), g);
    worst.meet(phase.asymmetry_parameter(), g);
  }
  return worst.value();
}

struct FittedScattering {
  OrdinateSet ordinates;
  Direction beam = Direction(.48, .36, -.8);
  FitOptions options;
  PhaseFunction phase = PhaseFunction::henyey_greenstein(asymmetry);
  ScatteringTable table;
};

FittedScattering fitted(const char* accuracy) {
  const SolverOptions level = accuracy_options(accuracy, HorizontalExtent::field, false);
  FittedScattering made;
  made.ordinates = make_ordinate_set(level.directions);
  made.options = level.fit;
  made.table =
      make_scattering_table(made.phase, ControlPoints(level.control_points), made.ordinates, made.beam, made.options);
  return made;
}

// Moment l <= 1, about the direction of arrival, of light scattered out of ordinate d: a share of 1 at l = 0.
double moment_of_column(const FittedScattering& fit, int d, int l) {
  double sum = 0;
  for (int e = 0; e < fit.ordinates.size(); ++e) {
    const double cosine = fit.ordinates.direction[e].dot(fit.ordinates.direction[d]);
    sum += fit.ordinates.weight[e] * fit.table.ordinates_from_ordinates(e, d) * (l == 0 ? 1 : cosine);
  }
  return sum / fit.ordinates.weight[d];
}

double column_sums() {
  const FittedScattering fit = fitted("draft");
  Worst worst;
  for (int d = 0; d < fit.ordinates.size(); ++d) worst.meet(moment_of_column(fit, d, 0), 1);
  return worst.value();
}

double column_asymmetries() {
  const FittedScattering fit = fitted("draft");
  // Delta-M: a peak that holds the fraction f = g^N of the light is counted as unscattered (Wiscombe 1977).
  const double f = std::pow(asymmetry, fit.options.delta_m_order);
  Worst worst;
  for (int d = 0; d < fit.ordinates.size(); ++d) worst.meet(moment_of_column(fit, d, 1), (asymmetry - f) / (1 - f));
  return worst.value();
}

// Flux up and down, per unit of light, of the beam's first scattering: int |mu| P over each half. The truncated
// function is a polynomial, whose sum over moments is written out here.
double first_scattering_of_the_beam() {
  const FittedScattering fit = fitted("draft");
  const int order = fit.options.beam_delta_m_order;
  const double f = std::pow(asymmetry, order);
  const auto truncated = [&](double cosine) {
    double before = 0, here = 1, sum = 0;
    for (int l = 0; l < order; ++l) {
      sum += (2 * l + 1) * (std::pow(asymmetry, l) - f) / (1 - f) * here;
      const double next = ((2 * l + 1) * cosine * here - l * before) / (l + 1);
      before = here;
      here = next;
    }
    return sum;
  };
  // Midpoints of fine steps: independent of every quadrature in use.
  constexpr int heights = 400, azimuths = 64;
  double up = 0, down = 0;
  for (int n = 0; n < 2 * heights; ++n) {
    const double z = (n + .5) / heights - 1;
    const double sine = std::sqrt(1 - z * z);
    double mean = 0;
    for (int m = 0; m < azimuths; ++m) {
      const double azimuth = 2 * pi * (m + .5) / azimuths;
      mean += truncated(fit.beam.dot(Direction(sine * std::cos(azimuth), sine * std::sin(azimuth), z))) / azimuths;
    }
    (z > 0 ? up : down) += std::abs(z) * mean / heights / 2;
  }
  double total = 0, fitted_up = 0, fitted_down = 0;
  for (int d = 0; d < fit.ordinates.size(); ++d) {
    const double light = fit.ordinates.weight[d] * fit.table.ordinates_from_beam(d);
    const double z = fit.ordinates.direction[d].z();
    total += light;
    (z > 0 ? fitted_up : fitted_down) += std::abs(z) * light;
  }
  Worst worst;
  worst.meet(total, 1);
  worst.meet(fitted_up, up);
  worst.meet(fitted_down, down);
  return worst.value();
}

}  // namespace

std::vector<PhysicalCheck> optics_checks() {
  return {
      // Simpson's rule on 4000 steps of the sharpest of them.
      {"phase-functions", "values, moments and asymmetry parameters of phase functions belong together", "1", 1e-8,
       norms_and_asymmetries},
      // The fit holds these to 1e-9; the iteration multiplies a loss by the number of scatterings, some hundreds.
      {"scattering-closure", "scattering on control points neither makes nor loses light", "1", 1e-8, column_sums},
      {"scattering-asymmetry", "scattering on control points keeps the asymmetry parameter", "1", 1e-8,
       column_asymmetries},
      // Midpoint rule on steps of 1/400.
      {"beam-scattering", "the beam's first scattering has the flux of its phase function, up and down", "1", 2e-5,
       first_scattering_of_the_beam},
  };
}

}  // namespace cloudbow
