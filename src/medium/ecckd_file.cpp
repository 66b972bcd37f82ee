// Definition files of ecCKD gas models (netCDF).
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <string>
#include <utility>

#include "ecckd_model.hpp"
#include "import_parts.hpp"
#include "netcdf_input.hpp"

namespace cloudbow {
namespace {

constexpr double most_numbers = 1e8;  // of one variable
constexpr std::size_t most_points = 4096, most_length = 100000;
constexpr const char* way_out = "take an undamaged ecCKD definition file, as in ecRad's data folder";
constexpr const char* source = "ecRad's data folder has such files";

struct Range {
  double lowest, highest;
};
constexpr Range of_pressures{1e-6, 1e7}, of_temperatures{1, 1000}, of_fractions{0, 1}, of_molar{0, 1e12},
    of_fluxes{0, 1e6}, of_wavenumbers{0, 1e7};

using Names = std::vector<std::string>;

class EcckdReader {
 public:
  explicit EcckdReader(const std::filesystem::path& file) : file_(file), input_(file) {}

  EcckdTables read() {
    check_kind();
    EcckdTables tables;
    tables.light = input_.find("planck_function") != nullptr ? GasModel::Light::longwave : GasModel::Light::solar;
    read_axes(tables);
    read_gases(tables);
    read_spectrum(tables);
    if (input_.find("band_number") != nullptr) read_bands(tables);
    if (tables.light == GasModel::Light::longwave) {
      read_planck(tables);
    } else {
      tables.solar_irradiance = numbers("solar_irradiance", {"g_point"}, of_fluxes);
      if (*std::max_element(tables.solar_irradiance.begin(), tables.solar_irradiance.end()) <= 0)
        fail("solar_irradiance: no light (found 0 at all g-points, allowed > 0 at one at least) {}", way_out);
      tables.rayleigh = numbers("rayleigh_molar_scattering_coeff", {"g_point"}, of_molar);
    }
    return tables;
  }

 private:
  template <class... Args>
  [[noreturn]] void fail(fmt::format_string<Args...> text, Args&&... args) const {
    fail_import(file_, text, std::forward<Args>(args)...);
  }

  void check_kind() const {
    const bool emits = input_.find("planck_function") != nullptr, shines = input_.find("solar_irradiance") != nullptr;
    if (emits != shines && input_.find("gpoint_fraction") != nullptr && !constituents().empty()) return;
    std::string found;
    constexpr std::size_t shown = 12;
    for (std::size_t n = 0; n < std::min(shown, input_.variables().size()); ++n)
      found += (n == 0 ? "" : ", ") + input_.variables()[n].name;
    if (input_.variables().size() > shown) found += ", ...";
    fail(
        "no gas model (found netCDF with {} {}, allowed an ecCKD definition file: the attribute constituent_id, the "
        "variables gpoint_fraction and either planck_function or solar_irradiance) {}",
        input_.variables().empty() ? "no" : "the variables", found.empty() ? "variable" : found, source);
  }

  Names constituents() const {
    std::istringstream words(input_.global_text("constituent_id"));
    Names names;
    for (std::string word; words >> word;) names.push_back(word);
    return names;
  }

  const NetcdfVariable& variable(const std::string& name, const Names& dimensions) const {
    const NetcdfVariable* found = input_.find(name);
    const auto listed = [](const Names& names) { return fmt::format("({})", fmt::join(names, ", ")); };
    if (found == nullptr)
      fail("'{}': no such variable (found none, allowed {}{}) {}", name, name, listed(dimensions), way_out);
    if (found->dimension != dimensions) {
      fail("'{}': other dimensions (found {}, allowed {}) {}", name, listed(found->dimension), listed(dimensions),
           way_out);
    }
    double size = 1;
    for (const std::size_t length : found->length) size *= static_cast<double>(length);
    if (!(size >= 1 && size <= most_numbers))
      fail("'{}': size out of range (found {} numbers, allowed 1 to {}) {}", name, size, most_numbers, way_out);
    return *found;
  }

