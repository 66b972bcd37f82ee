// Clouds as OpenVDB: all grids of a file, each as a cloud if it is one.
#include "cloudbow/medium/vdb_file.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::write_mutant({data, size}, "cloud.vdb");
  cloudbow::VdbReadOptions options;
  options.memory_limit_bytes = 100'000'000;
  fuzz::expect_clean([&] { cloudbow::read_cloud_vdb(path, options); });
  return 0;
}
