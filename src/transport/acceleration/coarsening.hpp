// A problem's cells in pairs along each axis. The low-order correction works on them if cells are optically thin
// enough.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "transport/system/sweep.hpp"

namespace cloudbow {

template <class Real>
struct Coarsening {
  OpticalGrid grid;                        ///< coefficients with truncated peaks, means over the volume
  std::vector<std::uint32_t> coarse_cell;  ///< [n] for each cell of the problem
  /// [n] place of its centre from the coarse cell's along x, y, z, in quarters of the coarse cell.
  std::vector<std::array<std::int8_t, 3>> quarters;
  std::vector<Real> share;  ///< [n] of the coarse cell's extinction, times volume, that is this cell's
};

/// @returns nothing if it does not pay or would not work: few cells, columns that exchange no light, or coarse cells
/// that light does not cross freely.
template <class Real>
std::optional<Coarsening<Real>> coarsen(const TransportSystem<Real>& system);

}  // namespace cloudbow
