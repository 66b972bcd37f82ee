#include <fmt/format.h>
#include <netcdf.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/medium/netcdf_library.hpp"
#include "cloudbow/optics/legendre_series.hpp"
#include "io/droplet_table_readers.hpp"
#include "io/hdf5_handle.hpp"

namespace cloudbow {
namespace {

void check(int status, const std::string& what) {
  if (status == NC_ENOMEM) throw std::bad_alloc();
  if (status != NC_NOERR)
    throw InputError(fmt::format("{}: damaged, or not such a table ({})", what, netcdf_library().strerror(status)));
}

class NetcdfFile {
 public:
  explicit NetcdfFile(const std::filesystem::path& path) {
    check(netcdf_library().open(path.c_str(), NC_NOWRITE, &id_), "netCDF");
  }
  ~NetcdfFile() { netcdf_library().close(id_); }
  NetcdfFile(const NetcdfFile&) = delete;
  NetcdfFile& operator=(const NetcdfFile&) = delete;

  bool has(const char* name) const {
    int variable = 0;
    return netcdf_library().inq_varid(id_, name, &variable) == NC_NOERR;
  }

  std::vector<std::size_t> shape(const char* name) const {
    const int variable = find(name);
    int rank = 0;
    check(netcdf_library().inq_varndims(id_, variable, &rank), name);
    std::vector<int> dimension(static_cast<std::size_t>(rank));
    check(netcdf_library().inq_vardimid(id_, variable, dimension.data()), name);
    std::vector<std::size_t> length(dimension.size());
    for (std::size_t n = 0; n < length.size(); ++n)
      check(netcdf_library().inq_dimlen(id_, dimension[n], &length[n]), name);
    return length;
  }

  /// The part start .. start + count of a variable, which must be of the shape given.
  std::vector<double> read(const char* name, const std::vector<std::size_t>& expected,
                           const std::vector<std::size_t>& start, const std::vector<std::size_t>& count) const {
    if (const auto found = shape(name); found != expected) {
      throw InputError(fmt::format("'{}': wrong shape (found {}, allowed {})", name, text(found), text(expected)));
    }
    std::size_t size = 1;
    for (const std::size_t length : count) {
      constexpr std::size_t most = std::size_t{1} << 27;
      if (length > most / std::max<std::size_t>(size, 1)) throw InputError(fmt::format("'{}': too large", name));
      size *= length;
    }
    std::vector<double> value(size);
    check(netcdf_library().get_vara_double(id_, find(name), start.data(), count.data(), value.data()), name);
    return value;
  }

  std::vector<double> read_all(const char* name, const std::vector<std::size_t>& expected) const {
    return read(name, expected, std::vector<std::size_t>(expected.size(), 0), expected);
  }

  /// Empty if there is none.
  std::string text_attribute(const char* name, const char* attribute) const {
    std::size_t length = 0;
    nc_type type = NC_NAT;
    if (netcdf_library().inq_att(id_, find(name), attribute, &type, &length) != NC_NOERR || type != NC_CHAR ||
        length > 4096)
      return {};
    std::string value(length, '\0');
    check(netcdf_library().get_att_text(id_, find(name), attribute, value.data()), name);
    return value;
  }

 private:
  static std::string text(const std::vector<std::size_t>& shape) {
    std::string words;
    for (const std::size_t length : shape) words += fmt::format("{}{}", words.empty() ? "" : " x ", length);
    return words.empty() ? "one number" : words;
  }

  int find(const char* name) const {
    int variable = 0;
    if (netcdf_library().inq_varid(id_, name, &variable) != NC_NOERR) {
      throw InputError(
          fmt::format("no variable '{}' (allowed: wavelen, reff, ext, ssa, pmom, as libRadtran's mie writes)", name));
    }
    return variable;
  }

