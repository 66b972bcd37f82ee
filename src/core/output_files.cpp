#include "cloudbow/core/output_files.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <unordered_map>

#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {

namespace fs = std::filesystem;

namespace {

/// Equal for two paths that lead to the same file: its number, or that of the folder and the name of a file not yet
/// written. Such names count as one if they differ by case alone: some file systems do not distinguish them.
std::string identity_of(const fs::path& path) {
  struct stat found {};
  if (stat(path.c_str(), &found) == 0) return fmt::format("{}:{}", found.st_dev, found.st_ino);
  const fs::path file = written_file(path);
  if (stat(file.parent_path().c_str(), &found) != 0) return file.string();
  std::string name = file.filename().string();
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) { return std::tolower(c); });
  return fmt::format("{}:{}/{}", found.st_dev, found.st_ino, name);
}

struct KindEndings {
  OutputKind kind;
  std::vector<std::string> endings;  ///< empty: any
};

const std::vector<std::string>& endings_of(OutputKind kind) {
  static const std::vector<KindEndings> table{{OutputKind::any, {}},
                                              {OutputKind::hdf5, {".h5", ".hdf5", ".nc", ".nc4"}},
                                              {OutputKind::checkpoint, {".h5", ".hdf5", ".checkpoint", ".ckpt", ".ck"}},
                                              {OutputKind::vdb, {".vdb"}},
                                              {OutputKind::csv, {".csv", ".txt"}},
                                              {OutputKind::plot, {".png", ".svg", ".pdf"}},
                                              {OutputKind::picture, {".png", ".svg", ".pdf", ".exr"}}};
  return std::ranges::find(table, kind, &KindEndings::kind)->endings;
}

[[noreturn]] void throw_overwrites(const OutputFile& output, const std::string& victim, const fs::path& path) {
  throw InputError(fmt::format("{}: {} would overwrite {} (found the same file as {}, allowed any other)",
                               output.path.string(), output.use, victim, path.string()));
}

}  // namespace

bool same_file(const fs::path& a, const fs::path& b) { return identity_of(a) == identity_of(b); }

std::string name_ending(const fs::path& file) {
  std::string ending = file.extension().string();
  std::transform(ending.begin(), ending.end(), ending.begin(), [](unsigned char c) { return std::tolower(c); });
  return ending.find_first_not_of(".0123456789") == std::string::npos ? "" : ending;
}

void check_ending(const OutputFile& output) {
  const std::vector<std::string>& allowed = endings_of(output.kind);
  const std::string ending = name_ending(output.path);
  if (allowed.empty() || ending.empty() || std::ranges::count(allowed, ending) > 0) return;
  throw InputError(fmt::format("{}: {} does not go by this ending (found {}, allowed {}, or none)",
                               output.path.string(), output.use, output.path.extension().string(),
                               fmt::join(allowed, ", ")));
}

void check_distinct(std::span<const OutputFile> outputs, std::span<const fs::path> inputs) {
  std::unordered_map<std::string, const fs::path*> read;
  for (const fs::path& input : inputs) {
    if (!input.empty()) read.emplace(identity_of(input), &input);
  }
  std::unordered_map<std::string, const OutputFile*> written;
  for (const OutputFile& output : outputs) {
    if (output.path.empty()) continue;
    const std::string identity = identity_of(output.path);
    if (const auto input = read.find(identity); input != read.end())
      throw_overwrites(output, "an input", *input->second);
    const auto [other, is_new] = written.emplace(identity, &output);
    if (!is_new) throw_overwrites(output, other->second->use, other->second->path);
    // Those of killed processes are removed when the output is written.
    for (const fs::path& input : inputs) {
      if (is_temporary_of(input, output.path)) throw_overwrites(output, "an input", input);
    }
  }
  for (const OutputFile& output : outputs) check_ending(output);
}

void check_writable(const fs::path& file) { const AtomicFile probe(file); }

void check_outputs(const std::vector<OutputFile>& outputs, std::span<const fs::path> inputs) {
  check_distinct(outputs, inputs);
  for (const OutputFile& output : outputs) {
    if (!output.path.empty()) check_writable(output.path);
  }
}

}  // namespace cloudbow
