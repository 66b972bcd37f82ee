// `cloudbow export`: fields of a result for other programs.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace cloudbow {

/// Adds the subcommand; if the user named it, `action` becomes its work.
void add_export(CLI::App& app, std::function<int()>& action);

}  // namespace cloudbow
