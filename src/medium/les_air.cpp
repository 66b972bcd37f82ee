#include "les_air.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "text_tokens.hpp"

namespace cloudbow {
namespace {

constexpr double gas_constant = 287.05;  // dry air, J/(kg K); vapour would change the density by less than 1 %
constexpr double gravity = 9.80665;
constexpr double potential_pressure = 1e5;  // Pa
constexpr double potential_exponent = 2.0 / 7;
constexpr double telling_extent = 200;  // m over which air gets thinner by 2 %, more than it varies sideways
constexpr double wrf_base = 300;        // K, which WRF subtracts from the potential temperature

constexpr double least_density = 0.01, largest_density = 2;  // kg/m3
constexpr const char* name_density =
    "name --air-density (a variable, a number in kg/m3, or us-1976), or --profile FILE";

std::vector<float> scaled(std::vector<float> value, double factor, double offset = 0) {
  for (float& number : value) number = static_cast<float>(number * factor + offset);
  return value;
}

bool has(const std::string& text, const char* word) { return text.find(word) != std::string::npos; }

}  // namespace

double standard_air_density(double height_m) {
  struct AirLayer {
    double base_m, kelvin, lapse, pascal;
  };
  constexpr std::array<AirLayer, 3> layers{
      {{0, 288.15, -6.5e-3, 101325}, {11000, 216.65, 0, 22632.06}, {20000, 216.65, 1e-3, 5474.889}}};
  constexpr double highest = 32000;
  if (!(height_m <= highest)) {
    throw InputError(
        fmt::format("--air-density us-1976: too high (found {:.6g} m, allowed up to {} m)", height_m, highest));
  }
  const AirLayer& layer = height_m < layers[1].base_m ? layers[0] : height_m < layers[2].base_m ? layers[1] : layers[2];
  const double rise = height_m - layer.base_m, kelvin = layer.kelvin + layer.lapse * rise;
  const double ratio = layer.lapse == 0 ? std::exp(-gravity * rise / (gas_constant * layer.kelvin))
                                        : std::pow(kelvin / layer.kelvin, -gravity / (gas_constant * layer.lapse));
  return layer.pascal * ratio / (gas_constant * kelvin);
}

template <class Function>
std::vector<float> LesAir::by_height(Function function, bool everywhere) const {
  const std::size_t count = columns(), levels = grid_.length(2);
  std::vector<float> value(count * levels, 1);
  for (std::size_t k = 0; k < levels; ++k) {
    std::optional<float> of_level;
    for (std::size_t c = 0; c < count; ++c) {
      const std::size_t n = k * count + c;
      if (!everywhere && !has_water(n)) continue;
      if (!of_level || grid_.has_levels_of_columns()) of_level = static_cast<float>(function(grid_.point_m(k, c)));
      value[n] = *of_level;
    }
  }
  return value;
}

void LesAir::add_water(const std::vector<float>& water) {
  other_water_.resize(water.size());
  for (std::size_t n = 0; n < water.size(); ++n) {
    if (water[n] != 0) other_water_[n] = true;
  }
}

/// Values outside the range are a wrong unit, or another quantity. Cells without water may have none.
template <class T>
void LesAir::check_range(const std::string& name, const std::vector<T>& value, double low, double high,
                         const char* unit, const char* hint) const {
  for (std::size_t n = 0; n < value.size(); ++n) {
    if (value[n] >= low && value[n] <= high) continue;
    if (std::isnan(value[n]) && !has_water(n) && file_.options.fill == "clear") continue;
    file_.fail("'{}': {} has the value {:.6g} {} (allowed {} to {} {}) {}", name, grid_.cell_text(n), value[n], unit,
               low, high, unit, hint);
  }
}

/// Density of air decreases with height: if it does not, the levels are upside down.
template <class T>
void LesAir::check_levels_ascend(const std::string& name, const std::vector<T>& value) const {
  const std::size_t top = grid_.length(2) - 1;
  if (!(height_m(top) - height_m(0) >= telling_extent)) return;
  const double lowest = value.front(), highest = value[columns() * top];
  if (!(highest > 1.01 * lowest)) return;
  file_.fail(
      "levels are upside down ('{}' grows from {:.6g} at {:.6g} m to {:.6g} at {:.6g} m, allowed a decrease); reverse "
      "them in the file, as 'ncpdq -a -LEVEL' does",
      name, lowest, height_m(0), highest, height_m(top));
}

const std::vector<float>& LesAir::density() {
  if (!density_.empty()) return density_;
  const CloudImportOptions& options = file_.options;
  if (set_density_as_given()) return density_;
  const bool by_gas_law = options.air_density.empty() && !options.pressure.empty();
  const NetcdfVariable* variable =
      by_gas_law ? nullptr : file_.find(options.air_density, air_density_names, "--air-density");
  if (variable != nullptr) {
    set_density_of(*variable);
  } else {
    set_density_by_gas_law();
  }
  return density_;
}

bool LesAir::set_density_as_given() {
  const std::string& given = file_.options.air_density;
  const std::size_t levels = grid_.length(2);
  if (profile_ != nullptr && given.empty() && file_.options.pressure.empty()) {
    density_ = by_height([&](double height) { return profile_->density_at(height); }, false);
    const NetcdfVariable* own = file_.first_of(air_density_names);
    file_.note("air density: {} at the heights of the cells{}", profile_->file.string(),
               own == nullptr ? "" : ", as --profile says, in place of '" + own->name + "'");
    return true;
  }
  if (given == "us-1976" && grid_.has_levels_of_columns()) {
    density_ = by_height(standard_air_density, false);
    file_.note("air density: U.S. Standard Atmosphere 1976 at the heights of the cells");
    return true;
  }
  if (given == "us-1976") {
    for (std::size_t k = 0; k < levels; ++k) {
      density_.insert(density_.end(), columns(), static_cast<float>(standard_air_density(height_m(k))));
    }
    file_.note("air density: U.S. Standard Atmosphere 1976 at the heights of the levels, {:.4g} to {:.4g} kg/m3",
               density_.front(), density_.back());
    return true;
  }
  const auto number = number_in(given);
  if (!number || file_.input.find(given) != nullptr) return false;
  if (!(*number >= least_density && *number <= largest_density)) {
    file_.fail(
        "--air-density has the value {:.6g} kg/m3 (allowed {} to {} kg/m3, a variable, or us-1976); air at the "
        "ground has about 1.2",
        *number, least_density, largest_density);
  }
  density_.assign(levels * columns(), static_cast<float>(*number));
  file_.note("air density: {} kg/m3 everywhere, as --air-density says", *number);
  return true;
}

void LesAir::set_density_of(const NetcdfVariable& variable) {
  if (file_.is_perturbation(variable)) {
    file_.fail("'{}' is a perturbation of the air density by its attributes (allowed: the density itself) {}",
               variable.name, name_density);
  }
  const double unit = file_.factor(variable, density_units, 1, "kg/m3");
  density_ = scaled(grid_.read(variable, "air density"), unit);
  check_range(variable.name, density_, least_density, largest_density, "kg/m3",
              "is it the air's density, in the unit that the file says?");
  check_levels_ascend(variable.name, density_);
  file_.note("air density: '{}'", variable.name);
}

void LesAir::fail_without_density() const {
  file_.fail(
      "water per kg of air needs the air's density (found none, nor pressure and temperature; fields in the file: {}) "
      "name --air-density (a variable, a number in kg/m3, or us-1976), or --profile FILE, or --with FILE (more "
      "variables), "
      "or --pressure and --temperature",
      file_.fields_there());
}

/// The pressure to which a perturbation is to be added: PB beside P, as WRF writes them, and the like.
const NetcdfVariable* LesAir::base_of(const NetcdfVariable& pressure) const {
  if (const std::string& given = file_.options.base_pressure; !given.empty())
    return &file_.named(given, "--base-pressure");
  constexpr std::array<std::pair<const char*, const char*>, 3> pairs{{{"P", "PB"}, {"p", "pb"}, {"prspert", "prs0"}}};
  for (const auto& [perturbation, base] : pairs) {
    if (pressure.name == perturbation) return file_.input.find(base);
  }
  return nullptr;
}

const NetcdfVariable* LesAir::pressure_variable() const {
  const std::string& given = file_.options.pressure;
  const NetcdfVariable* variable = file_.find(given, pressure_names, "--pressure");
  if (given.empty()) {
    for (const NetcdfVariable* candidate : file_.candidates(pressure_names)) {
      if (file_.is_perturbation(*candidate) && base_of(*candidate) == nullptr) continue;
      variable = candidate;
      break;
    }
  }
  if (variable != nullptr) return variable;
  // Levels of pressure: their coordinate is the pressure.
  const NetcdfVariable* coordinate = file_.input.find(grid_.vertical_name());
  return coordinate != nullptr && factor_of(pressure_units, coordinate->units) ? coordinate : nullptr;
}

const NetcdfVariable* LesAir::exner_variable() const {
  const NetcdfVariable* variable = file_.first_of(exner_names);
  return variable != nullptr && grid_.holds(*variable) && !file_.is_perturbation(*variable) ? variable : nullptr;
}

LesAir::Pressure LesAir::pressure_by_exner(const NetcdfVariable& of) {
  const std::vector<float> value = grid_.read(of, "Exner function");
  const float largest = *std::max_element(value.begin(), value.end());
  const bool is_times_capacity = largest > 10;  // RAMS writes c_p times the function
  const double unit = file_.factor(of, exner_units, is_times_capacity ? 1.0 / 1004 : 1,
                                   is_times_capacity ? "J/(kg K), c_p times the Exner function" : "1");
  Pressure result{of.name, {}};
  for (const float number : value)
    result.pa.push_back(potential_pressure * std::pow(number * unit, 1 / potential_exponent));
  check_range(result.name, result.pa, 100, 120000, "Pa", "is it the Exner function? name --pressure or --air-density");
  check_levels_ascend(result.name, result.pa);
  file_.note("pressure: 1e5 Pa times '{}'^(7/2), the Exner function", of.name);
  return result;
}

std::optional<LesAir::Pressure> LesAir::known_pressure() {
  if (const NetcdfVariable* of = pressure_variable();
      of != nullptr && (!file_.is_perturbation(*of) || base_of(*of) != nullptr))
    return pressure(*of);
  if (const NetcdfVariable* of = exner_variable()) return pressure_by_exner(*of);
  if (profile_ == nullptr || !profile_->atmosphere) return std::nullopt;
  const Atmosphere& air = *profile_->atmosphere;
  const std::vector<float> pa = by_height([&](double height) { return air.pressure_at(height); }, true);
  file_.note("pressure: {} at the heights of the cells", profile_->file.string());
  return Pressure{profile_->file.string(), {pa.begin(), pa.end()}};
}

LesAir::Pressure LesAir::pressure(const NetcdfVariable& of) {
  const NetcdfVariable* variable = &of;
  const NetcdfVariable* base = base_of(*variable);
  if (base == nullptr && file_.is_perturbation(*variable)) {
    file_.fail(
        "'{}' is a perturbation of pressure by its attributes (found no base pressure, allowed the pressure "
        "itself); name --base-pressure, or {}",
        variable->name, name_density);
  }
  Pressure result{variable->name, {}};
  std::vector<float> read = grid_.read(*variable, "pressure");
  const auto unit_of = [&](const NetcdfVariable& whole, const std::vector<float>& value) {
    float highest = 0;
    for (const float number : value) highest = std::max(highest, number);
    const bool is_hpa = highest < 2000;
    return file_.factor(whole, pressure_units, is_hpa ? 100 : 1, is_hpa ? "hPa" : "Pa");
  };
  if (base == nullptr) {
    const double unit = unit_of(*variable, read);
    for (const float value : read) result.pa.push_back(value * unit);
  } else {
    const std::vector<float> of_base = grid_.read(*base, "base pressure");
    const double unit = unit_of(*base, of_base);
    const double own_unit = file_.factor(*variable, pressure_units, unit, "that of the base pressure");
    for (std::size_t n = 0; n < read.size(); ++n) result.pa.push_back(read[n] * own_unit + of_base[n] * unit);
    result.name += "' + '" + base->name;
  }
  check_range(result.name, result.pa, 100, 120000, "Pa",
              "a perturbation of pressure cannot be used: name --pressure, or --air-density (a variable, a number in "
              "kg/m3, or us-1976)");
  check_levels_ascend(result.name, result.pa);
  return result;
}

const NetcdfVariable* LesAir::temperature_variable() const {
  const std::string &given = file_.options.temperature, &potential = file_.options.potential_temperature;
  if (!potential.empty()) return &file_.named(potential, "--potential-temperature");
  if (const NetcdfVariable* variable = file_.find(given, temperature_names, "--temperature")) return variable;
  if (const NetcdfVariable* variable = file_.first_of(potential_temperature_names)) return variable;
  return file_.first_of(liquid_potential_temperature_names);
}

bool LesAir::is_liquid_potential(const NetcdfVariable& variable) const {
  const std::string meaning = file_.meaning(variable);
  if (has(meaning, "liquid") && has(meaning, "potential temperature")) return true;
  const Names& names = liquid_potential_temperature_names.names;
  if (std::find(names.begin(), names.end(), variable.name) != names.end()) return true;
  if (file_.model == nullptr || has(meaning, "absolute")) return false;
  const Names& of_model = file_.model->liquid_potential;
  return std::find(of_model.begin(), of_model.end(), variable.name) != of_model.end();
}

/// The potential temperature of a reference state to which a difference is to be added, as MONC writes them.
static const NetcdfVariable* reference_of(const LesFile& file, const NetcdfVariable& variable, float lowest) {
  return variable.name == "th" && lowest < 150 ? file.input.find("thref") : nullptr;
}

std::vector<float> LesAir::kelvin_of(const NetcdfVariable& variable, const Pressure* pressure) {
  const std::string meaning = file_.meaning(variable);
  const Names& potential_names = potential_temperature_names.names;
  std::vector<float> value = grid_.read(variable, "temperature");
  float lowest = INFINITY;
  for (const float number : value) lowest = std::min(lowest, number);
  const bool says_potential = has(meaning, "potential temperature");
  if (says_potential && has(meaning, "equivalent")) {
    file_.fail(
        "'{}' is an equivalent potential temperature by its attributes (allowed: temperature, or potential "
        "temperature); name --temperature, or --air-density",
        variable.name);
  }
  const bool is_perturbation = file_.is_perturbation(variable);
  if (is_perturbation && !says_potential) {
    file_.fail("'{}' is a perturbation of temperature by its attributes (allowed: the temperature itself) {}",
               variable.name, name_density);
  }
  // WRF's T is the potential temperature less 300 K; its PB stands beside it.
  const bool is_from_300 = (says_potential && is_perturbation) ||
                           (variable.name == "T" && lowest < 150 && file_.input.find("PB") != nullptr);
  const NetcdfVariable* reference = reference_of(file_, variable, lowest);
  const bool is_potential =
      is_from_300 || says_potential || is_liquid_potential(variable) || reference != nullptr ||
      variable.name == file_.options.potential_temperature ||
      std::find(potential_names.begin(), potential_names.end(), variable.name) != potential_names.end();
  const auto celsius = factor_of(celsius_units, variable.units);
  if (!celsius) file_.factor(variable, kelvin_units, 1, "K");
  value = scaled(std::move(value), 1, celsius ? 273.15 : is_from_300 ? wrf_base : 0);
  if (reference != nullptr) {
    const std::vector<float> more = grid_.read(*reference, "reference potential temperature");
    for (std::size_t n = 0; n < value.size(); ++n) value[n] += more[n];
    file_.note("temperature: '{}' is the difference from '{}'", variable.name, reference->name);
  }
  const auto to_temperature = [&pressure](std::vector<float> theta) {
    for (std::size_t n = 0; n < theta.size(); ++n) {
      theta[n] = static_cast<float>(theta[n] * std::pow(pressure->pa[n] / potential_pressure, potential_exponent));
    }
    return theta;
  };
  if (is_potential && pressure == nullptr) {
    file_.fail(
        "'{}' is the potential temperature (found no pressure beside it; fields in the file: {}) name it with "
        "--pressure, or give --profile FILE with pressure and temperature",
        variable.name, file_.fields_there());
  }
  if (is_potential) {
    value = to_temperature(std::move(value));
    file_.note("temperature: '{}' is {}, T = {} (p / 1e5 Pa)^(2/7)", variable.name,
               is_from_300 ? "the potential temperature less 300 K" : "the potential temperature",
               is_from_300 ? "(300 K + '" + variable.name + "')" : "'" + variable.name + "'");
  }
  if (!is_potential && pressure != nullptr) {
    std::vector<float> converted = to_temperature(value);
    if (const std::string sign = sign_of_potential(*pressure, value, converted); !sign.empty()) {
      value = std::move(converted);
      file_.note("GUESSED: '{}' is the potential temperature ({}), T = '{}' (p / 1e5 Pa)^(2/7)", variable.name, sign,
                 variable.name);
    }
  }
  check_range(variable.name, value, 150, 350, "K",
              "a temperature in Celsius must say so in its attribute units (degC), a perturbation cannot be used: name "
              "--temperature, or --air-density (a variable, a number in kg/m3, or us-1976)");
  return value;
}

std::optional<double> LesAir::balance(const Pressure& pressure, const std::vector<float>& kelvin) const {
  const std::size_t top = grid_.length(2) - 1;
  const double extent = height_m(top) - height_m(0);
  const double by_weight = (pressure.pa.front() - pressure.pa[columns() * top]) / (gravity * extent);
  if (!(extent >= telling_extent) || by_weight == 0) return std::nullopt;
  const auto density = [&](std::size_t k) {
    return pressure.pa[columns() * k] / (gas_constant * kelvin[columns() * k]);
  };
  double mean = 0;
  for (std::size_t k = 0; k < top; ++k)
    mean += 0.5 * (density(k) + density(k + 1)) * (height_m(k + 1) - height_m(k)) / extent;
  const double ratio = mean / by_weight;
  return std::isfinite(ratio) ? std::optional(ratio) : std::nullopt;
}

/// Reason why numbers that are named temperature are the potential temperature; empty if they are not. The weight of
/// the air decides: the gas law with the temperature gives the density that pressure and heights have. If it is not
/// conclusive, temperature falls with height in a cloud, and potential temperature rises.
std::string LesAir::sign_of_potential(const Pressure& pressure, const std::vector<float>& kelvin,
                                      const std::vector<float>& converted) const {
  const auto fits = [](const std::optional<double>& ratio) { return ratio && *ratio > 0.99 && *ratio < 1.02; };
  const auto as_it_is = balance(pressure, kelvin), as_potential = balance(pressure, converted);
  if (fits(as_it_is)) return "";
  if (fits(as_potential)) {
    return fmt::format("with it pressure and heights agree to {:.1f} %, with a temperature to {:.1f} %",
                       100 * std::abs(*as_potential - 1), 100 * std::abs(as_it_is.value_or(0) - 1));
  }
  const auto mean = [&](const std::vector<float>& value, std::size_t k) {
    const auto begin = value.begin() + static_cast<std::ptrdiff_t>(k * columns());
    return std::accumulate(begin, begin + static_cast<std::ptrdiff_t>(columns()), 0.0) / static_cast<double>(columns());
  };
  std::size_t base = 0, top = grid_.length(2) - 1;
  while (base < top && mean(water_, base) == 0) ++base;
  while (top > base && mean(water_, top) == 0) --top;
  constexpr double telling_depth = 100;  // m, beyond which no inversion of temperature reaches in a cloud
  if (!(height_m(top) - height_m(base) >= telling_depth) || !(mean(kelvin, top) > mean(kelvin, base))) return "";
  return fmt::format("it rises from {:.6g} K at the cloud's base to {:.6g} K at its top", mean(kelvin, base),
                     mean(kelvin, top));
}

constexpr double kelvin_per_ratio = 2.5e6 / (3.5 * gas_constant);  // latent heat over heat capacity

void LesAir::add_heat_of_ratio(const std::string& name) {
  if (!(liquid_ratio_ > 0)) {
    file_.fail(
        "'{}' is a liquid water potential temperature (found no liquid water per kg of air beside it, allowed "
        "temperature) {}",
        name, name_density);
  }
  for (std::size_t n = 0; n < kelvin_.size(); ++n) {
    if (water_[n] > 0) kelvin_[n] = static_cast<float>(kelvin_[n] + kelvin_per_ratio * liquid_ratio_ * water_[n]);
  }
  file_.note("temperature: '{}' is that of all water as vapour, 2488 K times the mixing ratio of the liquid is added",
             name);
}

void LesAir::add_heat_of_condensation(const std::string& name, const std::vector<float>& liquid_g_m3,
                                      std::vector<float>& kelvin) {
  const std::vector<float>& air = density();
  for (std::size_t n = 0; n < kelvin.size(); ++n) {
    if (!(liquid_g_m3[n] > 0)) continue;
    const double ratio = 1e-3 * liquid_g_m3[n] / air[n];
    kelvin[n] = static_cast<float>(kelvin[n] + kelvin_per_ratio * ratio);
  }
  file_.note(
      "temperature grid: '{}' is that of all water as vapour, 2488 K times the mixing ratio of the liquid is added",
      name);
}

std::vector<float> LesAir::temperature(const std::vector<float>* liquid_g_m3) {
  const NetcdfVariable* variable = temperature_variable();
  if (variable == nullptr && profile_ != nullptr && profile_->atmosphere) {
    file_.note("temperature: {} at the heights of the cells", profile_->file.string());
    return by_height([&](double height) { return profile_->atmosphere->temperature_at(height); }, true);
  }
  if (variable == nullptr) {
    file_.fail(
        "no temperature (found neither a temperature nor a potential one; fields in the file: {}) name it with "
        "--temperature, or give --profile FILE with pressure and temperature",
        file_.fields_there());
  }
  if (!kelvin_.empty()) return kelvin_;
  const std::optional<Pressure> air = known_pressure();
  std::vector<float> kelvin = kelvin_of(*variable, air ? &*air : nullptr);
  if (!is_liquid_potential(*variable)) return kelvin;
  if (liquid_g_m3 == nullptr) {
    file_.fail(
        "'{}' is a liquid water potential temperature (found no liquid water, allowed temperature); name it "
        "with --temperature",
        variable->name);
  }
  add_heat_of_condensation(variable->name, *liquid_g_m3, kelvin);
  return kelvin;
}

void LesAir::set_density_by_gas_law() {
  const NetcdfVariable* variable = temperature_variable();
  const NetcdfVariable* of_pressure = variable == nullptr ? nullptr : pressure_variable();
  const NetcdfVariable* of_exner = variable == nullptr || of_pressure != nullptr ? nullptr : exner_variable();
  if (of_pressure == nullptr && of_exner == nullptr) fail_without_density();
  const Pressure air = of_pressure != nullptr ? pressure(*of_pressure) : pressure_by_exner(*of_exner);
  kelvin_ = kelvin_of(*variable, &air);
  if (is_liquid_potential(*variable)) add_heat_of_ratio(variable->name);
  const std::vector<float>& kelvin = kelvin_;
  for (std::size_t n = 0; n < kelvin.size(); ++n)
    density_.push_back(static_cast<float>(air.pa[n] / (gas_constant * kelvin[n])));
  check_range(air.name, density_, 0.01, 2, "kg/m3 of air",
              "with this temperature: are both in the units that the file says?");
  if (const auto ratio = balance(air, kelvin); ratio && !(*ratio > 0.9 && *ratio < 1.1)) {
    file_.fail(
        "'{}', '{}' and the heights contradict each other (found {:.5g} times the density that the weight of the air "
        "gives, allowed 0.9 to 1.1): is one in another unit, or a perturbation? name --pressure and --temperature, "
        "--air-density, or give --voxel-size-m DX DY DZ",
        air.name, variable->name, *ratio);
  }
  const bool is_sum = air.name.find('+') != std::string::npos;
  file_.note("air density: {}'{}'{} / (287.05 J/(kg K) '{}')", is_sum ? "(" : "", air.name, is_sum ? ")" : "",
             variable->name);
}

}  // namespace cloudbow