  std::vector<double> numbers(const std::string& name, const Names& dimensions, Range allowed) const {
    std::vector<double> value = input_.read(variable(name, dimensions));
    for (const double number : value) {
      if (number >= allowed.lowest && number <= allowed.highest) continue;
      fail("'{}': out of range (found {:.6g}, allowed {} to {}) {}", name, number, allowed.lowest, allowed.highest,
           way_out);
    }
    return value;
  }

  /// Positions in the tables are found by division: their steps must be equal.
  EvenAxis even_axis(const std::string& name, const std::vector<double>& value, const char* of = "") const {
    const std::size_t last = value.size() - 1;
    if (value.size() < 2 || value.size() > most_length)
      fail("'{}': length out of range (found {}, allowed 2 to {}) {}", name, value.size(), most_length, way_out);
    const EvenAxis axis{value[0], (value[last] - value[0]) / static_cast<double>(last), value.size()};
    constexpr double slack = 1e-3;  // of a step: numbers are floats
    for (std::size_t n = 0; n < last; ++n) {
      const double step = value[n + 1] - value[n];
      if (axis.step > 0 && std::abs(step - axis.step) <= slack * axis.step) continue;
      fail("'{}': uneven (found a step of {:.6g} at index {}, allowed ascending equal steps{}) {}", name, step, n, of,
           way_out);
    }
    return axis;
  }

  EvenAxis log_axis(const std::string& name, std::vector<double> value) const {
    for (double& number : value) {
      if (!(number > 0)) fail("'{}': not positive (found {:.6g}, allowed > 0) {}", name, number, way_out);
      number = std::log(number);
    }
    return even_axis(name, value, " of the logarithm");
  }

  void read_axes(EcckdTables& tables) const {
    tables.log_pressure = log_axis("pressure", numbers("pressure", {"pressure"}, of_pressures));
    const std::size_t pressures = tables.log_pressure.count;
    const std::vector<double> temperature = numbers("temperature", {"temperature", "pressure"}, of_temperatures);
    tables.first_temperature.assign(temperature.begin(), temperature.begin() + static_cast<std::ptrdiff_t>(pressures));
    std::vector<double> column(temperature.size() / pressures);
    for (std::size_t p = 0; p < pressures; ++p) {
      for (std::size_t t = 0; t < column.size(); ++t) column[t] = temperature[t * pressures + p];
      const EvenAxis axis = even_axis("temperature", column);
      if (p == 0) tables.temperature = axis;
      constexpr double slack = 1e-3;
      if (std::abs(axis.step - tables.temperature.step) > slack * axis.step) {
        fail("'temperature': uneven (found a step of {:.6g} K at pressure {}, allowed that of all, {:.6g} K) {}",
             axis.step, p, tables.temperature.step, way_out);
      }
    }
  }

  void read_gases(EcckdTables& tables) {
    for (const std::string& name : constituents()) {
      const auto same = [&](const EcckdGas& gas) { return gas.name == name; };
      if (std::any_of(tables.gas.begin(), tables.gas.end(), same))
        fail("constituent_id: a gas twice (found {}, allowed each once) {}", name, way_out);
      EcckdGas gas;
      gas.name = name;
      gas.dependence = dependence(name);
      Names dimensions{"temperature", "pressure", "g_point"};
      if (gas.dependence == EcckdDependence::lookup) {
        const std::string axis = name + "_mole_fraction";
        gas.log_mole_fraction = log_axis(axis, numbers(axis, {axis}, of_fractions));
        dimensions.insert(dimensions.begin(), axis);
      }
      if (gas.dependence == EcckdDependence::relative_linear)
        gas.reference_fraction = numbers(name + "_reference_mole_fraction", {}, of_fractions).front();
      gas.absorption = numbers(name + "_molar_absorption_coeff", dimensions, of_molar);
      tables.gas.push_back(std::move(gas));
    }
  }

  EcckdDependence dependence(const std::string& gas) const {
    constexpr Range codes{0, 3};
    const std::string name = gas + "_conc_dependence_code";
    const double code = numbers(name, {}, codes).front();
    if (code != std::floor(code)) fail("'{}': not a code (found {}, allowed 0, 1, 2, 3) {}", name, code, way_out);
    return static_cast<EcckdDependence>(static_cast<int>(code));
  }

