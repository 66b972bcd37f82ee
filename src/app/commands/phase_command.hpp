// `cloudbow phase`: a single phase function.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

namespace cloudbow {

/// Adds the subcommand; if the user named it, `action` becomes its work.
/// @param command as the user typed it, for the history of the file it writes
void add_phase(CLI::App& app, std::function<int()>& action, const std::string& command);

}  // namespace cloudbow
