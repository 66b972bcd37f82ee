// `cloudbow cloud`: makes, imports and describes cloud fields.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace cloudbow {

/// Adds the subcommand. If the user names one of its subcommands, `action` becomes what that one does.
void add_cloud(CLI::App& app, std::function<int()>& action);

}  // namespace cloudbow
