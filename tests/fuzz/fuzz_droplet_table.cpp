// Tables of droplets: HDF5, netCDF and text.
#include "cloudbow/io/droplet_table_file.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::write_mutant({data, size}, "droplets.h5");
  fuzz::expect_clean([&] { cloudbow::read_droplet_table(path, 0.67); });
  return 0;
}
