// One solve shared by ranks (docs/mpi.md, "One solve"). Each rank marches the light of some octants through all cells.
// It scatters the light of all ordinates in a range of cells, and keeps the moments of these.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "cloudbow/core/ranks.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"
#include "transport/grid/angular_field.hpp"
#include "transport/system/ground.hpp"
#include "transport/system/source_slopes.hpp"

namespace cloudbow {

/// Cells [first, last) among all.
struct CellRange {
  std::size_t first = 0;
  std::size_t last = 0;

  std::size_t size() const { return last - first; }
};

class OrdinateShare {
 public:
  /// Ranges of cells begin at multiples of this: the largest tile of a scattering, and the block of ordered sums.
  static constexpr std::size_t block_cells = 128;

  /// @param cells number of all
  OrdinateShare(Ranks& ranks, const OrdinateSet& ordinates, std::size_t cells);

  Ranks& ranks() const { return *ranks_; }
  bool is_first() const { return ranks_->is_first(); }
  /// Whether this rank marches the ordinate, and light of the octant.
  bool has(int ordinate) const { return owner_[ordinate] == ranks_->rank(); }
  bool has_octant(int octant) const { return owner_of_octant(octant) == ranks_->rank(); }
  /// Rank that marches light of the octant.
  int owner_of_octant(int octant) const;
  /// The cells of this rank.
  CellRange range() const;

  /// All rows of this rank's cells, zero.
  template <class Real>
  AngularField<Real> own_cells(std::optional<Real> float16_unit) const;

  /// A field of all rows of this rank's cells becomes one of its rows of all cells; other rows are empty. Row by row,
  /// so that it takes little more memory than the larger of both.
  template <class Real>
  void to_rows(AngularField<Real>& field) const;
  /// And back.
  template <class Real>
  void to_cells(AngularField<Real>& field) const;
  /// All rows of all cells at the first rank; nothing at the others.
  template <class Real>
  void to_first(AngularField<Real>& field) const;
  /// A field of all rows of this rank's cells becomes one of some rows of all cells; other rows are empty.
  /// @param needs [ranks][rows] whether that rank gets that row
  template <class Real>
  void to_needed_rows(AngularField<Real>& field, const std::vector<std::vector<bool>>& needs) const;

  /// Values [own cells] of every rank become known to all. @param all [cells]
  template <class Real>
  void gather_cells(std::span<const Real> own, std::span<Real> all) const;
  /// Values [own cells] become those of all cells at the first rank, and none at the others.
  template <class Real>
  void cells_to_first(std::vector<Real>& own) const;
  /// Values of every rank's blocks of block_cells cells, in the order of the blocks.
  std::vector<double> gather_blocks(std::span<const double> own) const;
  /// Arrays of which every rank has those of its ordinates become known to all. @param of_ordinate [D], each of the
  /// same size at all ranks
  template <class Value>
  void gather_ordinates(std::span<const std::span<Value>> of_ordinate) const;
  /// Arrays by octant, of which every rank has those of its octants, become known to all. @param of_octant [octants]
  template <class Value>
  void gather_octants(std::span<const std::span<Value>> of_octant) const;
  /// The values of the first rank become those of all.
  template <class Value>
  void from_first(std::span<Value> values) const;

  /// Slopes of the rank's octants [all cells] become those of all octants [own cells].
  template <class Real>
  void octants_to_cells(std::array<Slope<Real>, octants>& slopes) const;
  /// And back.
  template <class Real>
  void octants_to_rows(std::array<Slope<Real>, octants>& slopes) const;
  /// Slopes of all octants [own cells] become those of all cells at the first rank, and none at the others.
  template <class Real>
  void cells_to_first(std::array<Slope<Real>, octants>& slopes) const;
  /// Slopes of the rank's octants [all cells] are sent to the first rank, which then has those of all octants.
  template <class Real>
  void rows_to_first(std::array<Slope<Real>, octants>& slopes) const;

 private:
  template <class Rows>
  void exchange_rows(Rows& rows, bool to_cells) const;
  template <class Array>
  void collect(int rank, Array& values, std::size_t size) const;
  template <class Value>
  void gather_owned(std::span<const std::span<Value>> arrays, const std::function<int(int)>& owner) const;

  Ranks* ranks_;
  std::vector<int> owner_;                 // [D]
  std::vector<std::vector<int>> of_rank_;  // [ranks] its ordinates, ascending
  std::size_t most_ = 0;                   // ordinates of a rank
  std::vector<std::size_t> begin_;         // [ranks + 1] cells
};

}  // namespace cloudbow
