#include "app/runs/sweep_parts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <fstream>
#include <string_view>
#include <system_error>
#include <vector>

#include "app/process/version.hpp"
#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/digest.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/io/sweep_file.hpp"

namespace cloudbow {
namespace {

constexpr std::string_view vdb_begin = " BDV";
/// The header of an OpenVDB file has a random identifier, another one each time the same grid is written.
constexpr std::size_t vdb_identifier_begin = 21, vdb_identifier_end = 57;

bool is_part(const std::filesystem::path& file) {
  const std::string name = file.filename().string();
  constexpr std::size_t digits = 16;  // of run_key_text()
  // Temporary files of AtomicFile begin with a point.
  const std::string_view bare = std::string_view(name).substr(name.starts_with('.') ? 1 : 0);
  return bare.starts_with("run-") && bare.size() >= 4 + digits + 3 && bare.substr(4 + digits).starts_with(".h5");
}

}  // namespace

std::string run_key_text(std::uint64_t key) { return fmt::format("{:016x}", key); }

std::uint64_t RunKeys::of(const Scene& scene, const std::string& text, const RunOptions& options) {
  Digest digest;
  const auto add = [&digest](const std::string& words) {
    digest.add(words.size());
    digest.add_bytes(words.data(), words.size());
  };
  add(version());
  add(text);
  for (const bool flag : {options.compare, options.clear_sky}) digest.add(flag);
  for (const std::filesystem::path& input : scene.inputs) {
    if (!same_file(input, scene.path)) digest.add(contents_of(input));
  }
  return digest.value();
}

std::uint64_t RunKeys::contents_of(const std::filesystem::path& file) {
  if (const auto known = contents_.find(file); known != contents_.end()) return known->second;
  std::ifstream stream = open_input(file, "an input of the scene");
  Digest digest;
  std::vector<char> bytes(1 << 20);
  for (bool first = true; stream; first = false) {
    stream.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    const auto count = static_cast<std::size_t>(stream.gcount());
    if (first && count >= vdb_identifier_end && std::string_view(bytes.data(), vdb_begin.size()) == vdb_begin)
      std::fill(bytes.begin() + vdb_identifier_begin, bytes.begin() + vdb_identifier_end, '\0');
    digest.add_bytes(bytes.data(), count);
  }
  return contents_[file] = digest.value();
}

SweepParts::SweepParts(const std::filesystem::path& output) : folder_(output.string() + ".parts") {}

std::filesystem::path SweepParts::file(std::uint64_t key) const {
  return folder_ / fmt::format("run-{}.h5", run_key_text(key));
}

bool SweepParts::has(std::uint64_t key) const {
  const std::filesystem::path part = file(key);
  std::error_code error;
  return std::filesystem::exists(part, error) && is_whole_result(part, run_key_text(key));
}

void SweepParts::check() const {
  const auto refuse = [this](const std::string& reason) {
    throw InputError(
        fmt::format("{}: can't be made, a folder for the results of finished runs ({})", folder_.string(), reason));
  };
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(folder_, error);
  if (status.type() == std::filesystem::file_type::none) refuse(error.message());
  if (std::filesystem::exists(status) && !std::filesystem::is_directory(status)) refuse("a file has this name");
  if (std::filesystem::exists(status)) check_target(file(0));
}

void SweepParts::make() const {
  check();
  std::error_code error;
  std::filesystem::create_directory(folder_, error);
  check_target(file(0));
}

std::size_t SweepParts::remove(std::span<const std::uint64_t> keys) const {
  std::error_code error;
  std::vector<std::filesystem::path> parts;
  std::size_t kept = 0;
  for (const auto& entry : std::filesystem::directory_iterator(folder_, error)) {
    const std::string name = entry.path().filename().string();
    if (!is_part(entry.path())) continue;
    const bool of_keys = std::any_of(keys.begin(), keys.end(), [&](std::uint64_t key) {
      return name.find(file(key).filename().string()) != std::string::npos;
    });
    if (of_keys) {
      parts.push_back(entry.path());
    } else if (!name.starts_with('.')) {
      ++kept;
    }
  }
  for (const std::filesystem::path& part : parts) std::filesystem::remove(part, error);
  std::filesystem::remove(folder_, error);  // fails if anything is left in it
  return kept;
}

}  // namespace cloudbow
