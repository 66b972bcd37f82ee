// `cloudbow cloud import`: brings in clouds that others simulated.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace cloudbow {

/// Adds the subcommand. If the user names it, `action` becomes what it does.
void add_cloud_import(CLI::App& cloud_app, std::function<int()>& action);

}  // namespace cloudbow
