// One solve shared by ranks (docs/mpi.md, "One solve"). Each rank marches the ordinates of some octants through all
// cells. It scatters the light of all ordinates in a range of cells.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <vector>

#include "cloudbow/core/ranks.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"
#include "transport/grid/angular_field.hpp"
#include "transport/system/ground.hpp"
#include "transport/system/source_slopes.hpp"

namespace cloudbow {

class OrdinateShare {
 public:
  /// @param cells number of all
  OrdinateShare(Ranks& ranks, const OrdinateSet& ordinates, std::size_t cells);

  Ranks& ranks() const { return *ranks_; }
  /// Whether this rank marches the ordinate.
  bool has(int ordinate) const { return owner_[ordinate] == ranks_->rank(); }

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

  /// Every rank gets the values that the others have in their cells. @param sets of all cells, in sequence
  template <class Real>
  void gather_cells(std::span<Real> sets) const;
  /// Arrays of which every rank has those of its ordinates become known to all. @param of_ordinate [D], each of the
  /// same size at all ranks
  template <class Value>
  void gather_ordinates(std::span<const std::span<Value>> of_ordinate) const;
  /// Slopes of the radiance in each octant become known to all.
  template <class Real>
  void gather_octants(LightSlopes<Real>& slopes) const;

 private:
  int owner_of_octant(int octant) const;
  template <class Rows>
  void exchange_rows(Rows& rows, bool to_cells) const;

  Ranks* ranks_;
  std::vector<int> owner_;                 // [D]
  std::vector<std::vector<int>> of_rank_;  // [ranks] its ordinates, ascending
  std::size_t most_ = 0;                   // ordinates of a rank
  std::vector<std::size_t> begin_;         // [ranks + 1] cells
};

}  // namespace cloudbow
