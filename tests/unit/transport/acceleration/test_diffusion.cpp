#include <gtest/gtest.h>
#include <omp.h>

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "transport/acceleration/diffusion.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

struct Case {
  const char* name;
  std::array<int, 3> cells;
  bool periodic;
  double albedo;
  double largest_extinction;
  bool independent_columns = false;
  bool some_columns = false;  // take part
};

BoxGrid box_of(const Case& c) {
  BoxGrid box = make_box(c.cells[0], c.cells[1], 0, c.periodic);
  box.dx_m = 30;
  box.dy_m = 25;
  box.z_edge_m = {0};
  for (int k = 0; k < c.cells[2]; ++k) box.z_edge_m.push_back(box.z_edge_m.back() + (k % 2 == 0 ? 20. : 35.));
  return box;
}

ColumnSet columns_of(const Case& c, const BoxGrid& box) {
  ColumnSet all = ColumnSet::of(box);
  if (!c.some_columns) return all;
  std::vector<std::uint32_t> places;
  Random random(4);
  for (const std::uint32_t place : all.place) {
    if (random() < .6) places.push_back(place);
  }
  return {box.nx, box.ny, box.periodic, places};
}

// Contrast 1e6 and a third of it empty.
DiffusionCoefficients coefficients_of(const Case& c, const BoxGrid& box) {
  DiffusionCoefficients given;
  Random random(1);
  for (std::size_t i = 0; i < columns_of(c, box).size() * static_cast<std::size_t>(box.nz()); ++i) {
    const double extinction = random() < 1. / 3 ? 0 : c.largest_extinction * std::pow(10., -6 * random());
    given.extinction.push_back(static_cast<float>(extinction));
    given.transport.push_back(static_cast<float>(.4 * extinction));
    given.absorption.push_back(static_cast<float>(c.albedo < 1 ? 0 : .01 * extinction));
  }
  given.surface_albedo = c.albedo;
  given.independent_columns = c.independent_columns;
  return given;
}

// The finite volumes of theory.md (22), (23), face by face: each face exchanges with the place on its other side.
Eigen::MatrixXd assembled(const BoxGrid& box, const ColumnSet& columns, const DiffusionCoefficients& given) {
  const int n = static_cast<int>(columns.size()) * box.nz();
  const double depth = box.z_edge_m.back() - box.z_edge_m.front();
  const auto diffusivity = [&](int c) {
    double h = box.thickness_m(c % box.nz());  // smallest edge of the cell, of the axes that the field varies along
    if (box.nx > 1) h = std::min(h, box.dx_m);
    if (box.ny > 1) h = std::min(h, box.dy_m);
    const double longest = std::max(4 * h, .05 * depth);
    const double x = 1.5 * static_cast<double>(given.extinction[c]) * h;
    const double a = x < 1e-2 ? x / 6 : (1 + std::exp(-x)) / (1 - std::exp(-x)) - 2 / x;
    return 1 / (3 * std::max(static_cast<double>(given.transport[c]), 1 / longest)) + h / 4 * a;
  };
  const auto index = [&](int i, int j, int k) {
    const auto found =
        std::find(columns.place.begin(), columns.place.end(), static_cast<std::uint32_t>(j * box.nx + i));
    return found == columns.place.end() ? -1 : static_cast<int>(found - columns.place.begin()) * box.nz() + k;
  };
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n);
  for (int k = 0; k < box.nz(); ++k) {
    for (int j = 0; j < box.ny; ++j) {
      for (int i = 0; i < box.nx; ++i) {
        const int c = index(i, j, k);
        if (c < 0) continue;
        const std::array<double, 3> edge{box.dx_m, box.dy_m, box.thickness_m(k)};
        const double volume = edge[0] * edge[1] * edge[2];
        matrix(c, c) += static_cast<double>(given.absorption[c]) * volume;
        for (int axis = 0; axis < 3; ++axis) {
          const std::array<int, 3> count{box.nx, box.ny, box.nz()};
          if (axis < 2 && (given.independent_columns || (box.periodic && count[axis] == 1))) continue;
          for (const int side : {-1, 1}) {
            std::array<int, 3> to{i, j, k};
            to[axis] += side;
            const double area = volume / edge[axis];
            if (axis < 2 && box.periodic) to[axis] = (to[axis] + count[axis]) % count[axis];
            const bool outside = to[axis] < 0 || to[axis] >= count[axis] || index(to[0], to[1], to[2]) < 0;
            if (outside) {
              // Marshak: current = exchange * flux at the face, half a cell away.
              const double exchange =
                  axis == 2 && side < 0 ? (1 - given.surface_albedo) / (2 * (1 + given.surface_albedo)) : .5;
              if (exchange > 0) matrix(c, c) += area / (1 / exchange + edge[axis] / (2 * diffusivity(c)));
              continue;
            }
            const int other = index(to[0], to[1], to[2]);
            const double width = axis == 2 ? box.thickness_m(to[2]) : edge[axis];
            const double exchange = area / (edge[axis] / (2 * diffusivity(c)) + width / (2 * diffusivity(other)));
            matrix(c, c) += exchange;
            matrix(c, other) -= exchange;
          }
        }
      }
    }
  }
  return matrix;
}

