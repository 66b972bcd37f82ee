#include "vdb_plain_file.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstring>
#include <map>
#include <string_view>
#include <utility>

#include "vdb_plain_bytes.hpp"
#include "vdb_plain_tree.hpp"
#include "vdb_plain_values.hpp"

namespace cloudbow {

namespace {

using Bytes = PlainBytes;

/// The raw bytes of metadata, and the type that they are of.
struct Item {
  std::string type;
  std::string bytes;
};
using Metadata = std::map<std::string, Item, std::less<>>;

struct FixedSize {
  std::string_view type;
  std::size_t bytes;
};
constexpr std::array fixed_sizes{
    FixedSize{"bool", 1},   FixedSize{"float", 4},  FixedSize{"double", 8}, FixedSize{"int32", 4},
    FixedSize{"int64", 8},  FixedSize{"vec2i", 8},  FixedSize{"vec2s", 8},  FixedSize{"vec2d", 16},
    FixedSize{"vec3i", 12}, FixedSize{"vec3s", 12}, FixedSize{"vec3d", 24},
};

/// Types of grids that OpenVDB has read, and skipped, for years; with 16 bits they have a suffix.
constexpr std::array<std::string_view, 8> grid_types{
    "Tree_bool_5_4_3",  "Tree_double_5_4_3", "Tree_float_5_4_3", "Tree_int32_5_4_3",
    "Tree_int64_5_4_3", "Tree_vec3d_5_4_3",  "Tree_vec3i_5_4_3", "Tree_vec3s_5_4_3",
};
constexpr std::string_view float_grid = "Tree_float_5_4_3";
constexpr std::string_view half_suffix = "_HalfFloat";

/// Sizes of blocks of leaves, for readers that load them late: a count, then two lists, each after a length. The length
/// is 0 if the list is not compressed. A list may be missing; its length is then the largest number. An empty tree has
/// no count either.
bool is_load_list(std::string_view bytes) {
  constexpr std::uint32_t missing = 0xffffffffU;
  const auto take = [&bytes](std::uint32_t& number) {
    if (bytes.size() < sizeof number) return false;
    std::memcpy(&number, bytes.data(), sizeof number);
    bytes.remove_prefix(sizeof number);
    return true;
  };
  if (bytes.empty()) return true;
  std::uint32_t count = 0;
  if (!take(count)) return false;
  for (const std::uint64_t bytes_per_leaf : {1U, 8U}) {
    std::uint32_t length = 0;
    if (!take(length)) return false;
    if (length == missing) continue;
    const std::uint64_t stored = length == 0 ? bytes_per_leaf * count : length;
    if (stored > bytes.size()) return false;
    bytes.remove_prefix(static_cast<std::size_t>(stored));
  }
  return bytes.empty();
}

void check_item(const Item& item) {
  if (item.type == "string") return;
  if (item.type == "__delayedload") {
    require_plain(is_load_list(item.bytes));
    return;
  }
  const auto* const fixed = std::find_if(fixed_sizes.begin(), fixed_sizes.end(),
                                         [&](const FixedSize& size) { return size.type == item.type; });
  require_plain(fixed != fixed_sizes.end() && item.bytes.size() == fixed->bytes);
  if (item.type == "bool") require_plain(item.bytes[0] == 0 || item.bytes[0] == 1);
}

Metadata read_metadata(Bytes& bytes) {
  Metadata metadata;
  const auto count = bytes.number<std::uint32_t>();
  for (std::uint32_t n = 0; n < count; ++n) {
    std::string name = bytes.text();
    Item item;
    item.type = bytes.text();
    item.bytes = bytes.text();
    check_item(item);
    require_plain(!name.empty() && metadata.emplace(std::move(name), std::move(item)).second);
  }
  return metadata;
}

const Item* find(const Metadata& metadata, std::string_view name, std::string_view type) {
  const auto item = metadata.find(name);
  return item != metadata.end() && item->second.type == type ? &item->second : nullptr;
}

/// The numbers of metadata whose size check_item() has checked.
template <class Number, std::size_t Count>
std::array<Number, Count> numbers_of(const Item& item) {
  std::array<Number, Count> numbers{};
  require_plain(item.bytes.size() == sizeof numbers);
  std::memcpy(numbers.data(), item.bytes.data(), sizeof numbers);
  return numbers;
}

std::string text_of(const Metadata& metadata, std::string_view name) {
  const Item* const item = find(metadata, name, "string");
  return item != nullptr ? item->bytes : "";
}

std::optional<VdbIndex> index_of(const Metadata& metadata, std::string_view name) {
  const Item* const item = find(metadata, name, "vec3i");
  if (item == nullptr) return std::nullopt;
  return numbers_of<std::int32_t, 3>(*item);
}

template <class Number>
VdbVector vector_of(const Item& item) {
  VdbVector vector;
  const auto numbers = numbers_of<Number, 3>(item);
  std::copy(numbers.begin(), numbers.end(), vector.value.begin());
  return vector;
}

std::optional<VdbVector> vector_of(const Metadata& metadata, std::string_view name) {
  const auto found = metadata.find(name);
  if (found == metadata.end()) return std::nullopt;
  const Item& item = found->second;
  if (item.type == "vec3d") return vector_of<double>(item);
  if (item.type == "vec3s") return vector_of<float>(item);
  if (item.type == "vec3i") return vector_of<std::int32_t>(item);
  return VdbVector{.wrong_type = item.type};
}

bool is_level_set(const Metadata& metadata) {
  const std::string kind = text_of(metadata, "class");
  require_plain(kind.empty() || kind == "unknown" || kind == "fog volume" || kind == "level set" ||
                kind == "staggered");
  return kind == "level set";
}

using Matrix = std::array<std::array<double, 4>, 4>;

std::array<double, 3> read_vector(Bytes& bytes) {
  std::array<double, 3> vector{};
  bytes.read(std::as_writable_bytes(std::span(vector)));
  return vector;
}

/// OpenVDB refuses matrices with a determinant of less than 3e-15; those near it are not ordinary.
void check_matrix(const Matrix& m) {
  for (int row = 0; row < 4; ++row) {
    for (int column = 0; column < 4; ++column) require_plain(std::abs(m[row][column]) <= 1e15);
    require_plain(m[row][3] == (row < 3 ? 0 : 1));
  }
  const double determinant = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                             m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                             m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]);
  require_plain(std::abs(determinant) >= 1e-14);
}

