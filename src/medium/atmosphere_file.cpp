// Profiles of the air from files: text columns as AFGL profiles have them, and netCDF.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <optional>
#include <string>
#include <utility>

#include "cloudbow/core/input_file.hpp"
#include "cloudbow/core/sandbox.hpp"
#include "cloudbow/core/text_case.hpp"
#include "cloudbow/medium/atmosphere.hpp"
#include "les_vocabulary.hpp"
#include "netcdf_input.hpp"
#include "text_tokens.hpp"

namespace cloudbow {
namespace {

constexpr std::size_t most_heights = 100000;
constexpr double celsius_zero_k = 273.15;

const UnitTable fraction_units{"1, mol/mol, %, ppm, ppb",
                               {{"", 1},
                                {"1", 1},
                                {"-", 1},
                                {"mol/mol", 1},
                                {"molmol-1", 1},
                                {"mole/mole", 1},
                                {"%", 1e-2},
                                {"percent", 1e-2},
                                {"ppm", 1e-6},
                                {"ppmv", 1e-6},
                                {"1e-6", 1e-6},
                                {"ppb", 1e-9},
                                {"ppbv", 1e-9},
                                {"1e-9", 1e-9}}};

/// A gas by its names in files, and by its part of CF's mole_fraction_of_GAS_in_air.
struct Gas {
  const char* name;
  std::array<const char*, 2> of_cf;
};
constexpr std::array<Gas, 11> gases{{{"h2o", {"water_vapor", "water_vapour"}},
                                     {"o3", {"ozone", ""}},
                                     {"co2", {"carbon_dioxide", ""}},
                                     {"ch4", {"methane", ""}},
                                     {"n2o", {"nitrous_oxide", ""}},
                                     {"co", {"carbon_monoxide", ""}},
                                     {"o2", {"molecular_oxygen", "oxygen"}},
                                     {"no2", {"nitrogen_dioxide", ""}},
                                     {"so2", {"sulfur_dioxide", ""}},
                                     {"cfc11", {"cfc11", ""}},
                                     {"cfc12", {"cfc12", ""}}}};

bool is_gas(const std::string& name) {
  return std::any_of(gases.begin(), gases.end(), [&](const Gas& gas) { return name == gas.name; });
}

void order_from_below(Atmosphere& atmosphere) {
  const auto turn = [](std::vector<double>& value) { std::reverse(value.begin(), value.end()); };
  if (atmosphere.height_m.size() < 2 || atmosphere.height_m.front() < atmosphere.height_m.back()) return;
  turn(atmosphere.height_m);
  turn(atmosphere.pressure_pa);
  turn(atmosphere.temperature_k);
  for (auto& [gas, fraction] : atmosphere.mole_fraction) turn(fraction);
}

// -- Text -------------------------------------------------------------------------------------------------------------

/// Quantities of columns: "z", "p", "t", "air", or a gas; "" for a column that is not read.
struct Column {
  std::string quantity;
  double factor = 1;
  double offset = 0;
  bool is_number_density = false;
};

class AfglReader {
 public:
  explicit AfglReader(const std::filesystem::path& file) : file_(file), lines_(file) {}

  Atmosphere read() {
    std::string line;
    while (lines_.next(line)) {
      if (is_comment(line)) {
        if (rows_ == 0) read_heading(line);
      } else {
        read_row(line);
      }
    }
    if (rows_ == 0) {
      fail_import(file_, "no profile (found no line of numbers, allowed columns z p T, or netCDF)");
    }
    return atmosphere();
  }

 private:
  static constexpr std::array<const char*, 9> usual_order{"z", "p", "t", "air", "o3", "o2", "h2o", "co2", "no2"};

  /// A comment that names columns, as "# z(km) p(mb) T(K) air(cm-3)"; others say nothing.
  void read_heading(std::string line) {
    std::replace(line.begin(), line.end(), '#', ' ');
    std::vector<std::pair<std::string, std::string>> found;  // name and unit
    for (const std::string_view word : split_words(line)) {
      const auto bracket = std::min(word.find_first_of("(["), word.size());
      std::string unit(word.substr(bracket));
      if (bracket == 0 && !found.empty()) {
        found.back().second += unit;
      } else {
        found.emplace_back(lower_case(std::string(word.substr(0, bracket))), std::move(unit));
      }
    }
    for (auto& [name, unit] : found) {
      if (name == "height" || name == "altitude" || name == "alt") name = "z";
      if (name == "pressure" || name == "pres") name = "p";
      if (name == "temperature" || name == "temp") name = "t";
      std::erase_if(unit, [](char c) { return c == '(' || c == ')' || c == '[' || c == ']'; });
    }
    const auto has = [&](const char* name) {
      return std::count_if(found.begin(), found.end(), [&](const auto& column) { return column.first == name; });
    };
    if (has("z") != 1 || has("p") != 1 || has("t") != 1) return;
    columns_.clear();
    for (const auto& [name, unit] : found) columns_.push_back(column_of(name, unit));
    for (const Column& column : columns_) {
      if (!column.quantity.empty() && has(column.quantity.c_str()) > 1)
        lines_.fail("column {}: is there twice (allowed: once); name its columns apart", column.quantity);
    }
  }

