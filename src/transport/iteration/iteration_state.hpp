// The state of source iteration between two sweeps; storing and restoring it.
#pragma once

#include <utility>
#include <vector>

#include "cloudbow/transport/checkpoints.hpp"
#include "transport/acceleration/anderson.hpp"
#include "transport/iteration/source_iteration.hpp"

namespace cloudbow {

template <class Real>
struct IterationState {
  explicit IterationState(AndersonMixer<Real> mixing) : mixer(std::move(mixing)) {}

  IterationResult<Real> result;
  std::vector<Real> x;        ///< [low_moments][own cells] moments that scatter in the next sweep
  std::vector<Real> change;   ///< [low_moments][own cells] added to the radiance's own moments for that; empty: nothing
  std::vector<double> steps;  ///< relative size of each accelerated change so far
  AndersonMixer<Real> mixer;
  bool finds_slopes = false;  ///< the next sweep finds the light's own slopes
  int slope_sweeps = 0;       ///< sweeps that did
  int slopes_from = -1;       ///< index of the first of their steps; negative: none did
  bool dark = true;           ///< there is no radiance yet
  bool nearly_done = false;   ///< the next sweep records
  bool done = false;          ///< the result is complete
};

template <class Real>
StateKey state_key(const TransportSystem<Real>& system, const IterationState<Real>& state);

/// Between two sweeps, or after the last.
template <class Real>
void save_state(const TransportSystem<Real>& system, IterationState<Real>& state, Checkpoints& checkpoints);

/// Restores the content of the checkpoints: a state of the same problem, or the radiance of another one as a first
/// guess. A converged state that does not meet these options is such a guess too.
/// @param state as before the first sweep; its radiance has its size.
/// @returns false, and does nothing, if they are empty.
template <class Real>
bool restore_state(const TransportSystem<Real>& system, const IterationOptions& options, IterationState<Real>& state,
                   Checkpoints& checkpoints);

}  // namespace cloudbow
