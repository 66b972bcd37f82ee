#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/delta_m.hpp"
#include "cloudbow/optics/phase_fit.hpp"
#include "cloudbow/optics/sphere_fit.hpp"
#include "cloudbow/sphere/icosphere.hpp"
#include "fit_test_tools.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;
using Method = PhaseFitMethod;

std::vector<Method> every_method() {
  std::vector<Method> methods;
  for (const std::string& name : phase_fit_names()) methods.push_back(phase_fit_method(name));
  return methods;
}

TEST(InterpolantQuadrature, IntegratesPolynomialsOverTheSphere) {
  for (const int count : {12, 42, 162}) {
    const OrdinateSet set = interpolant_quadrature(ControlPoints(count));
    double sum = 0, fourth = 0, odd = 0;
    for (int d = 0; d < set.size(); ++d) {
      sum += set.weight[d];
      fourth += set.weight[d] * std::pow(set.direction[d].x(), 4);
      odd += set.weight[d] * set.direction[d].x() * std::pow(set.direction[d].z(), 2);
    }
    EXPECT_NEAR(sum, 4 * pi, 1e-11);
    EXPECT_NEAR(fourth, 4 * pi / 5, 1e-11);
    EXPECT_NEAR(odd, 0, 1e-11);
  }
}

// Against the mean over a golden spiral of 200000 directions, which is good to 1e-5.
TEST(InterpolantQuadrature, IntegratesAnInterpolant) {
  const ControlPoints points(42);
  const OrdinateSet set = interpolant_quadrature(points);
  const auto value = [&](const Direction& v) {
    const auto [index, weight] = points.stencil(v);
    double sum = 0;
    for (int k = 0; k < 3; ++k) sum += weight[k] * std::exp(points.directions()[index[k]].x());
    return sum;
  };
  double integral = 0, mean = 0;
  for (int d = 0; d < set.size(); ++d) integral += set.weight[d] * value(set.direction[d]);
  constexpr int count = 200000;
  for (int i = 0; i < count; ++i) {
    const double z = 1 - (2 * i + 1.0) / count, r = std::sqrt(1 - z * z),
                 azimuth = 2 * pi * std::fmod(i * 0.6180339887498949, 1);
    mean += value({r * std::cos(azimuth), r * std::sin(azimuth), z}) / count;
  }
  EXPECT_NEAR(integral / (4 * pi), mean, 1e-5);
}

struct Case {
  const char* name;
  PhaseFunction phase;
  int control_points;
  const char* ordinates;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name << ", " << c.control_points << " control points"; }

class EveryFunction : public testing::TestWithParam<Case> {
 protected:
  const ControlPoints points{GetParam().control_points};
  const OrdinateSet ordinates = make_ordinate_set(GetParam().ordinates);
  const std::vector<PhaseFit> fits =
      fit_phase_function(GetParam().phase, points, ordinates, every_method(), PhaseFitOptions{});
  const PhaseFitErrors& errors(Method method) const { return fits[static_cast<std::size_t>(method)].errors; }
};

INSTANTIATE_TEST_SUITE_P(
    PhaseFit, EveryFunction,
    testing::Values(Case{"isotropic", PhaseFunction::isotropic(), 42, "double-gauss-6x8"},
                    Case{"Rayleigh", PhaseFunction::rayleigh(), 42, "double-gauss-6x8"},
                    Case{"HG .5", PhaseFunction::henyey_greenstein(0.5), 162, "double-gauss-8x16"},
                    Case{"HG .85", PhaseFunction::henyey_greenstein(0.85), 162, "double-gauss-8x16"},
                    Case{"HG .85 delta-M 12", delta_m(PhaseFunction::henyey_greenstein(0.85), 12).truncated, 162,
                         "double-gauss-8x16"}));

TEST_P(EveryFunction, HoldsWhatItPromises) {
  ASSERT_EQ(fits.size(), phase_fit_names().size());
  const double g = GetParam().phase.asymmetry_parameter();
  double least = 0;
  for (int i = 0; i <= 1000; ++i) least = std::min(least, GetParam().phase(std::cos(pi * i / 1000)));
  for (const Method method :
       {Method::linear_programming, Method::linear_programming_bounded, Method::linear_programming_interpolant}) {
    const bool interpolant = method == Method::linear_programming_interpolant;
    const PhaseFitErrors& e = errors(method);
    EXPECT_EQ(fits[static_cast<std::size_t>(method)].exact_degree, 3);
    EXPECT_NEAR(interpolant ? e.interpolant_norm : e.ordinate_norm, 1, 1e-10);
    EXPECT_NEAR(interpolant ? e.interpolant_asymmetry : e.ordinate_asymmetry, g, 1e-10);
    EXPECT_GE(e.least_value, least * (1 + 1e-3) - 1e-12) << name_of(method);  // the bound's own search is coarser
  }
}

