// Phase functions of voxels. Truth: droplet_optics() for single radii, and mixtures that are exact by construction.
#include <gtest/gtest.h>

#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/phase_family.hpp"

namespace cloudbow {
namespace {

DropletTable four_rows() {
  return {0.67,
          {4, 5, 10, 20},
          {0.5, 0.4, 0.1, 0.05},
          {0.4, 0.5, 0.9, 1},
          {{1, 0.5, 0.1, 0.01}, {1, 0.4, 0.1, 0.008}, {1, 0.2, 0.05, 0.002}, {1, 0.1, 0.01, 0.001}}};
}

double moment_of(const PhaseFamily& family, std::size_t voxel, int l) {
  const auto [member, next_share] = family.voxel[voxel];
  const double here = family.function[member].moment(l);
  return next_share == 0 ? here : (1 - next_share) * here + next_share * family.function[member + 1].moment(l);
}

TEST(PhaseFamily, DropletsOfVoxelsAreThoseOfTheirRadii) {
  const DropletTable table = four_rows();
  const std::vector<float> radius{6, 5, 9.5F, 6};
  const VoxelDroplets droplets = droplets_of_voxels(table, radius);
  ASSERT_EQ(droplets.phase.function.size(), 2U);  // rows 5 um and 10 um
  for (std::size_t n = 0; n < radius.size(); ++n) {
    const DropletOptics truth = droplet_optics(table, radius[n]);
    EXPECT_EQ(droplets.extinction_m2_per_g[n], truth.extinction_m2_per_g);
    EXPECT_EQ(droplets.single_scattering_albedo[n], truth.single_scattering_albedo);
    for (const int l : {1, 2, 3}) EXPECT_NEAR(moment_of(droplets.phase, n, l), truth.phase_function.moment(l), 1e-15);
  }
}

TEST(PhaseFamily, ARadiusAtTheLastRowNeedsNoRowBeyond) {
  const VoxelDroplets droplets = droplets_of_voxels(four_rows(), std::vector<float>{20});
  EXPECT_EQ(droplets.extinction_m2_per_g[0], 0.05);
  EXPECT_EQ(moment_of(droplets.phase, 0, 1), 0.1);
  EXPECT_THROW(droplets_of_voxels(four_rows(), std::vector<float>{5, 21}), InputError);
}

TEST(PhaseFamily, SetsAreOrderedByAsymmetry) {
  const std::vector<double> asymmetry{0.8, 0.2, 0.5};
  std::vector<PhaseFunction> set;
  for (const double g : asymmetry) set.push_back(PhaseFunction::henyey_greenstein(g));
  const std::vector<std::size_t> number{0, 1, 2, 0};
  const PhaseFamily family = family_of_set(set, number);
  ASSERT_EQ(family.function.size(), 3U);
  for (std::size_t n = 0; n + 1 < 3; ++n)
    EXPECT_LT(family.function[n].asymmetry_parameter(), family.function[n + 1].asymmetry_parameter());
  for (std::size_t n = 0; n < number.size(); ++n) EXPECT_EQ(moment_of(family, n, 1), asymmetry[number[n]]);
}

// Functions between the first and the last are mixtures of both, so that two classes keep every moment.
TEST(PhaseFamily, ClassesKeepMixtures) {
  PhaseFamily family;
  for (const double share : {0., 0.2, 0.55, 1.})
    family.function.push_back(PhaseFunction::double_henyey_greenstein(0.9, 0.6, share));
  family.voxel = {{0, 0}, {1, 0.5}, {2, 0.25}, {3, 0}, {2, 0}};
  const VoxelClasses classes = classes_of_voxels(family, std::vector<double>{1, 2, 3, 4, 5}, 1e-9);
  ASSERT_EQ(classes.function.size(), 2U);
  EXPECT_EQ(classes.functions, 4);
  EXPECT_LT(classes.estimated_error, 1e-12);
  for (std::size_t n = 0; n < family.voxel.size(); ++n) {
    const double next = classes.next_share[n];
    const double low = classes.function[classes.lower[n]].moment(2);
    const double high = next == 0 ? 0 : classes.function[classes.lower[n] + 1U].moment(2);
    EXPECT_NEAR((1 - next) * low + next * high, moment_of(family, n, 2), 1e-7) << n;  // shares are floats
  }
}

TEST(PhaseFamily, VoxelsThatScatterNothingAskForNoFunction) {
  PhaseFamily family;
  for (const double g : {0.1, 0.5, 0.8}) family.function.push_back(PhaseFunction::henyey_greenstein(g));
  family.voxel = {{0, 0}, {1, 0}, {2, 0}};
  const VoxelClasses classes = classes_of_voxels(family, std::vector<double>{0, 2, 0}, 0);
  ASSERT_EQ(classes.function.size(), 1U);
  EXPECT_EQ(classes.functions, 1);
  EXPECT_EQ(classes.function[0].asymmetry_parameter(), 0.5);
  EXPECT_EQ(classes.lower, (std::vector<std::uint16_t>{0, 0, 0}));
  EXPECT_EQ(classes.next_share, (std::vector<float>{0, 0, 0}));
  // Nothing scatters at all: all functions count the same.
  EXPECT_EQ(classes_of_voxels(family, std::vector<double>{0, 0, 0}, 0).function.size(), 3U);
}

}  // namespace
}  // namespace cloudbow