class DiffusionIn : public testing::TestWithParam<Case> {};

TEST_P(DiffusionIn, AgreesWithADenseFactorisation) {
  const BoxGrid box = box_of(GetParam());
  const DiffusionCoefficients given = coefficients_of(GetParam(), box);
  const ColumnSet columns = columns_of(GetParam(), box);
  const Eigen::MatrixXd matrix = assembled(box, columns, given);
  Random random(2);
  Eigen::VectorXd source(matrix.rows());
  for (double& s : source) s = random();
  const Eigen::VectorXd truth = matrix.ldlt().solve(source);
  Eigen::VectorXd solved(matrix.rows());
  const DiffusionOperator diffusion(box, columns, given);
  const auto n = static_cast<std::size_t>(matrix.rows());
  DiffusionOperator::Workspace work;
  diffusion.solve({source.data(), n}, {solved.data(), n}, 1e-11, work);
  // Residuals of 1e-11, magnified by the condition of the matrix (1e3 and more).
  EXPECT_LT((solved - truth).norm(), 1e-7 * truth.norm());
  // Couplings are rounded to float: each by 6e-8 of itself.
  EXPECT_LT((matrix * solved - source).norm(), 6e-8 * matrix.norm() * solved.norm());
  // The tenth that acceleration requires is met as well.
  diffusion.solve({source.data(), n}, {solved.data(), n}, .1, work);
  EXPECT_LT((matrix * solved - source).norm(), .1 * source.norm());
}

INSTANTIATE_TEST_SUITE_P(
    Boxes, DiffusionIn,
    testing::Values(Case{"one_column", {1, 1, 12}, true, 0, .3}, Case{"one_cell", {1, 1, 1}, true, .3, .3},
                    Case{"even_periodic", {8, 4, 5}, true, .3, 1}, Case{"odd_periodic", {7, 5, 6}, true, 0, 1},
                    Case{"two_across", {2, 2, 4}, true, 0, 1}, Case{"three_across", {3, 1, 4}, true, 0, 1},
                    Case{"even_open", {6, 4, 5}, false, .3, 1}, Case{"odd_open", {5, 7, 3}, false, 1, 100},
                    Case{"one_open_column", {1, 1, 8}, false, 0, 1}, Case{"white_surface", {9, 6, 5}, true, 1, 100},
                    Case{"opaque", {7, 6, 5}, true, 0, 1e4}, Case{"columns", {4, 3, 6}, true, .3, 1, true},
                    Case{"gaps_even_periodic", {8, 6, 5}, true, .3, 1, false, true},
                    Case{"gaps_odd_periodic", {7, 9, 4}, true, 0, 100, false, true},
                    Case{"gaps_open", {9, 4, 5}, false, .3, 1, false, true}),
    [](const auto& instance) { return instance.param.name; });

// -D e'' + alpha e = q between Marshak ends D e' = e/2: e = q/alpha [1 - cosh(kappa (z - H/2)) / (cosh(kappa H/2) + 2 D
// kappa sinh(kappa H/2))], kappa = sqrt(alpha/D).
double error_in_slab(int levels) {
  constexpr double depth = 1, transport = 40, absorption = 1, q = 1;
  BoxGrid box = make_box(1, 1, 0);
  for (int k = 0; k <= levels; ++k) box.z_edge_m.push_back(depth * k / levels);
  box.z_edge_m.erase(box.z_edge_m.begin());
  const auto n = static_cast<std::size_t>(levels);
  const DiffusionCoefficients given{std::vector<float>(n, transport), std::vector<float>(n, transport),
                                    std::vector<float>(n, absorption)};
  std::vector<double> flux(n);
  DiffusionOperator::Workspace work;
  DiffusionOperator(box, ColumnSet::of(box), given)
      .solve(std::vector<double>(n, q * depth / levels), flux, 1e-12, work);
  constexpr double d = 1 / (3 * transport);
  const double kappa = std::sqrt(absorption / d);
  const double end = std::cosh(kappa * depth / 2) + 2 * d * kappa * std::sinh(kappa * depth / 2);
  double worst = 0;
  for (int k = 0; k < levels; ++k) {
    const double z = depth * (k + .5) / levels;
    worst = std::max(worst, std::abs(flux[k] - q / absorption * (1 - std::cosh(kappa * (z - depth / 2)) / end)));
  }
  return worst;
}

