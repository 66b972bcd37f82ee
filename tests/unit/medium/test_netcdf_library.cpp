// The functions of netCDF that the program calls. Truth: the library's own, which this test links.
#include <gmock/gmock.h>
#include <netcdf.h>

#include "cloudbow/medium/netcdf_library.hpp"

namespace cloudbow {
namespace {

TEST(NetcdfLibraryTest, FunctionsAreThoseOfNetcdf) {
  const NetcdfLibrary& library = netcdf_library();
  EXPECT_STREQ(library.strerror(NC_EBADDIM), nc_strerror(NC_EBADDIM));
  int file = 0;
  EXPECT_NE(library.open("/there/is/no/such/file.nc", NC_NOWRITE, &file), NC_NOERR);
  EXPECT_EQ(&library, &netcdf_library());
}

}  // namespace
}  // namespace cloudbow