  Column column_of(const std::string& name, const std::string& unit) const {
    const auto in = [&](const UnitTable& table, double usual) {
      const auto factor = unit.empty() ? std::optional(usual) : factor_of(table, unit);
      if (!factor) {
        lines_.fail("column {}: unit not known (found \"{}\", allowed {}); write it as in \"p(mb)\"", name, unit,
                    table.allowed);
      }
      return *factor;
    };
    constexpr double per_cm3 = 1e6;
    if (name == "z") return {name, in(length_units, 1000)};
    if (name == "p") return {name, in(pressure_units, 100)};
    if (name == "t") {
      if (factor_of(celsius_units, unit)) return {name, 1, celsius_zero_k};
      return {name, in(kelvin_units, 1)};
    }
    if (name == "air") return {name, in(number_per_volume_units, per_cm3), 0, true};
    if (!is_gas(name)) return {""};
    if (const auto factor = unit.empty() ? std::nullopt : factor_of(fraction_units, unit)) return {name, *factor};
    return {name, in(number_per_volume_units, per_cm3), 0, true};
  }

  void read_row(const std::string& line) {
    const auto words = split_words(line);
    if (rows_ == 0 && columns_.empty()) {
      if (words.size() > usual_order.size() || words.size() < 3) {
        lines_.fail(
            "columns not known (found {}, allowed 3 to {}: z p T air o3 o2 h2o co2 no2); name them: \"# z(km) p(mb) "
            "T(K)\"",
            words.size(), usual_order.size());
      }
      for (std::size_t n = 0; n < words.size(); ++n) columns_.push_back(column_of(usual_order[n], ""));
    }
    if (words.size() != columns_.size()) {
      lines_.fail("wrong number of columns (found {}, allowed {} in each line); fill the gaps", words.size(),
                  columns_.size());
    }
    value_.resize(columns_.size());
    for (std::size_t n = 0; n < words.size(); ++n) {
      const auto number = number_in(words[n]);
      if (!number) {
        lines_.fail("column {}: not a number (found \"{}\", allowed a number) comments begin with #", n + 1, words[n]);
      }
      value_[n].push_back(*number * columns_[n].factor + columns_[n].offset);
    }
    if (++rows_ > most_heights) lines_.fail("too many heights (found more, allowed {})", most_heights);
  }

  Atmosphere atmosphere() const {
    Atmosphere result;
    const std::vector<double>* air = nullptr;
    bool has_number_densities = false;
    for (std::size_t n = 0; n < columns_.size(); ++n) {
      if (columns_[n].quantity == "air") air = &value_[n];
    }
    for (std::size_t n = 0; n < columns_.size(); ++n) {
      const std::string& quantity = columns_[n].quantity;
      if (quantity.empty() || quantity == "air") continue;
      if (quantity == "z") {
        result.height_m = value_[n];
      } else if (quantity == "p") {
        result.pressure_pa = value_[n];
      } else if (quantity == "t") {
        result.temperature_k = value_[n];
      } else {
        result.mole_fraction[quantity] = columns_[n].is_number_density ? per_air(quantity, value_[n], air) : value_[n];
        has_number_densities = has_number_densities || columns_[n].is_number_density;
      }
    }
    if (has_number_densities) check_gas_law(result, *air);
    return result;
  }

  /// Densities of the air in another unit make fractions wrong by powers of ten.
  void check_gas_law(const Atmosphere& of, const std::vector<double>& air) const {
    constexpr double boltzmann = 1.380649e-23;  // J K-1
    constexpr double largest_factor = 2;        // pressures of 1e-5 hPa with one digit err by 25 %
    for (std::size_t n = 0; n < air.size(); ++n) {
      const double pressure = of.pressure_pa[n], temperature = of.temperature_k[n];
      // A value out of range has another message.
      if (!(pressure > 0 && pressure <= 120000 && temperature >= 100 && temperature <= 400)) continue;
      const double expected = pressure / (boltzmann * temperature);
      if (air[n] <= largest_factor * expected && air[n] * largest_factor >= expected) continue;
      fail_import(file_,
                  "column air: contradicts the gas law (found {:.4g} m-3 at {:.6g} m, allowed {:.4g} within a factor "
                  "of {}); look at the units",
                  air[n], of.height_m[n], expected, largest_factor);
    }
  }

  std::vector<double> per_air(const std::string& gas, std::vector<double> number,
                              const std::vector<double>* air) const {
    if (air == nullptr) {
      fail_import(
          file_,
          "column {}: no density of the air for it (found no column air, allowed one); add it, or give \"{}(ppm)\"",
          gas, gas);
    }
    for (std::size_t n = 0; n < number.size(); ++n) {
      if (!((*air)[n] > 0)) fail_import(file_, "column air: not positive (found {:.6g} m-3, allowed > 0)", (*air)[n]);
      number[n] /= (*air)[n];
    }
    return number;
  }

