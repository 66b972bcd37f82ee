// Light of blocks of air in the rays of one segment.
#pragma once

#include <cstddef>

#include "transport/rays/march.hpp"

namespace cloudbow {

/// All blocks of a level have the same optical path along a segment, and each has one source.
template <bool linear, class Real>
class AirSource {
 public:
  /// @param extinction 1/m of the level's air. @param cells, sent of the level and its source; its first cell is
  /// `first_cell`.
  AirSource(const SegmentGeometry<Real>& geometry, Real extinction, const CellView<Real>& cells, const Real* sent,
            std::size_t first_cell)
      : g_(geometry),
        crossing_(optical_path(extinction, geometry.length)),
        cells_(cells),
        sent_(sent),
        first_cell_(first_cell) {}

  /// The share of the entering light that does not leave.
  Real absorbed() const { return crossing_.absorbed(); }
  /// Light of a block that leaves the segment (docs/theory.md, Eq. 20). @param backwards the march goes against it.
  Real emission(std::size_t cell, bool backwards) const {
    Real emitted = crossing_.phi.phi1;
    if constexpr (linear) {
      const std::size_t c = cell - first_cell_;
      const Real x = cells_.gradient[0][c], y = cells_.gradient[1][c], z = cells_.gradient[2][c];
      const Real from = g_.at_entry(x, y, z), to = g_.at_exit(x, y, z);
      emitted = backwards ? crossing_.emitted(to, from) : crossing_.emitted(from, to);
    }
    return crossing_.t * sent_[cell - first_cell_] * emitted;
  }

 private:
  SegmentGeometry<Real> g_;
  Crossing<Real> crossing_;
  CellView<Real> cells_;
  const Real* sent_;
  std::size_t first_cell_;
};

}  // namespace cloudbow
