#include "cloudbow/medium/joined_fields.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <limits>

#include "cloudbow/core/available_memory.hpp"
#include "cloudbow/core/error.hpp"
#include "row_cursor.hpp"
#include "row_spans.hpp"

namespace cloudbow {
namespace {

constexpr double shift_tolerance = 1e-3;  // of a voxel, as of the faces of domains

double faces_between(const CloudField& from, const CloudField& to, int axis) {
  return (to.min_m[axis] - from.min_m[axis]) / from.cell_size_m[axis];
}

/// Moves a field into a larger box. @param first cell of the box, counted from the field's
void put_into_box(CloudField& field, const std::array<std::int64_t, 3>& first, const CloudField& box) {
  if (field.cells != box.cells) {
    std::vector<std::uint32_t> row_begin{0};
    row_begin.reserve(static_cast<std::size_t>(box.cells[1]) * static_cast<std::size_t>(box.cells[2]) + 1);
    for (std::int64_t k = first[2]; k < first[2] + box.cells[2]; ++k) {
      for (std::int64_t j = first[1]; j < first[1] + box.cells[1]; ++j) {
        const bool is_row = k >= 0 && k < field.cells[2] && j >= 0 && j < field.cells[1];
        row_begin.push_back(is_row ? field.row_begin[static_cast<std::size_t>(k * field.cells[1] + j + 1)]
                                   : row_begin.back());
      }
    }
    field.row_begin = std::move(row_begin);
    for (RowSpan& span : field.spans) span.i -= static_cast<std::int32_t>(first[0]);
  }
  field.cells = box.cells;
  field.cell_size_m = box.cell_size_m;
  field.min_m = box.min_m;
}

}  // namespace

std::optional<std::string> difference_of_voxels(const CloudField& field, const CloudField& other) {
  for (int axis = 0; axis < 3; ++axis) {
    const double here = field.cell_size_m[axis], there = other.cell_size_m[axis];
    // Over all cells of the axis the sizes may drift apart by the tolerance.
    const double drift = std::abs(here / there - 1) * std::max(field.cells[axis], other.cells[axis]);
    const double faces = faces_between(other, field, axis);
    const double shift = std::abs(faces - std::nearbyint(faces));
    constexpr double farthest = 2e9;  // faces that 32 bits count
    if (drift <= shift_tolerance && shift <= shift_tolerance && std::abs(faces) < farthest) continue;
    return fmt::format("along {} voxels of {:.10g} m with a face at {:.10g} m; of the other {:.10g} m and {:.10g} m",
                       "xyz"[axis], here, field.min_m[axis], there, other.min_m[axis]);
  }
  return std::nullopt;
}

void share_box(std::span<CloudField* const> fields) {
  if (fields.size() < 2) return;
  std::vector<std::array<std::int64_t, 3>> first(fields.size());
  CloudField box;
  box.cell_size_m = fields[0]->cell_size_m;
  for (int axis = 0; axis < 3; ++axis) {
    std::int64_t low = 0, end = 0;
    for (std::size_t n = 0; n < fields.size(); ++n) {
      first[n][axis] = std::llround(faces_between(*fields[0], *fields[n], axis));
      if (n == 0 || first[n][axis] < low) {
        low = first[n][axis];
        box.min_m[axis] = fields[n]->min_m[axis];
      }
      end = std::max(end, first[n][axis] + fields[n]->cells[axis]);
    }
    if (end - low > std::numeric_limits<std::int32_t>::max()) {
      throw InputError(fmt::format("too far apart (found a box of {} cells along {}, allowed {})", end - low,
                                   "xyz"[axis], std::numeric_limits<std::int32_t>::max()));
    }
    box.cells[axis] = static_cast<int>(end - low);
    for (auto& of_field : first) of_field[axis] = low - of_field[axis];
  }
  const double bytes =
      static_cast<double>(box.cells[1]) * box.cells[2] * sizeof(std::uint32_t) * static_cast<double>(fields.size() + 1);
  const double allowed = static_cast<double>(available_memory_bytes()) / 2;
  if (bytes > allowed) {
    throw InputError(
        fmt::format("too far apart (found a box of {} x {} x {} cells that takes {:.3g} GB, allowed "
                    "{:.3g} GB)",
                    box.cells[0], box.cells[1], box.cells[2], bytes * 1e-9, allowed * 1e-9));
  }
  for (std::size_t n = 0; n < fields.size(); ++n) put_into_box(*fields[n], first[n], box);
}

CloudField sum_of(std::span<const CloudField* const> fields) {
  CloudField sum;
  sum.cells = fields[0]->cells;
  sum.cell_size_m = fields[0]->cell_size_m;
  sum.min_m = fields[0]->min_m;
  sum.quantity = fields[0]->quantity;
  RowSpanWriter rows(sum);
  std::vector<double> row(static_cast<std::size_t>(sum.cells[0]), 0.);
  std::vector<std::int32_t> filled;
  for (std::size_t r = 0; r + 1 < fields[0]->row_begin.size(); ++r) {
    for (const CloudField* field : fields) {
      assert(field->cells == sum.cells);
      for (std::uint32_t s = field->row_begin[r]; s < field->row_begin[r + 1]; ++s) {
        const RowSpan& span = field->spans[s];
        const float* value = field->value.data() + span.offset;
        for (std::int32_t i = span.i; i < span.i + span.n; ++i, ++value) {
          double& of_voxel = row[static_cast<std::size_t>(i)];
          if (of_voxel == 0) filled.push_back(i);
          of_voxel += static_cast<double>(*value);
        }
      }
    }
    std::sort(filled.begin(), filled.end());
    for (const std::int32_t i : filled) {
      rows.add(i, static_cast<float>(row[static_cast<std::size_t>(i)]));
      row[static_cast<std::size_t>(i)] = 0;
    }
    filled.clear();
    rows.end_row();
  }
  return sum;
}

std::vector<std::size_t> places_in(const CloudField& all, const CloudField& field) {
  assert(all.cells == field.cells);
  std::vector<std::size_t> places;
  places.reserve(field.active_voxels());
  for (int k = 0; k < field.cells[2]; ++k) {
    for (int j = 0; j < field.cells[1]; ++j) {
      RowCursor cursor(all, k, j);
      const std::size_t row = static_cast<std::size_t>(k) * static_cast<std::size_t>(field.cells[1]) + j;
      for (std::uint32_t s = field.row_begin[row]; s < field.row_begin[row + 1]; ++s) {
        const RowSpan& span = field.spans[s];
        for (std::int32_t i = span.i; i < span.i + span.n; ++i) places.push_back(cursor.voxel(i).value());
      }
    }
  }
  return places;
}

}  // namespace cloudbow
