// ZIP by its specification, APPNOTE 6.3: the end record (4.3.16), its form of 64 bits (4.3.14), the directory (4.3.12)
// and the headers of members (4.3.7).
#include "npz_archive.hpp"

#include <zlib.h>

#include <algorithm>
#include <fstream>

#include "cloudbow/core/available_memory.hpp"
#include "import_parts.hpp"

namespace cloudbow {
namespace {

constexpr std::uint64_t end_bytes = 22, longest_comment = 65535, locator_bytes = 20, end_64_bytes = 56;
constexpr std::uint64_t directory_bytes = 46, header_bytes = 30;
constexpr std::uint64_t in_extra_field = 0xffffffff;
constexpr std::uint16_t extra_of_64_bits = 1;

/// A number of little-endian bytes.
std::uint64_t number_at(const std::string& bytes, std::size_t at, std::size_t count) {
  std::uint64_t number = 0;
  for (std::size_t n = 0; n < count; ++n)
    number |= static_cast<std::uint64_t>(static_cast<unsigned char>(bytes[at + n])) << (8 * n);
  return number;
}

}  // namespace

NpzArchive::NpzArchive(const std::filesystem::path& file)
    : file_(file), file_bytes_(static_cast<std::uint64_t>(std::filesystem::file_size(file))) {
  read_directory();
}

bool NpzArchive::has(const std::string& name) const {
  return std::find(names_.begin(), names_.end(), name) != names_.end();
}

std::string NpzArchive::bytes_at(std::uint64_t begin, std::uint64_t count) const {
  if (count > file_bytes_ || begin > file_bytes_ - count)
    fail_import(file_, "damaged or cut off: a part of the archive lies beyond its end (found {} bytes)", file_bytes_);
  std::ifstream stream(file_, std::ios::binary);
  std::string bytes(static_cast<std::size_t>(count), '\0');
  stream.seekg(static_cast<std::streamoff>(begin));
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(count)))
    fail_import(file_, "cannot be read (check the disk and its permissions)");
  return bytes;
}

void NpzArchive::read_directory() {
  const std::uint64_t tail_bytes = std::min(file_bytes_, end_bytes + longest_comment);
  const std::string tail = bytes_at(file_bytes_ - tail_bytes, tail_bytes);
  const auto end = tail.rfind("PK\x05\x06");
  if (end == std::string::npos || end + end_bytes > tail.size())
    fail_import(file_, "no NumPy archive, or cut off (found no end record of a ZIP file, allowed .npz)");
  std::uint64_t count = number_at(tail, end + 10, 2), size = number_at(tail, end + 12, 4);
  std::uint64_t begin = number_at(tail, end + 16, 4);
  const std::uint64_t end_at = file_bytes_ - tail_bytes + end;
  if ((begin == in_extra_field || count == 0xffff || size == in_extra_field) && end_at >= locator_bytes) {
    const std::string locator = bytes_at(end_at - locator_bytes, locator_bytes);
    if (locator.starts_with("PK\x06\x07")) {
      const std::string record = bytes_at(number_at(locator, 8, 8), end_64_bytes);
      count = number_at(record, 32, 8);
      size = number_at(record, 40, 8);
      begin = number_at(record, 48, 8);
    }
  }
  const std::string directory = bytes_at(begin, size);
  std::size_t at = 0;
  for (std::uint64_t n = 0; n < count; ++n) {
    if (directory.size() - at < directory_bytes || directory.compare(at, 4, "PK\x01\x02") != 0)
      fail_import(file_, "damaged directory of the archive (found {} of {} arrays)", n, count);
    const std::size_t name_bytes = number_at(directory, at + 28, 2), extra_bytes = number_at(directory, at + 30, 2),
                      comment_bytes = number_at(directory, at + 32, 2);
    const std::size_t extra = at + directory_bytes + name_bytes, next = extra + extra_bytes + comment_bytes;
    if (next > directory.size())
      fail_import(file_, "damaged directory of the archive (found {} of {} arrays)", n, count);
    Member member{static_cast<int>(number_at(directory, at + 10, 2)),
                  static_cast<std::uint32_t>(number_at(directory, at + 16, 4)), number_at(directory, at + 20, 4),
                  number_at(directory, at + 24, 4), number_at(directory, at + 42, 4)};
    for (std::size_t e = extra; e + 4 <= extra + extra_bytes;) {
      const std::size_t length = number_at(directory, e + 2, 2), stop = e + 4 + length;
      if (stop > extra + extra_bytes) break;
      std::size_t value = e + 4;
      for (std::uint64_t* number : {&member.bytes, &member.stored_bytes, &member.header_at}) {
        if (number_at(directory, e, 2) != extra_of_64_bits || *number != in_extra_field || value + 8 > stop) continue;
        *number = number_at(directory, value, 8);
        value += 8;
      }
      e = stop;
    }
    std::string name = directory.substr(at + directory_bytes, name_bytes);
    if (name.ends_with(".npy")) {
      names_.push_back(name.substr(0, name.size() - 4));
      members_.push_back(member);
    }
    at = next;
  }
  if (names_.empty()) fail_import(file_, "no NumPy archive (found no .npy file in it, allowed at least one)");
}

