#include "cloudbow/app/command_line.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <CLI/CLI.hpp>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <functional>
#include <optional>
#include <system_error>

#include "app/commands/cloud_commands.hpp"
#include "app/commands/command_checks.hpp"
#include "app/commands/export_command.hpp"
#include "app/commands/gas_commands.hpp"
#include "app/commands/mie_command.hpp"
#include "app/commands/phase_command.hpp"
#include "app/commands/render_command.hpp"
#include "app/commands/sweep_command.hpp"
#include "app/commands/tradeoff_command.hpp"
#include "app/commands/usage_error.hpp"
#include "app/commands/verify_command.hpp"
#include "app/planning/planner.hpp"
#include "app/planning/run_options.hpp"
#include "app/process/exit_codes.hpp"
#include "app/process/interrupt.hpp"
#include "app/process/messages.hpp"
#include "app/process/version.hpp"
#include "app/runs/merge.hpp"
#include "app/runs/run.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/printable.hpp"
#include "cloudbow/core/ranks.hpp"

namespace cloudbow {
namespace {

constexpr int exit_broken_pipe = 128 + SIGPIPE;  // as a shell reports it

/// The work of a subcommand, with its options. Only that of the one that the user named is run.
using Action = std::function<int()>;

/// Values of --target-error, --of and --budget.
struct TargetText {
  std::string error, of = "domain", budget;

