// How output of large-eddy simulations names its variables, axes and units.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "cloudbow/core/text_case.hpp"

namespace cloudbow {

/// Names that a variable goes by, the likeliest first.
using Names = std::vector<std::string>;

/// A quantity by names of variables and, if none of them is in the file, by CF standard names.
struct Words {
  Names names;
  Names standard_names;
};

extern const Words kWater, kExtinction, kAirDensity, kPressure, kTemperature, kPotentialTemperature, kDropletNumber,
    kEffectiveRadius, kScatteringAlbedo;

/// Water of other kinds, which is reported and not imported.
struct Species {
  const char* what;
  Names names;
};
extern const std::vector<Species> kSpecies;
/// Cloud ice, which is subtracted from a variable that holds water and ice together (kCondensate).
extern const Names kIce, kCondensate;

/// Variables that hold heights of levels; kHeights at centres or, one more, at edges of cells.
extern const Names kHeights;

/// A unit as files spell it, and its size in the table's own unit. factor_of says how spellings are compared.
struct Unit {
  const char* spelling;
  double factor;
};

struct UnitTable {
  const char* allowed;
  std::vector<Unit> units;
};

extern const UnitTable kRatio;            ///< kg/kg
extern const UnitTable kContent;          ///< g/m3
extern const UnitTable kExtinctionUnits;  ///< 1/m
extern const UnitTable kLength;           ///< m
extern const UnitTable kDensity;          ///< kg/m3
extern const UnitTable kPressureUnits;    ///< Pa
extern const UnitTable kKelvin;           ///< K
extern const UnitTable kCelsius;          ///< K above 273.15 K
extern const UnitTable kNumberPerVolume;  ///< 1/m3
extern const UnitTable kNumberPerMass;    ///< 1/kg
extern const UnitTable kRadius;           ///< um

/// Nothing for a spelling that the table does not know. Blanks, brackets and the signs ^ * _ . do not count, nor does
/// the case of letters, except the m of milli: "MG" and "Mb" may be mega and are not known. A number before the unit
/// ("1e-5 kg/kg") is part of the factor.
std::optional<double> factor_of(const UnitTable& table, const std::string& spelled);

/// A file that says "1" or nothing leaves the unit to be guessed.
bool is_unit_given(const std::string& units);

constexpr std::array<const char*, 4> kAxisNames{"x", "y", "z", "time"};

/// 0 x, 1 y, 2 z, 3 time; -1: not to be told from the name.
int axis_of_name(const std::string& name);

/// Longitude or latitude by its name.
bool axis_is_angle(const std::string& name);

}  // namespace cloudbow
