// The command line: subcommands, their options, exit codes.
#pragma once

namespace cloudbow {

/// Carries out the command in the arguments. Every error is printed as one message on stderr.
/// @returns the program's exit code: 0 done, 1 internal error, 2 the user's input or usage is wrong, 3 solved but not
/// converged, 128 + signal if SIGINT or SIGTERM ended a run.
int run_command_line(int argc, const char* const* argv);

}  // namespace cloudbow
