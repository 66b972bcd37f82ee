// The light through top and bottom of a result. Truth: the solution that was written.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <functional>
#include <limits>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/boundary_result.hpp"
#include "sample_solution.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

class BoundaryFile : public testing::Test {
 protected:
  const TemporaryFolder folder_;
  const std::filesystem::path file_ = folder_ / "result.h5";
};

TEST_F(BoundaryFile, IsReadAtTopAndBottom) {
  for (const std::vector<int>& levels : {std::vector<int>{}, std::vector<int>{0, 4}}) {
    write_result(file_, sample::solution(3, 2, 4, levels), sample::info());
    const BoundaryResult result = read_boundary_result(file_);
    ASSERT_EQ(result.fluxes.size(), 1U);
    EXPECT_EQ(result.fluxes[0].reflectance, 0.5);
    EXPECT_EQ(result.fluxes[0].transmittance, 0.375);
    EXPECT_THAT(result.x_m, ElementsAre(112.5, 137.5, 162.5));
    EXPECT_THAT(result.y_m, ElementsAre(-25, 25));
    ASSERT_EQ(result.fluxes[0].up_at_top.size(), 6U);
    for (int j = 0; j < 2; ++j) {
      for (int i = 0; i < 3; ++i) {
        const auto column = static_cast<std::size_t>(3 * j + i);
        EXPECT_EQ(result.fluxes[0].up_at_top[column], sample::field_value(1, 4, j, i));
        EXPECT_EQ(result.fluxes[0].down_at_bottom[column],
                  sample::field_value(2, 0, j, i) + sample::field_value(3, 0, j, i));
      }
    }
    EXPECT_EQ(result.cost.cpu_seconds, 24);
    EXPECT_EQ(result.cost.wall_seconds, 12.5);
    EXPECT_EQ(result.cost.table_seconds, 0.5);
    EXPECT_EQ(result.cost.peak_memory_bytes, 6e9);
    EXPECT_EQ(result.cost.sweeps, 17);
    EXPECT_EQ(result.cost.control_points, 162);
    EXPECT_TRUE(result.cost.converged);
  }
}

TEST_F(BoundaryFile, OfASpectrumAddsUpTheCost) {
  std::vector<Solution> both{sample::solution(3, 2, 4), sample::solution(3, 2, 4)};
  both[1].upwelling_flux.back() = 7;
  both[1].ledger.reflectance = 0.25;
  both[1].report.peak_memory_bytes = 7'000'000'000;
  both[1].report.converged = false;
  ResultInfo info = sample::info();
  info.wavelengths_um = {0.5, 0.6};
  write_result(file_, both, info);
  const BoundaryResult result = read_boundary_result(file_);
  ASSERT_EQ(result.fluxes.size(), 2U);
  EXPECT_THAT(result.wavelengths_um, ElementsAre(0.5, 0.6));
  EXPECT_EQ(result.fluxes[0].up_at_top.back(), sample::field_value(1, 4, 1, 2));
  EXPECT_EQ(result.fluxes[1].up_at_top.back(), 7);
  EXPECT_EQ(result.fluxes[1].reflectance, 0.25);
  EXPECT_EQ(result.cost.cpu_seconds, 48);
  EXPECT_EQ(result.cost.peak_memory_bytes, 7e9);
  EXPECT_FALSE(result.cost.converged);
}

// Sums of counts that no int holds were cast to one.
TEST_F(BoundaryFile, CostsThatNoRunHasAreRefused) {
  const auto refused = [&](const std::function<void(SolverReport&)>& change, const char* attribute) {
    std::vector<Solution> both{sample::solution(3, 2, 4), sample::solution(3, 2, 4)};
    for (Solution& solution : both) change(solution.report);
    ResultInfo info = sample::info();
    info.wavelengths_um = {0.5, 0.6};
    write_result(file_, both, info);
    EXPECT_THAT([&] { read_boundary_result(file_); },
                ThrowsMessage<InputError>(AllOf(HasSubstr("result.h5: attribute"), HasSubstr(attribute))));
  };
  refused([](SolverReport& r) { r.sweeps = std::numeric_limits<int>::max(); }, "sweeps");
  refused([](SolverReport& r) { r.control_points = -1; }, "control_points");
  refused([](SolverReport& r) { r.seconds_total = std::numeric_limits<double>::infinity(); }, "seconds_total");
  refused([](SolverReport& r) { r.cpu_seconds = std::numeric_limits<double>::quiet_NaN(); }, "cpu_seconds");
}

TEST_F(BoundaryFile, MustReachFromBottomToTop) {
  for (const std::vector<int>& levels : {std::vector<int>{0, 2}, std::vector<int>{1, 4}}) {
    write_result(file_, sample::solution(3, 2, 4, levels), sample::info());
    EXPECT_THAT([&] { read_boundary_result(file_); }, ThrowsMessage<InputError>(HasSubstr("output.flux_levels")));
  }
  std::ofstream(file_) << "no HDF5";
  EXPECT_THROW(read_boundary_result(file_), InputError);
  std::filesystem::remove(file_);
  EXPECT_THAT([&] { read_boundary_result(file_); }, ThrowsMessage<InputError>(HasSubstr("no such file")));
}

}  // namespace
}  // namespace cloudbow
