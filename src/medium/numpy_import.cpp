// Arrays of NumPy: a .npy file (format versions 1 to 3), or an archive of them (.npz). Numbers alone, [z][y][x] of the
// quantity that the user or the name of the array gives.
#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <istream>
#include <sstream>

#include "les_vocabulary.hpp"
#include "npz_archive.hpp"
#include "text_tokens.hpp"

namespace cloudbow {
namespace {

/// Content of the header, a Python dictionary like {'descr': '<f8', 'fortran_order': False, 'shape': (20, 8, 10), }.
struct NumpyHeader {
  std::string type;
  bool is_fortran = false;
  std::vector<double> shape;
};

/// Numbers in the order of C.
template <class T>
struct NumpyArray {
  std::vector<std::size_t> shape;
  std::vector<T> value;
};

/// Reads one array. Messages begin with the file, and with the array's name if it has one.
class NumpyReader {
 public:
  NumpyReader(const CloudImportOptions& options, std::istream& stream, const std::string& name)
      : options_(options), stream_(stream), name_(name.empty() ? "" : "array '" + name + "': ") {}

  /// Three dimensions, of which y and x may lack. @param may_be_negative coordinates may
  template <class T>
  NumpyArray<T> read(bool may_be_negative) {
    const NumpyHeader header = read_header();
    if (header.shape.empty() || header.shape.size() > 3)
      fail("array with {} dimensions (allowed: z; z, x; z, y, x)", header.shape.size());
    std::vector<double> shape = header.shape;
    if (shape.size() < 2) shape.push_back(1);
    if (shape.size() < 3) shape.insert(shape.begin() + 1, 1);
    check_import_size(options_, shape[2], shape[1], shape[0]);
    NumpyArray<T> array;
    for (const double length : shape) array.shape.push_back(static_cast<std::size_t>(length));
    array.value.resize(array.shape[0] * array.shape[1] * array.shape[2]);
    fill(array, header, may_be_negative);
    return array;
  }

 private:
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    fail_import(options_.file, "{}{}", name_, fmt::format(text, std::forward<Args>(args)...));
  }

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
      fail("the file is cut off (found its end before its {})", what);
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
      fail("damaged header of a NumPy array (found {} bytes of it)", size);
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
    if (begin == std::string::npos) fail("damaged header of a NumPy array (found no {})", key);
    return text.substr(begin);
  }
  std::string quoted_after(const std::string& text, const std::string& key) const {
    const std::string rest = after(text, key);
    return rest.starts_with('\'') ? rest.substr(1, rest.find('\'', 1) - 1) : rest.substr(0, 20);
  }

  template <class T>
  void fill(NumpyArray<T>& array, const NumpyHeader& header, bool may_be_negative) {
    const bool is_big = header.type == ">f4" || header.type == ">f8";
    const bool is_double = header.type == "<f8" || header.type == ">f8";
    if (!is_big && !is_double && header.type != "<f4")
      fail("numbers of type {} (allowed float32 or float64)", header.type);
    const std::size_t nz = array.shape[0], ny = array.shape[1], nx = array.shape[2];
    for (std::size_t n = 0; n < array.value.size(); ++n) {
      const auto raw = bytes(is_double ? 8 : 4, "last number");
      const double value = is_double ? number_of<double>(raw, is_big) : number_of<float>(raw, is_big);
      const std::size_t k = header.is_fortran ? n % nz : n / nx / ny;
      const std::size_t j = header.is_fortran ? n / nz % ny : n / nx % ny;
      const std::size_t i = header.is_fortran ? n / nz / ny : n % nx;
      const bool is_good = std::abs(value) <= largest_number && (may_be_negative || value >= 0);
      if (!is_good) fail("cell ({}, {}, {}) has the value {} (allowed: finite numbers >= 0)", i, j, k, value);
      array.value[(k * ny + j) * nx + i] = static_cast<T>(value);
    }
  }

  const CloudImportOptions& options_;
  std::istream& stream_;
  std::string name_;
};

