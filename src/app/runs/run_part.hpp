// Parts of a run: the solves of one job of a batch system in a file, from which `cloudbow merge` makes the result.
#pragma once

#include <cstdint>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "app/planning/solve_share.hpp"
#include "app/process/job_share.hpp"
#include "cloudbow/core/atomic_file.hpp"
#include "cloudbow/core/digest.hpp"

namespace cloudbow {

/// The command of which a file is a part: the same in all of them.
struct PartHeader {
  std::uint64_t key = 0;  ///< of RunKeys: all that the solves depend on
  std::uint64_t parts = 1;
  std::string version;  ///< of the program
  std::string scene, output;
  std::vector<std::string> overrides;
  bool compare = false;
  bool clear_sky = false;

  bool operator==(const PartHeader&) const = default;
};

/// FILE.part-I-of-N
std::filesystem::path part_file(const std::filesystem::path& output, const JobShare& share);

/// Writes every solve of one job to its part as soon as it is there.
class PartWriter : public SolveShare {
 public:
  /// @throws InputError if the file cannot be written.
  PartWriter(const std::filesystem::path& file, const JobShare& share, const PartHeader& header);

  bool has(std::size_t solve) const override { return share_.has(solve); }
  bool collects() const override { return false; }
  void give(std::size_t solve, const SolveResult& result) override;
  SolveResult take(std::size_t solve) override;
  void fail(std::size_t) override { throw; }

  /// The part gets its name. @throws InputError.
  void finish();
  std::size_t solves() const { return written_; }

 private:
  void write(const void* bytes, std::size_t count);
  void write_sized(std::span<const std::byte> bytes);

  JobShare share_;
  std::filesystem::path file_;
  AtomicFile target_;
  std::ofstream stream_;
  Digest digest_;
  std::size_t written_ = 0;
};

/// All parts of a run.
class PartsReader : public SolveShare {
 public:
  /// @throws InputError if a file is no part, is damaged or of another version; if the files are not all parts of one
  /// run.
  explicit PartsReader(const std::vector<std::filesystem::path>& files);

  const PartHeader& header() const { return header_; }

  bool has(std::size_t) const override { return false; }
  bool collects() const override { return true; }
  void give(std::size_t, const SolveResult&) override {}
  SolveResult take(std::size_t solve) override;
  void fail(std::size_t) override { throw; }

 private:
  struct Location {
    std::filesystem::path file;
    std::uint64_t offset = 0, size = 0;
  };
  /// @returns the number of the part.
  std::uint64_t add(const std::filesystem::path& file, bool first);

  PartHeader header_;
  std::map<std::uint64_t, Location> solves_;  ///< by number
};

}  // namespace cloudbow
