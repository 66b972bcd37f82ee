// Clouds as text, read as each of the forms in turn.
#include "cloudbow/medium/cloud_import.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  cloudbow::CloudImportOptions options;
  options.file = fuzz::write_mutant({data, size}, "cloud.txt");
  options.memory_limit_bytes = 100'000'000;
  for (const char* format : {"shdom", "optics-csv", "at3d", "mystic", "columns", "numpy"}) {
    options.format = format;
    fuzz::expect_clean([&] { cloudbow::import_cloud(options); });
    options.voxel_size_m = {50, 50, 50};
  }
  return 0;
}
