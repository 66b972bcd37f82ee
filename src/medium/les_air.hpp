// Density of the air of an LES file: as it is in the file, from pressure and temperature, or as the user gives it. And
// its temperature.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "air_profile.hpp"
#include "les_grid.hpp"

namespace cloudbow {

/// 15 C and 1013.25 hPa at the ground, -6.5 K/km up to 11 km, constant to 20 km, 1 K/km to 32 km (U.S. Standard
/// Atmosphere 1976).
/// @return kg/m3 at a height of up to 32 km.
double standard_air_density(double height_m);

class LesAir {
 public:
  /// Cells without water may lack air. @param profile for what the file lacks, or null
  LesAir(LesFile& file, const LesGrid& grid, const std::vector<float>& water, const AirProfile* profile)
      : file_(file), grid_(grid), water_(water), profile_(profile) {}

  /// The water is liquid, so many kg per kg of air: its heat of condensation is added to a liquid water potential
  /// temperature. Without it such a temperature gives no density.
  void set_liquid_ratio(double kg_per_kg) { liquid_ratio_ = kg_per_kg; }
  /// Cells are clear if no species has water there: those of another one count too.
  void add_water(const std::vector<float>& water);

  /// kg/m3 in all cells.
  const std::vector<float>& density();
  /// K in all cells. @param liquid_g_m3 in all cells, or null: its heat of condensation is added to a liquid water
  /// potential temperature. @throws InputError naming the variables that are missing
  std::vector<float> temperature(const std::vector<float>* liquid_g_m3);

 private:
  struct Pressure {
    std::string name;
    std::vector<double> pa;
  };

  bool set_density_as_given();
  void set_density_of(const NetcdfVariable& variable);
  void set_density_by_gas_law();
  [[noreturn]] void fail_without_density() const;
  const NetcdfVariable* base_of(const NetcdfVariable& pressure) const;
  /// Null if the file has none. It may be a perturbation, with a base or without.
  const NetcdfVariable* pressure_variable() const;
  Pressure pressure(const NetcdfVariable& variable);
  /// From the Exner function, p = 1e5 Pa Pi^(7/2). Null if the file has none.
  const NetcdfVariable* exner_variable() const;
  Pressure pressure_by_exner(const NetcdfVariable& variable);
  /// Of the file, else of the profile, else nothing.
  std::optional<Pressure> known_pressure();
  bool is_liquid_potential(const NetcdfVariable& variable) const;
  bool has_water(std::size_t cell) const { return water_[cell] != 0 || (!other_water_.empty() && other_water_[cell]); }
  const NetcdfVariable* temperature_variable() const;
  /// Temperature [K] from a variable that holds itself, the potential one, or the potential one's difference from 300
  /// K. @param pressure null: none is known.
  void add_heat_of_ratio(const std::string& name);
  void add_heat_of_condensation(const std::string& name, const std::vector<float>& liquid_g_m3,
                                std::vector<float>& kelvin);
  std::vector<float> kelvin_of(const NetcdfVariable& variable, const Pressure* pressure);
  /// Mean density of the first column by the gas law over that which the weight of the air gives; nothing if these
  /// cannot be compared.
  std::optional<double> balance(const Pressure& pressure, const std::vector<float>& kelvin) const;
  std::string sign_of_potential(const Pressure& pressure, const std::vector<float>& kelvin,
                                const std::vector<float>& converted) const;

  template <class T>
  void check_levels_ascend(const std::string& name, const std::vector<T>& value) const;
  template <class T>
  void check_range(const std::string& name, const std::vector<T>& value, double low, double high, const char* unit,
                   const char* hint) const;
  std::size_t columns() const { return grid_.length(0) * grid_.length(1); }
  /// Of a level in the first column.
  double height_m(std::size_t level) const { return grid_.height_m(level, 0); }
  /// Values in all cells from a function of height. Unless they are wanted everywhere, cells without water get 1.
  template <class Function>
  std::vector<float> by_height(Function function, bool everywhere) const;

  LesFile& file_;
  const LesGrid& grid_;
  const std::vector<float>& water_;
  const AirProfile* profile_;
  double liquid_ratio_ = 0;
  std::vector<bool> other_water_;
  std::vector<float> density_;
  std::vector<float> kelvin_;
};

}  // namespace cloudbow
