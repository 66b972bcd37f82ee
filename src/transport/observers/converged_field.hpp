// A converged iteration with all its context: the input of observers.
#pragma once

#include "transport/iteration/source_iteration.hpp"
#include "transport/observers/lateral_boundary.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {

/// References last as long as the solve. If ranks share it, each has the light of its cells.
template <class Real>
struct ConvergedField {
  const Problem& problem;
  const Discretisation& discretisation;
  const SolverOptions& options;
  const TransportSystem<Real>& system;
  const IterationResult<Real>& result;
  const LateralBoundary* lateral_boundary;  ///< radiance at open sides; null: nothing, or no open sides
  const OrdinateShare* share = nullptr;     ///< null: there is one rank

  /// Whether this rank makes the results.
  bool is_first() const { return share == nullptr || share->is_first(); }
};

}  // namespace cloudbow
