#include "app/runs/sweep.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <omp.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <condition_variable>
#include <csignal>
#include <exception>
#include <iterator>
#include <mutex>
#include <new>
#include <numeric>
#include <optional>
#include <set>
#include <system_error>
#include <thread>
#include <utility>

#include "app/process/exit_codes.hpp"
#include "app/process/history.hpp"
#include "app/process/host.hpp"
#include "app/process/interrupt.hpp"
#include "app/process/messages.hpp"
#include "app/process/version.hpp"
#include "app/runs/run.hpp"
#include "app/runs/sweep_parts.hpp"
#include "app/scene/config_tree.hpp"
#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/bytes.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/core/printable.hpp"
#include "cloudbow/core/ranks.hpp"

namespace cloudbow {
namespace {

constexpr std::size_t most_runs = 10000;

std::shared_ptr<CloudFiles> shared_files(const SweepOptions& options) {
  return std::make_shared<CloudFiles>(true, [quiet = options.run.quiet](const std::string& sentence) {
    if (!quiet) tell("cloudbow: {}\n", printable(sentence));
  });
}

/// Keys with one value are settings of all runs.
RunOptions common_options(const SweepOptions& options) {
  RunOptions common = options.run;
  common.quiet = true;
  for (const SweptKey& key : options.keys) {
    if (!key.is_list) common.overrides.push_back(fmt::format("{}={}", key.key, key.values.front()));
  }
  return common;
}

std::string names_of(const std::vector<SweptKey>& lists) {
  std::string names;
  for (const SweptKey& list : lists) names += (names.empty() ? "" : ", ") + list.key;
  return names;
}

[[noreturn]] void throw_without_lists(const std::vector<SweptKey>& keys) {
  const auto array = std::find_if(keys.begin(), keys.end(), [](const SweptKey& key) {
    return key.values.front().starts_with('[') && key.values.front().ends_with(']');
  });
  const std::string& key = array != keys.end() ? array->key : keys.empty() ? "KEY" : keys.front().key;
  throw InputError(fmt::format(
      "{}: nothing to sweep (found {}, allowed {}={} or {}=FIRST:LAST:STEP; `cloudbow run` solves one scene)", key,
      array != keys.end() ? fmt::format("{}, one value that is an array", array->values.front())
                          : std::string("no key with a list"),
      key,
      array != keys.end() ? array->values.front().substr(1, array->values.front().size() - 2)
                          : std::string("VALUE,VALUE,..."),
      key));
}

/// Refuses a key that is there twice, and one inside a key with a list: the later would overwrite the values of the
/// other, which the file would name nevertheless.
void check_contradictions(const std::vector<SweptKey>& keys) {
  for (auto key = keys.begin(); key != keys.end(); ++key) {
    if (std::any_of(keys.begin(), key, [&](const SweptKey& other) { return other.key == key->key; }))
      throw InputError(fmt::format("{}: a key twice (found two lists, allowed one)", key->key));
    const auto inner = std::find_if(keys.begin(), keys.end(), [&](const SweptKey& other) {
      return key->is_list && other.key.starts_with(key->key + ".");
    });
    if (inner != keys.end()) {
      throw InputError(
          fmt::format("{}: inside a key that has a list (found {} too, allowed one of the two)", inner->key, key->key));
    }
  }
}

/// The name of a result has no effect in a sweep.
void check_no_output_file(const std::vector<SweptKey>& keys) {
  for (const SweptKey& key : keys) {
    const bool is_there =
        key.key == "output.file" ||
        (key.key == "output" && std::any_of(key.values.begin(), key.values.end(), [](const std::string& table) {
           return config_value(table, "--set output").find("file") != nullptr;
         }));
    if (!is_there) continue;
    throw InputError(fmt::format(
        "output.file: has no effect in a sweep, which writes all runs to one file (found {}, allowed any other key; "
        "name the file by -o, in Python by output)",
        key.values.front()));
  }
}

std::vector<SweptKey> lists_of(const SweepOptions& options) {
  std::vector<SweptKey> lists;
  check_contradictions(options.keys);
  check_no_output_file(options.keys);
  std::copy_if(options.keys.begin(), options.keys.end(), std::back_inserter(lists),
               [](const SweptKey& key) { return key.is_list; });
  if (lists.empty()) throw_without_lists(options.keys);
  double product = 1;
  for (const SweptKey& list : lists) product *= static_cast<double>(list.values.size());
  if (product > static_cast<double>(most_runs))
    throw InputError(fmt::format("{}: too many runs (found {:.10g}, allowed {})", names_of(lists), product, most_runs));
  return lists;
}

std::vector<SweepDimension> dimensions_of(const std::vector<SweptKey>& lists) {
  const std::vector<std::string> names = dimension_names(lists);
  std::vector<SweepDimension> dimensions;
  for (std::size_t n = 0; n < lists.size(); ++n) {
    CoordinateValues values = coordinate_values(lists[n]);
    dimensions.push_back(
        {names[n], lists[n].key, std::move(values.numbers), std::move(values.texts), units_of_key(lists[n].key)});
  }
  return dimensions;
}

/// "KEY=VALUE" of each run, the last key fastest.
std::vector<std::vector<std::string>> product_of(const std::vector<SweptKey>& lists) {
  std::vector<std::vector<std::string>> runs(1);
  for (const SweptKey& list : lists) {
    std::vector<std::vector<std::string>> longer;
    for (const std::vector<std::string>& run : runs) {
      for (const std::string& value : list.values) {
        longer.push_back(run);
        longer.back().push_back(fmt::format("{}={}", list.key, value));
      }
    }
    runs = std::move(longer);
  }
  return runs;
}

RunOptions options_of(const RunOptions& common, const std::vector<std::string>& settings) {
  RunOptions options = common;
  options.overrides.insert(options.overrides.end(), settings.begin(), settings.end());
  return options;
}

void check_same_coordinates(const RunEstimate& first, const RunEstimate& other,
                            const std::vector<std::string>& settings) {
  for (const auto& [name, values] : first.coordinates) {
    const auto found = other.coordinates.find(name);
    if (found != other.coordinates.end() && found->second == values) continue;
    throw InputError(fmt::format(
        "{}: the run has another {} than the first one, so that one file cannot hold both (allowed: keys that "
        "leave the grid and the sizes of outputs as they are{})",
        fmt::join(settings, ", "), name,
        name == "z_edge" ? "; domain.vertical_cells fixes the levels of a scene without cloud" : ""));
  }
  if (other.coordinates.size() > first.coordinates.size())
    throw InputError(fmt::format("{}: the run has other outputs than the first one (allowed: the same in all)",
                                 fmt::join(settings, ", ")));
}

std::size_t done_runs(const SweepPlan& plan) {
  return static_cast<std::size_t>(
      std::count_if(plan.runs.begin(), plan.runs.end(), [](const auto& r) { return r.done; }));
}

std::string plan_text(const SweepPlan& plan, const std::string& first, int jobs, const std::optional<JobShare>& share) {
  std::string text = "runs      ";
  for (const SweepDimension& dimension : plan.dimensions) {
    text +=
        fmt::format("{}{} ({})", &dimension == &plan.dimensions.front() ? "" : " x ", dimension.size(), dimension.name);
  }
  text += fmt::format(": {}", plan.runs.size());
  if (const std::size_t done = done_runs(plan); done > 0) text += fmt::format(", of which {} are done", done);
  if (share) text += fmt::format("\nshare     {} of {}: {} runs to solve", share->number, share->of, plan.to_solve);
  text += fmt::format("\nall       {} predicted, {} at a time; {} predicted\n\nthe first run\n",
                      memory_text(plan.memory_bytes), std::min(static_cast<std::size_t>(jobs), plan.to_solve),
                      time_text(plan.seconds));
  return text + first;
}

/// A run that is over.
struct Finished {
  int exit_code = exit_done;
  std::string message{};
};

Finished end_of(const std::filesystem::path& part) {
  std::string sentence = shortcoming_of_result(part);
  return {sentence.empty() ? exit_done : exit_not_converged, std::move(sentence)};
}

/// Messages of a host, and its interrupts by way of a flag: only its own thread can ask it.
class WorkerScope {
 public:
  explicit WorkerScope(const HostCalls* host, const std::atomic<bool>& stop) {
    if (host == nullptr) return;
    HostCalls calls;
    calls.check_interrupt = [&stop] {
      if (stop) throw Interrupted{SIGINT};
    };
    calls.message = host->message;
    scope_.emplace(std::move(calls));
  }

