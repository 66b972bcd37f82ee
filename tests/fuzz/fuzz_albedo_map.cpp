// Maps of albedo: PNG, netCDF classic and netCDF-4, HDF5. All values are read and averaged over columns.
#include <zlib.h>

#include <algorithm>
#include <array>

#include "cloudbow/medium/albedo_map.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace {

constexpr std::array<std::uint8_t, 8> png_head{0x89, 'P', 'N', 'G', '\r', '\n', 0x1a, '\n'};

std::uint32_t number_at(const std::uint8_t* at) {
  return static_cast<std::uint32_t>(at[0]) << 24 | static_cast<std::uint32_t>(at[1]) << 16 |
         static_cast<std::uint32_t>(at[2]) << 8 | at[3];
}

/// A chunk whose check sum is wrong is refused before anything of it is read.
void put_check_sums_right(std::uint8_t* data, std::size_t size) {
  constexpr std::size_t frame = 12;  // length, name, check sum
  std::size_t at = png_head.size();
  while (at + frame <= size) {
    const std::size_t length = number_at(data + at);
    if (length > size - at - frame) return;
    const auto sum = crc32(0, data + at + 4, static_cast<uInt>(length + 4));
    for (int b = 0; b < 4; ++b) data[at + 8 + length + b] = static_cast<std::uint8_t>(sum >> (24 - 8 * b));
    at += frame + length;
  }
}

}  // namespace

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned int seed) {
  size = LLVMFuzzerMutate(data, size, most);
  const bool is_png = size > png_head.size() && std::equal(png_head.begin(), png_head.end(), data);
  if (is_png && seed % 8 != 0) put_check_sums_right(data, size);
  return size;
}

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::write_mutant({data, size}, "map");
  fuzz::expect_clean([&] {
    const cloudbow::GroundMap map = cloudbow::read_albedo_map(path);
    cloudbow::area_means(map, 5, 7);
  });
  return 0;
}
