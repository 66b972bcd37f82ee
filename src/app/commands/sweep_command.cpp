#include "app/commands/sweep_command.hpp"

#include <memory>
#include <vector>

#include "app/commands/command_checks.hpp"
#include "app/runs/sweep.hpp"

namespace cloudbow {

void add_sweep(CLI::App& app, std::function<int()>& action, const std::string& command, Ranks* ranks) {
  struct Options {
    SweepOptions sweep;
    std::vector<std::string> set;
    std::string share;
  };
  auto options = std::make_shared<Options>();
  RunOptions& run = options->sweep.run;
  run.command = command;
  run.ranks = ranks;
  CLI::App* sweep_app = app.add_subcommand("sweep", "Solve a scene for lists of values of its keys, into one file");
  sweep_app->add_option("scene", run.scene, "Scene file (TOML)")->type_name("FILE")->required();
  sweep_app
      ->add_option("--set", options->set,
                   "A key and its values: sun.zenith_deg=0:80:10 (first:last:step) or surface.albedo=0.05,0.2; one "
                   "value holds in all runs; repeatable, the product of the lists is solved")
      ->type_name("KEY=LIST")
      ->allow_extra_args(false)
      ->required();
  sweep_app->add_option("-o,--output", run.output, "Result file (HDF5) with a dimension per list")
      ->type_name("FILE")
      ->required();
  sweep_app->add_option("--jobs", options->sweep.jobs, "Runs at a time, which share the threads")
      ->capture_default_str()
      ->check(whole_number(1, 4096));
  sweep_app
      ->add_option("--share", options->share,
                   "Solve this share of the runs alone, as a job of a batch system; the same command without it then "
                   "writes the file")
      ->type_name("I/N");
  sweep_app->add_option("--threads", run.threads, "Threads in all (default: one per processor)")
      ->check(whole_number(1, 4096));
  sweep_app->add_flag("--compare", run.compare, "Solve as independent columns too, as in run");
  sweep_app->add_flag("--clear-sky", run.clear_sky, "Solve the scenes without their clouds too, as in run");
  sweep_app->add_flag("--dry-run", run.dry_run, "Check every scene, predict memory and time, write nothing");
  sweep_app->add_flag("--quiet", run.quiet, "Nothing but errors");
  sweep_app->footer(
      "Finished runs are kept in FILE.parts until the sweep is complete: the same command goes on after an interrupt. "
      "Values are those of the single runs (docs/howto-sweeps.md).");
  sweep_app->callback([&action, options] {
    action = [options] {
      for (const std::string& assignment : options->set) options->sweep.keys.push_back(parse_swept_key(assignment));
      if (!options->share.empty()) options->sweep.share = parse_job_share("--share", options->share);
      return sweep(options->sweep);
    };
  });
}

}  // namespace cloudbow
