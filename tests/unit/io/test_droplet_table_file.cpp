// Tables of droplets as files. Truth: the data written; tables of other programs' forms, made here value by value.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <netcdf.h>

#include <algorithm>
#include <filesystem>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/droplet_table_file.hpp"
#include "droplet_file_tools.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST_F(DropletTableFile, ReadsWhatItWrote) {
  const auto file = folder_ / "table.h5";
  write_droplet_table(file, small_table(), some_info());
  const DropletTable table = read_droplet_table(file);
  EXPECT_EQ(table.wavelength_um, 0.67);
  EXPECT_EQ(table.effective_radius_um, small_table().effective_radius_um);
  EXPECT_EQ(table.extinction_m2_per_g, small_table().extinction_m2_per_g);
  EXPECT_EQ(table.single_scattering_albedo, small_table().single_scattering_albedo);
  EXPECT_EQ(table.moments, small_table().moments);
  EXPECT_NO_THROW(read_droplet_table(file, 0.67));
  EXPECT_THAT(message(file, 0.55), AllOf(HasSubstr("table.h5"), HasSubstr("found 0.55"), HasSubstr("0.67")));
}

TEST_F(DropletTableFile, HoldsSeveralWavelengths) {
  const auto file = folder_ / "table.h5";
  DropletTable blue = small_table();
  blue.wavelength_um = 0.45;
  blue.extinction_m2_per_g = {0.26, 0.125};
  blue.moments = {{1, 0.5, 0.125, 0.01, 0.002}, {1, 0.3, 0.01}};
  DropletTableInfo blue_info = some_info();
  blue_info.refractive_index = {1.337, 1e-9};
  write_droplet_tables(file, std::vector{small_table(), blue}, std::vector{some_info(), blue_info});
  for (const DropletTable& expected : {small_table(), blue}) {
    const DropletTable table = read_droplet_table(file, expected.wavelength_um);
    EXPECT_EQ(table.wavelength_um, expected.wavelength_um);
    EXPECT_EQ(table.effective_radius_um, expected.effective_radius_um);
    EXPECT_EQ(table.extinction_m2_per_g, expected.extinction_m2_per_g);
    EXPECT_EQ(table.single_scattering_albedo, expected.single_scattering_albedo);
    EXPECT_EQ(table.moments, expected.moments);
  }
  EXPECT_THAT(message(file, 0.55), AllOf(HasSubstr("table.h5"), HasSubstr("found 0.55"), HasSubstr("nearest")));
  EXPECT_THAT(message(file, {}), HasSubstr("2 wavelengths"));
}

TEST_F(DropletTableFile, IsNetcdf4) {
  const auto file = folder_ / "table.h5";
  write_droplet_table(file, small_table(), some_info());
  int id = 0, variable = 0, dimension = 0;
  ASSERT_EQ(nc_open(file.c_str(), NC_NOWRITE, &id), NC_NOERR);
  for (const char* name : {"effective_radius", "moment", "angle"})
    EXPECT_EQ(nc_inq_dimid(id, name, &dimension), 0) << name;
  ASSERT_EQ(nc_inq_varid(id, "phase_function", &variable), NC_NOERR);
  const std::vector<double> angle = droplet_table_angles();
  std::vector<double> phase(2 * angle.size());
  ASSERT_EQ(nc_get_var_double(id, variable, phase.data()), NC_NOERR);
  nc_close(id);
  // P = 1 + 3 chi_1 + 5 chi_2 + ... straight on; alternating backwards.
  EXPECT_NEAR(phase[0], 1 + 3 * 0.25 + 5 * 0.01, 1e-6);
  EXPECT_NEAR(phase.back(), 1 - 3 * 0.25 + 5 * 0.125 - 7 * 0.003, 1e-6);
  EXPECT_EQ(angle.front(), 0);
  EXPECT_EQ(angle.back(), 180);
  EXPECT_TRUE(std::is_sorted(angle.begin(), angle.end()));
}

TEST_F(DropletTableFile, SaysWhatIsWrongWithAFile) {
  EXPECT_THAT(message(folder_ / "none.h5"), HasSubstr("no such file"));
  EXPECT_THAT(message(folder_), HasSubstr("a directory"));
  EXPECT_THAT(message(write_text("")), HasSubstr("not a table of droplets"));
  EXPECT_THAT(message(write_text("1 2 3\n")), HasSubstr("not a table of droplets"));
  EXPECT_THAT(message(write_text("\x89HDF\r\n\x1a\nand then nothing")), HasSubstr("table.txt: damaged"));
  EXPECT_THAT(message(write_text("CDF\x01 and then nothing")), HasSubstr("damaged"));

  const auto file = folder_ / "table.h5";
  write_droplet_table(file, small_table(), some_info());
  std::filesystem::resize_file(file, std::filesystem::file_size(file) / 2);
  EXPECT_THAT(message(file), HasSubstr("damaged"));
  write_droplet_table(file, small_table(), some_info());
  const hid_t handle = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  H5Ldelete(handle, "single_scattering_albedo", H5P_DEFAULT);
  H5Fclose(handle);
  EXPECT_THAT(message(file), HasSubstr("no variable 'single_scattering_albedo'"));
}

}  // namespace
}  // namespace cloudbow
