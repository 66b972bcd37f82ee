// Fills the row spans of a CloudField, voxel by voxel in the order k, j, i.
#pragma once

#include "cloudbow/medium/cloud_field.hpp"

namespace cloudbow {

class RowSpanWriter {
 public:
  explicit RowSpanWriter(CloudField& field) : field_(field) {
    field_.row_begin.assign(1, 0);
    field_.row_begin.reserve(static_cast<std::size_t>(field.cells[1]) * static_cast<std::size_t>(field.cells[2]) + 1);
  }

  void add(std::int32_t i, float value) {
    const bool extends =
        field_.spans.size() > field_.row_begin.back() && field_.spans.back().i + field_.spans.back().n == i;
    if (!extends) field_.spans.push_back({i, 0, static_cast<std::uint32_t>(field_.value.size())});
    ++field_.spans.back().n;
    field_.value.push_back(value);
  }

  void end_row() { field_.row_begin.push_back(static_cast<std::uint32_t>(field_.spans.size())); }

 private:
  CloudField& field_;
};

}  // namespace cloudbow