  int id_ = 0;
};

/// [km-1/(g/m3)] as libRadtran (km^-1/(g/m^3)), these pages and others spell it.
bool is_per_km_and_content(const std::string& units) {
  std::string plain;
  for (const char c : units) {
    if (c != '^' && c != ' ' && c != '*' && c != '{' && c != '}') plain += c;
  }
  return plain.starts_with("km-1") || plain.starts_with("1/km") || plain.starts_with("/km") ||
         plain.starts_with("(km-1)");
}

using MomentRows = std::vector<std::vector<double>>;

MomentRows without_factor(MomentRows rows) {
  for (auto& row : rows) {
    for (std::size_t l = 0; l < row.size(); ++l) row[l] /= static_cast<double>(2 * l + 1);
  }
  return rows;
}

bool any_negative(const MomentRows& rows) {
  return std::any_of(rows.begin(), rows.end(),
                     [](const auto& row) { return least_value(row).value < least_allowed(row); });
}

/// The asymmetry parameters beside the moments show whether these include the factor 2l+1, unless all are near 0.
std::optional<bool> includes_factor_by(const std::vector<double>& asymmetry, const MomentRows& rows) {
  constexpr double slack = 0.02;  // of tables with two decimals
  double with = 0, without = 0;
  for (std::size_t n = 0; n < asymmetry.size(); ++n) {
    with = std::max(with, std::abs(rows[n][1] / 3 - asymmetry[n]));
    without = std::max(without, std::abs(rows[n][1] - asymmetry[n]));
  }
  if (!(std::min(with, without) <= slack)) {
    throw InputError(
        fmt::format("'pmom' and 'gg' contradict each other (found moments 1 that differ from the asymmetry parameters "
                    "by up to {:.3g}, or {:.3g} if they hold the factor 2l+1; allowed {})",
                    without, with, slack));
  }
  if (std::max(with, without) <= slack) return std::nullopt;
  return with <= without;
}

/// libRadtran writes moments times 2l+1, and says so in their units; other programs that use the format need not. The
/// asymmetry parameters beside them decide, else the units, else the moments: no chi_l is above 1, and no phase
/// function negative. Otherwise the reader guesses, and adds a note.
bool includes_factor(const NetcdfFile& file, const MomentRows& rows, const std::vector<double>& asymmetry,
                     std::vector<std::string>& notes) {
  if (const auto included = includes_factor_by(asymmetry, rows)) return *included;
  if (file.text_attribute("pmom", "units").find("2*l+1") != std::string::npos) return true;
  const bool any_above_one = std::any_of(rows.begin(), rows.end(), [](const auto& row) {
    return std::any_of(row.begin(), row.end(), [](double value) { return std::abs(value) > 1.0001; });
  });
  if (any_above_one) return true;
  if (any_negative(rows)) return !any_negative(without_factor(rows));
  notes.emplace_back(
      "'pmom' read as moments without the factor 2l+1 (GUESSED: none is above 1; units of 'pmom' that "
      "say \"including factor 2*l+1\", or 'gg', would decide)");
  return false;
}

/// [row][l] moments g^l of Henyey-Greenstein functions, as long as their terms of a series count.
MomentRows henyey_greenstein_moments(const std::vector<double>& asymmetry) {
  constexpr double least_term = 1e-6;
  constexpr double largest = .995;  // 4700 moments
  MomentRows rows;
  for (const double g : asymmetry) {
    if (!(std::abs(g) <= largest))
      throw InputError(fmt::format("'gg': asymmetry parameter (found {}, allowed up to {})", g, largest));
    std::vector<double>& row = rows.emplace_back();
    double moment = 1;
    for (int l = 0; l < 2 || (2 * l + 1) * std::abs(moment) > least_term; ++l) {
      row.push_back(moment);
      moment *= g;
    }
  }
  return rows;
}

/// Rows are checked before they are mixed: in a mixture, values out of range may make up for each other.
/// @returns the note on the first row whose phase function rings below 0
std::string check_rows(const DropletTable& rows, const std::vector<double>& humidity) {
  std::string first_note;
  for (std::size_t n = 0; n < humidity.size(); ++n) {
    if (!(humidity[n] >= 0 && humidity[n] <= 100))
      throw InputError(fmt::format("'hum': out of range (found {} %, allowed 0 to 100 %)", humidity[n]));
    if (n > 0 && !(humidity[n] > humidity[n - 1]))
      throw InputError(fmt::format("'hum': does not ascend (found {} % after {} %)", humidity[n], humidity[n - 1]));
    std::string note = check_droplet_row(rows, n, fmt::format("relative humidity {} %", humidity[n]));
    if (first_note.empty()) first_note = std::move(note);
  }
  return first_note;
}

/// One row of a table whose rows belong to relative humidities: between two of them extinction and scattering are
/// linear in the humidity, and phase functions are mixed by scattering. The radius has no meaning.
DropletTable at_humidity(const DropletTable& rows, const std::vector<double>& humidity, double percent) {
  std::string note = check_rows(rows, humidity);
  if (!(percent >= humidity.front() && percent <= humidity.back())) {
    throw InputError(fmt::format("no such relative humidity (found {} %, allowed {} to {} %)", percent,
                                 humidity.front(), humidity.back()));
  }
  const auto above = std::upper_bound(humidity.begin(), humidity.end(), percent) - humidity.begin();
  const auto upper = std::min(static_cast<std::size_t>(above), humidity.size() - 1);
  const std::size_t lower = upper > 0 ? upper - 1 : 0;
  const double share = upper > lower ? (percent - humidity[lower]) / (humidity[upper] - humidity[lower]) : 0;
  const MixedDroplets mixed = mix(rows, {lower, share});
  const double upper_share = mixed.upper_share_of_scattering(share);
  DropletTable table;
  table.wavelength_um = rows.wavelength_um;
  table.notes = rows.notes;
  if (!note.empty()) table.notes.push_back(std::move(note));
  table.effective_radius_um = {1};
  table.extinction_m2_per_g = {mixed.extinction_m2_per_g};
  table.single_scattering_albedo = {mixed.single_scattering_albedo()};
  std::vector<double> moments(std::max(rows.moments[lower].size(), rows.moments[upper].size()), 0.);
  const auto add = [&](std::size_t row, double weight) {
    for (std::size_t l = 0; l < rows.moments[row].size(); ++l) moments[l] += weight * rows.moments[row][l];
  };
  add(lower, 1 - upper_share);
  add(upper, upper_share);
  table.moments = {std::move(moments)};
  return table;
}

/// Rows by effective radius, or by humidity: radii are missing then.
DropletTable read_rows(const NetcdfFile& file, const char* axis, std::optional<double> wavelength_um) {
  const auto only_axis = [&](const char* name) {
    const auto shape = file.shape(name);
    if (shape.size() != 1 || shape[0] == 0) throw InputError(fmt::format("'{}': not a list of numbers", name));
    return shape[0];
  };
  const std::size_t waves = only_axis("wavelen"), rows = only_axis(axis);
  const std::vector<double> wavelength = file.read_all("wavelen", {waves});
  const std::size_t wave = choose_wavelength(wavelength, wavelength_um);

  DropletTable table;
  table.wavelength_um = wavelength[wave];
  table.effective_radius_um = file.read_all(axis, {rows});
  table.single_scattering_albedo = file.read("ssa", {waves, rows}, {wave, 0}, {1, rows});
  table.extinction_m2_per_g = file.read("ext", {waves, rows}, {wave, 0}, {1, rows});
  const std::string units = file.text_attribute("ext", "units");
  if (!units.empty() && !is_per_km_and_content(units)) {
    throw InputError(fmt::format("'ext': unknown unit (found '{}', allowed 'km^-1/(g/m^3)')", units));
  }
  for (double& extinction : table.extinction_m2_per_g) extinction /= 1000;

  if (!file.has("pmom") && file.has("gg")) {
    table.moments = henyey_greenstein_moments(file.read("gg", {waves, rows}, {wave, 0}, {1, rows}));
    table.notes.emplace_back("no 'pmom', so that the phase functions are Henyey-Greenstein's with 'gg'");
    return table;
  }
  const std::vector<std::size_t> shape = file.shape("pmom");
  if (shape.size() != 4 || shape[0] != waves || shape[1] != rows || shape[2] == 0 || shape[3] < 2) {
    throw InputError(
        fmt::format("'pmom': wrong shape (found {} dimensions, allowed wavelength, radius, matrix element, "
                    "moment)",
                    shape.size()));
  }
  std::vector<double> count(rows, static_cast<double>(shape[3]));
  if (file.has("nmom")) count = file.read("nmom", {waves, rows, shape[2]}, {wave, 0, 0}, {1, rows, 1});
  for (std::size_t n = 0; n < rows; ++n) {
    if (!(count[n] >= 0)) {
      throw InputError(fmt::format("'nmom': number of moments out of range (found {} in row {}, allowed 0 or more)",
                                   count[n], n + 1));
    }
    // The first matrix element is the phase function. nmom is the number of moments, in some versions the last degree:
    // one more does no harm, because what is not there is 0 or the fill value.
    std::vector<double> moments = file.read("pmom", shape, {wave, n, 0, 0}, {1, 1, 1, shape[3]});
    const double most = std::clamp(count[n] + 1, 2.0, static_cast<double>(shape[3]));
    moments.resize(static_cast<std::size_t>(most));
    while (moments.size() > 2 && !(std::abs(moments.back()) > 0 && std::abs(moments.back()) < 1e30)) moments.pop_back();
    table.moments.push_back(std::move(moments));
  }
  std::vector<double> asymmetry;
  if (file.has("gg")) asymmetry = file.read("gg", {waves, rows}, {wave, 0}, {1, rows});
  if (includes_factor(file, table.moments, asymmetry, table.notes))
    table.moments = without_factor(std::move(table.moments));
  return table;
}

}  // namespace

DropletTable read_libradtran_table(const std::filesystem::path& path, std::optional<double> wavelength_um,
                                   std::optional<double> relative_humidity_percent) {
  hdf5::start_library();
  const NetcdfFile file(path);
  const bool by_humidity = file.has("hum") && !file.has("reff");
  if (by_humidity && !relative_humidity_percent) {
    throw InputError(
        "a table by relative humidity (found variable 'hum' without 'reff', allowed with relative_humidity_percent)");
  }
  if (!by_humidity) refuse_humidity(relative_humidity_percent);
  const DropletTable rows = read_rows(file, by_humidity ? "hum" : "reff", wavelength_um);
  return by_humidity ? at_humidity(rows, rows.effective_radius_um, *relative_humidity_percent) : rows;
}

}  // namespace cloudbow
