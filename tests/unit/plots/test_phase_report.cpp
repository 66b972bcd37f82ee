#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5_hl.h>

#include <cmath>
#include <filesystem>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/phase_file.hpp"
#include "cloudbow/optics/delta_m.hpp"
#include "cloudbow/plots/phase_plot.hpp"

namespace cloudbow {
namespace {

using testing::HasSubstr;

PhaseReport sample_report(double g = 0.5) {
  const ControlPoints points(42);
  const auto phase = PhaseFunction::henyey_greenstein(g);
  const DeltaM scaled = delta_m(phase, 6);
  const OrdinateSet ordinates = make_ordinate_set("double-gauss-6x8");
  const std::vector<PhaseFitMethod> methods = {PhaseFitMethod::least_squares, PhaseFitMethod::linear_programming};
  PhaseReport report{"sample", 6, scaled.forward_fraction, points, ordinates.name, {}, {}};
  for (const auto& [name, function] : {std::pair("raw", phase), std::pair("delta-M", scaled.truncated)}) {
    report.functions.push_back({name, function, fit_phase_function(function, points, ordinates, methods, {})});
  }
  return report;
}

class PhaseReportTest : public testing::Test {
 protected:
  void TearDown() override { std::filesystem::remove(file); }
  const std::filesystem::path file = std::filesystem::temp_directory_path() / "cloudbow_test_phase_report";
};

TEST_F(PhaseReportTest, FileHoldsFunctionMomentsAndFits) {
  const PhaseReport report = sample_report();
  write_phase_file(file, report, "cloudbow", "then");
  const hid_t id = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(id, 0);
  std::vector<double> angle(721), value(721), fitted(42);
  ASSERT_GE(H5LTread_dataset_double(id, "raw/angle", angle.data()), 0);
  ASSERT_GE(H5LTread_dataset_double(id, "raw/phase_function", value.data()), 0);
  EXPECT_EQ(angle[360], 180);
  EXPECT_NEAR(value[360], 0.5 / 2.25, 1e-14);  // (1-g)/(1+g)^2
  ASSERT_GE(H5LTread_dataset_double(id, "delta_m/value_linear_programming", fitted.data()), 0);
  for (int m = 0; m < 42; ++m) EXPECT_EQ(fitted[m], report.functions[1].fits[1].value[m]);
  double error = 0, f = 0;
  ASSERT_GE(H5LTget_attribute_double(id, "raw/fit_least_squares", "max_error", &error), 0);
  EXPECT_EQ(error, report.functions[0].fits[0].errors.max_error);
  ASSERT_GE(H5LTget_attribute_double(id, ".", "forward_fraction", &f), 0);
  EXPECT_NEAR(f, std::pow(0.5, 6), 1e-16);
  H5Fclose(id);
}

TEST_F(PhaseReportTest, TableNamesWhatIsInfeasible) {
  EXPECT_THAT(phase_table(sample_report()), Not(HasSubstr("infeasible")));
  EXPECT_THAT(phase_table(sample_report(0.95)), HasSubstr("linear-programming: moments l <= 3 are infeasible"));
}

TEST_F(PhaseReportTest, PlotIsAPng) {
  write_phase_plot(file, sample_report());
  EXPECT_GT(std::filesystem::file_size(file), 10000u);
}

TEST_F(PhaseReportTest, UnwritableFilesAreInputErrors) {
  EXPECT_THROW(write_phase_file("/nowhere/phase.h5", sample_report(), "", ""), InputError);
  EXPECT_THROW(write_phase_plot("/nowhere/phase.png", sample_report()), InputError);
}

}  // namespace
}  // namespace cloudbow
