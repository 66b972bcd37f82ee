// Turns a cloud about the vertical by quarter turns (counter-clockwise seen from above), after mirroring y if asked:
// for symmetry.py. usage: turn_cloud IN.vdb OUT.vdb QUARTER_TURNS [mirror]
#include <cstdlib>
#include <exception>
#include <iostream>
#include <string>
#include <utility>
#include <vector>

#include "cloudbow/medium/cloud_field.hpp"
#include "cloudbow/medium/vdb_file.hpp"

namespace {

using cloudbow::CloudField;

std::vector<float> dense_values(const CloudField& field) {
  const auto [nx, ny, nz] = field.cells;
  std::vector<float> dense(static_cast<std::size_t>(nx) * ny * nz, 0.0f);
  for (std::size_t row = 0; row + 1 < field.row_begin.size(); ++row) {
    for (auto s = field.row_begin[row]; s < field.row_begin[row + 1]; ++s) {
      const cloudbow::RowSpan& span = field.spans[s];
      for (int n = 0; n < span.n; ++n) dense[row * nx + span.i + n] = field.value[span.offset + n];
    }
  }
  return dense;
}

// Cell (i, j) goes to (i, ny-1-j); y to -y.
CloudField mirrored(const CloudField& field) {
  const auto [nx, ny, nz] = field.cells;
  const std::vector<float> from = dense_values(field);
  std::vector<float> to(from.size());
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        to[(static_cast<std::size_t>(k) * ny + (ny - 1 - j)) * nx + i] =
            from[(static_cast<std::size_t>(k) * ny + j) * nx + i];
  return cloudbow::make_cloud_field(field.cells, field.cell_size_m, {field.min_m[0], -field.max_m(1), field.min_m[2]},
                                    to, field.quantity);
}

// Cell (i, j) goes to (ny-1-j, i); (x, y) to (-y, x).
CloudField quarter_turned(const CloudField& field) {
  const auto [nx, ny, nz] = field.cells;
  const std::vector<float> from = dense_values(field);
  std::vector<float> to(from.size());
  for (int k = 0; k < nz; ++k)
    for (int j = 0; j < ny; ++j)
      for (int i = 0; i < nx; ++i)
        to[(static_cast<std::size_t>(k) * nx + i) * ny + (ny - 1 - j)] =
            from[(static_cast<std::size_t>(k) * ny + j) * nx + i];
  return cloudbow::make_cloud_field({ny, nx, nz}, {field.cell_size_m[1], field.cell_size_m[0], field.cell_size_m[2]},
                                    {-field.max_m(1), field.min_m[0], field.min_m[2]}, to, field.quantity);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 4) {
    std::cerr << "usage: turn_cloud IN.vdb OUT.vdb QUARTER_TURNS [mirror]\n";
    return 2;
  }
  try {
    CloudField field = cloudbow::read_cloud_vdb(argv[1]);
    if (argc > 4 && std::string(argv[4]) == "mirror") field = mirrored(field);
    for (int turn = std::atoi(argv[3]); turn > 0; --turn) field = quarter_turned(field);
    cloudbow::write_cloud_vdb(argv[2], field);
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