/// A cloud of the array's cells, with sizes that the user gives.
LevelledCloud cloud_of(const CloudImportOptions& options, NumpyArray<float> array, const std::string& quantity) {
  LevelledCloud cloud;
  cloud.quantity = quantity;
  cloud.nx = static_cast<int>(array.shape[2]);
  cloud.ny = static_cast<int>(array.shape[1]);
  cloud.density = std::move(array.value);
  if (!options.voxel_size_m) return cloud;
  cloud.dx_m = (*options.voxel_size_m)[0];
  cloud.dy_m = (*options.voxel_size_m)[1];
  for (std::size_t k = 0; k <= array.shape[0]; ++k)
    cloud.z_edge_m.push_back(static_cast<int>(k) * (*options.voxel_size_m)[2]);
  return cloud;
}

std::string note_of(const std::string& quantity, bool is_guess) {
  return fmt::format("{}{} in {}, [z][y][x], the first level the lowest{}", is_guess ? "GUESSED quantity: " : "",
                     quantity, quantity == "extinction" ? "1/m" : "g/m3", is_guess ? "; --quantity says it" : "");
}

// -- archives ---------------------------------------------------------------------------------------------------------

class NpzReader {
 public:
  explicit NpzReader(const CloudImportOptions& options) : options_(options), archive_(options.file) {}

  LevelledCloud read() {
    const std::string name = name_of_cloud();
    const auto is_of = [&name](const Words& words) { return std::ranges::count(words.names, name) > 0; };
    const std::string by_name = is_of(water_names)        ? "liquid_water_content"
                                : is_of(extinction_names) ? "extinction"
                                                          : "";
    const bool is_guess = options_.quantity.empty() && by_name.empty();
    const std::string quantity = !options_.quantity.empty() ? options_.quantity : is_guess ? "extinction" : by_name;
    NumpyArray<float> array = this->array<float>(name, false);
    shape_ = array.shape;
    LevelledCloud cloud = cloud_of(options_, std::move(array), quantity);
    cloud.source = fmt::format("array '{}'", name);
    cloud.notes.push_back(fmt::format("array '{}': {}", name, note_of(quantity, is_guess)));
    set_columns(cloud);
    set_levels(cloud);
    cloud.effective_radius_um = beside(effective_radius_names, "effective radius in um", cloud, 0, 1e30);
    cloud.single_scattering_albedo = beside(scattering_albedo_names, "single-scattering albedo", cloud, 0, 1);
    return cloud;
  }

 private:
  template <class T>
  NumpyArray<T> array(const std::string& name, bool may_be_negative) const {
    std::istringstream stream(archive_.content(name));
    return NumpyReader(options_, stream, name).read<T>(may_be_negative);
  }

  std::string list() const {
    std::string text;
    for (const std::string& name : archive_.names()) text += (text.empty() ? "" : ", ") + name;
    return text;
  }

  std::string name_of_cloud() const {
    if (!options_.variable.empty()) {
      if (archive_.has(options_.variable)) return options_.variable;
      fail_import(options_.file, "no array '{}' (as --variable says; arrays in the file: {})", options_.variable,
                  list());
    }
    const auto first_of = [this](const Words& words) {
      const auto found = std::ranges::find_if(words.names, [this](const auto& name) { return archive_.has(name); });
      return found == words.names.end() ? std::string() : *found;
    };
    const std::string water = first_of(water_names), extinction = first_of(extinction_names);
    if (!extinction.empty() && (water.empty() || options_.quantity == "extinction")) return extinction;
    if (!water.empty()) return water;
    if (archive_.names().size() == 1) return archive_.names().front();
    fail_import(options_.file, "no array of water or extinction (arrays in the file: {}) name it with --variable",
                list());
  }

  /// A list of coordinates in m; empty if there is none.
  std::vector<double> coordinates(const std::string& name) const {
    if (!archive_.has(name)) return {};
    NumpyArray<double> list = array<double>(name, true);
    if (list.shape[1] != 1 || list.shape[2] != 1)
      fail_import(options_.file, "array '{}': not a list of coordinates (found more than one dimension)", name);
    return std::move(list.value);
  }

