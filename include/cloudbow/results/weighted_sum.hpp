// Sums of solutions over a spectrum.
#pragma once

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// Adds `weight` times a solution of the same grid to a sum of such. Fluxes, powers and images add up; the ledger is
/// that of all power. The report is that of the solve that took most of something: sweeps, errors, memory; times add
/// up.
/// @param sum the sum so far; of the first solution it is Solution().
/// @throws std::invalid_argument for solutions of different levels or columns.
void add_weighted(Solution& sum, const Solution& solution, double weight);

}  // namespace cloudbow
