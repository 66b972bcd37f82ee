#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/scattering_table.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

Direction sun_at(double mu0, double azimuth) {
  const double sine = std::sqrt(1 - mu0 * mu0);
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), -mu0};
}

Eigen::VectorXd weights(const OrdinateSet& set) {
  return Eigen::Map<const Eigen::VectorXd>(set.weight.data(), set.size());
}

/// Legendre moment about a direction of a function given at the ordinates.
double moment_about(const Direction& axis, int l, const Eigen::VectorXd& value, const OrdinateSet& set) {
  double sum = 0;
  for (int d = 0; d < set.size(); ++d) {
    sum += set.weight[d] * value[d] * std::legendre(l, std::clamp(axis.dot(set.direction[d]), -1.0, 1.0));
  }
  return sum;
}

/// (1/4pi) int_up mu^power P(O.v) dO by brute force.
double half_range_by_quadrature(const PhaseFunction& phase, const Direction& v, int power) {
  const GaussLegendre rule = make_gauss_legendre(100);
  constexpr int azimuths = 200;
  double sum = 0;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double mu = (1 + rule.node[i]) / 2, sine = std::sqrt(1 - mu * mu);
    for (int k = 0; k < azimuths; ++k) {
      const double azimuth = 2 * pi * (k + 0.5) / azimuths;
      const Direction o(sine * std::cos(azimuth), sine * std::sin(azimuth), mu);
      sum += rule.weight[i] / 2 * (2 * pi / azimuths) * std::pow(mu, power) * phase(o.dot(v));
    }
  }
  return sum / (4 * pi);
}

struct Case {
  const char* name;
  PhaseFunction phase;
  const char* ordinates;
  int control_points;
  FitOptions options;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name << ' ' << c.ordinates; }

FitOptions options(FitMethod method, int order, int beam_order, int exact_moments, bool minimax = true) {
  FitOptions o;
  o.method = method;
  o.delta_m_order = order;
  o.beam_delta_m_order = beam_order;
  o.exact_moments = exact_moments;
  o.beam_half_range_rows = std::min(3, exact_moments);
  o.minimax = minimax;
  return o;
}

class EveryFit : public testing::TestWithParam<Case> {
 protected:
  void expect_light_is_conserved() const;
  void expect_moments_of_columns() const;
  void expect_rows_of_beam() const;
  void expect_positive_where_truncated_function_is() const;
  void expect_points_and_ordinates_agree() const;

  const OrdinateSet set = make_ordinate_set(GetParam().ordinates);
  const ControlPoints points{GetParam().control_points,
                             set.is_control_points ? control_point_frame_rotation() : Eigen::Matrix3d::Identity()};
  const Direction sun = sun_at(0.3, 0.7);
  const ScatteringTable table = make_scattering_table(GetParam().phase, points, set, sun, GetParam().options);
};

constexpr auto programme = FitMethod::linear_programming;
INSTANTIATE_TEST_SUITE_P(
    ScatteringTable, EveryFit,
    testing::Values(
        Case{"HG .85", PhaseFunction::henyey_greenstein(0.85), "double-gauss-6x8", 42, options(programme, 6, 8, 2)},
        Case{"HG .85", PhaseFunction::henyey_greenstein(0.85), "double-gauss-8x16", 162, options(programme, 8, 12, 3)},
        Case{"HG .98", PhaseFunction::henyey_greenstein(0.98), "double-gauss-8x16", 162, options(programme, 8, 12, 3)},
        Case{"HG -.5", PhaseFunction::henyey_greenstein(-0.5), "double-gauss-8x16", 162, options(programme, 8, 12, 3)},
        Case{"Rayleigh", PhaseFunction::rayleigh(), "double-gauss-8x16", 162, options(programme, 8, 12, 3)},
        Case{"HG .85", PhaseFunction::henyey_greenstein(0.85), "control-points-162", 162,
             options(programme, 10, 10, 3, false)},
        Case{"HG .85 least squares", PhaseFunction::henyey_greenstein(0.85), "double-gauss-8x16", 162,
             options(FitMethod::least_squares, 8, 12, 3)},
        Case{"HG .85 collocation", PhaseFunction::henyey_greenstein(0.85), "double-gauss-8x16", 162,
             options(FitMethod::collocation, 8, 12, 3)}));