/// The linear maps, by what they store. Those with a scale store five more vectors that follow from it, or four.
Matrix read_transform(Bytes& bytes, std::string& type) {
  type = bytes.text();
  const bool translates = type == "TranslationMap" || type == "ScaleTranslateMap" || type == "UniformScaleTranslateMap";
  const bool scales = type == "ScaleMap" || type == "UniformScaleMap" || (translates && type != "TranslationMap");
  Matrix matrix{};
  for (std::size_t a = 0; a < 4; ++a) matrix[a][a] = 1;
  if (type == "AffineMap" || type == "UnitaryMap") {
    bytes.read(std::as_writable_bytes(std::span(matrix)));
  } else {
    require_plain(translates || scales);
  }
  if (translates) {
    const auto translation = read_vector(bytes);
    for (std::size_t a = 0; a < 3; ++a) matrix[3][a] = translation[a] + 0.0;
  }
  if (scales) {
    const auto scale = read_vector(bytes);
    for (std::size_t a = 0; a < 3; ++a) matrix[a][a] = scale[a];
    constexpr int derived = 4;  // voxel size, 1/scale, 1/scale^2, 1/(2 scale)
    for (int n = 0; n < derived; ++n) read_vector(bytes);
  }
  check_matrix(matrix);
  return matrix;
}

struct Descriptor {
  std::string name;  ///< as messages and scenes have it
  std::string type;
  bool half = false;
  std::uint64_t begin = 0;
  std::uint64_t leaves = 0;  ///< begin of the values of leaves
  std::uint64_t end = 0;
};

/// Grids of the same name are numbered after a separator: "density", 0x1e, "1" is called "density[1]".
std::string shown_name(const std::string& unique) {
  constexpr char separator = 0x1e;
  const auto at = unique.find(separator);
  if (at == std::string::npos) return unique;
  const std::string number = unique.substr(at + 1);
  require_plain(!number.empty() && number.size() < 10 && number.find_first_not_of("0123456789") == std::string::npos);
  return unique.substr(0, at) + "[" + number + "]";
}

