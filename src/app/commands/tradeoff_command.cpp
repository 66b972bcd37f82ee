#include "app/commands/tradeoff_command.hpp"

#include <memory>

#include "app/commands/command_checks.hpp"
#include "app/planning/tradeoff.hpp"

namespace cloudbow {

void add_tradeoff(CLI::App& app, std::function<int()>& action) {
  auto options = std::make_shared<TradeoffOptions>();
  CLI::App* tradeoff_app =
      app.add_subcommand("tradeoff", "Solve a scene at every level of accuracy: error against time and memory");
  tradeoff_app->add_option("scene", options->scene, "Scene file (TOML)")->type_name("FILE")->required();
  tradeoff_app->add_option("--levels", options->levels, "Some of " + joined(tradeoff_levels()) + " (default: all)")
      ->type_name("LEVEL,...")
      ->delimiter(',')
      ->allow_extra_args(false);
  tradeoff_app
      ->add_option("--reference", options->reference,
                   "Result file (HDF5) of the same columns that errors are against (default: the best level)")
      ->type_name("FILE");
  tradeoff_app->add_option("--csv", options->csv, "Write the table, unrounded, to this file")->type_name("FILE");
  tradeoff_app->add_option("--plot", options->plot, "Draw errors against CPU seconds (PNG, SVG, PDF)")
      ->type_name("FILE");
  tradeoff_app->add_option("--set", options->overrides, "Replace any key of the scene, as in run; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  tradeoff_app->add_option("--threads", options->threads, "Threads (default: one per processor)")
      ->check(whole_number(1, 4096));
  tradeoff_app->add_flag("--quiet", options->quiet, "The table and errors alone");
  tradeoff_app->footer(
      "Each level is a run of its own with the outputs of the scene. Keys of [solver] in the scene hold at every "
      "level (docs/accuracy.md).");
  tradeoff_app->callback([&action, options] { action = [options] { return tradeoff(*options); }; });
}

}  // namespace cloudbow
