// The short table that a run prints.
#pragma once

#include <string>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// The energy ledger, the course of the solve and its cost; the last line says "converged" or "NOT CONVERGED". Ends
/// with a newline.
/// @param flux_units of scenes that emit, whose ledger is in fluxes.
std::string summary_table(const Solution& solution, const std::string& flux_units = "W m-2");

}  // namespace cloudbow
