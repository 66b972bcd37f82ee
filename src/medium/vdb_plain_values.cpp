#include "vdb_plain_values.hpp"

#include <dlfcn.h>
#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "vdb_grid.hpp"

namespace cloudbow {

namespace {

/// A node's byte about its inactive values, which need not be stored.
enum class Inactive : std::uint8_t {
  background = 0,
  negative_background = 1,
  one_value = 2,
  background_of_either_sign = 3,
  background_and_one_value = 4,
  two_values = 5,
  all_stored = 6,
};

constexpr std::size_t blosc_header_bytes = 16;

using BloscDecompress = int (*)(const void* source, void* target, std::size_t target_bytes, int threads);

/// Loading takes longer than reading a small file, and many files do not need it.
BloscDecompress blosc_decompress() {
  static const auto function = []() -> BloscDecompress {
    void* const library = dlopen("libblosc.so.1", RTLD_NOW | RTLD_LOCAL);
    if (library == nullptr) return nullptr;
    return reinterpret_cast<BloscDecompress>(dlsym(library, "blosc_decompress_ctx"));
  }();
  return function;
}

template <class Number>
Number number_at(std::span<const std::byte> bytes, std::size_t offset) {
  Number number{};
  std::memcpy(&number, bytes.data() + offset, sizeof number);
  return number;
}

/// The library does not get the size of its input, so the sizes and offsets in it are checked first. Only LZ4 is
/// allowed, the compression that OpenVDB uses.
/// @returns whether the values follow the header as they are.
bool check_blosc(std::span<const std::byte> bytes, std::size_t target_bytes) {
  constexpr std::uint8_t uncompressed = 0x2;
  require_plain(bytes.size() >= blosc_header_bytes);
  const auto version = number_at<std::uint8_t>(bytes, 0);
  const auto flags = number_at<std::uint8_t>(bytes, 2);
  const auto type_bytes = number_at<std::uint8_t>(bytes, 3);
  const std::size_t uncompressed_bytes = number_at<std::uint32_t>(bytes, 4);
  const std::size_t block_bytes = number_at<std::uint32_t>(bytes, 8);
  require_plain(version == 2 && type_bytes > 0 && block_bytes > 0);
  require_plain(uncompressed_bytes == target_bytes);
  require_plain(number_at<std::uint32_t>(bytes, 12) == bytes.size());
  if ((flags & uncompressed) != 0) {
    require_plain(bytes.size() == blosc_header_bytes + target_bytes);
    return true;
  }
  require_plain(block_bytes <= target_bytes);
  require_plain((flags >> 5U) == 1);
  const std::size_t blocks = (target_bytes + block_bytes - 1) / block_bytes;
  const std::size_t first = blosc_header_bytes + 4 * blocks;
  require_plain(bytes.size() > first);
  for (std::size_t block = 0; block < blocks; ++block) {
    const std::size_t begin = number_at<std::uint32_t>(bytes, blosc_header_bytes + 4 * block);
    require_plain(begin >= first && begin + 4 <= bytes.size());
  }
  return false;
}

}  // namespace

float float_of_half(std::uint16_t bits) {
  const std::uint32_t sign = static_cast<std::uint32_t>(bits & 0x8000U) << 16U;
  const std::uint32_t exponent = (bits >> 10U) & 0x1fU;
  const std::uint32_t fraction = bits & 0x3ffU;
  if (exponent == 0) {  // zero, and numbers of less precision, which float has all
    const float magnitude = static_cast<float>(fraction) * 0x1p-24F;
    return std::bit_cast<float>(sign | std::bit_cast<std::uint32_t>(magnitude));
  }
  const std::uint32_t wide = exponent == 0x1fU ? 0xffU : exponent + 112;
  return std::bit_cast<float>(sign | (wide << 23U) | (fraction << 13U));
}

PlainCoding PlainCoding::of_flags(std::uint32_t flags, bool half) {
  constexpr std::uint32_t zip = 1, active_mask = 2, blosc = 4;
  require_plain((flags & ~(zip | active_mask | blosc)) == 0 && (flags & (zip | blosc)) != (zip | blosc));
  PlainCoding coding;
  if ((flags & zip) != 0) coding.method = Method::zip;
  if ((flags & blosc) != 0) coding.method = Method::blosc;
  coding.only_active = (flags & active_mask) != 0;
  coding.half = half;
  return coding;
}

void PlainNodeValues::read(std::span<const std::uint64_t> active, float background) {
  const auto byte = bytes_.number<std::uint8_t>();
  require_plain(byte <= static_cast<std::uint8_t>(Inactive::all_stored));
  const auto kind = static_cast<Inactive>(byte);
  require_plain(coding_.only_active || kind == Inactive::all_stored);

  inactive_ = {kind == Inactive::background ? background : -background, background};
  if (kind == Inactive::one_value || kind == Inactive::background_and_one_value || kind == Inactive::two_values) {
    inactive_[0] = bytes_.number<float>();
  }
  if (kind == Inactive::two_values) inactive_[1] = bytes_.number<float>();
  selection_.clear();
  if (kind == Inactive::background_of_either_sign || kind == Inactive::background_and_one_value ||
      kind == Inactive::two_values) {
    selection_.resize(active.size());
    bytes_.read(std::as_writable_bytes(std::span(selection_)));
  }
  stores_all_ = kind == Inactive::all_stored;
  only_background_ = kind == Inactive::background;
  read_stored(stores_all_ ? 64 * active.size() : count_bits(active));
}

void PlainNodeValues::read_stored(std::size_t count) {
  stored_.resize(count);
  if (!coding_.half) {
    read_block(std::as_writable_bytes(std::span(stored_)));
    return;
  }
  if (count == 0) return;  // then there is not even an empty block
  halves_.resize(count);
  read_block(std::as_writable_bytes(std::span(halves_)));
  for (std::size_t n = 0; n < count; ++n) stored_[n] = float_of_half(halves_[n]);
}

void PlainNodeValues::read_block(std::span<std::byte> target) {
  if (coding_.method == PlainCoding::Method::none) {
    bytes_.read(target);
    return;
  }
  const auto length = bytes_.number<std::int64_t>();
  if (length <= 0) {  // what compression would make larger is stored as it is
    require_plain(length == -static_cast<std::int64_t>(target.size()));
    bytes_.read(target);
    return;
  }
  require_plain(static_cast<std::uint64_t>(length) <= bytes_.left());
  // No compression makes values much larger than they are.
  require_plain(static_cast<std::uint64_t>(length) <= 2 * target.size() + 1024);
  compressed_.resize(static_cast<std::size_t>(length));
  bytes_.read(compressed_);
  if (coding_.method == PlainCoding::Method::zip) {
    auto bytes = static_cast<uLongf>(target.size());
    const int status = uncompress(reinterpret_cast<Bytef*>(target.data()), &bytes,
                                  reinterpret_cast<const Bytef*>(compressed_.data()), compressed_.size());
    require_plain(status == Z_OK && bytes == target.size());
    return;
  }
  if (check_blosc(compressed_, target.size())) {
    std::copy(compressed_.begin() + blosc_header_bytes, compressed_.end(), target.begin());
    return;
  }
  const BloscDecompress decompress = blosc_decompress();
  require_plain(decompress != nullptr);
  const int bytes = decompress(compressed_.data(), target.data(), target.size(), 1);
  require_plain(bytes >= 0 && static_cast<std::size_t>(bytes) == target.size());
}

}  // namespace cloudbow
