// `cloudbow run` in a process of its own.
#pragma once

#include <string>
#include <vector>

namespace cloudbow {

/// Runs this program with the arguments given and waits for its end. What it prints on stdout is dropped; stderr is
/// that of the caller. A signal noted by an InterruptGuard ends the child.
/// @returns its exit code, 128 + signal where one ended it. @throws Interrupted; std::system_error where no process can
/// be started.
int run_child(const std::vector<std::string>& arguments);

}  // namespace cloudbow
