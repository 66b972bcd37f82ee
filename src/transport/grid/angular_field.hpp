// Values by direction and cell: the large array of a solve. On request it is kept as half-precision numbers (IEEE 754
// binary16), which kernels read and write by blocks.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "transport/grid/lanes.hpp"

namespace cloudbow {

/// Converts float16 numbers [n], times `unit`, and back. Beyond 65504 units the largest number is stored; below 2^-25
/// units zero.
void load_float16(const std::uint16_t* from, std::size_t n, float unit, float* to);
/// Numbers are rounded up or down so that their mean is conserved. If similar numbers were all rounded to the nearest,
/// energy would not be conserved. The rounding of a number depends on it and its index alone, so an iteration that
/// stores converges. @param place of the first.
void store_float16(const float* from, std::size_t n, float unit, std::uint32_t place, std::uint16_t* to);

/// One row of a field, [cells].
template <class Real>
struct FieldRow {
  const Real* plain = nullptr;
  const std::uint16_t* packed = nullptr;  ///< instead
  Real unit = 1;

  /// The values [first, first + n), copied to `room` [n] if they are packed.
  const Real* read(std::size_t first, std::size_t n, Real* room) const {
    if (packed == nullptr) return plain + first;
    if constexpr (sizeof(Real) == sizeof(float)) load_float16(packed + first, n, unit, room);
    return room;
  }
};

/// D values per cell, one row per ordinate. Holds source or voxel-mean radiance; each overwrites the other. Plain rows,
/// value(d, c) at row(d)[c], can be read and written beyond their end: by lane_padding, and to the end of a tile. A
/// rank holds all rows of a range of cells, or some rows of all cells.
template <class Real>
struct AngularField {
  int rows = 0;
  std::size_t cells = 0;                            ///< of each row
  std::size_t first_cell = 0;                       ///< of them, among all; a multiple of 128
  std::size_t all_cells = 0;                        ///< number of all
  std::vector<std::vector<Real>> data;              ///< [rows][at least cells + lane_padding], or empty and
  std::vector<std::vector<std::uint16_t>> float16;  ///< [rows][as above], numbers of units; never with Real = double
  Real unit = 1;                                    ///< that of the float16 values, a power of two

  AngularField() = default;
  AngularField(int row_count, std::size_t cell_count, std::optional<Real> float16_unit = std::nullopt)
      : cells(cell_count), all_cells(cell_count), unit(float16_unit.value_or(1)) {
    if (float16_unit) float16.resize(1);
    set_rows(row_count);
  }

  bool packed() const { return !float16.empty(); }
  /// Rows, for plain fields only.
  Real* row(int d) { return data[d].data(); }
  const Real* row(int d) const { return data[d].data(); }
  FieldRow<Real> stored_row(int d) const {
    return packed() ? FieldRow<Real>{nullptr, float16[d].data(), unit} : FieldRow<Real>{data[d].data(), nullptr, 1};
  }
  /// Stores `from` [n] in row d, from cell `first` on. For packed fields only.
  void store(int d, std::size_t first, std::size_t n, const Real* from) {
    if constexpr (sizeof(Real) == sizeof(float)) {
      const std::uint32_t place =
          static_cast<std::uint32_t>(first_cell + first) + static_cast<std::uint32_t>(d) * place_step;
      store_float16(from, n, unit, place, float16[d].data() + first);
    }
  }
  /// Rows are dropped or added, zero.
  void set_rows(int count) {
    rows = count;
    const auto set = [&](auto& of) {
      of.resize(count);
      for (auto& row : of) row.resize(padded(cells));
    };
    if (packed()) {
      set(float16);
    } else {
      set(data);
    }
  }

  static constexpr std::uint32_t place_step = 0x85EBCA6B;  // rows are rounded apart from each other
  static constexpr std::size_t tile = 64;
  static std::size_t padded(std::size_t cell_count) { return (cell_count + tile - 1) / tile * tile + lane_padding; }
};

}  // namespace cloudbow