TEST(Diffusion, ConvergesToTheSlabAtSecondOrder) {
  const double coarse = error_in_slab(400);
  const double fine = error_in_slab(800);
  EXPECT_LT(fine, 1e-3);
  EXPECT_NEAR(coarse / fine, 4, .2);  // next order: 5 % at these steps
}

// A periodic row of five columns without its third. Neighbours are found across the seam too.
TEST(ColumnSet, NeighboursAreThoseThatTakePart) {
  const ColumnSet columns(5, 1, true, {0, 1, 3, 4});
  const std::uint32_t none = 4;
  EXPECT_EQ(columns.beside[0], (std::array<std::uint32_t, 4>{1, 3, none, none}));
  EXPECT_EQ(columns.beside[1], (std::array<std::uint32_t, 4>{none, 0, none, none}));
  EXPECT_EQ(columns.beside[2], (std::array<std::uint32_t, 4>{3, none, none, none}));
  EXPECT_EQ(columns.beside[3], (std::array<std::uint32_t, 4>{0, 2, none, none}));
  EXPECT_EQ(ColumnSet(5, 1, false, {0, 4}).beside[1], (std::array<std::uint32_t, 4>{2, 2, 2, 2}));
  EXPECT_EQ(columns.by_place(), (std::vector<std::uint32_t>{0, 1, none, 2, 3}));
}

// The equations are linear. The factors exceed the range of float, in which the cycles are. The arrays of one solve are
// used by the next; differences are rounding.
TEST(Diffusion, SolutionsScaleWithTheirSources) {
  const Case c{"", {8, 6, 5}, true, 0, 1};
  const BoxGrid box = box_of(c);
  const DiffusionOperator diffusion(box, columns_of(c, box), coefficients_of(c, box));
  Random random(4);
  std::vector<double> source(cells_of(box)), flux(cells_of(box)), scaled(cells_of(box));
  for (double& s : source) s = random();
  DiffusionOperator::Workspace work;
  diffusion.solve(source, flux, .1, work);
  for (const double factor : {1e-60, 1., 1e60}) {
    std::vector<double> other = source;
    for (double& s : other) s *= factor;
    diffusion.solve(other, scaled, .1, work);
    for (std::size_t n = 0; n < flux.size(); ++n) EXPECT_NEAR(scaled[n] / factor, flux[n], 1e-6 * std::abs(flux[n]));
  }
}

TEST(Diffusion, DarkSourceGivesNothing) {
  const Case c{"", {4, 3, 5}, true, 0, 1};
  const BoxGrid box = box_of(c);
  std::vector<double> flux(cells_of(box), 7.);
  DiffusionOperator::Workspace work;
  DiffusionOperator(box, columns_of(c, box), coefficients_of(c, box))
      .solve(std::vector<double>(cells_of(box), 0.), flux, .1, work);
  EXPECT_EQ(flux, std::vector<double>(cells_of(box), 0.));
}

TEST(Diffusion, BitsDoNotDependOnThreads) {
  for (const bool even : {true, false}) {
    const Case c{"", {even ? 32 : 33, 32, 20}, true, 0, 1};  // enough cells for the parallel loops
    const BoxGrid box = box_of(c);
    const DiffusionOperator diffusion(box, columns_of(c, box), coefficients_of(c, box));
    Random random(3);
    std::vector<double> source(cells_of(box)), one(cells_of(box)), two(cells_of(box));
    for (double& s : source) s = random();
    DiffusionOperator::Workspace work_of_one, work_of_two;
    const int threads = omp_get_max_threads();
    omp_set_num_threads(1);
    diffusion.solve(source, one, 1e-3, work_of_one);
    omp_set_num_threads(2);
    diffusion.solve(source, two, 1e-3, work_of_two);
    omp_set_num_threads(threads);
    EXPECT_EQ(one, two);
  }
}

}  // namespace
}  // namespace cloudbow
