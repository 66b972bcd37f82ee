// Few phase functions for many. Truths: mixtures that are exact by construction, and the guarantees of the class
// (asymmetry kept, tolerance kept, error 0 with every function).
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "optics/phase_classes.hpp"

namespace cloudbow {
namespace {

std::vector<PhaseFunction> henyey_greenstein_family(int count, double from, double to) {
  std::vector<PhaseFunction> family;
  for (int n = 0; n < count; ++n)
    family.push_back(PhaseFunction::henyey_greenstein(from + (to - from) * n / (count - 1)));
  return family;
}

double moment_of(const std::vector<PhaseFunction>& family, const PhaseClasses& classes, const ClassMixture& mixture,
                 int l) {
  const double low = family[classes.members()[mixture.lower]].moment(l);
  if (mixture.next_share == 0) return low;
  return (1 - mixture.next_share) * low + mixture.next_share * family[classes.members()[mixture.lower + 1]].moment(l);
}

TEST(PhaseClasses, MixturesOfTwoFunctionsNeedTheseTwo) {
  std::vector<PhaseFunction> family;
  const std::vector<double> share{0, 0.2, 0.55, 0.7, 1};
  for (const double s : share) family.push_back(PhaseFunction::double_henyey_greenstein(0.9, 0.6, s));
  const PhaseClasses classes(family, std::vector<double>(5, 1.0), 1e-9);
  EXPECT_EQ(classes.members(), (std::vector<std::size_t>{0, 4}));
  EXPECT_LT(classes.estimated_error(), 1e-12);
  for (std::size_t n = 1; n < 4; ++n) {
    EXPECT_EQ(classes.mixture(n).lower, 0U);
    EXPECT_NEAR(classes.mixture(n).next_share, share[n], 1e-12);
  }
  EXPECT_NEAR(classes.mixture(1, 0.5).next_share, 0.5 * (0.2 + 0.55), 1e-12);
  EXPECT_EQ(classes.mixture(4).lower, 1U);
  EXPECT_EQ(classes.mixture(4).next_share, 0);
}

TEST(PhaseClasses, ToleranceIsKeptWithFewerClassesTheLooserItIs) {
  const auto family = henyey_greenstein_family(30, 0.6, 0.9);
  std::size_t before = 1;
  for (const double tolerance : {1e-2, 1e-3, 1e-4, 1e-5}) {
    const PhaseClasses classes(family, std::vector<double>(30, 1.0), tolerance);
    EXPECT_LE(classes.estimated_error(), tolerance);
    EXPECT_GT(classes.members().size(), before);
    before = classes.members().size();
  }
  const PhaseClasses all(family, std::vector<double>(30, 1.0), 0);
  EXPECT_EQ(all.members().size(), 30U);
  EXPECT_EQ(all.estimated_error(), 0);
}

TEST(PhaseClasses, MixturesKeepTheAsymmetryParameter) {
  const auto family = henyey_greenstein_family(20, 0.7, 0.88);
  const PhaseClasses classes(family, std::vector<double>(20, 1.0), 1e-3);
  ASSERT_LT(classes.members().size(), 10U);
  for (std::size_t n = 0; n < 20; ++n) {
    EXPECT_NEAR(moment_of(family, classes, classes.mixture(n), 1), family[n].asymmetry_parameter(), 1e-12);
  }
}

TEST(PhaseClasses, EstimateBoundsTheTurnedShareOfLight) {
  // Of isotropically incident light the share turned over by a scattering is 1/2 - 3/8 chi_1 + 7/128 chi_3 + ...: chi_3
  // of the mixture is off, and the estimate is the worst direction, so not below the mean.
  const auto family = henyey_greenstein_family(3, 0.5, 0.9);
  const PhaseClasses classes(family, std::vector<double>{1, 2, 1}, 0.1);
  ASSERT_EQ(classes.members().size(), 2U);
  const ClassMixture mixture = classes.mixture(1);
  // Half of int P_l P_0: weights 1/2 (2l+1) a_l^2 with a_l = int_0^1 P_l: a_1 = 1/2, a_3 = -1/8, a_5 = 1/16, a_7 =
  // -5/128.
  double change = 0;
  for (const auto& [l, a] : {std::pair{3, -1.0 / 8}, std::pair{5, 1.0 / 16}, std::pair{7, -5.0 / 128}}) {
    change -= 0.5 * (2 * l + 1) * a * a * (moment_of(family, classes, mixture, l) - family[1].moment(l));
  }
  EXPECT_GT(std::abs(change), 1e-4);
  EXPECT_GT(classes.estimated_error(), 0.5 * std::abs(change));  // half of the scattering is in the function left out
}

TEST(PhaseClasses, FunctionsWithoutWeightAreLeftOut) {
  const auto family = henyey_greenstein_family(6, 0.5, 0.9);
  const PhaseClasses classes(family, std::vector<double>{0, 1, 0, 1, 0, 0}, 0);
  EXPECT_EQ(classes.members(), (std::vector<std::size_t>{1, 3}));
  const PhaseClasses one(family, std::vector<double>{0, 0, 5, 0, 0, 0}, 1e-3);
  EXPECT_EQ(one.members(), (std::vector<std::size_t>{2}));
  EXPECT_EQ(one.mixture(2).next_share, 0);
}

TEST(PhaseClasses, WeightsSayWhereClassesAreNeeded) {
  const auto family = henyey_greenstein_family(40, 0.3, 0.9);
  std::vector<double> weight(40, 1e-6);
  for (int n = 30; n < 40; ++n) weight[n] = 1;
  const PhaseClasses classes(family, weight, 2e-4);
  const auto in_heavy =
      std::count_if(classes.members().begin(), classes.members().end(), [](auto m) { return m >= 30; });
  EXPECT_GE(in_heavy + 1, static_cast<std::ptrdiff_t>(classes.members().size()));
}

}  // namespace
}  // namespace cloudbow
