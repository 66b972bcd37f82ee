// `cloudbow gas`: describes gas models, and computes the optics of the air.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace cloudbow {

/// Adds the subcommand; if the user named one of its own subcommands, `action` becomes the work of that.
/// @param command as the user typed it, for the history of the file it writes
void add_gas(CLI::App& app, std::function<int()>& action, const std::string& command);

}  // namespace cloudbow
