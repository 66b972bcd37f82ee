// Diffusion correction of scalar flux and current, in levels and columns that diffuse light (docs/theory.md,
// "Acceleration").
#pragma once

#include <array>
#include <span>
#include <vector>

#include "transport/acceleration/diffusion.hpp"
#include "transport/system/sweep.hpp"

namespace cloudbow {

/// Optical depth for transport scattering [1], of columns from top to bottom. Mean over the columns, each weighted with
/// its own: clear columns do not count, nor columns of thin air alone. Absorption does not count either: it leaves few
/// orders of scattering.
template <class Real>
double transport_depth(const TransportSystem<Real>& system);

template <class Real>
class DiffusionCorrection {
 public:
  /// On the levels and columns in which light diffuses.
  explicit DiffusionCorrection(const TransportSystem<Real>& system);

  using Flow = std::array<std::vector<float>, 3>;  // [axis][cells of the diffusion problem]
  /// Arrays of correct(), to be kept between calls.
  struct Workspace {
    std::vector<double> source, correction;
    Flow flow;
    DiffusionOperator::Workspace solve;
  };

  /// moments [low_moments][n] += diffusive response to the change [low_moments][n] of scalar flux and current in one
  /// sweep.
  void correct(std::span<const Real> change, std::span<Real> moments, Workspace& work) const;

 private:
  struct Voxel {
    std::uint32_t cell;    // its cell of the system,
    std::uint32_t place;   // and of the diffusion problem
    double share;          // part of the cell of the system that it is
    double power;          // scattered per scalar flux
    double forward;        // current that a change of the current leads to
    double current_share;  // of the correction of the current that is made
  };

  void diverge(const Flow& flow, std::vector<double>& source) const;

  bool independent_columns_;
  std::size_t all_;  // cells of the system
  double tolerance_;
  LevelRange levels_;
  BoxGrid box_;  // of these levels
  DiffusionOperator operator_;
  std::vector<Voxel> voxels_;  // with matter, of the levels and columns
};

}  // namespace cloudbow
