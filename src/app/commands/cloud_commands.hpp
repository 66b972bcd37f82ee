// `cloudbow cloud`: makes, imports and describes cloud fields.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace cloudbow {

/// Adds the subcommand; if the user named one of its own subcommands, `action` becomes the work of that.
void add_cloud(CLI::App& app, std::function<int()>& action);

}  // namespace cloudbow