  void read_spectrum(EcckdTables& tables) const {
    GasModel::Spectrum& spectrum = tables.spectrum;
    spectrum.lower = numbers("wavenumber1", {"wavenumber"}, of_wavenumbers);
    spectrum.upper = numbers("wavenumber2", {"wavenumber"}, of_wavenumbers);
    if (spectrum.lower.size() > most_length)
      fail("'wavenumber1': too long (found {}, allowed {}) {}", spectrum.lower.size(), most_length, way_out);
    for (std::size_t i = 0; i < spectrum.lower.size(); ++i) {
      if (spectrum.upper[i] > spectrum.lower[i] && (i == 0 || spectrum.lower[i] >= spectrum.upper[i - 1])) continue;
      fail("'wavenumber1': not in order (found {:.6g} to {:.6g} cm-1 at index {}, allowed ascending intervals) {}",
           spectrum.lower[i], spectrum.upper[i], i, way_out);
    }
    if (input_.find("solar_spectral_irradiance") != nullptr && tables.light == GasModel::Light::solar)
      spectrum.solar = numbers("solar_spectral_irradiance", {"wavenumber"}, of_fluxes);

    tables.fraction = numbers("gpoint_fraction", {"g_point", "wavenumber"}, of_fractions);
    const std::size_t intervals = spectrum.lower.size();
    tables.points = tables.fraction.size() / intervals;
    if (tables.points > most_points)
      fail("'gpoint_fraction': too many g-points (found {}, allowed {})", tables.points, most_points);
    for (std::size_t g = 0; g < tables.points; ++g) {
      double sum = 0;
      for (std::size_t i = 0; i < intervals; ++i) sum += tables.fraction[g * intervals + i];
      constexpr double slack = 0.01;
      if (std::abs(sum - 1) <= slack) continue;
      fail("'gpoint_fraction': not the fractions of a g-point (found a sum of {:.6g} at g-point {}, allowed 1) {}", sum,
           g, way_out);
    }
  }

  void read_bands(EcckdTables& tables) const {
    GasModel::Bands& bands = tables.bands;
    bands.lower = numbers("wavenumber1_band", {"band"}, of_wavenumbers);
    bands.upper = numbers("wavenumber2_band", {"band"}, of_wavenumbers);
    for (std::size_t b = 0; b < bands.lower.size(); ++b) {
      if (bands.upper[b] > bands.lower[b]) continue;
      fail("'wavenumber2_band': not above wavenumber1_band (found {:.6g} cm-1 in band {}, allowed > {:.6g} cm-1) {}",
           bands.upper[b], b, bands.lower[b], way_out);
    }
    const Range of_bands{0, static_cast<double>(bands.lower.size() - 1)};
    for (const double number : numbers("band_number", {"g_point"}, of_bands)) {
      if (number != std::floor(number))
        fail("'band_number': not a number of a band (found {}, allowed integers from 0) {}", number, way_out);
      bands.of_point.push_back(static_cast<int>(number));
    }
    for (std::size_t b = 0; b < bands.lower.size(); ++b) {
      if (std::find(bands.of_point.begin(), bands.of_point.end(), static_cast<int>(b)) == bands.of_point.end())
        fail("'band_number': a band without g-points (found none in band {}, allowed one or more) {}", b, way_out);
    }
  }

  void read_planck(EcckdTables& tables) const {
    const std::vector<double> temperature = numbers("temperature_planck", {"temperature_planck"}, of_temperatures);
    tables.planck_temperature = even_axis("temperature_planck", temperature);
    tables.planck_flux = numbers("planck_function", {"temperature_planck", "g_point"}, of_fluxes);
  }

  const std::filesystem::path& file_;
  NetcdfInput input_;
};

}  // namespace

EcckdTables read_ecckd(const std::filesystem::path& file) {
  constexpr const char* allowed = "an ecCKD definition file";
  if (!begins_as_netcdf(file, allowed)) {
    fail_import(file, "no gas model (found neither netCDF nor HDF5, allowed {}, which is netCDF) {}", allowed, source);
  }
  return EcckdReader(file).read();
}

}  // namespace cloudbow
