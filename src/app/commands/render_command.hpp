// cloudbow render: a result as a picture or a figure.
#pragma once

#include <functional>

namespace CLI {
class App;
}

namespace cloudbow {

/// Adds the subcommand to the program; when it is named on the command line, `action` becomes its work.
void add_render(CLI::App& app, std::function<int()>& action);

}  // namespace cloudbow