std::string NpzArchive::content(const std::string& name) const {
  const auto found = std::find(names_.begin(), names_.end(), name);
  const Member& member = members_[static_cast<std::size_t>(found - names_.begin())];
  const std::string header = bytes_at(member.header_at, header_bytes);
  if (!header.starts_with("PK\x03\x04")) fail_import(file_, "array '{}': damaged (found no header of it)", name);
  const std::string stored = bytes_at(
      member.header_at + header_bytes + number_at(header, 26, 2) + number_at(header, 28, 2), member.stored_bytes);
  if (member.bytes > available_memory_bytes() / 2) {
    fail_import(file_, "array '{}': too large for the memory (found {} bytes, allowed {})", name, member.bytes,
                available_memory_bytes() / 2);
  }
  constexpr int as_it_is = 0, deflated = 8;
  constexpr std::uint64_t most_times = 1100;  // deflate packs at most 1032 bytes into one
  std::string bytes;
  if (member.method == as_it_is) {
    bytes = stored;
  } else if (member.method == deflated && member.bytes / most_times <= member.stored_bytes) {
    bytes.resize(static_cast<std::size_t>(member.bytes));
    z_stream stream{};
    if (inflateInit2(&stream, -MAX_WBITS) != Z_OK) throw std::bad_alloc();
    // Counts of zlib have 32 bits.
    constexpr std::size_t most = 1U << 30;
    std::size_t in = 0, out = 0;
    int status = Z_OK;
    while (status == Z_OK && out <= bytes.size()) {
      const std::size_t in_now = std::min(most, stored.size() - in), out_now = std::min(most, bytes.size() - out);
      // zlib does not write to its input.
      stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(stored.data() + in));
      stream.avail_in = static_cast<uInt>(in_now);
      stream.next_out = reinterpret_cast<Bytef*>(bytes.data() + out);
      stream.avail_out = static_cast<uInt>(out_now);
      status = inflate(&stream, Z_NO_FLUSH);
      in += in_now - stream.avail_in;
      out += out_now - stream.avail_out;
    }
    inflateEnd(&stream);
    if (status != Z_STREAM_END || out != bytes.size())
      fail_import(file_, "array '{}': its compressed numbers are damaged", name);
  } else {
    fail_import(
        file_,
        "array '{}': compressed by a method that is not read (found {}, allowed numpy.savez or savez_compressed)", name,
        member.method);
  }
  std::uint32_t checksum = 0;
  for (std::size_t at = 0; at < bytes.size(); at += 1U << 30) {
    const std::size_t count = std::min<std::size_t>(1U << 30, bytes.size() - at);
    checksum = static_cast<std::uint32_t>(
        crc32(checksum, reinterpret_cast<const Bytef*>(bytes.data() + at), static_cast<uInt>(count)));
  }
  if (bytes.size() != member.bytes || checksum != member.checksum)
    fail_import(file_, "array '{}': damaged (its checksum differs)", name);
  return bytes;
}

}  // namespace cloudbow