void EveryFit::expect_light_is_conserved() const {
  EXPECT_EQ(table.report.fallbacks, 0);
  EXPECT_LE(table.report.closure, 1e-13);  // rescaled in double; sums of some hundred terms
  const Eigen::VectorXd w = weights(set);
  EXPECT_LE((table.ordinates_from_ordinates.transpose() * w - w).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_NEAR(w.dot(table.ordinates_from_beam), 1, 1e-13);
}

void EveryFit::expect_moments_of_columns() const {
  const PhaseFunction truncated = delta_m(GetParam().phase, GetParam().options.delta_m_order).truncated;
  for (int l = 0; l <= GetParam().options.exact_moments; ++l) {
    for (int d = 0; d < set.size(); ++d) {
      // 1e-8: solvers stop at 1e-9 in the rows
      EXPECT_NEAR(moment_about(set.direction[d], l, table.ordinates_from_ordinates.col(d), set) / set.weight[d],
                  truncated.moment(l), 1e-8);
    }
  }
}

void EveryFit::expect_rows_of_beam() const {
  const bool own_order = !set.is_control_points;
  const int order = own_order ? GetParam().options.beam_delta_m_order : GetParam().options.delta_m_order;
  const DeltaM scaled = delta_m(GetParam().phase, order);
  EXPECT_EQ(table.beam_forward_fraction, scaled.forward_fraction);
  for (int l = 0; l <= GetParam().options.exact_moments; ++l) {
    EXPECT_NEAR(moment_about(sun, l, table.ordinates_from_beam, set), scaled.truncated.moment(l), 1e-8);
  }
  for (int k = 0; own_order && k < GetParam().options.beam_half_range_rows; ++k) {
    double upward = 0;
    for (int d = 0; d < set.size(); ++d) {
      if (set.direction[d].z() > 0)
        upward += set.weight[d] * std::pow(set.direction[d].z(), k) * table.ordinates_from_beam[d];
    }
    EXPECT_NEAR(upward, half_range_by_quadrature(scaled.truncated, sun, k), 1e-8);
  }
}

void EveryFit::expect_positive_where_truncated_function_is() const {
  if (GetParam().options.method != FitMethod::linear_programming) return;  // corrections may turn values negative
  double least = 0;
  for (const int order : {GetParam().options.delta_m_order, GetParam().options.beam_delta_m_order}) {
    const PhaseFunction truncated = delta_m(GetParam().phase, order).truncated;
    for (int i = 0; i <= 10000; ++i) least = std::min(least, truncated(std::cos(pi * i / 10000)));
  }
  EXPECT_GE(table.report.least_value, least * (1 + 1e-3) - 1e-12);  // the bound comes from a coarser search
}

void EveryFit::expect_points_and_ordinates_agree() const {
  for (int d = 0; d < set.size(); ++d) {
    const auto [index, weight] = points.stencil(set.direction[d]);
    double interpolated = 0;
    for (int k = 0; k < 3; ++k) interpolated += weight[k] * table.points_from_beam[index[k]];
    EXPECT_NEAR(table.ordinates_from_beam[d], interpolated, 1e-15);
  }
}

// One test, because making a table takes longest.
TEST_P(EveryFit, ConservesLightAndHoldsItsRows) {
  expect_light_is_conserved();
  expect_moments_of_columns();
  expect_rows_of_beam();
  expect_positive_where_truncated_function_is();
  expect_points_and_ordinates_agree();
}

TEST(ScatteringTable, IsotropicIsExact) {
  const OrdinateSet set = make_ordinate_set("double-gauss-6x8");
  const ScatteringTable table =
      make_scattering_table(PhaseFunction::isotropic(), ControlPoints(42), set, sun_at(0.5, 0), FitOptions{});
  EXPECT_EQ(table.report.linear_programmes, 0);
  for (int d = 0; d < set.size(); ++d) {
    EXPECT_NEAR(table.points_from_ordinates.col(d).maxCoeff(), set.weight[d] / (4 * pi), 1e-15);
    EXPECT_NEAR(table.points_from_ordinates.col(d).minCoeff(), set.weight[d] / (4 * pi), 1e-15);
    EXPECT_NEAR(table.ordinates_from_beam[d], 1 / (4 * pi), 1e-15);
  }
}

TEST(ScatteringTable, FollowsASmoothFunctionPointByPoint) {
  const OrdinateSet set = make_ordinate_set("double-gauss-8x16");
  const auto phase = PhaseFunction::rayleigh();
  const ControlPoints points(162);
  const ScatteringTable table = make_scattering_table(phase, points, set, std::nullopt, FitOptions{});
  EXPECT_EQ(table.points_from_beam.size(), 0);
  EXPECT_LT(table.report.max_error, 0.02);  // curvature 1.5 over an edge of .32: 1.5 .32^2 / 8 = .019
  for (int d = 0; d < set.size(); ++d) {
    for (int m = 0; m < points.size(); ++m) {
      EXPECT_NEAR(table.points_from_ordinates(m, d) * 4 * pi / set.weight[d],
                  phase(points.directions()[m].dot(set.direction[d])), 0.03);
    }
  }
}

TEST(ScatteringTable, BackwardPeakKeepsItsMomentsAndConservesLight) {
  const OrdinateSet set = make_ordinate_set("double-gauss-8x16");
  const ScatteringTable table = make_scattering_table(PhaseFunction::henyey_greenstein(-0.95), ControlPoints(162), set,
                                                      sun_at(0.2, 1), FitOptions{});
  EXPECT_EQ(table.forward_fraction, 0);
  EXPECT_EQ(table.beam_forward_fraction, 0);
  EXPECT_GE(table.report.least_value, 0);  // without positive solution the rows are relaxed, not the sign
  EXPECT_LE(table.report.closure, 1e-13);
  for (int d = 0; d < set.size(); ++d) {
    EXPECT_NEAR(moment_about(set.direction[d], 1, table.ordinates_from_ordinates.col(d), set) / set.weight[d], -0.95,
                1e-7);
  }
}

TEST(ScatteringTable, NeedsLittleSymmetry) {
  // A turned frame shares only the inversion with the product set: half the columns are solved, and all hold their
  // moments.
  const OrdinateSet set = make_ordinate_set("double-gauss-6x8");
  const ControlPoints points(42, control_point_frame_rotation());
  const auto phase = PhaseFunction::henyey_greenstein(0.5);
  const ScatteringTable table = make_scattering_table(phase, points, set, std::nullopt, options(programme, 6, 8, 2));
  EXPECT_EQ(table.report.linear_programmes, set.size() / 2);
  const double expected = delta_m(phase, 6).truncated.moment(1);
  for (int d = 0; d < set.size(); ++d) {
    EXPECT_NEAR(moment_about(set.direction[d], 1, table.ordinates_from_ordinates.col(d), set) / set.weight[d], expected,
                1e-8);
  }
}

TEST(ScatteringTable, HasTheSameBitsForAnyNumberOfThreads) {
  const OrdinateSet set = make_ordinate_set("double-gauss-8x16");
  const ControlPoints points(162);
  const auto make = [&](int threads) {
    omp_set_num_threads(threads);
    return make_scattering_table(PhaseFunction::henyey_greenstein(0.85), points, set, sun_at(0.3, 0.1), FitOptions{});
  };
  const int before = omp_get_max_threads();
  const ScatteringTable one = make(1), three = make(3);
  omp_set_num_threads(before);
  EXPECT_EQ(one.points_from_ordinates, three.points_from_ordinates);
  EXPECT_EQ(one.points_from_beam, three.points_from_beam);
}

TEST(ScatteringTable, RejectsOptionsOutOfRange) {
  const OrdinateSet set = make_ordinate_set("double-gauss-6x8");
  const auto make = [&](int order, int beam_order, int moments, int rows) {
    FitOptions o = options(programme, order, beam_order, moments);
    o.beam_half_range_rows = rows;
    return make_scattering_table(PhaseFunction::isotropic(), ControlPoints(42), set, std::nullopt, o);
  };
  EXPECT_NO_THROW(make(6, 8, 3, 3));
  EXPECT_THROW(make(0, 8, 3, 3), InputError);
  EXPECT_THROW(make(8, 6, 3, 3), InputError);
  EXPECT_THROW(make(6, 65, 3, 3), InputError);
  EXPECT_THROW(make(6, 8, -1, 3), InputError);
  EXPECT_THROW(make(6, 8, 13, 3), InputError);
  EXPECT_THROW(make(6, 8, 3, 7), InputError);
}

}  // namespace
}  // namespace cloudbow
