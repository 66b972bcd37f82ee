// The subcommand `cloudbow sweep`.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace cloudbow {

/// @param action is set to the work of the subcommand if the user named it.
/// @param command as the user typed it
void add_sweep(CLI::App& app, std::function<int()>& action, const std::string& command);

}  // namespace cloudbow