 private:
  std::optional<HostScope> scope_;
};

/// Solves runs, several at a time.
class Workers {
 public:
  Workers(const SweepOptions& options, const SweepPlan& plan, const SweepParts& parts)
      : options_(options), plan_(plan), parts_(parts), common_(common_options(options)), finished_(plan.runs.size()) {
    for (std::size_t n = 0; n < plan.runs.size(); ++n) {
      if (plan.runs[n].to_solve) waiting_.push_back(n);
    }
    jobs_ = std::min(waiting_.size(), static_cast<std::size_t>(options.jobs));
    const int threads = common_.threads > 0 ? common_.threads : omp_get_max_threads();
    common_.threads = std::max(1, threads / std::max(1, static_cast<int>(jobs_)));
  }

  /// @returns the end of each run; of those that were done before, nothing.
  std::vector<Finished> solve() {
    const HostCalls* host = HostScope::calls();
    std::vector<std::thread> threads;
    running_ = jobs_;
    for (std::size_t n = 0; n < jobs_; ++n) threads.emplace_back([this, host] { work(host); });
    std::exception_ptr interrupt;
    try {
      wait(host);
    } catch (...) {
      interrupt = std::current_exception();
      stop_ = true;
    }
    for (std::thread& thread : threads) thread.join();
    if (interrupt) std::rethrow_exception(interrupt);
    if (error_) std::rethrow_exception(error_);
    return std::move(finished_);
  }

