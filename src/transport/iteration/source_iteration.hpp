// Source iteration: scatter, sweep, accelerate, until the estimated true error and the energy ledger are within
// tolerance (docs/theory.md, "Iteration").
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "cloudbow/transport/checkpoints.hpp"
#include "cloudbow/transport/solution.hpp"
#include "transport/system/sweep.hpp"

namespace cloudbow {

struct IterationReport {
  bool converged = false;
  bool stalled = false;  ///< it was ended before max_sweeps, as it came no closer
  int sweeps = 0;
  double estimated_error = 0;
  double seconds_sweeps = 0;
  double seconds_scattering = 0;
  double seconds_acceleration = 0;
};

template <class Real>
struct IterationResult {
  AngularField<Real> radiance;  ///< voxel-mean diffuse radiance at the ordinates; shared: in the cells of this rank
  std::vector<Real> moments;    ///< [low_moments][cells of the field] of it
  std::optional<LightSlopes<Real>> slopes;  ///< if the system has tables for them
  SweepFluxes<Real> fluxes;
  EnergyLedger ledger;  ///< transmittance_direct left for the caller
  IterationReport report;
};

/// Light with which an iteration starts.
template <class Real>
struct FirstGuess {
  bool is_given = false;        ///< false: the iteration makes its own, by the low-order problem
  std::vector<Real> moments{};  ///< [low_moments][own cells] of the diffuse radiance
  /// Of the source alone, fitted. They stay, and of_radiance is empty. None: the iteration finds its own.
  std::optional<LightSlopes<Real>> slopes{};
};

using IterationCallback = std::function<void(int sweep, double estimated_error, double energy_residual)>;

/// @param checkpoints the first state is read from them; states are written to them when they are due, and at the end;
/// or null.
/// @param share this rank's part of an iteration that ranks share, without checkpoints; null: there is one rank
/// @param guess of an iteration without checkpoints.
/// @throws std::runtime_error if the iteration diverges, even after a restart without mixing and diffusion.
template <class Real>
IterationResult<Real> iterate_source(const TransportSystem<Real>& system, const IterationOptions& options,
                                     const IterationCallback& progress, Checkpoints* checkpoints = nullptr,
                                     const OrdinateShare* share = nullptr, FirstGuess<Real> guess = {});

}  // namespace cloudbow
