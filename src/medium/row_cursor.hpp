// Finds the voxels of one row of a cloud.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>

#include "cloudbow/medium/cloud_field.hpp"

namespace cloudbow {

/// The voxels of row (k, j), asked for from left to right. A row beyond the box has none.
class RowCursor {
 public:
  RowCursor() = default;
  RowCursor(const CloudField& cloud, int k, int j) : cloud_(&cloud) {
    if (k < 0 || k >= cloud.cells[2] || j < 0 || j >= cloud.cells[1]) return;
    const std::size_t row = static_cast<std::size_t>(k) * static_cast<std::size_t>(cloud.cells[1]) + j;
    span_ = cloud.row_begin[row];
    end_ = cloud.row_begin[row + 1];
  }
  /// Index into CloudField::value; none if the voxel is clear. @param i not less than in the call before
  std::optional<std::size_t> voxel(int i) {
    while (span_ < end_ && cloud_->spans[span_].i + cloud_->spans[span_].n <= i) ++span_;
    if (span_ == end_ || cloud_->spans[span_].i > i) return std::nullopt;
    return cloud_->spans[span_].offset + static_cast<std::size_t>(i - cloud_->spans[span_].i);
  }

 private:
  const CloudField* cloud_ = nullptr;
  std::uint32_t span_ = 0;
  std::uint32_t end_ = 0;
};

}  // namespace cloudbow
