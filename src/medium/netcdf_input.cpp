#include "netcdf_input.hpp"

#include <netcdf.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <limits>
#include <new>
#include <string_view>

#include "classic_header.hpp"
#include "cloudbow/core/hdf5_file.hpp"
#include "cloudbow/core/input_file.hpp"
#include "cloudbow/medium/netcdf_library.hpp"
#include "import_parts.hpp"
#include "text_tokens.hpp"

namespace cloudbow {
namespace {

constexpr double word_bytes = 4;  // bytes to which the classic format pads

double padded(double bytes) { return word_bytes * std::ceil(bytes / word_bytes); }
double name_bytes(const std::string& name) { return word_bytes + padded(static_cast<double>(name.size())); }

bool is_integer(nc_type type) { return type != NC_FLOAT && type != NC_DOUBLE; }

/// Value that the library writes into elements that are never written; for bytes, no value is certain to be no data.
double default_fill(nc_type type) {
  switch (type) {
    case NC_SHORT:
      return NC_FILL_SHORT;
    case NC_USHORT:
      return NC_FILL_USHORT;
    case NC_INT:
      return NC_FILL_INT;
    case NC_UINT:
      return NC_FILL_UINT;
    case NC_INT64:
      return static_cast<double>(NC_FILL_INT64);
    case NC_UINT64:
      return static_cast<double>(NC_FILL_UINT64);
    default:
      return std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace

bool begins_as_netcdf(const std::filesystem::path& file, const char* allowed) {
  std::ifstream stream = open_input(file, allowed);
  std::array<char, 4> begin{};
  stream.read(begin.data(), begin.size());
  const std::string_view text(begin.data(), begin.size());
  if (!text.starts_with("CDF") && text != "\x89HDF") return false;
  netcdf_library();
  return true;
}

struct ValidValues {
  std::vector<double> missing;
  double lowest = -std::numeric_limits<double>::infinity();
  double highest = std::numeric_limits<double>::infinity();

  bool contain(double stored) const {
    // Written nowhere, floats hold the library's own fill value.
    constexpr double never_written = 9.9e36;
    return stored >= lowest && stored <= highest && stored <= never_written &&
           std::find(missing.begin(), missing.end(), stored) == missing.end();
  }
};

NetcdfInput::OpenFile::OpenFile(const std::filesystem::path& file) : path(file) {
  hdf5::check_file(path);
  std::ifstream stream = open_input(path, "netCDF");
  if (const auto bytes = longest_classic_name(stream); bytes > NC_MAX_NAME) {
    fail_import(path, "damaged: a name in its header is too long (found {} bytes, allowed {}); get a complete copy",
                bytes, NC_MAX_NAME);
  }
  stream.close();
  check(netcdf_library().open(path.c_str(), NC_NOWRITE, &id), "not netCDF, or damaged");
}

NetcdfInput::OpenFile::~OpenFile() { netcdf_library().close(id); }

void NetcdfInput::OpenFile::check(int status, const std::string& what) const {
  if (status == NC_ENOMEM) throw std::bad_alloc();
  if (status != NC_NOERR) fail_import(path, "{} (the library says: {})", what, netcdf_library().strerror(status));
}

NetcdfInput::NetcdfInput(const std::filesystem::path& path, bool has_groups) { open(path, has_groups); }

NetcdfInput::NetcdfInput(const std::filesystem::path& first, const std::vector<std::filesystem::path>& others) {
  open(first, true);
  for (const auto& other : others) open(other, true);
}

void NetcdfInput::open(const std::filesystem::path& path, bool has_groups) {
  files_.push_back(std::make_unique<OpenFile>(path));
  files_.back()->groups_left = has_groups ? 1000 : 0;
  list_variables(files_.back()->id, "");
  check_length(files_.size() - 1);
}

void NetcdfInput::list_variables(int group, const std::string& path) {
  OpenFile& file = *files_.back();
  const std::size_t file_index = files_.size() - 1;
  int count = 0;
  file.check(netcdf_library().inq_nvars(group, &count), "damaged");
  for (int id = 0; id < count; ++id) {
    std::array<char, NC_MAX_NAME + 1> name{};
    int rank = 0;
    file.check(netcdf_library().inq_varname(group, id, name.data()), "damaged");
    file.check(netcdf_library().inq_varndims(group, id, &rank), "damaged");
    nc_type type = NC_NAT;
    file.check(netcdf_library().inq_vartype(group, id, &type), "damaged");
    const bool is_taken = find_in(file_index, name.data()) != nullptr;
    NetcdfVariable variable{id, (is_taken ? path : "") + name.data(), {}, {}, {}, type == NC_FLOAT, group, file_index};
    std::vector<int> dimension(static_cast<std::size_t>(rank));
    file.check(netcdf_library().inq_vardimid(group, id, dimension.data()), "damaged");
    for (const int d : dimension) {
      std::size_t length = 0;
      file.check(netcdf_library().inq_dim(group, d, name.data(), &length), "damaged");
      variable.dimension.emplace_back(name.data());
      variable.length.push_back(length);
    }
    variable.units = text_attribute(variable, "units");
    variables_.push_back(std::move(variable));
  }
  int groups = 0;
  if (file.groups_left <= 0 || netcdf_library().inq_grps(group, &groups, nullptr) != NC_NOERR || groups <= 0) return;
  std::vector<int> inner(static_cast<std::size_t>(groups));
  file.check(netcdf_library().inq_grps(group, &groups, inner.data()), "damaged");
  for (const int id : inner) {
    if (file.groups_left-- <= 0) return;
    std::array<char, NC_MAX_NAME + 1> name{};
    file.check(netcdf_library().inq_grpname(id, name.data()), "damaged");
    list_variables(id, path + name.data() + "/");
  }
}

/// Bytes that a classic header takes for the attributes of a variable, or of the file.
double NetcdfInput::attribute_bytes(const OpenFile& file, int variable) {
  int count = 0;
  file.check(variable == NC_GLOBAL ? netcdf_library().inq_natts(file.id, &count)
                                   : netcdf_library().inq_varnatts(file.id, variable, &count),
             "damaged");
  double bytes = 2 * word_bytes;
  for (int n = 0; n < count; ++n) {
    std::array<char, NC_MAX_NAME + 1> name{};
    nc_type type = NC_NAT;
    std::size_t length = 0, size = 0;
    file.check(netcdf_library().inq_attname(file.id, variable, n, name.data()), "damaged");
    file.check(netcdf_library().inq_att(file.id, variable, name.data(), &type, &length), "damaged");
    file.check(netcdf_library().inq_type(file.id, type, nullptr, &size), "damaged");
    bytes += name_bytes(name.data()) + 2 * word_bytes + padded(static_cast<double>(length * size));
  }
  return bytes;
}

/// The library reads zeros beyond the end of a classic file that was cut off: header and data must be there as the file
/// format says (netCDF User's Guide, "File Format Specifications"; the sizes of CDF-1, which the later ones exceed),
/// but for the padding after the last number.
void NetcdfInput::check_length(std::size_t index) const {
  const OpenFile& file = *files_[index];
  int format = 0, dimensions = 0;
  file.check(netcdf_library().inq_format(file.id, &format), "damaged");
  if (format == NC_FORMAT_NETCDF4 || format == NC_FORMAT_NETCDF4_CLASSIC) return;
  file.check(netcdf_library().inq_ndims(file.id, &dimensions), "damaged");
  double least = 6 * word_bytes + attribute_bytes(file, NC_GLOBAL) - (word_bytes - 1);
  for (int d = 0; d < dimensions; ++d) {
    std::array<char, NC_MAX_NAME + 1> name{};
    file.check(netcdf_library().inq_dimname(file.id, d, name.data()), "damaged");
    least += name_bytes(name.data()) + word_bytes;
  }
  for (const NetcdfVariable& variable : variables_) {
    if (variable.file != index) continue;
    nc_type type = NC_NAT;
    std::size_t bytes = 0;
    file.check(netcdf_library().inq_vartype(variable.group, variable.id, &type), variable.name);
    file.check(netcdf_library().inq_type(file.id, type, nullptr, &bytes), variable.name);
    auto size = static_cast<double>(bytes);
    for (const std::size_t length : variable.length) size *= static_cast<double>(length);
    const auto rank = static_cast<double>(variable.length.size());
    least += name_bytes(variable.name) + (4 + rank) * word_bytes + attribute_bytes(file, variable.id) + size;
  }
  const auto found = static_cast<double>(std::filesystem::file_size(file.path));
  if (found < least) fail_import(file.path, "the file is cut off (found {} bytes, allowed at least {})", found, least);
}

const NetcdfVariable* NetcdfInput::find(const std::string& name) const {
  const auto found = std::find_if(variables_.begin(), variables_.end(), [&](const auto& v) { return v.name == name; });
  return found == variables_.end() ? nullptr : &*found;
}

const NetcdfVariable* NetcdfInput::find_in(std::size_t file, const std::string& name) const {
  const auto found = std::find_if(variables_.begin(), variables_.end(),
                                  [&](const auto& v) { return v.file == file && v.name == name; });
  return found == variables_.end() ? nullptr : &*found;
}

std::string NetcdfInput::text_attribute(const NetcdfVariable& variable, const char* name) const {
  return text_of(file_of(variable), variable.group, variable.id, name);
}

std::string NetcdfInput::global_text(const char* name) const {
  return text_of(*files_.front(), files_.front()->id, NC_GLOBAL, name);
}

std::string NetcdfInput::text_of(const OpenFile& file, int group, int variable, const char* name) {
  std::size_t length = 0;
  nc_type type = NC_NAT;
  if (netcdf_library().inq_att(group, variable, name, &type, &length) != NC_NOERR) return {};
  constexpr std::size_t longest = 4096;
  std::string text;
  if (type == NC_CHAR && length <= longest) {
    text.assign(length, '\0');
    file.check(netcdf_library().get_att_text(group, variable, name, text.data()), name);
  } else if (type == NC_STRING && length == 1) {
    char* string = nullptr;
    file.check(netcdf_library().get_att_string(group, variable, name, &string), name);
    if (string != nullptr) text = string;
    netcdf_library().free_string(1, &string);
  }
  return text.substr(0, text.find('\0'));
}

/// None if there is no such attribute. Text must hold a number, which some programs write so.
std::vector<double> NetcdfInput::numbers_of(const OpenFile& file, int group, int variable, const std::string& owner,
                                            const char* name) {
  std::size_t length = 0;
  nc_type type = NC_NAT;
  if (netcdf_library().inq_att(group, variable, name, &type, &length) != NC_NOERR) return {};
  constexpr std::size_t longest = 4096;
  if (length > longest) fail_import(file.path, "{}: attribute {} is too long (found {} values)", owner, name, length);
  if (type != NC_CHAR && type != NC_STRING) {
    std::vector<double> number(length);
    file.check(netcdf_library().get_att_double(group, variable, name, number.data()),
               fmt::format("{}: attribute {} is not numbers", owner, name));
    return number;
  }
  const std::string text = text_of(file, group, variable, name);
  if (text.empty()) fail_import(file.path, "{}: attribute {} is not a number (found text)", owner, name);
  std::vector<double> number;
  for (const std::string_view word : split_words(text)) {
    const auto value = number_in(word);
    if (!value) fail_import(file.path, "{}: attribute {} is not a number (found '{}')", owner, name, text);
    number.push_back(*value);
  }
  return number;
}

std::vector<double> NetcdfInput::numbers_of_attribute(const NetcdfVariable& variable, const char* name) const {
  return numbers_of(file_of(variable), variable.group, variable.id, "'" + variable.name + "'", name);
}

std::optional<double> NetcdfInput::number_attribute(const NetcdfVariable& variable, const char* name) const {
  const std::vector<double> number = numbers_of_attribute(variable, name);
  if (number.empty()) return std::nullopt;
  if (number.size() != 1) {
    fail_import(file_of(variable).path, "'{}': attribute {} is not one number (found {})", variable.name, name,
                number.size());
  }
  return number[0];
}

std::optional<double> NetcdfInput::global_number(const char* name) const {
  for (const auto& file : files_) {
    const std::vector<double> number = numbers_of(*file, file->id, NC_GLOBAL, "the file", name);
    if (number.size() == 1) return number[0];
  }
  return std::nullopt;
}

double NetcdfInput::packing_step(const NetcdfVariable& variable) const {
  nc_type type = NC_NAT;
  file_of(variable).check(netcdf_library().inq_vartype(variable.group, variable.id, &type), variable.name);
  return is_integer(type) ? std::abs(number_attribute(variable, "scale_factor").value_or(0)) : 0;
}

std::size_t NetcdfInput::chunk_length(const NetcdfVariable& variable, std::size_t dimension) const {
  int storage = NC_CONTIGUOUS;
  std::vector<std::size_t> chunk(variable.length.size(), 1);
  if (netcdf_library().inq_var_chunking(variable.group, variable.id, &storage, chunk.data()) != NC_NOERR ||
      storage != NC_CHUNKED)
    return 1;
  return std::max<std::size_t>(1, chunk[dimension]);
}

/// netCDF User's Guide, "Attribute Conventions": all of these are of the stored numbers, with one exception. A valid
/// range of floating type for packed integers is of the unpacked ones.
ValidValues NetcdfInput::valid_values(const NetcdfVariable& variable) const {
  nc_type type = NC_NAT;
  file_of(variable).check(netcdf_library().inq_vartype(variable.group, variable.id, &type), variable.name);
  const double scale = number_attribute(variable, "scale_factor").value_or(1);
  const double offset = number_attribute(variable, "add_offset").value_or(0);
  const auto as_stored = [&](double number) { return type == NC_FLOAT ? static_cast<float>(number) : number; };
  const auto bound = [&](double number, const char* name) {
    nc_type of_bound = NC_NAT;
    file_of(variable).check(netcdf_library().inq_atttype(variable.group, variable.id, name, &of_bound), variable.name);
    const bool is_unpacked = is_integer(type) && !is_integer(of_bound) && (scale != 1 || offset != 0);
    return is_unpacked ? (number - offset) / scale : as_stored(number);
  };

  ValidValues valid;
  const std::vector<double> fill = numbers_of_attribute(variable, "_FillValue");
  valid.missing = fill.empty() ? std::vector{default_fill(type)} : fill;
  for (const double number : numbers_of_attribute(variable, "missing_value")) {
    valid.missing.push_back(as_stored(number));
  }
  if (const auto lowest = number_attribute(variable, "valid_min")) valid.lowest = bound(*lowest, "valid_min");
  if (const auto highest = number_attribute(variable, "valid_max")) valid.highest = bound(*highest, "valid_max");
  const std::vector<double> range = numbers_of_attribute(variable, "valid_range");
  if (range.empty()) return valid;
  if (range.size() != 2) {
    fail_import(file_of(variable).path, "'{}': attribute valid_range is not two numbers (found {})", variable.name,
                range.size());
  }
  valid.lowest = bound(range[0], "valid_range");
  valid.highest = bound(range[1], "valid_range");
  return valid;
}

std::vector<double> NetcdfInput::read(const NetcdfVariable& variable, const std::vector<std::size_t>& start,
                                      const std::vector<std::size_t>& count) const {
  double size = 1;
  for (const std::size_t length : count) size *= static_cast<double>(length);
  if (size > max_import_cells)
    fail_import(file_of(variable).path, "'{}': too large ({:.3g} numbers)", variable.name, size);
  std::vector<double> value(static_cast<std::size_t>(size));
  if (value.empty()) return value;
  file_of(variable).check(
      netcdf_library().get_vara_double(variable.group, variable.id, start.data(), count.data(), value.data()),
      fmt::format("'{}' cannot be read", variable.name));

  if (text_attribute(variable, "_Unsigned") == "true") {
    fail_import(file_of(variable).path,
                "'{}': attribute _Unsigned is not read (allowed: numbers of the type that they are stored as)",
                variable.name);
  }
  const ValidValues valid = valid_values(variable);
  const double scale = number_attribute(variable, "scale_factor").value_or(1);
  const double offset = number_attribute(variable, "add_offset").value_or(0);
  for (double& number : value) {
    number = valid.contain(number) ? number * scale + offset : std::numeric_limits<double>::quiet_NaN();
  }
  return value;
}

std::vector<double> NetcdfInput::read(const NetcdfVariable& variable) const {
  return read(variable, std::vector<std::size_t>(variable.length.size(), 0), variable.length);
}

}  // namespace cloudbow