 private:
  void wait(const HostCalls* host) {
    constexpr std::chrono::milliseconds between_looks{20};
    std::size_t shown = 0;
    std::unique_lock lock(mutex_);
    while (running_ > 0 || shown < done_) {  // the last runs may end during a report
      if (running_ > 0) changed_.wait_for(lock, between_looks);
      const std::size_t done = done_;
      lock.unlock();
      InterruptGuard::check();
      if (host != nullptr && host->progress && done > shown)
        host->progress(
            {"run", static_cast<int>(done), 0, 0, static_cast<double>(done) / static_cast<double>(waiting_.size())});
      shown = done;
      lock.lock();
    }
  }

  void work(const HostCalls* host) {
    const WorkerScope scope(host, stop_);
    try {
      while (const std::optional<std::size_t> run = next()) {
        const auto start = std::chrono::steady_clock::now();
        Finished end = solve(*run);
        const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
        const std::lock_guard lock(mutex_);
        ++done_;
        if (!options_.run.quiet && host == nullptr) {
          tell("{} of {}: {}, {:.1f} s{}\n", done_, waiting_.size(), fmt::join(plan_.runs[*run].settings, ", "),
               seconds, end.exit_code == exit_done ? "" : ", " + printable(end.message));
        }
        finished_[*run] = std::move(end);
        changed_.notify_all();
      }
    } catch (...) {
      const std::lock_guard lock(mutex_);
      if (!error_) error_ = std::current_exception();
      stop_ = true;
    }
    const std::lock_guard lock(mutex_);
    --running_;
    changed_.notify_all();
  }

  std::optional<std::size_t> next() {
    const std::lock_guard lock(mutex_);
    if (stop_ || next_ == waiting_.size()) return std::nullopt;
    return waiting_[next_++];
  }

  Finished solve(std::size_t n) {
    const PlannedSweepRun& run = plan_.runs[n];
    try {
      RunOptions options = options_of(common_, run.settings);
      options.dry_run = true;  // the output is that of the sweep
      std::set<std::string> printed = plan_.printed;
      const PreparedRun prepared = prepare_run(options, printed);
      options.dry_run = false;
      SolvedRun solved = solve_run(prepared.scenes, options, *plan_.files);
      solved.info.scene = run.scene;
      solved.info.run_key = run_key_text(run.key);
      const std::filesystem::path part = parts_.file(run.key);
      write_run(part, solved, options.threads);
      return end_of(part);
    } catch (const Interrupted&) {
      throw;
    } catch (const InputError& error) {
      return {exit_input_error, error.what()};
    } catch (const std::bad_alloc&) {
      return {exit_input_error, "out of memory"};
    } catch (const std::exception& error) {
      return {exit_internal_error, error.what()};
    }
  }

