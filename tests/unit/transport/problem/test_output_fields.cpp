// The list of fields. Truth: what is written down here of each, and that no field is forgotten by what goes by the
// list.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include "cloudbow/transport/output_fields.hpp"

namespace cloudbow {
namespace {

TEST(OutputFields, NamesAndArraysAreDistinct) {
  Solution solution;
  std::set<std::string> names;
  std::set<const void*> arrays;
  for (const OutputField& field : output_fields()) {
    EXPECT_TRUE(names.insert(field.name).second) << field.name;
    EXPECT_TRUE(arrays.insert(&(solution.*field.values)).second) << field.name;
    EXPECT_FALSE(std::string(field.units).empty()) << field.name;
    EXPECT_FALSE(std::string(field.long_name).empty()) << field.name;
    const bool at_levels = field.grid == OutputField::Grid::levels;
    const bool is_flux = at_levels && field.key != nullptr;
    EXPECT_EQ(field.profile != nullptr, is_flux) << field.name << ": fluxes alone have a profile";
    EXPECT_EQ(field.asked == nullptr, at_levels) << field.name << ": no flag asks for a field at levels";
  }
}

TEST(OutputFields, NamesAndUnitsOfScenesThatEmit) {
  Solution solution;
  const auto names = [&](std::size_t n, SpectralUnit unit) { return names_of(output_fields()[n], solution, unit); };
  EXPECT_EQ(names(3, SpectralUnit::band).name, "absorbed_power");
  EXPECT_STREQ(names(0, SpectralUnit::band).standard_name, "upwelling_shortwave_flux_in_air");
  solution.emits = true;
  EXPECT_EQ(names(3, SpectralUnit::band).name, "net_absorbed_power");
  EXPECT_EQ(names(3, SpectralUnit::band).units, "W m-3");
  EXPECT_EQ(names(3, SpectralUnit::wavelength).units, "W m-3 um-1");
  EXPECT_EQ(names(0, SpectralUnit::wavelength).units, "W m-2 um-1");
  EXPECT_STREQ(names(0, SpectralUnit::band).standard_name, "upwelling_longwave_flux_in_air");
  EXPECT_STREQ(names(1, SpectralUnit::band).standard_name, "downwelling_longwave_flux_in_air");
  EXPECT_STREQ(names(0, SpectralUnit::wavelength).standard_name, "upwelling_radiative_flux_per_unit_wavelength_in_air");
  solution.sun = Sun{{0, 0, -1}, 1};
  for (std::size_t n = 0; n < output_fields().size(); ++n)
    EXPECT_EQ(names(n, SpectralUnit::band).standard_name, nullptr) << "neither shortwave nor longwave";
}

TEST(OutputFields, FieldsOfCellsAreCountedIfAskedFor) {
  OutputOptions options;
  EXPECT_EQ(cell_field_count(options), 1) << "absorbed power is the default";
  options.actinic = true;
  EXPECT_EQ(cell_field_count(options), 2);
  options.radiance_field = true;
  options.views.resize(1);
  options.cameras.resize(1);
  options.circumsolar_half_angle = .05;
  ask_for_fluxes_alone(options);
  EXPECT_EQ(cell_field_count(options), 0);
  EXPECT_FALSE(options.absorption || options.actinic || options.radiance_field);
  EXPECT_TRUE(options.views.empty() && options.cameras.empty());
  EXPECT_EQ(options.circumsolar_half_angle, 0);
}

}  // namespace
}  // namespace cloudbow
