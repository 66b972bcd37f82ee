#include "clouds.hpp"

#include <pybind11/numpy.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <utility>
#include <vector>

#include "cloudbow/medium/vdb_file.hpp"
#include "host.hpp"

namespace py = pybind11;

namespace cloudbow::python {
namespace {

using Dense = py::array_t<float, py::array::c_style>;

/// Names of the float grids of a file, each with its quantity and units.
std::vector<std::array<std::string, 3>> list_grids(const std::filesystem::path& file) {
  std::vector<std::array<std::string, 3>> grids;
  without_lock({py::none(), py::none()}, [&] {
    for (const VdbGridInfo& grid : describe_cloud_vdb(file).grids) {
      if (grid.type.starts_with("float")) grids.push_back({grid.name, grid.quantity, grid.units});
    }
  });
  return grids;
}

/// Calls action(first dense index, first value, count) for each span.
template <class Action>
void for_each_span(const CloudField& field, const Action& action) {
  const auto [nx, ny, nz] = field.cells;
  for (std::size_t row = 0; row < static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz); ++row) {
    for (std::size_t s = field.row_begin[row]; s < field.row_begin[row + 1]; ++s) {
      const RowSpan& span = field.spans[s];
      action(row * static_cast<std::size_t>(nx) + static_cast<std::size_t>(span.i), std::size_t{span.offset},
             static_cast<std::size_t>(span.n));
    }
  }
}

/// (values [z][y][x], cell size, lower corner, quantity, units, notes); voxels without a value have `empty`.
py::tuple read_grid(const std::filesystem::path& file, const VdbReadOptions& options, float empty) {
  VdbCloud cloud;
  without_lock({py::none(), py::none()}, [&] { cloud = read_cloud_vdb(file, options); });
  const auto [nx, ny, nz] = cloud.cells;
  Dense values({nz, ny, nx});
  float* const dense = values.mutable_data();
  std::fill_n(dense, values.size(), empty);
  for_each_span(cloud, [&](std::size_t to, std::size_t from, std::size_t count) {
    std::copy_n(cloud.value.data() + from, count, dense + to);
  });
  return py::make_tuple(values, cloud.cell_size_m, cloud.min_m, cloud.quantity, cloud.units, cloud.notes);
}

struct Grid {
  std::string name;
  std::string quantity;
  std::string units;
  Dense values;  ///< [z][y][x]
};

/// Writes the first grid, whose values > 0 are the cloud, and the others on its voxels.
void write_grids(const std::filesystem::path& file, const std::array<double, 3>& cell_size_m,
                 const std::array<double, 3>& min_m, const std::vector<Grid>& grids, bool half) {
  const Grid& first = grids.front();
  const std::array<int, 3> cells{static_cast<int>(first.values.shape(2)), static_cast<int>(first.values.shape(1)),
                                 static_cast<int>(first.values.shape(0))};
  const std::vector<float> dense(first.values.data(), first.values.data() + first.values.size());
  const CloudField field = make_cloud_field(cells, cell_size_m, min_m, dense, first.quantity);
  std::vector<VdbAuxiliary> auxiliaries;
  for (std::size_t n = 1; n < grids.size(); ++n) {
    VdbAuxiliary auxiliary{grids[n].name, grids[n].quantity, grids[n].units, {}};
    auxiliary.value.resize(field.value.size());
    const float* const from = grids[n].values.data();
    for_each_span(field, [&](std::size_t at, std::size_t to, std::size_t count) {
      std::copy_n(from + at, count, auxiliary.value.data() + to);
    });
    auxiliaries.push_back(std::move(auxiliary));
  }
  without_lock({py::none(), py::none()},
               [&] { write_cloud_vdb(file, field, {.grid = first.name, .half = half}, auxiliaries); });
}

}  // namespace

void add_clouds(py::module_& module) {
  py::class_<Grid>(module, "Grid")
      .def(py::init<std::string, std::string, std::string, Dense>(), py::arg("name"), py::arg("quantity"),
           py::arg("units"), py::arg("values"));
  module.def("list_grids", &list_grids, py::arg("file"));
  module.def(
      "read_grid",
      [](const std::filesystem::path& file, const std::string& grid, const std::string& up_axis, float empty) {
        VdbReadOptions options;
        options.grid = grid;
        options.up_axis = up_axis;
        return read_grid(file, options, empty);
      },
      py::arg("file"), py::arg("grid"), py::arg("up_axis"), py::arg("empty"));
  module.def("write_grids", &write_grids, py::arg("file"), py::arg("cell_size_m"), py::arg("min_m"), py::arg("grids"),
             py::arg("half"));
}

}  // namespace cloudbow::python
