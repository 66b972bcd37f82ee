#include "app/runs/run_part.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <set>
#include <stdexcept>
#include <string_view>

#include "app/process/version.hpp"
#include "cloudbow/core/bytes.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/core/printable.hpp"

// A file has these bytes, in the order of this machine. First come the magic, the number of the part, and the size and
// bytes of the header. Each solve follows with its number, its size and its bytes. The end is a number that no solve
// has, and the digest of all before.
namespace cloudbow {

template <class Archive>
void visit_members(Archive& archive, PartHeader& header) {
  auto& [key, parts, by, scene, output, overrides, compare, clear_sky] = header;
  archive(key, parts, by, scene, output, overrides, compare, clear_sky);
}

namespace {

constexpr std::string_view magic = "cloudbow part 1\n";
constexpr std::uint64_t after_last_solve = std::numeric_limits<std::uint64_t>::max();
constexpr const char* allowed_file = "a file of run --part";

[[noreturn]] void refuse(const std::filesystem::path& file, const std::string& problem) {
  throw InputError(
      fmt::format("{}: can't be read as a part of a run ({}); allowed: {}", file.string(), problem, allowed_file));
}

/// Reads a part piece by piece, and its digest with it.
class PartFile {
 public:
  explicit PartFile(const std::filesystem::path& file)
      : file_(file), stream_(open_input(file, allowed_file)), left_(std::filesystem::file_size(file)) {}

  void read(void* to, std::uint64_t count) {
    if (count > left_ || !stream_.read(static_cast<char*>(to), static_cast<std::streamsize>(count)))
      refuse(file_, "it ends too early");
    left_ -= count;
    digest_.add_bytes(to, count);
  }
  std::uint64_t read_number() {
    std::uint64_t number = 0;
    read(&number, sizeof number);
    return number;
  }
  /// A number of bytes that the file still holds.
  std::uint64_t read_size() {
    const std::uint64_t size = read_number();
    if (size > left_) refuse(file_, "it ends too early");
    return size;
  }
  void pass_over(std::uint64_t count) {
    std::vector<std::byte> room(std::min<std::uint64_t>(count, std::uint64_t{1} << 20));
    for (std::uint64_t done = 0; done < count; done += room.size()) {
      room.resize(std::min<std::uint64_t>(room.size(), count - done));
      read(room.data(), room.size());
    }
  }
  bool is_at_end() const { return left_ == 0; }
  std::uint64_t offset() { return static_cast<std::uint64_t>(stream_.tellg()); }
  std::uint64_t digest() const { return digest_.value(); }

 private:
  std::filesystem::path file_;
  std::ifstream stream_;
  std::uint64_t left_;
  Digest digest_;
};

struct PartBegin {
  PartHeader header;
  std::uint64_t number = 0;
};

PartBegin read_begin(PartFile& part, const std::filesystem::path& file) {
  std::array<char, magic.size()> found{};
  part.read(found.data(), found.size());
  if (std::string_view(found.data(), found.size()) != magic) refuse(file, "it begins with other bytes");
  PartBegin begin;
  begin.number = part.read_number();
  std::vector<std::byte> bytes(part.read_size());
  part.read(bytes.data(), bytes.size());
  try {
    ByteReader reader(bytes);
    reader(begin.header);
  } catch (const InputError& error) {
    refuse(file, error.what());
  }
  if (begin.number < 1 || begin.number > begin.header.parts) refuse(file, "its bytes are damaged");
  return begin;
}

void check_same_run(const PartHeader& first, const PartHeader& other, const std::filesystem::path& file) {
  if (other == first) return;
  const std::string what = other.version != first.version ? fmt::format("version {}", printable(other.version))
                           : other.parts != first.parts   ? fmt::format("{} parts", other.parts)
                           : other.scene != first.scene   ? fmt::format("scene {}", printable(other.scene))
                                                          : "other inputs or options";
  throw InputError(
      fmt::format("{}: is of another run than the first part (found {}, allowed parts of one command and version)",
                  file.string(), what));
}

}  // namespace

std::filesystem::path part_file(const std::filesystem::path& output, const JobShare& share) {
  return fmt::format("{}.part-{}-of-{}", output.string(), share.number, share.of);
}

PartWriter::PartWriter(const std::filesystem::path& file, const JobShare& share, const PartHeader& header)
    : share_(share), file_(file), target_(file), stream_(target_.temporary(), std::ios::binary) {
  ByteWriter writer;
  writer(header);
  write(magic.data(), magic.size());
  const std::uint64_t number = share.number;
  write(&number, sizeof number);
  write_sized(writer.take());
}

void PartWriter::write(const void* bytes, std::size_t count) {
  digest_.add_bytes(bytes, count);
  if (!stream_.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(count)))
    throw_unwritable(file_, "the disk refuses more bytes");
}

