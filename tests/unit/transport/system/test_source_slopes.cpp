// Slopes of the source from the light's own moments.
#include <gtest/gtest.h>
#include <omp.h>

#include <numbers>

#include "gather_test_tools.hpp"
#include "transport/iteration/source_iteration.hpp"
#include "transport/rays/slope_fit.hpp"
#include "transport/system/transport_system.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

template <class Real>
Slope<Real> no_slope(std::size_t n) {
  Slope<Real> slope;
  for (auto& axis : slope) axis.assign(n + lane_padding, Real(0));
  return slope;
}

// Thousands of cells, so that some ordinates are marched sideways.
struct Field {
  BoxGrid box = make_box(24, 20, 12);
  Cells<double> cells;
  OrdinateSet ordinates = make_ordinate_set("double-gauss-6x8");
  std::vector<OrdinatePath> paths;
  std::vector<DenseMatrix<double>> isotropic;

  Field() {
    box.dx_m = 3;
    box.dy_m = 4;
    cells = make_cells<double>(make_grid(box, random_extinction(box, .1, 8), .8), untruncated, false);
    paths = make_ordinate_paths(box, cells, ordinates.direction, false);
    DenseMatrix<double>& matrix = isotropic.emplace_back(ordinates.size(), ordinates.size());
    for (int to = 0; to < ordinates.size(); ++to) {
      for (int from = 0; from < ordinates.size(); ++from)
        matrix(to, from) = ordinates.weight[from] / (4 * std::numbers::pi);
    }
  }
  SlopeTables<double> tables() const {
    return {box, cells, ordinates, paths, isotropic, no_slope<double>(cells.size()), {true, true}};
  }
};

TEST(SourceSlopes, AMarchThroughLinearLightFindsItsSlope) {
  // In a very thick medium the radiance in a cell is its source, here linear in place.
  Field field;
  std::fill(field.cells.extinction.begin(), field.cells.extinction.end(), 1e5);
  for (auto& transposed : field.cells.transposed)
    std::fill(transposed.extinction.begin(), transposed.extinction.end(), 1e5);
  TransportSystem<double> system{.box = field.box,
                                 .cells = std::make_shared<const Cells<double>>(field.cells),
                                 .ordinates = field.ordinates,
                                 .paths = field.paths,
                                 .slopes = field.tables(),
                                 .scattering = OrdinateScattering<double>(field.ordinates, field.isotropic),
                                 .truncated_asymmetry = {0.},
                                 .absorption = std::vector<float>(field.cells.size()),
                                 .beam = {},
                                 .ground = Ground<double>({}, field.ordinates, std::nullopt),
                                 .side_radiance = {}};
  const bool some_sideways =
      std::any_of(field.paths.begin(), field.paths.end(), [](const OrdinatePath& p) { return !p.sideways.empty(); });
  EXPECT_TRUE(some_sideways);
  const std::size_t n = field.cells.size();
  LightSlopes<double> slopes = system.slopes->none(n);
  slopes.fitted = true;
  slopes.frozen = false;
  const std::array<double, 3> wanted{.5, -.3, .7};
  for (auto& octant : slopes.of_octant) {
    for (std::size_t axis = 0; axis < 3; ++axis) std::fill_n(octant[axis].begin(), n, wanted[axis]);
  }
  AngularField<double> radiance(field.ordinates.size(), n);
  for (auto& row : radiance.data) std::fill_n(row.begin(), n, 2.);
  SweepWorkspace<double> work;
  sweep(system, radiance, false, work, &slopes);
  for (int q = 0; q < octants; ++q) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t c = 0; c < n; ++c)
        ASSERT_NEAR(slopes.of_radiance[q][axis][c] / (2 * wanted[axis]), 1, .25) << "what regularisation takes";
    }
  }
  // Isotropic scattering keeps the relative slope.
  for (std::size_t c = 0; c < n; ++c) ASSERT_NEAR(slopes.of_octant[3][2][c], wanted[2], .1);
}

TEST(SourceSlopes, ScatteringMixesOctantsAsItMixesLight) {
  const Field field;
  const SlopeTables<double> tables = field.tables();
  const std::size_t n = field.cells.size();
  LightSlopes<double> slopes = tables.none(n);
  AngularField<double> radiance(field.ordinates.size(), n);
  // Light of one octant alone, 5 with a slope of 1 along y: each octant gets an eighth of both.
  for (int d = 0; d < field.ordinates.size(); ++d)
    std::fill_n(radiance.data[d].begin(), n, octant_of(field.ordinates.direction[d]) == 6 ? 5. : 0.);
  std::fill_n(slopes.of_radiance[6][1].begin(), n, 1.);
  tables.scatter(field.cells, radiance, slopes);
  for (int q = 0; q < octants; ++q) {
    for (std::size_t c = 0; c < n; ++c) {
      ASSERT_NEAR(slopes.of_octant[q][1][c], .2, 1e-12);
      ASSERT_EQ(slopes.of_octant[q][0][c], 0);
    }
  }
}

