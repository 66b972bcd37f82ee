// Checkpoints: all of their values in the child process, then the arrays of make_seeds.py as a run loads them.
#include <vector>

#include "cloudbow/io/checkpoint_file.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

namespace {

template <class Number>
void load(const cloudbow::CheckpointInput& input, const char* name, std::size_t rows, std::size_t length) {
  std::vector<std::vector<Number>> value(rows, std::vector<Number>(length));
  cloudbow::StateArray array{name, sizeof(Number), length, {}};
  for (auto& row : value) array.rows.push_back(row.data());
  input.load(array);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::write_mutant({data, size}, "state.h5");
  fuzz::expect_clean([&] {
    const cloudbow::CheckpointInput input(path);
    load<double>(input, "numbers", 1, 8);
    load<float>(input, "radiance", 6, 20);
    load<std::uint16_t>(input, "halves", 2, 20);
  });
  return 0;
}
