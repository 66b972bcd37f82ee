// `cloudbow tradeoff`: error against time and memory.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace cloudbow {

/// Adds the subcommand; where the user named it, `action` becomes what it does.
void add_tradeoff(CLI::App& app, std::function<int()>& action);

}  // namespace cloudbow
