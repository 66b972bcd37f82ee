// Profiles of the air: AFGL's text columns, netCDF classic and netCDF-4. Every profile is interpolated at some heights.
#include "cloudbow/medium/atmosphere.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::write_mutant({data, size}, "air");
  fuzz::expect_clean([&] {
    const cloudbow::Atmosphere air = cloudbow::read_atmosphere(file);
    for (const double height : {-100., 0., 1500., 1e5}) {
      air.temperature_at(height);
      air.density_at(height);
    }
  });
  return 0;
}
