// cloud_cells CLOUD.vdb: a cloud as text, for programs that do not read VDB. The first line is "NX NY NZ DX DY DZ
// BOTTOM". The value of every cell follows, x fastest, the lowest layer first.
#include <exception>
#include <iomanip>
#include <iostream>
#include <vector>

#include "cloudbow/medium/cloud_field.hpp"
#include "cloudbow/medium/vdb_file.hpp"

int main(int argc, char** argv) {
  if (argc != 2) {
    std::cerr << "usage: cloud_cells CLOUD.vdb\n";
    return 2;
  }
  try {
    const cloudbow::CloudField field = cloudbow::read_cloud_vdb(argv[1]);
    const auto [nx, ny, nz] = field.cells;
    const auto [dx, dy, dz] = field.cell_size_m;
    std::cout << std::setprecision(9) << nx << ' ' << ny << ' ' << nz << ' ' << dx << ' ' << dy << ' ' << dz << ' '
              << field.min_m[2] << '\n';
    std::vector<float> row(nx);
    for (std::size_t r = 0; r + 1 < field.row_begin.size(); ++r) {
      row.assign(row.size(), 0.0f);
      for (auto s = field.row_begin[r]; s < field.row_begin[r + 1]; ++s) {
        const cloudbow::RowSpan& span = field.spans[s];
        for (int n = 0; n < span.n; ++n) row[span.i + n] = field.value[span.offset + n];
      }
      for (int i = 0; i < nx; ++i) std::cout << row[i] << (i + 1 < nx ? ' ' : '\n');
    }
  } catch (const std::exception& error) {
    std::cerr << error.what() << '\n';
    return 1;
  }
}
