// Text files of phase functions: Legendre moments, tables over the angle, sets.
#include "cloudbow/io/phase_function_file.hpp"
#include "cloudbow/io/phase_set_file.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::write_mutant({data, size}, "phase.txt");
  fuzz::expect_clean([&] { cloudbow::read_legendre_file(path); });
  fuzz::expect_clean([&] { cloudbow::read_phase_table_file(path); });
  fuzz::expect_clean([&] { cloudbow::read_phase_set_file(path, cloudbow::MomentFactor::automatic); });
  return 0;
}