TEST_P(EveryFunction, EachFitIsBestInItsOwnMeasure) {
  constexpr double rounding = 1 + 1e-7;  // the simplex stops at 1e-9
  for (const PhaseFit& fit : fits) {
    ASSERT_GT(fit.value.size(), 0) << name_of(fit.method);
    EXPECT_LE(errors(Method::least_squares).rms_error, rounding * fit.errors.rms_error + 1e-14);
    EXPECT_LE(errors(Method::minimax_absolute).max_error, rounding * fit.errors.max_error + 1e-9);
  }
  // The bound is the purpose of the two-stage fit.
  EXPECT_LE(errors(Method::linear_programming_bounded).max_error,
            1.2 * rounding * errors(Method::minimax_absolute).max_error + 1e-9);
}

TEST_P(EveryFunction, CollocationHasTheValuesAtThePoints) {
  const PhaseFit& fit = fits[static_cast<std::size_t>(Method::collocation)];
  for (int m = 0; m < points.size(); ++m) {
    EXPECT_NEAR(fit.value[m], GetParam().phase(points.directions()[m].dot(PhaseFitOptions{}.travel.normalized())),
                1e-12);
  }
}

TEST(PhaseFit, OfTheIsotropicFunctionIsOne) {
  const auto fits = fit_phase_function(PhaseFunction::isotropic(), ControlPoints(42),
                                       make_ordinate_set("double-gauss-6x8"), every_method(), PhaseFitOptions{});
  for (const PhaseFit& fit : fits) EXPECT_LE((fit.value.array() - 1).abs().maxCoeff(), 1e-9) << name_of(fit.method);
}

TEST(PhaseFit, HoldsNormAndAsymmetryForLightFromAnywhere) {
  const ControlPoints points(162);
  const OrdinateSet ordinates = make_ordinate_set("double-gauss-8x16");
  const std::vector<Method> methods = {Method::linear_programming, Method::linear_programming_interpolant};
  for (const Direction& travel : {Direction(0, 0, -1), Direction(1, 0, -0.05), points.directions()[7]}) {
    PhaseFitOptions options;
    options.travel = travel;
    const auto fits = fit_phase_function(delta_m(PhaseFunction::henyey_greenstein(0.9), 10).truncated, points,
                                         ordinates, methods, options);
    const double g = delta_m(PhaseFunction::henyey_greenstein(0.9), 10).truncated.asymmetry_parameter();
    EXPECT_NEAR(fits[0].errors.ordinate_norm, 1, 1e-10);
    EXPECT_NEAR(fits[0].errors.ordinate_asymmetry, g, 1e-10);
    EXPECT_NEAR(fits[1].errors.interpolant_norm, 1, 1e-10);
    EXPECT_NEAR(fits[1].errors.interpolant_asymmetry, g, 1e-10);
  }
}

TEST(PhaseFit, SaysWhereTheMomentsAreInfeasible) {
  const std::vector<Method> methods = {Method::linear_programming, Method::linear_programming_bounded};
  const auto fits = fit_phase_function(PhaseFunction::henyey_greenstein(0.95), ControlPoints(42),
                                       make_ordinate_set("double-gauss-6x8"), methods, PhaseFitOptions{});
  for (const PhaseFit& fit : fits) {
    EXPECT_LT(fit.exact_degree, 3);
    EXPECT_NEAR(fit.errors.ordinate_norm, 1, 1e-10);
    EXPECT_GE(fit.errors.least_value, 0);
    EXPECT_LT(fit.errors.worst_angle_deg, 30);  // in the peak
  }
}

TEST(PhaseFit, MorePointsFollowASmoothFunctionMoreClosely) {
  const auto error = [](int count, const char* ordinates, Method method) {
    return fit_phase_function(PhaseFunction::henyey_greenstein(0.5), ControlPoints(count), make_ordinate_set(ordinates),
                              std::span(&method, 1), PhaseFitOptions{})[0]
        .errors.max_error_between;
  };
  for (const Method method : every_method()) {
    if (method == Method::minimax_relative) continue;  // larger errors allowed for large values of the function
    EXPECT_LT(error(162, "double-gauss-8x16", method), error(42, "double-gauss-6x8", method)) << name_of(method);
  }
}

TEST(PhaseFit, SectionPassesThroughTheControlPointAhead) {
  const ControlPoints points(42);
  Eigen::VectorXd value = Eigen::VectorXd::Zero(42);
  value[5] = 3;
  const std::vector<double> angle = {0, 180, 360};
  const auto section = great_circle_section(points, value, points.directions()[5], angle);
  EXPECT_NEAR(section[0], 3, 1e-12);
  EXPECT_NEAR(section[1], 0, 1e-12);
  EXPECT_NEAR(section[2], 3, 1e-6);
}

TEST(PhaseFit, RejectsOptionsOutOfRange) {
  const auto make = [](const PhaseFitOptions& options) {
    return fit_phase_function(PhaseFunction::rayleigh(), ControlPoints(12), make_ordinate_set("double-gauss-4x8"), {},
                              options);
  };
  EXPECT_NO_THROW(make({}));
  EXPECT_THROW(make({.travel = Direction::Zero()}), InputError);
  EXPECT_THROW(make({.exact_moments = 0}), InputError);
  EXPECT_THROW(make({.exact_moments = 13}), InputError);
  EXPECT_THROW(make({.bound_factor = 0.9}), InputError);
  EXPECT_THROW(phase_fit_method("chebyshev"), InputError);
}

}  // namespace
}  // namespace cloudbow
