// `cloudbow cloud`: makes, imports and describes cloud fields.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace cloudbow {

/// Adds the subcommand; where the user named one of its own, `action` becomes what it does.
void add_cloud(CLI::App& app, std::function<int()>& action);

}  // namespace cloudbow