  void set_columns(LevelledCloud& cloud) const {
    if (options_.voxel_size_m) return;
    const std::array<std::size_t, 2> count{shape_[2], shape_[1]};
    const std::array<double*, 2> size{&cloud.dx_m, &cloud.dy_m}, low{&cloud.x_min_m, &cloud.y_min_m};
    for (std::size_t a = 0; a < 2; ++a) {
      const std::string name(1, "xy"[a]);
      const std::vector<double> centre = coordinates(name);
      if (centre.size() < 2 || centre.size() != count[a]) {
        fail_import(options_.file, "no coordinates '{}' in m (found {} for {} cells); add them, or give --voxel-size-m",
                    name, centre.size(), count[a]);
      }
      *size[a] = uniform_spacing(options_.file, name, centre);
      *low[a] = centre.front() - 0.5 * *size[a];
    }
    cloud.notes.push_back("columns: arrays 'x' and 'y', in m");
  }

  void set_levels(LevelledCloud& cloud) const {
    if (options_.levels_by_voxel_size) return;
    const std::vector<double> height = coordinates("z");
    const std::size_t nz = shape_[0];
    if (height.empty() && options_.voxel_size_m) return;
    const bool are_edges = height.size() == nz + 1;
    if (height.size() < 2 || (height.size() != nz && !are_edges)) {
      fail_import(options_.file,
                  "no heights 'z' in m (found {} for {} levels); add them, or give --voxel-size-m DX DY DZ",
                  height.size(), nz);
    }
    for (std::size_t n = 1; n < height.size(); ++n) {
      if (height[n] > height[n - 1]) continue;
      fail_import(options_.file,
                  "array 'z': heights do not ascend (found {:.6g} m after {:.6g} m) turn them and the fields",
                  height[n], height[n - 1]);
    }
    cloud.z_edge_m = are_edges ? height : edges_between(height);
    cloud.notes.push_back(fmt::format("levels: array 'z' in m, {}", are_edges ? "edges of cells" : "centres of cells"));
  }

  /// An array on the cells of the cloud, in whose cells values lie between the bounds; empty if there is none.
  std::vector<float> beside(const Words& words, const char* what, LevelledCloud& cloud, double low, double high) const {
    const auto name = std::ranges::find_if(words.names, [this](const auto& n) { return archive_.has(n); });
    if (name == words.names.end()) return {};
    NumpyArray<float> values = array<float>(*name, true);
    if (values.shape != shape_)
      fail_import(options_.file, "array '{}': another shape than that of the cloud (allowed the same)", *name);
    for (std::size_t n = 0; n < values.value.size(); ++n) {
      float& value = values.value[n];
      if (cloud.density[n] <= 0) {
        value = 1;
      } else if (!(value > low || (low == 0 && high == 1 && value == 0)) || value > high) {
        fail_import(options_.file, "array '{}': {} in a cell with cloud (allowed {} to {})", *name, value, low, high);
      }
    }
    cloud.notes.push_back(fmt::format("{}: array '{}'", what, *name));
    return std::move(values.value);
  }

  const CloudImportOptions& options_;
  NpzArchive archive_;
  std::vector<std::size_t> shape_;
};

}  // namespace

LevelledCloud import_numpy(const CloudImportOptions& options) {
  std::ifstream stream(options.file, std::ios::binary);
  if (!stream) fail_import(options.file, "cannot be opened for reading (check its permissions)");
  if (stream.peek() == 'P') return NpzReader(options).read();
  if (!options.variable.empty()) {
    fail_import(options.file, "one array without a name (found --variable, allowed for .npz); leave out --variable");
  }
  if (!options.voxel_size_m) {
    fail_import(options.file, "a NumPy array does not say how large cells are (allowed: with --voxel-size-m DX DY DZ)");
  }
  const bool is_guess = options.quantity.empty();
  const std::string quantity = is_guess ? "extinction" : options.quantity;
  LevelledCloud cloud = cloud_of(options, NumpyReader(options, stream, "").read<float>(false), quantity);
  cloud.notes.push_back(note_of(quantity, is_guess));
  return cloud;
}

}  // namespace cloudbow
