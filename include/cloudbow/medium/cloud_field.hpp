// A cloud as cells of constant density: the active voxels of a grid as row spans, without the types of any file format.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace cloudbow {

/// A run of active voxels in one row (constant j, k): columns i .. i + n - 1, values at value[offset] onwards.
struct RowSpan {
  std::int32_t i;
  std::int32_t n;
  std::uint32_t offset;
};

/// Cells are boxes of cell_size_m; cell (0,0,0) has its lower corner at min_m. z is up.
struct CloudField {
  std::array<int, 3> cells{};           ///< nx, ny, nz, each >= 1
  std::array<double, 3> cell_size_m{};  ///< dx, dy, dz > 0
  std::array<double, 3> min_m{};        ///< lower corner of the box
  /// nz*ny + 1: spans of row (k, j) are spans[row_begin[k*ny+j] .. row_begin[k*ny+j+1])
  std::vector<std::uint32_t> row_begin;
  std::vector<RowSpan> spans;  ///< order: k, then j, then i ascending
  std::vector<float> value;  ///< > 0, finite; in the units of `quantity` (extinction 1/m or liquid water content g/m3)
  std::string quantity;      ///< "extinction", "liquid_water_content", or empty if the file does not say

  std::size_t active_voxels() const { return value.size(); }
  double max_m(int axis) const { return min_m[axis] + cells[axis] * cell_size_m[axis]; }
};

/// Spans from a dense array dense[(k*ny + j)*nx + i]; zeros are empty.
CloudField make_cloud_field(std::array<int, 3> cells, std::array<double, 3> cell_size_m, std::array<double, 3> min_m,
                            const std::vector<float>& dense, std::string quantity);

}  // namespace cloudbow
