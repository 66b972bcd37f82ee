// Names of variables, axes and units in output of large-eddy simulations.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/core/text_case.hpp"

namespace cloudbow {

/// Names of a variable, the likeliest first.
using Names = std::vector<std::string>;

/// A quantity by names of variables and, if none of them is in the file, by CF standard names.
struct Words {
  Names names;
  Names standard_names;
};

extern const Words water_names, extinction_names, air_density_names, pressure_names, temperature_names,
    potential_temperature_names, liquid_potential_temperature_names, exner_names, droplet_number_names,
    effective_radius_names, scattering_albedo_names;

/// Water of other kinds. Cloud ice is subtracted from a variable that holds water and ice together (condensate_names).
extern const Words ice_names, rain_names, snow_names, graupel_names, precipitation_names, hail_names, aggregates_names;
extern const Names condensate_names;
extern const Words ice_radius_names, rain_radius_names, snow_radius_names, graupel_radius_names;

/// Water of another kind than cloud liquid. Kinds without an option are reported and not imported.
struct Species {
  const char* what;
  const Words* names;
  const char* option = nullptr;  ///< the word of --species
  const char* grid = nullptr;    ///< name and quantity of its grid
  const char* radius_grid = nullptr;
  const Words* radius_names = nullptr;
};
extern const std::vector<Species> species_names;

/// Variables that hold heights of levels; heights_names at centres or, one more, at edges of cells.
extern const Names heights_names;

/// A unit as files spell it, and its size in the table's own unit. factor_of describes how spellings are compared.
struct Unit {
  const char* spelling;
  double factor;
};

struct UnitTable {
  const char* allowed;
  std::vector<Unit> units;
};

extern const UnitTable ratio_units;              ///< kg/kg
extern const UnitTable content_units;            ///< g/m3
extern const UnitTable extinction_units;         ///< 1/m
extern const UnitTable length_units;             ///< m
extern const UnitTable geopotential_units;       ///< m2/s2
extern const UnitTable angle_units;              ///< degree
extern const UnitTable exner_units;              ///< heat capacities c_p of the air
extern const UnitTable density_units;            ///< kg/m3
extern const UnitTable pressure_units;           ///< Pa
extern const UnitTable kelvin_units;             ///< K
extern const UnitTable celsius_units;            ///< K above 273.15 K
extern const UnitTable number_per_volume_units;  ///< 1/m3
extern const UnitTable number_per_mass_units;    ///< 1/kg
extern const UnitTable radius_units;             ///< um

/// Nothing for a spelling that is not in the table. Blanks, brackets and the signs ^ * _ . do not count, nor does the
/// case of letters, except the m of milli: "MG" and "Mb" may be mega and are not in it. A number before the unit ("1e-5
/// kg/kg") is part of the factor.
std::optional<double> factor_of(const UnitTable& table, const std::string& spelled);

/// In a file with "1" or no unit, the unit must be guessed.
bool is_unit_given(const std::string& units);

constexpr std::array<const char*, 4> axis_names{"x", "y", "z", "time"};

/// 0 x, 1 y, 2 z, 3 time; -1: the name does not determine it.
int axis_of_name(const std::string& name);

/// Longitude or latitude by its name.
bool axis_is_angle(const std::string& name);

}  // namespace cloudbow
