// Comparison of the two readers of VDB files. Truth: OpenVDB.
#pragma once

#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

#include "medium/vdb_grid.hpp"
#include "medium/vdb_plain_file.hpp"
#include "medium/vdb_read.hpp"
#include "vdb_test_tools.hpp"

namespace cloudbow {

inline constexpr std::uint64_t gigabyte = 1'000'000'000;

inline VdbGrid read_by_openvdb(const std::filesystem::path& path, const std::string& name) {
  return read_grid_by_openvdb(path, name, gigabyte, {[](const VdbGridHeader&) {}, [](double) {}});
}

/// All bits of numbers, so that NaN and the sign of 0 count.
template <class Number>
void append_bits(std::string& text, const Number& number) {
  static_assert(std::is_trivially_copyable_v<Number>);
  text.append(reinterpret_cast<const char*>(&number), sizeof number);
}

inline std::string bits_of(const std::optional<VdbVector>& vector) {
  if (!vector) return "none";
  std::string text = vector->wrong_type;
  for (const double number : vector->value) append_bits(text, number);
  return text;
}

inline std::string bits_of(const std::vector<VdbTile>& tiles) {
  std::string text;
  for (const VdbTile& tile : tiles) {
    append_bits(text, tile.origin);
    append_bits(text, tile.edge);
    append_bits(text, std::bit_cast<std::uint32_t>(tile.value));
  }
  return text;
}

inline std::string bits_of(const std::vector<float>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)};
}

inline void expect_same_header(const VdbGridHeader& a, const VdbGridHeader& b) {
  EXPECT_EQ(a.map_type, b.map_type);
  EXPECT_EQ(a.is_linear, b.is_linear);
  EXPECT_EQ(a.is_singular, b.is_singular);
  EXPECT_EQ(a.matrix, b.matrix);
  EXPECT_EQ(a.quantity, b.quantity);
  EXPECT_EQ(a.units, b.units);
  EXPECT_EQ(a.is_level_set, b.is_level_set);
  EXPECT_EQ(a.voxel_count, b.voxel_count);
  EXPECT_EQ(a.first_voxel, b.first_voxel);
  EXPECT_EQ(a.last_voxel, b.last_voxel);
  EXPECT_EQ(bits_of(a.domain_min_m), bits_of(b.domain_min_m));
  EXPECT_EQ(bits_of(a.domain_max_m), bits_of(b.domain_max_m));
}

/// All members, in their order.
inline void expect_same_grid(const VdbGrid& a, const VdbGrid& b) {
  expect_same_header(a.header, b.header);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(a.background), std::bit_cast<std::uint32_t>(b.background));
  ASSERT_EQ(a.leaves.size(), b.leaves.size());
  for (std::size_t n = 0; n < a.leaves.size(); ++n) {
    EXPECT_EQ(a.leaves[n].origin, b.leaves[n].origin);
    EXPECT_EQ(a.leaves[n].active, b.leaves[n].active);
    EXPECT_EQ(a.leaves[n].differs, b.leaves[n].differs);
    EXPECT_EQ(a.leaves[n].first, b.leaves[n].first);
  }
  EXPECT_TRUE(bits_of(a.values) == bits_of(b.values));
  EXPECT_TRUE(bits_of(a.active_tiles) == bits_of(b.active_tiles));
  EXPECT_TRUE(bits_of(a.differing_tiles) == bits_of(b.differing_tiles));
  EXPECT_EQ(a.inactive.voxels, b.inactive.voxels);
  EXPECT_EQ(std::bit_cast<std::uint32_t>(a.inactive.example), std::bit_cast<std::uint32_t>(b.inactive.example));
}

/// All that reading gives: the cloud and its notes, or the message. The memory allowed is fixed: messages name it, and
/// that of the machine changes from one reading to the next.
inline std::string outcome_of(const VdbGridReader& reader, const std::filesystem::path& path, VdbReadOptions options) {
  options.memory_limit_bytes = gigabyte;
  try {
    const VdbCloud cloud = read_cloud(reader, path, options);
    std::string text = cloud.quantity + "|" + cloud.units + "|";
    for (const std::string& note : cloud.notes) text += note + "|";
    append_bits(text, cloud.cells);
    append_bits(text, cloud.cell_size_m);
    append_bits(text, cloud.min_m);
    for (const auto begin : cloud.row_begin) append_bits(text, begin);
    for (const RowSpan& span : cloud.spans) append_bits(text, span);
    return text + bits_of(cloud.value);
  } catch (const InputError& error) {
    return error.what();
  }
}

/// Both readers read the file, and to the same.
inline void expect_same_reading(const std::filesystem::path& path, const VdbReadOptions& options = {}) {
  SCOPED_TRACE(path.string() + " " + options.grid);
  const std::optional<VdbGrid> plain = read_plain_vdb(path, options.grid, gigabyte);
  ASSERT_TRUE(plain) << "is not read as an ordinary file";
  expect_same_grid(*plain, read_by_openvdb(path, options.grid));
  EXPECT_TRUE(outcome_of(read_grid, path, options) == outcome_of(read_grid_by_openvdb, path, options));
}

/// A linear congruential generator: the same numbers everywhere.
class Numbers {
 public:
  explicit Numbers(std::uint32_t seed) : state_(seed) {}
  std::size_t below(std::size_t end) {
    state_ = state_ * 6364136223846793005U + 1442695040888963407U;
    return static_cast<std::size_t>((state_ >> 33U) % end);
  }

 private:
  std::uint64_t state_;
};

/// Voxels in several leaves, of both signs of the indices, with a few inactive ones.
inline openvdb::FloatGrid::Ptr scattered_grid(float background = 0, const std::string& name = "density") {
  auto grid = openvdb::FloatGrid::create(background);
  grid->setName(name);
  Numbers numbers(7);
  for (int n = 0; n < 900; ++n) {
    const openvdb::Coord index(static_cast<int>(numbers.below(30)) - 15, static_cast<int>(numbers.below(20)) - 9,
                               static_cast<int>(numbers.below(40)) - 20);
    grid->tree().setValueOn(index, 0.25F + 0.001F * static_cast<float>(numbers.below(1000)));
  }
  return grid;
}

}  // namespace cloudbow
