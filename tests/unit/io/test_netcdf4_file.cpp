// HDF5 as netCDF-4 requires it. Truth: what the netCDF library reads.
#include <gtest/gtest.h>
#include <netcdf.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "io/netcdf4_file.hpp"
#include "temporary_folder.hpp"

namespace cloudbow::netcdf4 {
namespace {

class Netcdf4File : public testing::Test {
 protected:
  Netcdf4File() {
    hdf5::Handle file = hdf5::create_file(folder_ / "a.nc");
    write_attributes(file, {{"title", "a cloud"}, {"count", std::int32_t{3}}, {"list", std::vector<double>{1, .5}}});
    write_coordinate(file, "x", std::vector<double>{10, 20, 30}, {{"units", "m"}});
    write_dimension(file, "point", 2);
    write_variable(file, "flux", {"point", "x"}, std::span(std::as_const(flux_)), {{"units", "W m-2"}});
    {
      const hdf5::Handle group = create_group(file, "part");
      write_dimension(group, "n", 2);
      write_variable(group, "index", {"n"}, std::span<const std::int32_t>(index_), {});
    }
    hdf5::finish_file(file);
    EXPECT_EQ(nc_open((folder_ / "a.nc").c_str(), NC_NOWRITE, &id_), NC_NOERR);
  }
  ~Netcdf4File() override { nc_close(id_); }

  int variable(const char* name) const {
    int found = -1;
    EXPECT_EQ(nc_inq_varid(id_, name, &found), NC_NOERR) << name;
    return found;
  }
  std::string text(int of, const char* name) const {
    std::size_t length = 0;
    EXPECT_EQ(nc_inq_attlen(id_, of, name, &length), NC_NOERR) << name;
    std::string value(length, ' ');
    EXPECT_EQ(nc_get_att_text(id_, of, name, value.data()), NC_NOERR) << name;
    return value;
  }

  const TemporaryFolder folder_;
  std::vector<float> flux_{1, 2, 3, 4, 5, 6};
  std::vector<std::int32_t> index_{7, -8};
  int id_ = -1;
};

TEST_F(Netcdf4File, VariablesHaveTheirDimensionsByName) {
  int rank = 0;
  std::array<int, 2> dimension{};
  ASSERT_EQ(nc_inq_varndims(id_, variable("flux"), &rank), NC_NOERR);
  ASSERT_EQ(rank, 2);
  nc_inq_vardimid(id_, variable("flux"), dimension.data());
  std::array<std::string, 2> names;
  for (std::size_t n = 0; n < 2; ++n) {
    std::array<char, NC_MAX_NAME + 1> name{};
    std::size_t length = 0;
    nc_inq_dim(id_, dimension[n], name.data(), &length);
    names[n] = name.data() + std::to_string(length);
  }
  EXPECT_EQ(names, (std::array<std::string, 2>{"point2", "x3"}));
  int found = 0;
  EXPECT_EQ(nc_inq_varid(id_, "point", &found), NC_ENOTVAR) << "a length alone is no variable";
}

TEST_F(Netcdf4File, ValuesAndAttributesAreThoseWritten) {
  std::vector<float> flux(6);
  ASSERT_EQ(nc_get_var_float(id_, variable("flux"), flux.data()), NC_NOERR);
  EXPECT_EQ(flux, flux_);
  std::vector<double> x(3);
  nc_get_var_double(id_, variable("x"), x.data());
  EXPECT_EQ(x, (std::vector<double>{10, 20, 30}));
  EXPECT_EQ(text(variable("flux"), "units"), "W m-2");
  EXPECT_EQ(text(variable("x"), "units"), "m");
  EXPECT_EQ(text(NC_GLOBAL, "title"), "a cloud");
  int count = 0;
  EXPECT_EQ(nc_get_att_int(id_, NC_GLOBAL, "count", &count), NC_NOERR);
  EXPECT_EQ(count, 3);
  std::array<double, 2> list{};
  EXPECT_EQ(nc_get_att_double(id_, NC_GLOBAL, "list", list.data()), NC_NOERR);
  EXPECT_EQ(list, (std::array<double, 2>{1, .5}));
  float fill = 0;
  EXPECT_EQ(nc_get_att_float(id_, variable("flux"), "_FillValue", &fill), NC_NOERR);
  EXPECT_TRUE(std::isnan(fill));
}

TEST_F(Netcdf4File, GroupsHaveVariablesOfTheirOwn) {
  int group = 0, index = 0;
  ASSERT_EQ(nc_inq_grp_ncid(id_, "part", &group), NC_NOERR);
  ASSERT_EQ(nc_inq_varid(group, "index", &index), NC_NOERR);
  std::vector<int> values(2);
  EXPECT_EQ(nc_get_var_int(group, index, values.data()), NC_NOERR);
  EXPECT_EQ(values, (std::vector<int>{7, -8}));
}

}  // namespace
}  // namespace cloudbow::netcdf4
