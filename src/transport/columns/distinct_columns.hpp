// Contents of columns that exchange no diffuse light, and the groups of equal ones.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "cloudbow/transport/solution.hpp"
#include "transport/columns/polar_streams.hpp"

namespace cloudbow {

// The active cells of each column, from the bottom up.
struct ColumnCells {
  std::vector<std::uint32_t> begin;  // [columns + 1]
  std::vector<std::uint32_t> cell;   // [n]
  std::vector<std::uint32_t> level_cell;

  std::span<const std::uint32_t> of(std::size_t column) const {
    return {cell.data() + begin[column], cell.data() + begin[column + 1]};
  }
};

ColumnCells column_cells(const OpticalGrid& grid);

// The beam, if it crosses columns.
struct SlantedBeam {
  std::vector<float> irradiance;  // mean in each active cell, for scattering; `everywhere`: in each cell of the box
  bool everywhere;
  std::vector<double> carried;  // [nz+1][columns] flux that the streams count as unscattered
  std::vector<double> direct;   // [nz+1][columns] by the true extinction
  double side_gain;
  double side_loss;

  double at(std::size_t cell, std::size_t place) const {
    return static_cast<double>(irradiance[everywhere ? place : cell]);
  }
};

/// Empty without sun, or if the beam stays in its column.
std::optional<SlantedBeam> slanted_beam(const Problem& problem, const SolverOptions& options,
                                        const PolarStreams& streams);

// Groups of equal columns: `first` are those that are solved.
struct DistinctColumns {
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> next;  // [columns] the next equal one; itself: none
};

/// Columns whose fluxes depend on the same numbers are equal.
DistinctColumns distinct_columns(const Problem& problem, const ColumnCells& cells,
                                 const std::optional<SlantedBeam>& beam);

}  // namespace cloudbow
