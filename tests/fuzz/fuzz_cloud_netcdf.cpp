// Clouds of large-eddy simulations, netCDF classic and netCDF-4.
#include "cloudbow/medium/cloud_import.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cloudbow::CloudImportOptions options;
  options.file = fuzz::write_mutant({data, size}, "les.nc");
  options.format = "les";
  options.memory_limit_bytes = 100'000'000;
  fuzz::expect_clean([&] { cloudbow::import_cloud(options); });
  options.species = {"all"};
  options.temperature_grid = true;
  options.may_be_clear = true;
  fuzz::expect_clean([&] { cloudbow::import_cloud(options); });
  // As the profile of another cloud, which is none here: the file itself.
  options.profile = options.file;
  fuzz::expect_clean([&] { cloudbow::import_cloud(options); });
  return 0;
}
