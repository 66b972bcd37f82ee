#include "cloudbow/medium/cloud_field.hpp"

#include <fmt/format.h>

#include <cassert>
#include <cmath>
#include <utility>

#include "cloudbow/core/error.hpp"
#include "row_spans.hpp"

namespace cloudbow {

CloudField make_cloud_field(std::array<int, 3> cells, std::array<double, 3> cell_size_m, std::array<double, 3> min_m,
                            const std::vector<float>& dense, std::string quantity) {
  const auto [nx, ny, nz] = cells;
  assert(nx >= 1 && ny >= 1 && nz >= 1);
  assert(dense.size() == static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz));

  CloudField field;
  field.cells = cells;
  field.cell_size_m = cell_size_m;
  field.min_m = min_m;
  field.quantity = std::move(quantity);
  RowSpanWriter rows(field);
  auto value = dense.begin();
  for (int k = 0; k < nz; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i, ++value) {
        if (!std::isfinite(*value) || *value < 0) {
          throw InputError(fmt::format(
              "cloud field: cell ({}, {}, {}) has the value {} (finite numbers >= 0 are allowed)", i, j, k, *value));
        }
        if (*value > 0) rows.add(i, *value);
      }
      rows.end_row();
    }
  }
  return field;
}

}  // namespace cloudbow
