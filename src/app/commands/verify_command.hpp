// `cloudbow verify`: physical checks on the user's machine.
#pragma once

#include <CLI/CLI.hpp>
#include <functional>

namespace cloudbow {

/// Adds the subcommand; if the user named it, `action` becomes its work.
void add_verify(CLI::App& app, std::function<int()>& action);

}  // namespace cloudbow
