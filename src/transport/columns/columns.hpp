// Columns that exchange no diffuse light, each solved independently without iteration (docs/theory.md, "Columns without
// iteration"). This solver replaces the sweeps if only fluxes, absorption and actinic flux are requested.
#pragma once

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Solves each distinct column once. SolverReport::sweeps is 1; its estimated_error is the RMS over columns of the
/// imbalance of each column's diffuse light, per EnergyLedger::power: rounding alone. The same bits for any number of
/// threads.
/// @throws InputError for a count of streams that does not exist.
template <class Real>
Solution solve_columns(const Problem& problem, const SolverOptions& options, const ProgressCallback& progress);

/// Bytes that solve_columns() needs, with the problem's grid.
std::size_t columns_memory(const Problem& problem, const SolverOptions& options, bool in_double, int threads);
/// Seconds of it.
double columns_seconds(const Problem& problem, const SolverOptions& options, bool in_double, int threads);

}  // namespace cloudbow
