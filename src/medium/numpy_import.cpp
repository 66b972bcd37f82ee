// An array of NumPy (.npy, format versions 1 to 3): numbers alone, [z][y][x] of the quantity that the user gives.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "text_tokens.hpp"

namespace cloudbow {
namespace {

/// Content of the header, a Python dictionary like {'descr': '<f8', 'fortran_order': False, 'shape': (20, 8, 10), }.
struct NumpyHeader {
  std::string type;
  bool is_fortran = false;
  std::vector<double> shape;
};

class NumpyReader {
 public:
  explicit NumpyReader(const CloudImportOptions& options) : options_(options), stream_(options.file, std::ios::binary) {
    if (!stream_) fail_import(options.file, "cannot be opened for reading (check its permissions)");
  }

  LevelledCloud read() {
    if (!options_.voxel_size_m) {
      fail_import(options_.file,
                  "a NumPy array does not say how large cells are (allowed: with --voxel-size-m DX DY DZ)");
    }
    const NumpyHeader header = read_header();
    std::vector<double> shape = header.shape;
    if (shape.empty() || shape.size() > 3) {
      fail_import(options_.file, "array with {} dimensions (allowed: z; z, x; z, y, x)", shape.size());
    }
    if (shape.size() < 2) shape.push_back(1);
    if (shape.size() < 3) shape.insert(shape.begin() + 1, 1);
    check_import_size(options_, shape[2], shape[1], shape[0]);
    LevelledCloud cloud;
    cloud.quantity = options_.quantity.empty() ? "extinction" : options_.quantity;
    cloud.nx = static_cast<int>(shape[2]);
    cloud.ny = static_cast<int>(shape[1]);
    cloud.dx_m = (*options_.voxel_size_m)[0];
    cloud.dy_m = (*options_.voxel_size_m)[1];
    for (int k = 0; k <= static_cast<int>(shape[0]); ++k) cloud.z_edge_m.push_back(k * (*options_.voxel_size_m)[2]);
    cloud.allocate();
    fill(cloud, header);
    cloud.notes.push_back(fmt::format("{}{} in {}, [z][y][x], the first level the lowest{}",
                                      options_.quantity.empty() ? "GUESSED quantity: " : "", cloud.quantity,
                                      cloud.quantity == "extinction" ? "1/m" : "g/m3",
                                      options_.quantity.empty() ? "; --quantity says it" : ""));
    return cloud;
  }

 private:
  template <class T>
  T number_of(std::array<char, 8> bytes, bool is_big) {
    if (is_big != (std::endian::native == std::endian::big)) std::reverse(bytes.begin(), bytes.begin() + sizeof(T));
    T value{};
    std::memcpy(&value, bytes.data(), sizeof(T));
    return value;
  }

  std::array<char, 8> bytes(std::size_t count, const char* what) {
    std::array<char, 8> read{};
    if (!stream_.read(read.data(), static_cast<std::streamsize>(count)))
      fail_import(options_.file, "the file is cut off (found its end before its {})", what);
    return read;
  }

  NumpyHeader read_header() {
    const auto start = bytes(8, "header");
    const bool is_long = start[6] > 1;
    const std::uint32_t size = is_long ? number_of<std::uint32_t>(bytes(4, "header"), false)
                                       : number_of<std::uint16_t>(bytes(2, "header"), false);
    constexpr std::uint32_t longest = 65536;
    std::string text(std::min(size, longest), ' ');
    if (size > longest || !stream_.read(text.data(), static_cast<std::streamsize>(text.size())))
      fail_import(options_.file, "damaged header of a NumPy array (found {} bytes of it)", size);
    NumpyHeader header;
    header.type = quoted_after(text, "'descr':");
    header.is_fortran = after(text, "'fortran_order':").starts_with("True");
    std::string numbers = after(text, "'shape':");
    numbers = numbers.substr(0, numbers.find(')'));
    std::replace(numbers.begin(), numbers.end(), '(', ' ');
    for (const std::string_view word : split_words(numbers)) header.shape.push_back(number_in(word).value_or(0));
    return header;
  }

  std::string after(const std::string& text, const std::string& key) const {
    const auto at = text.find(key);
    const auto begin = at == std::string::npos ? at : text.find_first_not_of(' ', at + key.size());
    if (begin == std::string::npos) fail_import(options_.file, "damaged header of a NumPy array (found no {})", key);
    return text.substr(begin);
  }
  std::string quoted_after(const std::string& text, const std::string& key) const {
    const std::string rest = after(text, key);
    return rest.starts_with('\'') ? rest.substr(1, rest.find('\'', 1) - 1) : rest.substr(0, 20);
  }

  void fill(LevelledCloud& cloud, const NumpyHeader& header) {
    const bool is_big = header.type == ">f4" || header.type == ">f8";
    const bool is_double = header.type == "<f8" || header.type == ">f8";
    if (!is_big && !is_double && header.type != "<f4") {
      fail_import(options_.file, "numbers of type {} (allowed float32 or float64)", header.type);
    }
    const auto nx = static_cast<std::size_t>(cloud.nx), ny = static_cast<std::size_t>(cloud.ny),
               nz = static_cast<std::size_t>(cloud.nz());
    for (std::size_t n = 0; n < cloud.density.size(); ++n) {
      const auto raw = bytes(is_double ? 8 : 4, "last number");
      const double value = is_double ? number_of<double>(raw, is_big) : number_of<float>(raw, is_big);
      const std::size_t k = header.is_fortran ? n % nz : n / nx / ny;
      const std::size_t j = header.is_fortran ? n / nz % ny : n / nx % ny;
      const std::size_t i = header.is_fortran ? n / nz / ny : n % nx;
      if (!(value >= 0 && value <= largest_value)) {
        fail_import(options_.file, "cell ({}, {}, {}) has the value {} (allowed: finite numbers >= 0)", i, j, k, value);
      }
      cloud.density[(k * ny + j) * nx + i] = static_cast<float>(value);
    }
  }

  const CloudImportOptions& options_;
  std::ifstream stream_;
};

}  // namespace

LevelledCloud import_numpy(const CloudImportOptions& options) { return NumpyReader(options).read(); }

}  // namespace cloudbow
