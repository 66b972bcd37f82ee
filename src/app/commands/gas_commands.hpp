// `cloudbow gas`: describes gas models, and computes the optics of the air.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace cloudbow {

/// Adds the subcommand. If the user names one of its subcommands, `action` becomes what that one does.
/// @param command as the user typed it, for the history of the file it writes
void add_gas(CLI::App& app, std::function<int()>& action, const std::string& command);

}  // namespace cloudbow
