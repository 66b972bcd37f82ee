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
    EXPECT_EQ(field.profile != nullptr, at_levels) << field.name << ": fluxes alone have a profile";
    EXPECT_EQ(field.asked == nullptr, at_levels) << field.name << ": fluxes alone are always there";
  }
}

TEST(OutputFields, FieldsOfCellsAreCountedIfAskedFor) {
  OutputOptions options;
  EXPECT_EQ(cell_field_count(options), 1) << "absorbed power is the default";
  options.actinic = true;
  EXPECT_EQ(cell_field_count(options), 2);
  options.radiance_field = true;
  options.views.resize(1);
  options.cameras.resize(1);
  ask_for_fluxes_alone(options);
  EXPECT_EQ(cell_field_count(options), 0);
  EXPECT_FALSE(options.absorption || options.actinic || options.radiance_field);
  EXPECT_TRUE(options.views.empty() && options.cameras.empty());
}

}  // namespace
}  // namespace cloudbow
