// `cloudbow run`: one scene from file to file.
#pragma once

#include "app/planning/run_options.hpp"

namespace cloudbow {

/// @returns exit_done, or exit_not_converged where the solve did not reach its tolerance or the ledger does not close,
/// or where the result misses the goal: it is written all the same.
/// @throws InputError, Interrupted.
int run(const RunOptions& options);

}  // namespace cloudbow
