#include "plots/cloud_outline.hpp"

#include <cstddef>
#include <functional>

namespace cloudbow {

namespace {

/// Calls use(first, end) for each run of indices in [0, count) for which `holds`.
template <class Use>
void for_each_run(int count, const std::function<bool(int)>& holds, const Use& use) {
  for (int n = 0; n < count; ++n) {
    if (!holds(n)) continue;
    const int first = n;
    while (n < count && holds(n)) ++n;
    use(first, n);
  }
}

}  // namespace

std::vector<OutlinePiece> cloud_outline(const FluxImage& image, double threshold_per_m) {
  const SectionClouds& clouds = *image.clouds;
  const int rows = static_cast<int>(clouds.row_edge_m.size()) - 1, columns = image.columns;
  const auto inside = [&](int row, int column) {
    return static_cast<double>(clouds.extinction[static_cast<std::size_t>(row) * columns + column]) > threshold_per_m;
  };
  const auto face_m = [&](int column) { return image.column_start_m + column * image.column_width_m; };
  std::vector<OutlinePiece> pieces;
  for (int row = 1; row < rows; ++row) {
    const double z = clouds.row_edge_m[row];
    for_each_run(
        columns, [&](int i) { return inside(row - 1, i) != inside(row, i); },
        [&](int first, int end) {
          pieces.push_back({face_m(first), z, face_m(end), z});
        });
  }
  for (int column = 1; column < columns; ++column) {
    const double x = face_m(column);
    for_each_run(
        rows, [&](int k) { return inside(k, column - 1) != inside(k, column); },
        [&](int first, int end) {
          pieces.push_back({x, clouds.row_edge_m[first], x, clouds.row_edge_m[end]});
        });
  }
  return pieces;
}

}  // namespace cloudbow
