// `cloudbow run` in a process of its own.
#pragma once

#include <string>
#include <vector>

namespace cloudbow {

/// Runs this program with the arguments given and waits for its end. Its stdout is discarded; stderr is that of the
/// caller. A signal noted by an InterruptGuard ends the child.
/// @returns its exit code, 128 + signal if one ended it. @throws Interrupted; std::system_error if no process can be
/// started.
int run_child(const std::vector<std::string>& arguments);

}  // namespace cloudbow