void PartWriter::write_sized(std::span<const std::byte> bytes) {
  const std::uint64_t size = bytes.size();
  write(&size, sizeof size);
  write(bytes.data(), bytes.size());
}

void PartWriter::give(std::size_t solve, const SolveResult& result) {
  const std::uint64_t number = solve;
  write(&number, sizeof number);
  write_sized(bytes_of(result));
  ++written_;
}

SolveResult PartWriter::take(std::size_t) { throw std::logic_error("a part takes no results"); }

void PartWriter::finish() {
  write(&after_last_solve, sizeof after_last_solve);
  const std::uint64_t digest = digest_.value();
  write(&digest, sizeof digest);
  stream_.close();
  if (!stream_) throw_unwritable(file_, "the disk refuses more bytes");
  target_.commit();
}

PartsReader::PartsReader(const std::vector<std::filesystem::path>& files) {
  std::set<std::uint64_t> numbers;
  for (const std::filesystem::path& file : files) {
    if (const std::uint64_t number = add(file, numbers.empty()); !numbers.insert(number).second)
      throw InputError(
          fmt::format("{}: is part {} of {} (found it twice, allowed once)", file.string(), number, header_.parts));
  }
  for (std::uint64_t number = 1; number <= header_.parts; ++number) {
    if (numbers.contains(number)) continue;
    throw InputError(fmt::format(
        "{}: part {} of {} is missing (found {} parts, allowed all) give its file too, or solve it with --part {}/{}",
        header_.output, number, header_.parts, numbers.size(), number, header_.parts));
  }
}

std::uint64_t PartsReader::add(const std::filesystem::path& file, bool first) {
  PartFile part(file);
  const PartBegin begin = read_begin(part, file);
  if (first) {
    header_ = begin.header;
    if (header_.version != version())
      throw InputError(fmt::format("{}: is a part by another version (found {}, allowed {}); use that program",
                                   file.string(), printable(header_.version), version()));
  }
  check_same_run(header_, begin.header, file);
  for (std::uint64_t solve = part.read_number(); solve != after_last_solve; solve = part.read_number()) {
    const std::uint64_t size = part.read_size();
    solves_[solve] = {file, part.offset(), size};
    part.pass_over(size);
  }
  const std::uint64_t digest = part.digest();
  if (part.read_number() != digest) refuse(file, "its bytes are damaged");
  if (!part.is_at_end()) refuse(file, "it goes on after its end");
  return begin.number;
}

SolveResult PartsReader::take(std::size_t solve) {
  const auto found = solves_.find(solve);
  if (found == solves_.end())
    throw InputError(
        fmt::format("{}: solve {} is in no part (found parts of fewer solves, allowed those of this scene)",
                    header_.output, solve));
  const Location& location = found->second;
  std::ifstream stream = open_input(location.file, allowed_file);
  stream.seekg(static_cast<std::streamoff>(location.offset));
  std::vector<std::byte> bytes(location.size);
  if (!stream.read(reinterpret_cast<char*>(bytes.data()), static_cast<std::streamsize>(bytes.size())))
    refuse(location.file, "it ends too early");
  try {
    return solve_result(bytes);
  } catch (const InputError& error) {
    refuse(location.file, error.what());
  }
}

}  // namespace cloudbow
