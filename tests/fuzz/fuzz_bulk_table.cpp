// Tables of bulk optics in ecRad's layout, netCDF classic and netCDF-4.
#include "cloudbow/medium/bulk_table_file.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto file = fuzz::write_mutant({data, size}, "bulk.nc");
  fuzz::expect_clean([&] { cloudbow::read_bulk_table(file); });
  return 0;
}
