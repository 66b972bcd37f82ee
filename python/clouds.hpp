// Clouds in OpenVDB files as arrays.
#pragma once

#include <pybind11/pybind11.h>

namespace cloudbow::python {

/// Adds list_grids, read_grid and write_grids.
void add_clouds(pybind11::module_& module);

}  // namespace cloudbow::python
