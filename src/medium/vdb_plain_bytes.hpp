// Bytes of a file that may be damaged. Each length is compared with the size of the file before it is used.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <span>
#include <string>
#include <type_traits>

namespace cloudbow {

/// Thrown within the reader of ordinary files, for any other file. It never leaves that reader.
struct NotPlain {};

inline void require_plain(bool condition) {
  if (!condition) throw NotPlain{};
}

/// Reads a file from its start. Numbers are little-endian, as OpenVDB writes them.
class PlainBytes {
 public:
  /// @throws NotPlain if it cannot be opened
  explicit PlainBytes(const std::filesystem::path& path);

  std::uint64_t size() const { return size_; }
  std::uint64_t position() const { return position_; }
  std::uint64_t left() const { return size_ - position_; }

  /// @throws NotPlain if the file ends before
  void read(std::span<std::byte> target);

  template <class Number>
  Number number() {
    static_assert(std::is_arithmetic_v<Number> && !std::is_same_v<Number, bool>);
    Number value{};
    read(std::as_writable_bytes(std::span(&value, 1)));
    return value;
  }
  /// A byte that must be 0 or 1.
  bool flag();
  /// So many bytes as a text.
  std::string text(std::uint64_t bytes);
  /// A text after its length.
  std::string text() { return text(number<std::uint32_t>()); }

  void move_to(std::uint64_t position);

 private:
  std::filebuf file_;
  std::uint64_t size_ = 0;
  std::uint64_t position_ = 0;
};

}  // namespace cloudbow
