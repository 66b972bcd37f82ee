// Light of another solve of the same cells as the first guess of an iteration.
#pragma once

#include <optional>

#include "cloudbow/transport/cell_light.hpp"
#include "transport/iteration/source_iteration.hpp"

namespace cloudbow {

/// The light of another solve, whose direct beam may contain another part of the forward peak. All light together is
/// nearly the same. Its memory is taken over.
/// @param light of the system's cells. @param share for whose cells the guess is; null: for all
template <class Real>
FirstGuess<Real> first_guess(const TransportSystem<Real>& system, const std::optional<Sun>& sun, CellLight&& light,
                             const OrdinateShare* share = nullptr);

/// The light of a solution. Its memory is taken over. @param plan of the solve, whose problem has the system's cells.
/// @param share of the solve: each rank has the light of its cells, and gets that of all; slopes of its octants alone
template <class Real>
CellLight cell_light(const TransportSystem<Real>& system, const SolvePlan& plan, IterationResult<Real>&& solved,
                     const OrdinateShare* share = nullptr);

}  // namespace cloudbow