  std::optional<Target> target() const {
    if (error.empty() && budget.empty()) return std::nullopt;
    Target target;
    if (!error.empty()) target.error = parse_target_error(error);
    target.of = of == "domain" ? ErrorOf::domain : ErrorOf::columns;
    if (!budget.empty()) target.budget_seconds = parse_budget(budget);
    return target;
  }
};

void add_run(CLI::App& app, Action& action, const std::string& command, Ranks* ranks) {
  auto options = std::make_shared<RunOptions>();
  auto target = std::make_shared<TargetText>();
  auto part = std::make_shared<std::string>();
  options->command = command;
  options->ranks = ranks;
  CLI::App* run_app = app.add_subcommand("run", "Solve a scene file and write one HDF5 file");
  run_app->add_option("scene", options->scene, "Scene file (TOML)")->type_name("FILE")->required();
  run_app->add_option("-o,--output", options->output, "Result file (default: the scene's name with .h5, here)")
      ->type_name("FILE");
  run_app
      ->add_option(
          "--set", options->overrides,
          "Replace any key of the scene, as in --set sun.zenith_deg=30 --set layer.0.optical_depth=2; repeatable")
      ->type_name("KEY=VALUE")
      ->allow_extra_args(false);
  run_app->add_option("--threads", options->threads, "Threads (default: one per processor)")
      ->check(whole_number(1, 4096));
  run_app->add_flag("--quiet", options->quiet, "Print errors alone");
  run_app->add_flag("--clear-sky", options->clear_sky,
                    "Solve the scene without its clouds too; write its fluxes and print what the clouds change");
  auto* compare = run_app->add_flag("--compare", options->compare,
                                    "Solve as independent columns too; write the difference of the column fluxes");
  auto* dry_run = run_app->add_flag("--dry-run", options->dry_run,
                                    "Validate, print domain and optical depth, predict memory and time, write nothing");
  auto* checkpoint =
      run_app
          ->add_option("--checkpoint", options->checkpoint,
                       "Keep the state of the iteration here, for --resume: every few minutes, when a signal ends the "
                       "run, and when the iteration is done")
          ->type_name("FILE");
  run_app->add_option("--checkpoint-every", options->checkpoint_minutes, "Minutes between checkpoints")
      ->type_name("MINUTES")
      ->needs(checkpoint)
      ->capture_default_str()
      ->check(finite_number(0, "minutes >= 0"));
  auto* resume =
      run_app
          ->add_option("--resume", options->resume,
                       "Go on from a checkpoint, to the same bits; that of another sun, surface or output is a first "
                       "guess. May be the --checkpoint of the same command: not there yet, the run begins anew")
          ->type_name("FILE");
  run_app
      ->add_option("--target-error", target->error,
                   "Choose the cheapest level of accuracy with this expected error, as 1%")
      ->type_name("ERROR")
      ->excludes(compare)
      ->excludes(dry_run)
      ->excludes(checkpoint)
      ->excludes(resume);
  run_app
      ->add_option(
          "--budget", target->budget,
          "Choose the best level (with --target-error: the cheapest that reaches it) within this time, as 30s, "
          "2m, 1.5h")
      ->type_name("TIME")
      ->excludes(compare)
      ->excludes(dry_run)
      ->excludes(checkpoint)
      ->excludes(resume);
  run_app->add_option("--of", target->of, "Fluxes that the error is of: domain, columns")
      ->capture_default_str()
      ->check(CLI::IsMember({"domain", "columns"}));
  run_app
      ->add_option(
          "--part", *part,
          "Solve every Nth wavelength or g-point alone, as a job of a batch system, and write FILE.part-I-of-N; "
          "cloudbow merge joins the parts")
      ->type_name("I/N")
      ->excludes(dry_run);
  run_app->callback([&action, options, target, part] {
    action = [options, target, part] {
      options->target = target->target();
      if (!part->empty()) options->part = parse_job_share("--part", *part);
      return run(*options);
    };
  });
}

void add_merge(CLI::App& app, Action& action, const std::string& command) {
  auto options = std::make_shared<MergeOptions>();
  options->command = command;
  CLI::App* merge_app = app.add_subcommand("merge", "Join the parts of a run into its result");
  merge_app->add_option("parts", options->parts, "Files of run --part, all of one run")
      ->type_name("PART...")
      ->required();
  merge_app->add_option("-o,--output", options->output, "Result file (default: as the runs of the parts name it)")
      ->type_name("FILE");
  merge_app->add_option("--threads", options->threads, "Threads (default: one per processor)")
      ->check(whole_number(1, 4096));
  merge_app->add_flag("--quiet", options->quiet, "Print errors alone");
  merge_app->callback([&action, options] { action = [options] { return merge(*options); }; });
}

void add_mie(CLI::App& app, Action& action, const std::string& command) {
  auto options = std::make_shared<MieOptions>();
  options->command = command;
  CLI::App* mie_app = app.add_subcommand("mie", "Make a table of droplets by Mie theory, for scenes");
  mie_app->add_option("--wavelength-um", options->wavelength_um, "Wavelengths [um], one or several")
      ->type_name("W|FROM:TO:STEP")
      ->required();
  mie_app->add_option("--effective-radius-um", options->effective_radius_um, "Effective radii [um]")
      ->type_name("R|FROM:TO:STEP")
      ->required();
  mie_app->add_option("--distribution", options->distribution, "Spread of the sizes: gamma, lognormal")
      ->capture_default_str()
      ->check(CLI::IsMember({"gamma", "lognormal"}));
  mie_app->add_option("--variance", options->variance, "Effective variance of the sizes")
      ->capture_default_str()
      ->check(finite_number(0, "a variance > 0"));
  auto* substance = mie_app->add_option("--substance", options->substance, "Substance of the droplets: water, ice")
                        ->capture_default_str()
                        ->check(CLI::IsMember({"water", "ice"}));
  mie_app->add_option("--refractive-index", options->refractive_index, "Instead of the substance's: n + i k, k >= 0")
      ->type_name("N K")
      ->expected(2)
      ->excludes(substance)
      ->check(finite_number(0, "a number >= 0"));
  mie_app
      ->add_option("--density-g-cm3", options->density_g_cm3,
                   "Density of the droplets (default: the substance's, or 1)")
      ->check(finite_number(0, "a density > 0"));
  mie_app->add_option("-o,--output", options->output, "Table (HDF5)")->type_name("FILE")->required();
  mie_app->add_option("--threads", options->threads, "Threads (default: one per processor)")
      ->check(whole_number(1, 4096));
  mie_app->add_flag("--quiet", options->quiet, "Print errors alone");
  mie_app->callback([&action, options] { action = [options] { return make_mie_file(*options); }; });
}

std::string command_text(int argc, const char* const* argv) {
  std::string text = "cloudbow";
  for (int n = 1; n < argc; ++n) text += fmt::format(" {}", argv[n]);
  return text;
}

/// Printed text may still be in the buffer when the disk is full. A closed stdout (EBADF) is no error: its owner wants
/// no output.
void check_printed() {
  if (std::fflush(stdout) == 0 || errno == EBADF) return;
  if (errno == EPIPE) throw std::system_error(errno, std::generic_category(), "stdout");
  throw InputError(fmt::format("stdout: can't be written ({})", std::generic_category().message(errno)));
}

/// An empty word comes from a variable that a script did not set. It would be taken for an option not given.
void check_no_empty_words(const CLI::App& app) {
  for (const CLI::Option* option : app.get_options()) {
    for (const std::string& word : option->results()) {
      if (word.empty())
        throw InputError(fmt::format("{}: empty (found \"\", allowed a value, or leave the option out)",
                                     option->get_name(true, true)));
    }
  }
  for (const CLI::App* command : app.get_subcommands()) check_no_empty_words(*command);
}

/// Other commands would write their outputs several times.
void check_takes_ranks(const CLI::App& app, const Ranks& ranks) {
  const std::string command = app.get_subcommands().front()->get_name();
  if (command == "run" || command == "sweep") return;
  throw InputError(
      fmt::format("mpirun: `cloudbow {}` is a command of one process (found {}, allowed 1; run and sweep "
                  "take several)",
                  command, ranks.size()));
}

/// @param ranks all processes that run this command; null: this one alone
int parse_and_act(int argc, const char* const* argv, Ranks* ranks) {
  CLI::App app("Sunlight in cloudy air, solved deterministically", "cloudbow");
  app.set_version_flag("--version", version_text());
  app.require_subcommand(1);
  app.footer(
      "Exit codes: 0 done, 1 internal error, 2 wrong input or usage, or too little memory. "
      "3: the solve did not converge, missed its target error or time (the result says so), or a check of verify "
      "does not hold");
  Action action;
  add_run(app, action, command_text(argc, argv), ranks);
  add_merge(app, action, command_text(argc, argv));
  add_sweep(app, action, command_text(argc, argv), ranks);
  add_cloud(app, action);
  add_mie(app, action, command_text(argc, argv));
  add_gas(app, action, command_text(argc, argv));
  add_render(app, action);
  add_export(app, action);
  add_phase(app, action, command_text(argc, argv));
  add_tradeoff(app, action);
  add_verify(app, action);
  try {
    app.parse(argc, argv);
  } catch (const CLI::Success& help_or_version) {
    if (ranks != nullptr && !ranks->is_first()) return exit_done;
    return app.exit(help_or_version);
  } catch (const CLI::ParseError& error) {
    throw InputError(fmt::format("{} (cloudbow --help, cloudbow COMMAND --help)", usage_error(app, error)));
  }
  check_no_empty_words(app);
  if (ranks != nullptr) check_takes_ranks(app, *ranks);
  const int code = action();
  check_printed();
  return code;
}

/// Sets process state that a parent may have left different from the usual one.
void settle_process() {
  // Opens missing standard streams. Otherwise the next file that is opened becomes one, and messages are written into
  // it.
  while (true) {
    const int descriptor = open("/dev/null", O_RDWR);
    if (descriptor <= STDERR_FILENO && descriptor >= 0) continue;
    if (descriptor >= 0) close(descriptor);
    break;
  }
  // A file over the limit of its size is reported, as a full disk is. A reader of stderr that has gone ends no run.
  std::signal(SIGXFSZ, SIG_IGN);
  std::signal(SIGPIPE, SIG_IGN);
  // Ignored, it would hide how children end.
  std::signal(SIGCHLD, SIG_DFL);
}

/// The end of a command.
struct CommandEnd {
  int exit_code = exit_done;
  std::string message{};  ///< why it failed; empty: it did not
  bool interrupted = false;
};

template <class Command>
CommandEnd end_of(const Command& command) {
  try {
    return {command()};
  } catch (const InputError& error) {
    return {exit_input_error, printable(error.what())};
  } catch (const Interrupted& interrupted) {
    return {128 + interrupted.signal, "interrupted", true};
  } catch (const std::bad_alloc&) {
    return {exit_input_error, "out of memory (a smaller domain, a lower solver.accuracy or fewer --threads need less)"};
  } catch (const std::system_error& error) {
    if (error.code() == std::errc::broken_pipe) return {exit_broken_pipe};
    const bool no_memory = error.code() == std::errc::not_enough_memory;
    return {no_memory ? exit_input_error : exit_internal_error,
            fmt::format("{}{}", no_memory ? "" : "internal error: ", printable(error.what()))};
  } catch (const std::exception& error) {
    return {exit_internal_error, fmt::format("internal error: {}", printable(error.what()))};
  }
}

/// Most errors come to all ranks, and then the first reports them. An error of one rank ends the others.
void end_ranks(Ranks& ranks, const CommandEnd& end) {
  constexpr std::chrono::seconds patience{2};
  if (end.message.empty()) return;
  const bool all = ranks.all_arrive(patience);
  if (!all && !ranks.is_first()) {
    mute_messages(false);
    tell("cloudbow: {} (process {} of {})\n", end.message, ranks.rank() + 1, ranks.size());
  } else {
    tell("cloudbow: {}\n", end.message);
  }
  // Messages that an interrupt has cut short would keep MPI from its own end.
  if (!all || end.interrupted) ranks.abort(end.exit_code);
}

/// All processes that mpirun has started, of which the first speaks; null: this one alone.
std::unique_ptr<Ranks> join_ranks() {
  std::unique_ptr<Ranks> ranks = start_ranks();
  if (!ranks) return nullptr;
  ranks->while_waiting = [] { InterruptGuard::check(); };
  mute_messages(!ranks->is_first());
  return ranks;
}

}  // namespace

int run_command_line(int argc, const char* const* argv) {
  settle_process();
  std::unique_ptr<Ranks> ranks;
  const CommandEnd end = end_of([&] {
    ranks = join_ranks();
    return parse_and_act(argc, argv, ranks.get());
  });
  if (ranks) {
    end_ranks(*ranks, end);
  } else if (!end.message.empty()) {
    tell("cloudbow: {}\n", end.message);
  }
  return end.exit_code;
}

}  // namespace cloudbow
