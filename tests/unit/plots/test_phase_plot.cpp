// The plot of a phase function. Truth: it is a PNG, or an error.
#include <gtest/gtest.h>

#include <filesystem>

#include "../results/phase_report_sample.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/plots/phase_plot.hpp"

namespace cloudbow {
namespace {

class PhaseReportTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file); }
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "cloudbow_test_phase_report";
};

TEST_F(PhaseReportTest, PlotIsAPng) {
  write_phase_plot(file, sample_report());
  EXPECT_GT(std::filesystem::file_size(file), 10000u);
}

TEST_F(PhaseReportTest, UnwritableFilesAreInputErrors) {
  EXPECT_THROW(write_phase_plot("/nowhere/phase.png", sample_report()), InputError);
}

}  // namespace
}  // namespace cloudbow
