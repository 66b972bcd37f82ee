// How long idle threads of the program spin before they sleep. By default those of GCC's runtime spin for milliseconds.
// If other programs use the machine, spinning threads take the time of those that work: two threads on two busy cores
// took three times the CPU time (docs/speed.md, "Busy machines").
//
// The runtime reads its settings in its own constructor. The program is therefore linked with the static library
// (CMakeLists.txt beside this file), whose constructor comes after this one.
#include <cstdlib>

namespace {

[[gnu::constructor(101)]] void bound_the_spin_of_idle_threads() {
  constexpr int user_wins = 0;
  if (std::getenv("OMP_WAIT_POLICY") != nullptr) return;
  setenv("GOMP_SPINCOUNT", "1000", user_wins);  // GCC: some 10 us
  setenv("KMP_BLOCKTIME", "1", user_wins);      // Clang: ms
}

}  // namespace
