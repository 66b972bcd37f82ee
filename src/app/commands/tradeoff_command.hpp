// `cloudbow tradeoff`: error against time and memory.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace cloudbow {

/// Adds the subcommand; if the user named it, `action` becomes its work.
void add_tradeoff(CLI::App& app, std::function<int()>& action);

}  // namespace cloudbow
