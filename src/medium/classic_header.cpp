#include "classic_header.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace cloudbow {
namespace {

/// netCDF User's Guide, "File Format Specifications". Reading ends with the stream's error.
class ClassicHeader {
 public:
  explicit ClassicHeader(std::istream& stream) : stream_(stream) {}

  std::uint64_t longest_name() {
    std::array<char, 4> magic{};
    stream_.read(magic.data(), magic.size());
    const char version = magic[3];
    if (!stream_ || !std::string_view(magic.data(), 3).starts_with("CDF")) return 0;
    if (version != 1 && version != 2 && version != 5) return 0;
    count_bytes_ = version == 5 ? 8 : 4;
    const std::uint64_t offset_bytes = version == 1 ? 4 : 8;
    read_count();  // records
    read_list([&] {
      read_name();
      read_count();  // length
    });
    read_attributes();
    read_list([&] {
      read_name();
      skip(read_count(), count_bytes_);  // dimensions
      read_attributes();
      skip(word_bytes + count_bytes_ + offset_bytes, 1);  // type, size, begin
    });
    return longest_;
  }

 private:
  static constexpr std::uint64_t word_bytes = 4;  // to which names and values are padded

  std::uint64_t read_number(std::uint64_t bytes) {
    std::uint64_t number = 0;
    for (std::uint64_t n = 0; n < bytes; ++n) number = number << 8 | static_cast<unsigned char>(stream_.get());
    return stream_ ? number : 0;
  }

  std::uint64_t read_count() { return read_number(count_bytes_); }

  void skip(std::uint64_t count, std::uint64_t size) {
    constexpr std::uint64_t most = std::uint64_t{1} << 40;  // no header is as long
    if (count > most) return stream_.setstate(std::ios::failbit);
    const std::uint64_t padded = (count * size + word_bytes - 1) / word_bytes * word_bytes;
    stream_.seekg(static_cast<std::streamoff>(padded), std::ios::cur);
  }

  void read_name() {
    const std::uint64_t length = read_count();
    longest_ = std::max(longest_, length);
    skip(length, 1);
  }

  template <class One>
  void read_list(const One& read_one) {
    read_number(word_bytes);  // kind of the list
    const std::uint64_t count = read_count();
    for (std::uint64_t n = 0; n < count && stream_; ++n) read_one();
  }

  void read_attributes() {
    read_list([&] {
      // By the number of the type, from NC_BYTE = 1 to NC_UINT64 = 11.
      constexpr std::array<std::uint64_t, 12> bytes{0, 1, 1, 2, 4, 4, 8, 1, 2, 4, 8, 8};
      read_name();
      const std::uint64_t type = read_number(word_bytes), count = read_count();
      if (type == 0 || type >= bytes.size()) return stream_.setstate(std::ios::failbit);
      skip(count, bytes[type]);
    });
  }

  std::istream& stream_;
  std::uint64_t count_bytes_ = 4;
  std::uint64_t longest_ = 0;
};

}  // namespace

std::uint64_t longest_classic_name(std::istream& stream) { return ClassicHeader(stream).longest_name(); }

}  // namespace cloudbow
