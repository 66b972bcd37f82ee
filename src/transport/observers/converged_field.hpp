// A converged iteration with all its context: the input of observers.
#pragma once

#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/lateral_boundary.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {

/// References last as long as the solve.
template <class Real>
struct ConvergedField {
  const Problem& problem;
  const Discretisation& discretisation;
  const SolverOptions& options;
  const TransportSystem<Real>& system;
  const IterationResult<Real>& result;
  const LateralBoundary* lateral_boundary;  ///< radiance at open sides; null: nothing, or no open sides
};

}  // namespace cloudbow
