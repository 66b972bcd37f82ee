#include "cloudbow/io/exr_file.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cstring>
#include <string_view>

#include "cloudbow/core/atomic_file.hpp"

namespace cloudbow {

namespace {

/// Little-endian, as the format is.
class Bytes {
 public:
  template <class Number>
  void number(Number value) {
    static_assert(std::endian::native == std::endian::little);
    const auto at = bytes_.size();
    bytes_.resize(at + sizeof value);
    std::memcpy(bytes_.data() + at, &value, sizeof value);
  }
  template <class... Numbers>
  void numbers(Numbers... value) {
    (number(value), ...);
  }
  void text(std::string_view value) {
    bytes_.insert(bytes_.end(), value.begin(), value.end());
    bytes_.push_back(0);
  }
  void append(const Bytes& other) { bytes_.insert(bytes_.end(), other.bytes_.begin(), other.bytes_.end()); }
  void attribute(std::string_view name, std::string_view type, const Bytes& value) {
    text(name);
    text(type);
    number(static_cast<std::int32_t>(value.size()));
    append(value);
  }
  std::size_t size() const { return bytes_.size(); }
  const std::vector<std::uint8_t>& all() const { return bytes_; }

 private:
  std::vector<std::uint8_t> bytes_;
};

template <class... Numbers>
Bytes bytes_of(Numbers... value) {
  Bytes bytes;
  bytes.numbers(value...);
  return bytes;
}

Bytes channel_list(const FloatImage& image) {
  Bytes list;
  for (const auto& channel : image.channel) {
    list.text(channel.name);
    // 32-bit floats; linear; sampled at every pixel.
    list.numbers(std::int32_t{2}, std::uint32_t{0}, std::int32_t{1}, std::int32_t{1});
  }
  list.number(std::uint8_t{0});
  return list;
}

Bytes header(const FloatImage& image) {
  const Bytes window =
      bytes_of(std::int32_t{0}, std::int32_t{0}, std::int32_t{image.width - 1}, std::int32_t{image.height - 1});
  Bytes bytes = bytes_of(std::int32_t{20000630}, std::int32_t{2});  // magic number, version
  bytes.attribute("channels", "chlist", channel_list(image));
  bytes.attribute("compression", "compression", bytes_of(std::uint8_t{0}));
  bytes.attribute("dataWindow", "box2i", window);
  bytes.attribute("displayWindow", "box2i", window);
  bytes.attribute("lineOrder", "lineOrder", bytes_of(std::uint8_t{0}));  // from the top
  bytes.attribute("pixelAspectRatio", "float", bytes_of(1.0F));
  bytes.attribute("screenWindowCenter", "v2f", bytes_of(0.0F, 0.0F));
  bytes.attribute("screenWindowWidth", "float", bytes_of(1.0F));
  bytes.number(std::uint8_t{0});
  return bytes;
}

}  // namespace

void write_exr(const std::filesystem::path& file, const FloatImage& unordered) {
  FloatImage image = unordered;
  // The format requires channels in the order of their names.
  std::sort(image.channel.begin(), image.channel.end(), [](const auto& a, const auto& b) { return a.name < b.name; });
  const auto width = static_cast<std::size_t>(image.width), height = static_cast<std::size_t>(image.height);
  const std::size_t line = width * image.channel.size() * sizeof(float);
  Bytes bytes = header(image);
  const std::size_t first_line = bytes.size() + height * sizeof(std::uint64_t);
  for (std::size_t row = 0; row < height; ++row)
    bytes.number(static_cast<std::uint64_t>(first_line + row * (line + 2 * sizeof(std::int32_t))));
  for (std::size_t row = 0; row < height; ++row) {
    bytes.numbers(static_cast<std::int32_t>(row), static_cast<std::int32_t>(line));
    for (const auto& channel : image.channel) {
      assert(channel.value.size() == width * height);
      for (std::size_t column = 0; column < width; ++column) bytes.number(channel.value[row * width + column]);
    }
  }
  write_file_atomically(file, bytes.all());
}

}  // namespace cloudbow