  const std::filesystem::path& file_;
  TextLines lines_;
  std::vector<Column> columns_;
  std::vector<std::vector<double>> value_;  // by column
  std::size_t rows_ = 0;
};

// -- netCDF -----------------------------------------------------------------------------------------------------------

const Words profile_height_names{{"z", "height", "altitude", "alt", "Z"},
                                 {"altitude", "height", "height_above_mean_sea_level", "geometric_height"}};

class NetcdfProfiles {
 public:
  explicit NetcdfProfiles(const std::filesystem::path& file) : file_(file), input_(file) {}

  Atmosphere read() {
    Atmosphere result;
    const NetcdfVariable& height = needed(profile_height_names, "height");
    result.height_m = profile(height);
    scale(result.height_m, unit(height, length_units));
    const NetcdfVariable& pressure = needed(pressure_names, "pressure");
    result.pressure_pa = profile(pressure);
    scale(result.pressure_pa, unit(pressure, pressure_units));
    const NetcdfVariable& temperature = needed(temperature_names, "temperature");
    result.temperature_k = profile(temperature);
    if (factor_of(celsius_units, temperature.units)) {
      for (double& value : result.temperature_k) value += celsius_zero_k;
    } else {
      scale(result.temperature_k, unit(temperature, kelvin_units));
    }
    for (const Gas& gas : gases) {
      Words words{{gas.name, upper_case(gas.name)}, {}};
      for (const char* of_cf : gas.of_cf) {
        if (*of_cf == '\0') continue;
        for (const char* form : {"mole_fraction_of_{}_in_air", "mole_fraction_of_{}"}) {
          words.names.push_back(fmt::format(fmt::runtime(form), of_cf));
          words.standard_names.push_back(words.names.back());
        }
      }
      const NetcdfVariable* variable = find(words);
      if (variable == nullptr) continue;
      std::vector<double> fraction = profile(*variable);
      scale(fraction, unit(*variable, fraction_units));
      result.mole_fraction[gas.name] = std::move(fraction);
    }
    return result;
  }

 private:
  static std::string upper_case(std::string text) {
    for (char& c : text) c = c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return text;
  }
  static void scale(std::vector<double>& value, double factor) {
    for (double& number : value) number *= factor;
  }

  const NetcdfVariable* find(const Words& words) const {
    for (const std::string& name : words.names) {
      if (const NetcdfVariable* variable = input_.find(name)) return variable;
    }
    for (const std::string& name : words.standard_names) {
      for (const NetcdfVariable& variable : input_.variables()) {
        if (input_.text_attribute(variable, "standard_name") == name) return &variable;
      }
    }
    return nullptr;
  }

  const NetcdfVariable& needed(const Words& words, const char* what) const {
    if (const NetcdfVariable* variable = find(words)) return *variable;
    std::string found, allowed;
    for (const NetcdfVariable& variable : input_.variables()) found += (found.empty() ? "" : ", ") + variable.name;
    for (const std::string& name : words.names) allowed += (allowed.empty() ? "" : ", ") + name;
    fail_import(file_, "{}: no such variable (found {}, allowed {}, or the standard_name {}); rename the variable",
                what, found.empty() ? "none" : found, allowed, words.standard_names.front());
  }

  double unit(const NetcdfVariable& variable, const UnitTable& table) const {
    if (const auto factor = factor_of(table, variable.units)) return *factor;
    fail_import(file_, "'{}': unit not known (found \"{}\", allowed {}); set its attribute units", variable.name,
                variable.units, table.allowed);
  }

  std::vector<double> profile(const NetcdfVariable& variable) const {
    std::size_t long_dimensions = 0, length = 1;
    for (const std::size_t n : variable.length) {
      long_dimensions += n == 1 ? 0 : 1;
      if (n != 1) length = n;
    }
    if (long_dimensions != 1 || length > most_heights) {
      fail_import(file_,
                  "'{}': not one profile (found {} dimensions longer than 1, allowed 1 of 2 to {} values); cut "
                  "one profile out of the file",
                  variable.name, long_dimensions, most_heights);
    }
    return input_.read(variable);
  }

  const std::filesystem::path& file_;
  NetcdfInput input_;
};

}  // namespace

Atmosphere read_atmosphere(const std::filesystem::path& file) {
  constexpr const char* allowed = "a profile of the air as text columns or netCDF";
  const auto checked = [&](Atmosphere atmosphere) {
    order_from_below(atmosphere);
    check_atmosphere(atmosphere, file.string());
    return atmosphere;
  };
  if (begins_as_netcdf(file, allowed)) {
    return after_sandbox(file, {.library = "netCDF"}, [&] { return checked(NetcdfProfiles(file).read()); });
  }
  constexpr std::uintmax_t most_text_bytes = 100000000;
  check_input(file, allowed, most_text_bytes);
  return checked(AfglReader(file).read());
}

}  // namespace cloudbow
