// Names and units of LES files. Truth: the factors of the units.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "les_test_tools.hpp"

namespace cloudbow {
namespace {

using namespace les_test;
using testing::HasSubstr;

TEST_F(LesImport, UnitsAreReadInAllSpellingsAndMegaIsNotMilli) {
  const auto read = [&](const std::string& units, double factor) {
    return with(
        [&](NetcdfBuilder& file) {
          add_water(file, "qc", units, factor);
          file.variable("rho", {"z"}, "KG/M^3", profile(density));
        },
        false);
  };
  for (const char* units : {"KG/KG", "Kg/Kg", "kg kg^{-1}", "kg kg**-1", "[kg/kg]", "kg kg\xe2\x81\xbb\xc2\xb9"})
    expect_truth(import_cloud(read(units, 1)));
  for (const char* units : {"1e-5kg/kg", "1.e-5 kg kg-1", "1E-2 g/kg"}) expect_truth(import_cloud(read(units, 1e5)));
  expect_truth(import_cloud(read("mg/kg", 1e6)));
  for (const char* units : {"MG/KG", "Mg/kg", "10-3 kg/kg", "kg", "K"})
    EXPECT_THAT(error_of(read(units, 1)), HasSubstr("unit not known")) << units;
}

}  // namespace
}  // namespace cloudbow
