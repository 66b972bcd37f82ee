// The short table that a run prints.
#pragma once

#include <string>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// The energy ledger, the course of the solve and its cost; the last line says "converged" or "NOT CONVERGED". Ends
/// with a newline.
std::string summary_table(const Solution& solution);

}  // namespace cloudbow
