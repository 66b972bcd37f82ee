// `cloudbow run`: one scene from file to file.
#pragma once

#include "app/planning/run_options.hpp"

namespace cloudbow {

/// @returns exit_done, or exit_not_converged: the solve did not reach its tolerance, the energy ledger does not close
/// or the result misses the target. The result is written in all cases.
/// @throws InputError, Interrupted.
int run(const RunOptions& options);

}  // namespace cloudbow
