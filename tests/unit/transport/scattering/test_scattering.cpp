#include <gtest/gtest.h>
#include <omp.h>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "transport/scattering/scattering.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

constexpr int ordinates = 24;
constexpr std::size_t cell_count = 300;  // two tiles and a part of one

std::vector<double> quadrature() {
  Random random(1);
  std::vector<double> weight(ordinates);
  double sum = 0;
  for (double& w : weight) sum += w = .2 + random();
  for (double& w : weight) w *= 4 * std::numbers::pi / sum;
  return weight;
}

// Positive, and sum_i w_i m(i, j) = w_j: conservative scattering.
Eigen::MatrixXd conservative_matrix(unsigned seed) {
  Random random(seed);
  const auto weight = quadrature();
  Eigen::MatrixXd matrix(ordinates, ordinates);
  for (int j = 0; j < ordinates; ++j) {
    double sum = 0;
    for (int i = 0; i < ordinates; ++i) sum += weight[i] * (matrix(i, j) = random() < .1 ? 0 : random());
    matrix.col(j) *= weight[j] / sum;
  }
  return matrix;
}

template <class Real>
struct ScatteringScene {
  std::vector<double> weight = quadrature();
  std::vector<DenseMatrix<Real>> matrix;
  Cells<Real> medium;  // only `scattered` matters here
  AngularField<Real> radiance{ordinates, cell_count};

  explicit ScatteringScene(int phase_functions = 2) {
    Random random(2);
    for (int p = 0; p < phase_functions; ++p) {
      matrix.push_back(rounded_conservatively<Real>(conservative_matrix(3 + static_cast<unsigned>(p)), weight));
      std::vector<Real> share(cell_count);
      for (Real& s : share) s = random() < .2 ? Real(0) : static_cast<Real>(random() / phase_functions);
      medium.scattered.push_back(share);
    }
    for (int d = 0; d < ordinates; ++d) {
      for (std::size_t c = 0; c < cell_count; ++c) radiance.row(d)[c] = static_cast<Real>(random());
    }
  }

  AngularField<Real> scattered(const std::vector<BeamSource<Real>>& beam = {}, const std::vector<Real>& correction = {},
                               const DenseMatrix<Real>& shape = {}) const {
    AngularField<Real> field = radiance;
    scatter_in_place<Real>(field, matrix, medium, {beam, correction, {}}, shape);
    return field;
  }

  // The sum of products that scattering is, one after the other in double.
  double source(int row, std::size_t c, const AngularField<Real>& from) const {
    double sum = 0;
    for (std::size_t p = 0; p < matrix.size(); ++p) {
      for (int d = 0; d < from.rows; ++d) {
        sum += static_cast<double>(medium.scattered[p][c]) * static_cast<double>(matrix[p](row, d)) *
               static_cast<double>(from.row(d)[c]);
      }
    }
    return sum;
  }
};

template <class Real>
class ScatteringOf : public testing::Test {
 public:
  // Sums of some fifty positive terms, each rounded.
  static constexpr double tolerance = 16 * static_cast<double>(std::numeric_limits<Real>::epsilon());
};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(ScatteringOf, Precisions);

TYPED_TEST(ScatteringOf, ConservesPower) {
  const ScatteringScene<TypeParam> scene;
  const auto source = scene.scattered();
  for (std::size_t c = 0; c < cell_count; ++c) {
    double in = 0;
    double out = 0;
    for (int d = 0; d < ordinates; ++d) {
      in += scene.weight[d] * static_cast<double>(scene.radiance.row(d)[c]);
      out += scene.weight[d] * static_cast<double>(source.row(d)[c]);
    }
    const double scattered =
        static_cast<double>(scene.medium.scattered[0][c]) + static_cast<double>(scene.medium.scattered[1][c]);
    EXPECT_NEAR(out, scattered * in, this->tolerance * in);
  }
}

TYPED_TEST(ScatteringOf, IsTheSumOverPhaseFunctionsAndOrdinates) {
  const ScatteringScene<TypeParam> scene;
  const auto source = scene.scattered();
  for (std::size_t c = 0; c < cell_count; ++c) {
    for (int d = 0; d < ordinates; ++d) {
      EXPECT_NEAR(static_cast<double>(source.row(d)[c]), scene.source(d, c, scene.radiance), this->tolerance);
    }
  }
}

TYPED_TEST(ScatteringOf, GoesToOtherDirectionsAlike) {
  ScatteringScene<TypeParam> scene;
  constexpr int points = 42;
  Random random(9);
  for (auto& matrix : scene.matrix) {
    matrix.resize(points, ordinates);
    for (int m = 0; m < points; ++m) {
      for (int d = 0; d < ordinates; ++d) matrix(m, d) = static_cast<TypeParam>(random() / ordinates);
    }
  }
  const AngularField<TypeParam> source = scatter_to<TypeParam>(points, scene.radiance, scene.matrix, scene.medium);
  for (std::size_t c = 0; c < cell_count; ++c) {
    for (int m = 0; m < points; ++m) {
      EXPECT_NEAR(static_cast<double>(source.row(m)[c]), scene.source(m, c, scene.radiance), this->tolerance);
    }
  }
}

