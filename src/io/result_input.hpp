// A result file read back: its grid and what it holds by cells.
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "cloudbow/medium/optical_grid.hpp"
#include "cloudbow/sphere/control_points.hpp"
#include "cloudbow/sphere/direction.hpp"
#include "io/hdf5_handle.hpp"

namespace cloudbow {

/// Indices i, j, k of a cell.
using CellIndex = std::array<std::int32_t, 3>;

/// Every function throws InputError if the file lacks or contradicts the requested data, hdf5::Error if it is damaged.
class ResultInput {
 public:
  /// @throws InputError if the file is missing, is not one of cloudbow run, or holds several wavelengths.
  explicit ResultInput(const std::filesystem::path& path);

  const BoxGrid& box() const { return box_; }

  /// A variable of shape (z, y, x). @param field of output.fields that makes it, for the message if it is missing.
  std::vector<float> cell_field(const char* name, const char* field) const;
  bool has(const char* name) const { return hdf5::exists(file_, name); }
  /// Of a variable; `otherwise` if it has none.
  std::string units(const char* name, const char* otherwise) const;

 private:
  friend class RadianceFieldInput;
  void read_box();
  std::vector<double> coordinate(const char* name) const;
  [[noreturn]] void fail(const std::string& problem) const;

  std::string path_;
  hdf5::Handle file_;
  BoxGrid box_;
};

/// The group radiance_field. The part of its largest variable that is read at once is bounded.
class RadianceFieldInput {
 public:
  explicit RadianceFieldInput(const ResultInput& result);

  const std::vector<Direction>& directions() const { return direction_; }
  const std::vector<CellIndex>& cells() const { return cell_; }

  /// The corners of the triangle that holds the direction, and their weights (theory.md, Eq. 9).
  Stencil stencil(const Direction& unit) const;
  /// Radiance of each cell in the direction of the stencil.
  std::vector<float> radiance(const Stencil& stencil) const;
  /// Radiances at control points first to first + count - 1: [count][cells].
  std::vector<float> radiances(std::size_t first, std::size_t count) const;

 private:
  template <class Use>
  void for_each_cell(Use use) const;

  const ResultInput& result_;
  hdf5::Handle dataset_;
  std::vector<Direction> direction_;
  std::vector<std::array<std::int32_t, 3>> triangle_;
  std::vector<CellIndex> cell_;
};

}  // namespace cloudbow
