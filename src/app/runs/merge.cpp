#include "app/runs/merge.hpp"

#include <fmt/format.h>

#include <memory>

#include "app/process/exit_codes.hpp"
#include "app/process/interrupt.hpp"
#include "app/process/version.hpp"
#include "app/runs/run_part.hpp"
#include "app/runs/sweep_parts.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"

namespace cloudbow {
namespace {

PartHeader part_header(const PreparedRun& prepared, const RunOptions& options, std::uint64_t parts) {
  const Scene& scene = prepared.scenes.front();
  return {.key = RunKeys().of(scene, scene.text, options),
          .parts = parts,
          .version = version(),
          .scene = options.scene.string(),
          .output = prepared.output.string(),
          .overrides = options.overrides,
          .compare = options.compare,
          .clear_sky = options.clear_sky};
}

}  // namespace

int solve_part(const PreparedRun& prepared, RunOptions options) {
  const std::filesystem::path file = part_file(prepared.output, *options.part);
  const auto part = std::make_shared<PartWriter>(file, *options.part, part_header(prepared, options, options.part->of));
  options.share = part;
  solve_run(prepared.scenes, options);
  part->finish();
  if (!options.quiet) {
    fmt::print("part {} of {}: {} solves in {}. After all parts, `cloudbow merge {}.part-*` writes {}\n",
               options.part->number, options.part->of, part->solves(), file.string(), prepared.output.string(),
               prepared.output.string());
  }
  return exit_done;
}

int merge(const MergeOptions& given) {
  const auto parts = std::make_shared<PartsReader>(given.parts);
  const PartHeader& header = parts->header();
  RunOptions options;
  options.scene = header.scene;
  options.overrides = header.overrides;
  options.output = given.output.empty() ? std::filesystem::path(header.output) : given.output;
  options.threads = given.threads;
  options.quiet = given.quiet;
  options.compare = header.compare;
  options.clear_sky = header.clear_sky;
  options.command = given.command;
  options.share = parts;
  const PreparedRun prepared = prepare_run(options);
  if (part_header(prepared, options, header.parts).key != header.key) {
    throw InputError(
        fmt::format("{}: has changed since its parts were solved (found another scene or other inputs, "
                    "allowed the same); solve the parts anew",
                    header.scene));
  }
  check_distinct(std::vector<OutputFile>{{prepared.output, "the result", OutputKind::hdf5}}, given.parts);
  const InterruptGuard guard;
  return finish_run(prepared, solve_run(prepared.scenes, options), options);
}

}  // namespace cloudbow
