#include "app/planning/run_checkpoints.hpp"

#include <fmt/format.h>

#include "app/process/interrupt.hpp"
#include "app/process/messages.hpp"
#include "app/process/version.hpp"
#include "cloudbow/core/digest.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/core/printable.hpp"

namespace cloudbow {
namespace {

// The same bits are the promise of one version alone.
StateKey of_this_version(const StateKey& key, const std::string& source) {
  Digest digest;
  digest.add(key.problem);
  digest.add_bytes(source.data(), source.size());
  return {key.layout, digest.value()};
}

bool is_there(const std::filesystem::path& file) {
  std::error_code error;
  return std::filesystem::exists(file, error);
}

}  // namespace

std::filesystem::path checkpoint_file(const std::filesystem::path& file, std::size_t of, std::size_t solves) {
  if (file.empty()) return {};
  return solves > 1 ? std::filesystem::path(fmt::format("{}.{}", file.string(), of + 1)) : file;
}

RunCheckpoints::RunCheckpoints(const RunOptions& options, std::size_t of, std::size_t solves)
    : quiet_(options.quiet), every_(60 * options.checkpoint_minutes), source_(fmt::format("cloudbow {}", version())) {
  if (!options.checkpoint.empty()) to_ = checkpoint_file(options.checkpoint, of, solves);
  if (options.resume.empty()) return;
  from_ = checkpoint_file(options.resume, of, solves);
  // A file used for both --checkpoint and --resume does not exist at the first start. Those of later wavelengths are
  // written later.
  const bool may_lack = of > 0 || (!options.checkpoint.empty() && same_file(options.checkpoint, options.resume));
  if (may_lack && !is_there(from_)) return;
  input_ = std::make_unique<CheckpointInput>(from_);
}

Checkpoints::Found RunCheckpoints::find(const StateKey& key) {
  used_ = true;
  if (!input_) return Found::nothing;
  if (input_->key().layout != key.layout) {
    throw InputError(
        fmt::format("{}: is of other cells, directions or another precision (allowed: a checkpoint of the same cloud, "
                    "domain, solver.accuracy, solver.mode and solver.radiance_storage; sun, sky, surface, tolerance "
                    "and output may differ, but actinic flux and subdivided levels have cells of their own)",
                    from_.string()));
  }
  return of_this_version(key, source_) == input_->key() ? Found::same_problem : Found::same_layout;
}

void RunCheckpoints::load(const StateArray& array) { input_->load(array); }

void RunCheckpoints::refuse(const std::string& problem) {
  throw InputError(fmt::format("{}: {}", from_.string(), problem));
}

void RunCheckpoints::loaded(int sweeps) {
  input_.reset();
  if (quiet_) return;
  if (sweeps > 0) {
    tell("cloudbow: goes on after sweep {} of {}\n", sweeps, from_.string());
  } else {
    tell("cloudbow: begins with the light of {}, another problem or tolerance\n", from_.string());
  }
}

bool RunCheckpoints::due() {
  return !to_.empty() && (InterruptGuard::noted() || std::chrono::steady_clock::now() - last_ >= every_);
}

void RunCheckpoints::save(const StateKey& key, std::span<const StateArray> state) {
  if (to_.empty()) return;
  try {
    write_checkpoint(to_, source_, of_this_version(key, source_), state);
    if (InterruptGuard::noted() && !quiet_) tell("cloudbow: the run can go on with --resume {}\n", to_.string());
  } catch (const InputError& error) {
    tell("cloudbow: no checkpoint: {}\n", printable(error.what()));
  }
  last_ = std::chrono::steady_clock::now();
  InterruptGuard::check();
}

}  // namespace cloudbow