TEST(SourceSlopes, MixWeighsPartsAndStaysPositive) {
  const std::size_t n = 4;
  Slope<double> multiple = no_slope<double>(n), beam = no_slope<double>(n), slope;
  std::fill_n(multiple[0].begin(), n, .5);
  std::fill_n(beam[0].begin(), n, -1.5);
  std::fill_n(beam[2].begin(), n, 9.);
  const std::vector<double> source{4, 4, 0, -4}, from_beam{0, 1, 0, 0};
  mix_slopes(multiple, beam, {}, 0, n, source.data(), from_beam.data(), slope);
  EXPECT_DOUBLE_EQ(slope[0][0], .5);
  // (.5 * 3 - 1.5)/4 and 9/4: the source would be negative at a corner, so both are scaled to a change of 1 to it.
  EXPECT_DOUBLE_EQ(slope[0][1], 0);
  EXPECT_DOUBLE_EQ(slope[2][1], 2);
  EXPECT_EQ(slope[0][2], 0) << "no source has no slope";
  EXPECT_DOUBLE_EQ(slope[0][3], .5) << "relative to a source that truncation makes negative";
  Slope<double> of_last;
  mix_slopes(multiple, beam, {}, 1, n - 1, source.data() + 1, from_beam.data() + 1, of_last);
  for (std::size_t c = 1; c < n; ++c) EXPECT_EQ(of_last[2][c - 1], slope[2][c]) << "some of the cells: as all of them";
}

// Two clouds beside each other, some of whose cells are thick.
Problem thick_clouds() {
  BoxGrid box = make_box(30, 24, 8);
  box.dx_m = box.dy_m = 60;
  for (double& z : box.z_edge_m) z *= 40;
  std::vector<float> extinction = random_extinction(box, .06, 5);
  for (std::size_t c = 0; c < extinction.size(); ++c) {
    if (c % 30 > 17) extinction[c] = 0;
  }
  Problem problem;
  problem.grid = make_grid(box, extinction, .99);
  problem.phase = {PhaseFunction::henyey_greenstein(.85)};
  problem.sun = Sun{travel_along(-.3, 30), 1.};
  problem.surface.albedo = .2;
  return problem;
}

template <class Real>
std::pair<AngularField<Real>, LightSlopes<Real>> solved_with(int threads) {
  const Problem problem = thick_clouds();
  SolverOptions options = coarse_options();
  options.max_sweeps = 9;
  options.circumsolar_half_angle = .01;  // so that slopes of the radiance are kept
  const Discretisation discretisation = discretise(problem.phase, problem.sun->travel, options);
  const TransportSystem<Real> system = make_system<Real>(problem, discretisation, options);
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  auto solved = iterate_source<Real>(system, options, {});
  omp_set_num_threads(before);
  return {std::move(solved.radiance), std::move(*solved.slopes)};
}

TEST(SourceSlopes, HaveTheSameBitsForAnyNumberOfThreads) {
  const auto one = solved_with<float>(1);
  double largest = 0;
  for (const float g : one.second.of_octant[0][0]) largest = std::max(largest, std::abs(static_cast<double>(g)));
  EXPECT_GT(largest, .1);
  EXPECT_FALSE(one.second.of_radiance[0][0].empty());
  for (const int threads : {2, 3, 5}) {
    const auto more = solved_with<float>(threads);
    EXPECT_EQ(more.first.data, one.first.data) << threads;
    EXPECT_EQ(more.second.of_octant, one.second.of_octant) << threads;
    EXPECT_EQ(more.second.of_radiance, one.second.of_radiance) << threads;
  }
}

TEST(SourceSlopes, FloatFollowsDouble) {
  const auto in_float = solved_with<float>(1);
  const auto in_double = solved_with<double>(1);
  double difference = 0, size = 0;
  for (int q = 0; q < octants; ++q) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      for (std::size_t c = 0; c < in_double.first.cells; ++c) {
        const double g = in_double.second.of_radiance[q][axis][c];
        difference += std::pow(static_cast<double>(in_float.second.of_radiance[q][axis][c]) - g, 2);
        size += g * g;
      }
    }
  }
  EXPECT_LT(std::sqrt(difference / size), 3e-3);  // the fit of phi4 is off by up to .15 %
}

}  // namespace
}  // namespace cloudbow
