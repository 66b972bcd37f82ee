// Gas models: ecCKD definition files, netCDF classic and netCDF-4.
#include "cloudbow/medium/gas_model.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::write_mutant({data, size}, "model.nc");
  fuzz::expect_clean([&] { cloudbow::read_gas_model(file); });
  return 0;
}