Descriptor read_descriptor(Bytes& bytes, bool has_offsets) {
  Descriptor grid;
  grid.name = shown_name(bytes.text());
  grid.type = bytes.text();
  grid.half = grid.type.ends_with(half_suffix);
  if (grid.half) grid.type.resize(grid.type.size() - half_suffix.size());
  require_plain(std::find(grid_types.begin(), grid_types.end(), grid.type) != grid_types.end());
  require_plain(bytes.text().empty());  // another grid whose voxels it shares
  grid.begin = bytes.number<std::uint64_t>();
  grid.leaves = bytes.number<std::uint64_t>();
  grid.end = bytes.number<std::uint64_t>();
  if (has_offsets) {
    require_plain(grid.begin == bytes.position() && grid.begin < grid.leaves && grid.leaves <= grid.end);
    require_plain(grid.end <= bytes.size());
  } else {
    require_plain(grid.begin == 0 && grid.leaves == 0 && grid.end == 0);
  }
  return grid;
}

VdbGridHeader read_grid_header(Bytes& bytes, bool half) {
  const Metadata metadata = read_metadata(bytes);
  const Item* const stored_as_half = find(metadata, "is_saved_as_half_float", "bool");
  require_plain((stored_as_half != nullptr && stored_as_half->bytes[0] == 1) == half);
  VdbGridHeader header;
  header.quantity = text_of(metadata, "quantity");
  header.units = text_of(metadata, "units");
  header.is_level_set = is_level_set(metadata);
  if (const Item* const count = find(metadata, "file_voxel_count", "int64")) {
    header.voxel_count = numbers_of<std::int64_t, 1>(*count)[0];
  }
  header.first_voxel = index_of(metadata, "file_bbox_min");
  header.last_voxel = index_of(metadata, "file_bbox_max");
  header.domain_min_m = vector_of(metadata, "domain_min_m");
  header.domain_max_m = vector_of(metadata, "domain_max_m");
  header.matrix = read_transform(bytes, header.map_type);
  return header;
}

/// @returns whether grids can be skipped: their descriptors then have offsets.
bool read_file_header(Bytes& bytes) {
  constexpr std::int64_t mark = 0x56444220;
  constexpr std::uint32_t first_version = 222, last_version = 224;
  require_plain(bytes.number<std::int64_t>() == mark);
  const auto version = bytes.number<std::uint32_t>();
  require_plain(version >= first_version && version <= last_version);
  for (int n = 0; n < 2; ++n) bytes.number<std::uint32_t>();  // version of the library
  const bool has_offsets = bytes.flag();
  constexpr std::string_view id_pattern = "xxxxxxxx-xxxx-xxxx-xxxx-xxxxxxxxxxxx";
  const std::string id = bytes.text(id_pattern.size());
  require_plain(std::equal(id.begin(), id.end(), id_pattern.begin(), [](char found, char allowed) {
    return allowed == '-' ? found == '-' : std::isxdigit(static_cast<unsigned char>(found)) != 0;
  }));
  read_metadata(bytes);
  return has_offsets;
}

VdbGrid read_named(Bytes& bytes, const std::string& name, std::uint64_t memory_bytes) {
  const bool has_offsets = read_file_header(bytes);
  std::optional<VdbGrid> wanted;
  const auto grids = bytes.number<std::int32_t>();
  for (std::int32_t n = 0; n < grids; ++n) {
    const Descriptor descriptor = read_descriptor(bytes, has_offsets);
    const auto flags = bytes.number<std::uint32_t>();
    VdbGrid grid;
    grid.header = read_grid_header(bytes, descriptor.half);
    const PlainCoding coding = PlainCoding::of_flags(flags, descriptor.half);
    const bool is_wanted = descriptor.name == name;
    if (is_wanted || !has_offsets) {
      require_plain(descriptor.type == float_grid);
      PlainTree tree(bytes, coding, memory_bytes, grid);
      tree.read_topology();
      require_plain(!has_offsets || bytes.position() == descriptor.leaves);
      tree.read_leaves();
      require_plain(!has_offsets || bytes.position() == descriptor.end);
    } else {
      require_plain(bytes.position() < descriptor.leaves);
      bytes.move_to(descriptor.end);
    }
    if (is_wanted) {
      require_plain(!wanted);
      wanted = std::move(grid);
    }
  }
  require_plain(wanted.has_value() && bytes.left() == 0);
  return std::move(*wanted);
}

}  // namespace

std::optional<VdbGrid> read_plain_vdb(const std::filesystem::path& path, const std::string& name,
                                      std::uint64_t memory_bytes) {
  try {
    PlainBytes bytes(path);
    return read_named(bytes, name, memory_bytes);
  } catch (const NotPlain&) {
    return std::nullopt;
  }
}

}  // namespace cloudbow
