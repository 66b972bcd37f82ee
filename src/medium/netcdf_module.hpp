// The module cloudbow_netcdf, for netcdf_library.cpp.
#pragma once

#include "cloudbow/medium/netcdf_library.hpp"

/// The module's one symbol.
extern "C" const cloudbow::NetcdfLibrary cloudbow_netcdf_module;
