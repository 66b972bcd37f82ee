#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "transport/scattering/low_moments.hpp"
#include "transport/scattering/octant_scattering.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

constexpr std::size_t octant_cells = 150;  // two tiles and a part of one

// Scattering between ordinates by a function of the angle, with the numbers that scatter_in_place takes.
template <class Real>
struct OctantScene {
  OrdinateSet ordinates;
  std::vector<DenseMatrix<Real>> matrix;
  LowMoments<Real> low;
  Cells<Real> medium;  // only `scattered` matters here
  AngularField<Real> field;
  std::vector<BeamSource<Real>> beam;
  std::vector<Real> correction, emission;

  explicit OctantScene(const char* name) : ordinates(make_ordinate_set(name)), low(ordinates) {
    const int count = ordinates.size();
    Random random(1);
    for (const double g : {.6, -.3}) {
      DenseMatrix<Real> between(count, count);
      for (int i = 0; i < count; ++i) {
        for (int j = 0; j < count; ++j) {
          const double cosine = ordinates.direction[i].dot(ordinates.direction[j]);
          between(i, j) = static_cast<Real>((1 - g * g) / std::pow(1 + g * g - 2 * g * cosine, 1.5) / count);
        }
      }
      matrix.push_back(between);
      std::vector<Real> share(octant_cells);
      for (std::size_t c = 0; c < octant_cells; ++c)  // the first scatters nothing in the first tile
        share[c] = matrix.size() == 1 && c < 64 ? Real(0) : static_cast<Real>(random());
      medium.scattered.push_back(share);
    }
    const auto randomly = [&](std::size_t n) {
      std::vector<Real> values(n);
      for (Real& v : values) v = static_cast<Real>(random() - .3);
      return values;
    };
    field = AngularField<Real>(count, octant_cells);
    for (auto& row : field.data) {
      const auto values = randomly(octant_cells);
      std::copy(values.begin(), values.end(), row.begin());
    }
    beam.push_back({Eigen::Matrix<Real, Eigen::Dynamic, 1>::Random(count), randomly(octant_cells)});
    correction = randomly(4 * octant_cells);
    emission = randomly(low_moments * octant_cells);
  }
};

template <class Real>
class FoldedScatteringOf : public testing::Test {};
using Precisions = testing::Types<float, double>;
TYPED_TEST_SUITE(FoldedScatteringOf, Precisions);

TYPED_TEST(FoldedScatteringOf, IsTheFullProduct) {
  // Sums of some hundred terms of the size of one, in another order.
  constexpr double tolerance = 200 * static_cast<double>(std::numeric_limits<TypeParam>::epsilon());
  for (const char* name : {"double-gauss-4x8", "double-gauss-6x8", "double-gauss-8x16", "reduced-double-gauss-12x20"}) {
    SCOPED_TRACE(name);
    const OctantScene<TypeParam> scene(name);
    const auto octant_scattering =
        OctantScattering<TypeParam>::make(scene.ordinates, scene.matrix, scene.low.weights, scene.low.shape);
    ASSERT_TRUE(octant_scattering);
    for (const ScatteringTerms<TypeParam>& terms :
         {ScatteringTerms<TypeParam>{}, ScatteringTerms<TypeParam>{scene.beam, scene.correction, scene.emission},
          ScatteringTerms<TypeParam>{scene.beam, scene.correction, {}, true},
          ScatteringTerms<TypeParam>{{}, {}, scene.emission, true}}) {
      AngularField<TypeParam> full = scene.field;
      scatter_in_place<TypeParam>(full, scene.matrix, scene.medium, terms, scene.low.shape);
      AngularField<TypeParam> quick = scene.field;
      octant_scattering->scatter_in_place(quick, scene.medium, terms);
      for (int d = 0; d < full.rows; ++d) {
        for (std::size_t c = 0; c < octant_cells; ++c)
          ASSERT_NEAR(static_cast<double>(quick.row(d)[c]), static_cast<double>(full.row(d)[c]), tolerance);
      }
    }
    std::vector<TypeParam> full(low_moments * octant_cells), quick(low_moments * octant_cells, TypeParam(99));
    moments_of<TypeParam>(scene.field, scene.low.weights, full);
    octant_scattering->moments_of(scene.field, quick);
    for (std::size_t i = 0; i < full.size(); ++i)
      ASSERT_NEAR(static_cast<double>(quick[i]), static_cast<double>(full[i]), 10 * tolerance);
  }
}

TEST(OctantScattering, IsNotMadeWithoutTheSymmetry) {
  const OctantScene<double> transposed("control-points-42");
  EXPECT_FALSE(OctantScattering<double>::make(transposed.ordinates, transposed.matrix, transposed.low.weights,
                                              transposed.low.shape));
  OctantScene<double> uneven("double-gauss-4x8");
  uneven.matrix[0](3, 5) *= 1.1;
  EXPECT_FALSE(OctantScattering<double>::make(uneven.ordinates, uneven.matrix, uneven.low.weights, uneven.low.shape));
}

}  // namespace
}  // namespace cloudbow