  const SweepOptions& options_;
  const SweepPlan& plan_;
  const SweepParts& parts_;
  RunOptions common_;
  std::vector<std::size_t> waiting_;  ///< runs to solve
  std::size_t jobs_ = 0;              ///< of them at a time
  std::atomic<bool> stop_ = false;
  std::mutex mutex_;  ///< of the members below
  std::condition_variable changed_;
  std::size_t next_ = 0, done_ = 0, running_ = 0;
  std::vector<Finished> finished_;
  std::exception_ptr error_;
};

/// 1 is graver than 2, and 2 than 3.
int graver(int a, int b) {
  if (a == exit_done || b == exit_done) return std::max(a, b);
  return std::min(a, b);
}

template <class Archive>
void visit_members(Archive& archive, Finished& end) {
  archive(end.exit_code, end.message);
}

/// The ends of the runs that other ranks have solved come to the first.
void gather_ends(Ranks& ranks, const SweepPlan& plan, std::vector<Finished>& finished) {
  if (!ranks.is_first()) {
    ByteWriter writer;
    for (std::size_t n = 0; n < finished.size(); ++n) {
      if (plan.runs[n].to_solve) writer(n, finished[n]);
    }
    writer(finished.size());
    send_bytes(ranks, 0, writer.take());
    return;
  }
  for (int rank = 1; rank < ranks.size(); ++rank) {
    const std::vector<std::byte> bytes = receive_bytes(ranks, rank);
    ByteReader reader(bytes);
    std::size_t n = 0;
    for (reader(n); n < finished.size(); reader(n)) reader(finished[n]);
  }
}

}  // namespace

SweepPlan plan_sweep(const SweepOptions& options) {
  const std::vector<SweptKey> lists = lists_of(options);
  const RunOptions common = common_options(options);
  const SweepParts parts(options.run.output);
  RunKeys keys;
  SweepPlan plan;
  plan.files = shared_files(options);
  plan.scene = read_config(common.scene, common.overrides).text;
  if (options.show_scene) options.show_scene(plan.scene);
  plan.dimensions = dimensions_of(lists);
  std::vector<std::filesystem::path> inputs;
  std::optional<RunEstimate> first;
  std::vector<std::uint64_t> memory;
  for (std::vector<std::string>& settings : product_of(lists)) {
    InterruptGuard::check();
    RunOptions of_run = options_of(common, settings);
    of_run.dry_run = true;
    const PreparedRun prepared = prepare_run(of_run, plan.printed);
    const Scene& scene = prepared.scenes.front();
    inputs.insert(inputs.end(), scene.inputs.begin(), scene.inputs.end());
    const RunEstimate estimate = estimate_run(prepared.scenes, of_run, *plan.files);
    if (first) {
      check_same_coordinates(*first, estimate, settings);
    } else {
      first = estimate;
    }
    PlannedSweepRun run{std::move(settings), scene.text};
    if (options.show_scene) options.show_scene(run.scene);
    run.key = keys.of(scene, run.scene, of_run);
    run.done = parts.has(run.key);
    run.to_solve = !run.done && (!options.share || options.share->has(plan.runs.size()));
    if (run.to_solve) {
      ++plan.to_solve;
      plan.seconds += estimate.seconds;
      memory.push_back(estimate.memory_bytes);
    }
    plan.runs.push_back(std::move(run));
  }
  std::sort(inputs.begin(), inputs.end());
  inputs.erase(std::unique(inputs.begin(), inputs.end()), inputs.end());
  const std::vector<OutputFile> outputs{{options.run.output, "the result", OutputKind::hdf5},
                                        {parts.folder(), "the folder of finished runs", OutputKind::any}};
  check_distinct(outputs, inputs);
  for (const std::filesystem::path& input : inputs) {
    if (same_file(input.parent_path().empty() ? "." : input.parent_path(), parts.folder())) {
      throw InputError(
          fmt::format("{}: would be removed (found an input in the folder of finished runs, allowed "
                      "another folder)",
                      input.string()));
    }
  }
  parts.check();
  if (options.run.dry_run) {
    check_target(options.run.output);
  } else if (options.run.ranks == nullptr || options.run.ranks->is_first()) {
    check_writable(options.run.output);
  }
  std::sort(memory.rbegin(), memory.rend());
  memory.resize(std::min(memory.size(), static_cast<std::size_t>(options.jobs)));
  plan.memory_bytes = std::accumulate(memory.begin(), memory.end(), std::uint64_t{0});
  if (const std::uint64_t available = available_memory(options.run); plan.memory_bytes > available) {
    throw InputError(fmt::format(
        "--jobs: the runs need more memory than is available (found {} at a time with {:.0f} MB, allowed {:.0f} MB); "
        "fewer at a time need less",
        memory.size(), static_cast<double>(plan.memory_bytes) / 1e6, static_cast<double>(available) / 1e6));
  }
  plan.text = plan_text(plan, first->text, options.jobs, options.share);
  return plan;
}

SweepOutcome solve_sweep(const SweepOptions& options, const SweepPlan& plan) {
  const SweepParts parts(options.run.output);
  parts.make();
  std::vector<Finished> finished = Workers(options, plan, parts).solve();
  SweepOutcome outcome;
  if (options.run.ranks != nullptr) {
    gather_ends(*options.run.ranks, plan, finished);
    if (!options.run.ranks->is_first()) return outcome;
  }
  const auto note = [&outcome](const PlannedSweepRun& run, const Finished& end) {
    outcome.exit_code = graver(outcome.exit_code, end.exit_code);
    if (!end.message.empty())
      outcome.sentences.push_back(fmt::format("{}: {}", fmt::join(run.settings, ", "), end.message));
  };
  if (options.share && options.run.ranks == nullptr) {
    for (std::size_t n = 0; n < plan.runs.size(); ++n) {
      if (plan.runs[n].to_solve) note(plan.runs[n], finished[n]);
    }
    return outcome;
  }
  std::vector<SweptRun> runs;
  bool any = false, all = true;
  for (std::size_t n = 0; n < plan.runs.size(); ++n) {
    const PlannedSweepRun& run = plan.runs[n];
    if (run.done) finished[n] = end_of(parts.file(run.key));
    const Finished& end = finished[n];
    const bool has_result = end.exit_code == exit_done || end.exit_code == exit_not_converged;
    any = any || has_result;
    all = all && has_result;
    runs.push_back({has_result ? parts.file(run.key) : std::filesystem::path(), end.exit_code, end.message, run.scene});
    note(run, end);
  }
  if (any) {
    write_sweep(options.run.output, plan.dimensions, runs,
                {fmt::format("cloudbow {}", version()), history_line(options.run.command), plan.scene});
    outcome.written = true;
  } else {
    outcome.sentences.push_back(fmt::format("no run has a result: {} is not written", options.run.output.string()));
  }
  // A failed run may succeed in another attempt, with more memory perhaps.
  if (all) {
    std::vector<std::uint64_t> keys;
    for (const PlannedSweepRun& run : plan.runs) keys.push_back(run.key);
    outcome.kept = parts.remove(keys);
  } else if (any) {
    outcome.sentences.push_back(
        fmt::format("the results of the other runs are kept in {}: the same command solves "
                    "those that failed again",
                    parts.folder().string()));
  }
  return outcome;
}

int sweep(const SweepOptions& given) {
  const InterruptGuard guard;
  SweepOptions options = given;
  const Ranks* const ranks = options.run.ranks;
  const bool prints = ranks == nullptr || ranks->is_first();
  if (ranks != nullptr) {
    if (options.share) {
      throw InputError(
          "--share: excludes mpirun (found both, allowed one of the two) mpirun shares the runs out itself");
    }
    options.share = {static_cast<std::size_t>(ranks->rank()) + 1, static_cast<std::size_t>(ranks->size())};
  }
  const SweepPlan plan = plan_sweep(options);
  if (options.run.dry_run) {
    if (prints) fmt::print("{}", plan.text);
    return exit_done;
  }
  const std::string folder = SweepParts(options.run.output).folder().string();
  if (const std::size_t done = done_runs(plan); !options.run.quiet && done > 0)
    tell("cloudbow: {} of {} runs were done, in {}\n", done, plan.runs.size(), folder);
  try {
    const SweepOutcome outcome = solve_sweep(options, plan);
    for (const std::string& sentence : outcome.sentences) tell("cloudbow: {}\n", printable(sentence));
    if (options.run.quiet || !prints) return outcome.exit_code;
    if (options.share && ranks == nullptr) {
      fmt::print(
          "share {} of {}: {} runs solved, kept in {}. Without --share, after all shares, the same command writes {}\n",
          options.share->number, options.share->of, plan.to_solve, folder, options.run.output.string());
    } else {
      if (outcome.written) fmt::print("{} runs written to {}\n", plan.runs.size(), options.run.output.string());
      if (outcome.kept > 0)
        tell("cloudbow: {} finished runs of other sweeps stay in {}: remove the folder if none goes on\n", outcome.kept,
             folder);
    }
    return outcome.exit_code;
  } catch (const Interrupted&) {
    tell("cloudbow: finished runs are kept in {}: the same command goes on from there\n", folder);
    throw;
  }
}

}  // namespace cloudbow
