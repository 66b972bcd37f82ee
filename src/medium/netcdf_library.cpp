#include "cloudbow/medium/netcdf_library.hpp"

#include "cloudbow/core/module.hpp"
#include "netcdf_module.hpp"

namespace cloudbow {

const NetcdfLibrary& netcdf_library() {
  static const void* const symbol = load_module("cloudbow_netcdf.so", "cloudbow_netcdf_module",
                                                {"netCDF", "reads netCDF files", 20'000'000, 0, false});
  return *static_cast<const NetcdfLibrary*>(symbol);
}

}  // namespace cloudbow
