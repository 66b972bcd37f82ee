// The subcommand `cloudbow sweep`.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>

#include "cloudbow/core/ranks.hpp"

namespace cloudbow {

/// @param action is set to the work of the subcommand if the user named it.
/// @param command as the user typed it
/// @param ranks processes that run this command; null: this one alone
void add_sweep(CLI::App& app, std::function<int()>& action, const std::string& command, Ranks* ranks);

}  // namespace cloudbow
