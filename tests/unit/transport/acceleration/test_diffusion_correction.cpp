#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "transport/acceleration/diffusion_correction.hpp"
#include "transport/scattering/low_moments.hpp"
#include "transport/system/transport_system.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

constexpr int side = 3, depth = 6;

// A cloud of side x side columns in an empty domain of n x n. Its lowest corner is in column (at, at).
struct CorrectionCase {
  Problem problem;
  TransportSystem<double> system;
  std::vector<double> correction;  // [low_moments][cell of the cloud, level by level, from its corner]

  CorrectionCase(int n, int at) : problem(cloud_in(n, at)), system(make_system_of(problem)) {
    const std::size_t cells = system.cells->size();
    const std::vector<std::uint32_t> dense = dense_indices(system.cells->rows);
    const auto place_in_cloud = [&](std::size_t c) {
      const int i = (static_cast<int>(dense[c]) % n - at + n) % n;
      const int j = (static_cast<int>(dense[c]) / n % n - at + n) % n;
      const int k = static_cast<int>(dense[c]) / (n * n);
      return static_cast<std::size_t>((k * side + j) * side + i);
    };
    std::vector<double> change(low_moments * cells, 0.), found(low_moments * cells, 0.);
    for (std::size_t m = 0; m < 4; ++m)
      for (std::size_t c = 0; c < cells; ++c)
        change[m * cells + c] = std::sin(static_cast<double>(m * cells + place_in_cloud(c)));
    DiffusionCorrection<double>::Workspace work;
    DiffusionCorrection<double>(system).correct(change, found, work);
    correction.resize(found.size());
    for (std::size_t m = 0; m < 4; ++m)
      for (std::size_t c = 0; c < cells; ++c) correction[m * cells + place_in_cloud(c)] = found[m * cells + c];
  }

  static Problem cloud_in(int n, int at) {
    const BoxGrid box = make_box(n, n, depth);
    std::vector<float> extinction(cells_of(box), 0.F);
    for (int k = 0; k < depth; ++k)
      for (int j = 0; j < side; ++j)
        for (int i = 0; i < side; ++i)
          extinction[static_cast<std::size_t>((k * n + (at + j) % n) * n + (at + i) % n)] =
              static_cast<float>(3 + i + 2 * j + k);
    Problem problem;
    problem.grid = make_grid(box, extinction, .999);
    problem.phase = {PhaseFunction::henyey_greenstein(.5)};
    problem.sun = Sun{travel_along(-.6, 37), 1.};
    return problem;
  }

  static TransportSystem<double> make_system_of(const Problem& problem) {
    const SolverOptions options = coarse_options();
    return make_system<double>(problem, discretise(problem.phase, problem.sun->travel, options), options);
  }
};

double relative_difference(const std::vector<double>& a, const std::vector<double>& b) {
  double difference = 0, size = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    difference += std::pow(a[i] - b[i], 2);
    size += a[i] * a[i];
  }
  return std::sqrt(difference / size);
}

// Empty columns far from the cloud take no part, and none is beside it over the seam alone: the problem is the same.
// The multigrid differs, and each solves to a residual of 2 %.
TEST(DiffusionCorrection, DoesNotDependOnTheEmptyDomain) {
  const CorrectionCase small(9, 3), large(24, 3), at_the_seam(24, 22);
  ASSERT_EQ(small.correction.size(), large.correction.size());
  EXPECT_LT(relative_difference(small.correction, large.correction), .02);
  EXPECT_LT(relative_difference(large.correction, at_the_seam.correction), .02);
}

// A change of the scalar flux alone, everywhere of one sign, leaves more light of that sign everywhere.
TEST(DiffusionCorrection, MoreLightBringsMore) {
  const CorrectionCase field(9, 3);
  const std::size_t cells = field.system.cells->size();
  std::vector<double> change(low_moments * cells, 0.), found(low_moments * cells, 0.);
  std::fill_n(change.begin(), cells, 1.);
  DiffusionCorrection<double>::Workspace work;
  DiffusionCorrection<double>(field.system).correct(change, found, work);
  for (std::size_t c = 0; c < cells; ++c) EXPECT_GT(found[c], 0.);
}

}  // namespace
}  // namespace cloudbow
