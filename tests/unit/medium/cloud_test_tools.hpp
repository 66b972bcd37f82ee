// Functions that the tests of clouds share.
#pragma once

#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/cloud_field.hpp"

namespace cloudbow {

/// Cell (i, j, k) at (k*ny + j)*nx + i; checks on the way that the spans are well formed.
inline std::vector<float> to_dense(const CloudField& field) {
  const auto [nx, ny, nz] = field.cells;
  std::vector<float> dense(static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz),
                           0.0F);
  const std::size_t rows = static_cast<std::size_t>(ny) * static_cast<std::size_t>(nz);
  EXPECT_EQ(field.row_begin.size(), rows + 1);
  EXPECT_EQ(field.row_begin.front(), 0U);
  EXPECT_EQ(field.row_begin.back(), field.spans.size());
  std::size_t offset = 0;
  for (std::size_t row = 0; row < rows; ++row) {
    int free = 0;  // a span that starts at the end of another should have been the same span
    for (auto s = field.row_begin[row]; s < field.row_begin[row + 1]; ++s) {
      const auto& span = field.spans[s];
      EXPECT_EQ(span.offset, offset);
      EXPECT_GE(span.i, free);
      EXPECT_GE(span.n, 1);
      EXPECT_LE(span.i + span.n, nx);
      for (int i = span.i; i < span.i + span.n; ++i)
        dense[row * static_cast<std::size_t>(nx) + static_cast<std::size_t>(i)] = field.value[offset++];
      free = span.i + span.n + 1;
    }
  }
  EXPECT_EQ(offset, field.value.size());
  return dense;
}

/// Vertical sums of value * dz, columns in the order j, i.
inline std::vector<double> column_depths(const CloudField& field) {
  const auto dense = to_dense(field);
  std::vector<double> depths(static_cast<std::size_t>(field.cells[0]) * static_cast<std::size_t>(field.cells[1]), 0.0);
  for (std::size_t n = 0; n < dense.size(); ++n)
    depths[n % depths.size()] += static_cast<double>(dense[n]) * field.cell_size_m[2];
  return depths;
}

/// The message of the InputError that the call throws.
template <class Function>
std::string message_of(Function function) {
  try {
    function();
  } catch (const InputError& error) {
    return error.what();
  }
  ADD_FAILURE() << "no InputError was thrown";
  return "";
}

}  // namespace cloudbow
