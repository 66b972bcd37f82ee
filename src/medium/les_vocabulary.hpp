// How output of large-eddy simulations names its variables, axes and units.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

namespace cloudbow {

/// Names that a variable goes by, the likeliest first.
using Names = std::vector<std::string>;

extern const Names kWater, kAirDensity, kPressure, kTemperature, kDropletNumber, kEffectiveRadius;

/// A unit as files spell it and what one of it is. Spelling is compared without blanks, '^', '*' and '_'.
struct Unit {
  const char* spelling;
  double factor;
};

struct UnitTable {
  const char* allowed;
  std::vector<Unit> units;
};

extern const UnitTable kRatio;             ///< kg/kg
extern const UnitTable kContent;           ///< g/m3
extern const UnitTable kLength;            ///< m
extern const UnitTable kDensity;           ///< kg/m3
extern const UnitTable kPressureUnits;     ///< Pa
extern const UnitTable kTemperatureUnits;  ///< K
extern const UnitTable kNumberPerVolume;   ///< 1/m3
extern const UnitTable kNumberPerMass;     ///< 1/kg
extern const UnitTable kRadius;            ///< um

/// Nothing for a spelling that the table does not know.
std::optional<double> factor_of(const UnitTable& table, const std::string& spelled);

/// A file that says "1" or nothing leaves the unit to be guessed.
bool is_unit_given(const std::string& units);

std::string lower_case(std::string text);

constexpr std::array<const char*, 4> kAxisNames{"x", "y", "z", "time"};

/// 0 x, 1 y, 2 z, 3 time; -1: not to be told from the name.
int axis_of_name(const std::string& name);

}  // namespace cloudbow
