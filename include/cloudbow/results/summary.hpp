// The short table that a run prints.
#pragma once

#include <string>

#include "cloudbow/transport/solution.hpp"

namespace cloudbow {

/// The energy ledger, how the solve went and what it cost; the last line says "converged" or "NOT CONVERGED". Ends with
/// a newline.
std::string summary_table(const Solution& solution);

}  // namespace cloudbow
