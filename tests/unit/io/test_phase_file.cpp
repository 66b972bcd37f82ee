// The file of a phase function. Truth: closed forms, and the numbers of the report.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <hdf5_hl.h>

#include <cmath>

#include "../results/phase_report_sample.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/io/phase_file.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

TEST(PhaseFile, HoldsFunctionMomentsAndFits) {
  const TemporaryFolder folder;
  const std::filesystem::path file = folder / "phase.h5";
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

TEST(PhaseFile, ThatCannotBeWrittenIsAnInputError) {
  EXPECT_THROW(write_phase_file("/nowhere/phase.h5", sample_report(), "", ""), InputError);
}

}  // namespace
}  // namespace cloudbow
