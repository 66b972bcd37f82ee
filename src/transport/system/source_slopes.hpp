// Slopes of the source within cells, from the spatial moments of the light itself (docs/theory.md, "Slopes within
// cells"). In a cell that light enters from a side, the source falls within the first metres; differences between
// neighbours do not see that. So each octant of ordinates has the slope of its own light, and the direct beam its own.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "transport/grid/octants.hpp"
#include "transport/rays/direct_beam.hpp"
#include "transport/rays/ordinate_path.hpp"
#include "transport/scattering/ordinate_scattering.hpp"

namespace cloudbow {

/// [n + lane_padding] slopes from face to face along x, y, z.
template <class Real>
using Slope = std::array<std::vector<Real>, 3>;

/// Slopes in each octant between two sweeps, in all cells. A rank that shares the solve has those of the source in its
/// octants alone, and those of the radiance in its cells alone.
template <class Real>
struct LightSlopes {
  /// Of the multiply scattered source towards each octant, relative to it.
  std::array<Slope<Real>, octants> of_octant;
  /// Of the radiance in each octant, W m-2 sr-1 from face to face; may be empty if sweeps leave them as they are.
  std::array<Slope<Real>, octants> of_radiance;
  bool fitted = false;  ///< false: sweeps take differences between neighbours in their place
  bool frozen = true;   ///< sweeps leave them as they are; false: they find them anew
};

/// Tables for slopes, which stay the same during the iteration.
template <class Real>
class SlopeTables {
 public:
  SlopeTables(const BoxGrid& box, const Cells<Real>& cells, const OrdinateSet& ordinates,
              const std::vector<OrdinatePath>& paths, std::span<const DenseMatrix<Real>> scattering, Slope<Real> beam,
              VaryingAxes varying);

  /// Of the direct beam's irradiance, relative to it.
  const Slope<Real>& beam() const { return beam_; }

  /// Slopes of zero.
  LightSlopes<Real> none(std::size_t cells) const;

  /// Slopes of the radiance of an octant from its first moments, which are summed over its ordinates with their
  /// weights. Called by all threads of a team.
  void team_fit(const ActiveRows& rows, int octant, const Slope<Real>& moment, Slope<Real>& slope) const;

  /// Slopes of the source that this radiance makes in its cells, from those of the radiance in the same cells.
  void scatter(const Cells<Real>& cells, const AngularField<Real>& radiance, LightSlopes<Real>& slopes) const;

 private:
  struct Spread {  // second moments of the places of an octant's rays, summed over its ordinates with their weights
    double weight = 0;
    std::vector<Eigen::Matrix3d> by_level;  // [nz] of marches along z
    // Of marches sideways, by run of even levels: [nx], [ny] of those along x, y; empty: none.
    std::vector<std::array<std::vector<Eigen::Matrix3d>, 2>> by_sheet;
  };
  OrdinateSet ordinates_;
  std::vector<int> run_of_level_;  // [nz] of even levels; -1: none
  std::array<Spread, octants> spread_;
  std::vector<std::array<std::array<Real, octants>, octants>> between_;  // [p][to][from]
  Slope<Real> beam_;
};

/// Slopes of a source, relative to it and limited so that the linear source stays positive in every cell.
/// @param emission that it contains. @param source, from_beam [n]
/// @param slope of its multiply scattered part, W m-2 sr-1 from face to face; in place.
template <class Real>
void make_relative(const Slope<Real>& beam, const CellEmission<Real>& emission, std::span<const Real> source,
                   std::span<const Real> from_beam, Slope<Real>& slope);

/// Slopes of a source of `n` cells, relative to it. Its multiply scattered part has the slopes `multiple`, its part
/// from the beam alone those of the beam. Its emission has the slope of the Planck radiance. Limited so that the linear
/// source stays positive in every cell.
/// @param multiple, beam, emission of all cells; `emission` is part of the source. @param first the cells' first.
/// @param source, from_beam [n] of the cells [first, first + n): the source, and its part from the beam.
/// @param slope [3][n + lane_padding or more] of these cells; it grows if it has less.
template <class Real>
void mix_slopes(const Slope<Real>& multiple, const Slope<Real>& beam, const CellEmission<Real>& emission,
                std::size_t first, std::size_t n, const Real* source, const Real* from_beam, Slope<Real>& slope);

}  // namespace cloudbow
