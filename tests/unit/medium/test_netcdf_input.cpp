// netCDF variable by variable. Truth: the numbers of the files, by netCDF's conventions.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/file.h>
#include <unistd.h>

#include <cmath>

#include "les_test_tools.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;

TEST_F(LesImport, VariablesOfGroupsAreRead) {
  const CloudImportOptions options = with([](NetcdfBuilder& file) {
    file.group("air");
    file.variable("rho", {"z"}, "kg/m3", profile(density));
    file.variable("qc", {"z"}, "kg/kg", profile([](int) { return 7; }));  // the file's own counts
  });
  expect_truth(import_cloud(options));
}

TEST_F(LesImport, MissingValuesAreKnownInAllTheirForms) {
  const auto file_with = [&](const std::function<void(NetcdfBuilder&)>& say, double missing = 1e20) {
    return with(
        [&](NetcdfBuilder& file) {
          file.variable("qc", {"z", "y", "x"}, "g/kg", field([missing](int k, int j, int i) {
                          return k == 4 && j == 1 && i == 1 ? missing : 1e3 * water(k, j, i);
                        }));
          file.variable("rho", {"z"}, "kg/m3", profile(density));
          say(file);
        },
        false);
  };
  const std::vector<std::function<void(NetcdfBuilder&)>> ways{
      [](NetcdfBuilder& file) { file.number("qc", "missing_value", {1e20}, NC_FLOAT); },
      [](NetcdfBuilder& file) { file.number("qc", "missing_value", {1e20}, NC_DOUBLE); },
      [](NetcdfBuilder& file) {
        file.number("qc", "missing_value", {-999, 1e20}, NC_DOUBLE);
      },
      [](NetcdfBuilder& file) { file.text("qc", "missing_value", "1e20"); },
      [](NetcdfBuilder& file) {
        file.number("qc", "valid_range", {0, 50}, NC_FLOAT);
      },
      [](NetcdfBuilder& file) { file.number("qc", "valid_max", {50}, NC_FLOAT); }};
  for (const auto& way : ways) {
    CloudImportOptions options = file_with(way);
    EXPECT_THAT(error_of(options), HasSubstr("'qc': cell (1, 1, 4) has the value NaN or missing"));
    options.fill = "clear";
    const ImportedCloud cloud = import_cloud(options);
    EXPECT_EQ(cloud.field.active_voxels(), std::size_t{4 * nx * ny - 1});
    EXPECT_THAT(notes_of(cloud), HasSubstr("1 cells are missing and count as clear air"));
  }
  EXPECT_THAT(error_of(file_with([](NetcdfBuilder& file) { file.number("qc", "valid_min", {0}, NC_FLOAT); }, -9999)),
              HasSubstr("NaN or missing"));
  // Said in no way it is no water that there is.
  EXPECT_THAT(error_of(file_with([](NetcdfBuilder&) {})), HasSubstr("allowed up to 20 g/m3"));
  // Attributes that cannot be followed are not passed over.
  EXPECT_THAT(error_of(file_with([](NetcdfBuilder& file) { file.text("qc", "scale_factor", "a tenth"); })),
              HasSubstr("attribute scale_factor is not a number (found 'a tenth')"));
  EXPECT_THAT(error_of(file_with([](NetcdfBuilder& file) {
                file.number("qc", "scale_factor", {1, 2}, NC_DOUBLE);
              })),
              HasSubstr("attribute scale_factor is not one number (found 2)"));
  EXPECT_THAT(error_of(file_with([](NetcdfBuilder& file) { file.number("qc", "valid_range", {1}, NC_DOUBLE); })),
              HasSubstr("valid_range is not two numbers"));
}

TEST_F(LesImport, PackedNumbersAreValidByWhatIsStoredAndZeroToTheStep) {
  constexpr double step = 1e-7;
  double offset = 9.9997e-4;  // 0 lies between two steps, and the lower one is nearer
  const auto packed = [&](double extra, const std::function<void(NetcdfBuilder&)>& say) {
    return with(
        [&](NetcdfBuilder& file) {
          file.variable("qc", {"z", "y", "x"}, "kg kg**-1", field([&](int k, int j, int i) {
                          const double value = water(k, j, i) + (k == 4 && j == 0 && i == 0 ? extra : 0);
                          return std::floor((value - offset) / step + 0.4);
                        }),
                        NC_SHORT);
          file.number("qc", "scale_factor", {step}, NC_DOUBLE);
          file.number("qc", "add_offset", {offset}, NC_DOUBLE);
          file.variable("rho", {"z"}, "kg/m3", profile(density));
          say(file);
        },
        false);
  };
  const ImportedCloud cloud = import_cloud(packed(0, [](NetcdfBuilder&) {}));
  expect_truth(cloud, 1, 1e-3);  // a step is that much of 4e-4 kg/kg, the least water
  EXPECT_THAT(notes_of(cloud), HasSubstr("36 cells barely below 0 count as 0"));
  offset = 1.00003e-3;  // the upper one is nearer: no haze of 0.3 steps
  const ImportedCloud above = import_cloud(packed(0, [](NetcdfBuilder&) {}));
  expect_truth(above, 1, 1e-3);
  EXPECT_THAT(notes_of(above), HasSubstr("36 cells within half a step of its packing"));
  // 1.2e-3 kg/kg is stored as 2000: a range of integers is of stored numbers, one of floats of unpacked ones.
  const auto range = [](double most, nc_type type) {
    return [most, type](NetcdfBuilder& file) { file.number("qc", "valid_max", {most}, type); };
  };
  EXPECT_THAT(error_of(packed(7e-4, range(1000, NC_SHORT))), HasSubstr("cell (0, 0, 4) has the value NaN or missing"));
  EXPECT_THAT(error_of(packed(7e-4, range(1.1e-3, NC_DOUBLE))), HasSubstr("cell (0, 0, 4) has the value NaN"));
  EXPECT_EQ(import_cloud(packed(7e-4, range(1.3e-3, NC_DOUBLE))).field.active_voxels(), std::size_t{4 * nx * ny});
  // More than a step below 0 is an error.
  EXPECT_THAT(error_of(packed(-1e-3, [](NetcdfBuilder&) {})), HasSubstr("allowed: numbers >= 0, and down to"));
}

TEST_F(LesImport, ALockedFileSaysSo) {
  const CloudImportOptions options = with([](NetcdfBuilder&) {});
  const int writer = open(options.file.c_str(), O_RDWR | O_CLOEXEC);
  ASSERT_EQ(flock(writer, LOCK_EX), 0);
  EXPECT_THAT(error_of(options), HasSubstr("is locked"));
  close(writer);
  EXPECT_THAT(error_of(options), HasSubstr("air's density"));
}

}  // namespace
}  // namespace cloudbow