TYPED_TEST(ScatteringOf, IsotropicMatrixGivesTheMeanEverywhere) {
  ScatteringScene<TypeParam> scene(1);
  Eigen::MatrixXd isotropic(ordinates, ordinates);
  for (int j = 0; j < ordinates; ++j) isotropic.col(j).setConstant(scene.weight[j] / (4 * std::numbers::pi));
  scene.matrix[0] = rounded_conservatively<TypeParam>(isotropic, scene.weight);
  const auto source = scene.scattered();
  for (std::size_t c = 0; c < cell_count; ++c) {
    double mean = 0;
    for (int d = 0; d < ordinates; ++d)
      mean += scene.weight[d] * static_cast<double>(scene.radiance.row(d)[c]) / (4 * std::numbers::pi);
    for (int d = 0; d < ordinates; ++d) {
      EXPECT_NEAR(static_cast<double>(source.row(d)[c]), static_cast<double>(scene.medium.scattered[0][c]) * mean,
                  this->tolerance);
    }
  }
}

TYPED_TEST(ScatteringOf, AddsBeamsAndScattersTheCorrectionOfTheMoments) {
  const ScatteringScene<TypeParam> scene;
  Random random(5);
  std::vector<BeamSource<TypeParam>> beam(2);
  for (auto& b : beam) {
    b.direction.resize(ordinates);
    for (int d = 0; d < ordinates; ++d) b.direction[d] = static_cast<TypeParam>(random());
    for (std::size_t c = 0; c < cell_count; ++c) b.intensity.push_back(static_cast<TypeParam>(random()));
  }
  std::vector<TypeParam> correction(low_moments * cell_count);
  for (auto& x : correction) x = static_cast<TypeParam>(random() - .5);
  DenseMatrix<TypeParam> shape(ordinates, low_moments);
  for (int d = 0; d < ordinates; ++d) {
    for (int m = 0; m < low_moments; ++m) shape(d, m) = static_cast<TypeParam>(random());
  }
  AngularField<TypeParam> corrected = scene.radiance;
  for (int d = 0; d < ordinates; ++d) {
    for (std::size_t c = 0; c < cell_count; ++c) {
      for (int m = 0; m < low_moments; ++m) corrected.row(d)[c] += shape(d, m) * correction[m * cell_count + c];
    }
  }
  const auto source = scene.scattered(beam, correction, shape);
  for (std::size_t c = 0; c < cell_count; ++c) {
    for (int d = 0; d < ordinates; ++d) {
      double truth = scene.source(d, c, corrected);
      for (const auto& b : beam) truth += static_cast<double>(b.direction[d]) * static_cast<double>(b.intensity[c]);
      EXPECT_NEAR(static_cast<double>(source.row(d)[c]), truth, 4 * this->tolerance);  // terms of both signs, up to 4
    }
  }
}

TYPED_TEST(ScatteringOf, MomentsAreWeightedSums) {
  const ScatteringScene<TypeParam> scene;
  Random random(6);
  DenseMatrix<TypeParam> weights(low_moments, ordinates);
  for (int m = 0; m < low_moments; ++m) {
    for (int d = 0; d < ordinates; ++d) weights(m, d) = static_cast<TypeParam>(random() - .5);
  }
  std::vector<TypeParam> moments(low_moments * cell_count, TypeParam(99));
  moments_of<TypeParam>(scene.radiance, weights, moments);
  for (int m = 0; m < low_moments; ++m) {
    for (std::size_t c = 0; c < cell_count; ++c) {
      double truth = 0;
      for (int d = 0; d < ordinates; ++d)
        truth += static_cast<double>(weights(m, d)) * static_cast<double>(scene.radiance.row(d)[c]);
      EXPECT_NEAR(static_cast<double>(moments[m * cell_count + c]), truth, this->tolerance);
    }
  }
}

TYPED_TEST(ScatteringOf, BitsDoNotDependOnThreads) {
  const ScatteringScene<TypeParam> scene;
  const int threads = omp_get_max_threads();
  omp_set_num_threads(1);
  const auto one = scene.scattered();
  omp_set_num_threads(2);
  const auto two = scene.scattered();
  omp_set_num_threads(threads);
  EXPECT_EQ(one.data, two.data);
}

TEST(RoundedConservatively, KeepsColumnIntegrals) {
  const auto weight = quadrature();
  const Eigen::MatrixXd matrix = conservative_matrix(3);
  const DenseMatrix<float> rounded = rounded_conservatively<float>(matrix, weight);
  double plainly = 0;
  double carefully = 0;
  for (int j = 0; j < ordinates; ++j) {
    double off = 0;
    double off_plainly = 0;
    double unit = 0;  // half a unit in the last place of the largest element
    for (int i = 0; i < ordinates; ++i) {
      off += weight[i] * (static_cast<double>(rounded(i, j)) - matrix(i, j));
      off_plainly += weight[i] * (static_cast<double>(static_cast<float>(matrix(i, j))) - matrix(i, j));
      unit = std::max(unit, weight[i] * matrix(i, j) * 6e-8);
      EXPECT_NEAR(static_cast<double>(rounded(i, j)), matrix(i, j), 1e-6 * matrix(i, j) + 1e-8);
      if (matrix(i, j) == 0) {
        EXPECT_EQ(rounded(i, j), 0);
      }
    }
    EXPECT_LE(std::abs(off), unit);
    carefully += std::abs(off);
    plainly += std::abs(off_plainly);
  }
  EXPECT_LT(carefully, plainly / 2);
}

}  // namespace
}  // namespace cloudbow
