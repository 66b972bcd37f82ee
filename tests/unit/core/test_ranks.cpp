// Messages between ranks. Truth: what was sent. That MPI does the same is seen by tests/robustness/ranks.py.
#include <gtest/gtest.h>

#include <cstdlib>
#include <numeric>

#include "../thread_ranks.hpp"
#include "cloudbow/core/ranks.hpp"

namespace cloudbow {
namespace {

TEST(Ranks, BytesOfAnyNumberArrive) {
  ThreadRanks::run(2, [](Ranks& ranks) {
    for (const std::size_t size : {std::size_t{0}, std::size_t{1}, std::size_t{1000}}) {
      const std::vector<std::byte> bytes(size, std::byte{7});
      if (ranks.is_first()) {
        EXPECT_EQ(receive_bytes(ranks, 1), bytes);
      } else {
        send_bytes(ranks, 0, bytes);
      }
    }
  });
}

TEST(Ranks, RangesBecomeKnownToAll) {
  const std::vector<std::size_t> begin{0, 3, 3, 10};  // one of them is empty
  ThreadRanks::run(3, [&](Ranks& ranks) {
    const auto own = static_cast<std::size_t>(ranks.rank());
    std::vector<float> values(10, 0);
    for (std::size_t n = begin[own]; n < begin[own + 1]; ++n) values[n] = static_cast<float>(n + 1);
    gather_ranges(ranks, begin, values.data());
    std::vector<float> wanted(10);
    std::iota(wanted.begin(), wanted.end(), 1.F);
    EXPECT_EQ(values, wanted);
    EXPECT_EQ(ranks.bytes_sent(), 2 * (begin[own + 1] - begin[own]) * sizeof(float));
  });
}

/// Variables of a launcher's environment for one test.
class Environment {
 public:
  explicit Environment(const char* name, const char* value) : name_(name) { setenv(name, value, 1); }
  ~Environment() { unsetenv(name_); }
  Environment(const Environment&) = delete;
  Environment& operator=(const Environment&) = delete;

 private:
  const char* name_;
};

TEST(Ranks, AreThoseOfTheLauncher) {
  for (const char* name : {"OMPI_COMM_WORLD_SIZE", "PMI_SIZE", "PMIX_RANK", "SLURM_NTASKS"}) unsetenv(name);
  EXPECT_EQ(launched_processes(), 1);
  EXPECT_EQ(start_ranks(), nullptr);
  {
    const Environment open_mpi("OMPI_COMM_WORLD_SIZE", "4");
    EXPECT_EQ(launched_processes(), 4);
  }
  for (const char* no_number : {"", "1", "x", "4x", "-3"}) {
    const Environment open_mpi("OMPI_COMM_WORLD_SIZE", no_number);
    EXPECT_EQ(launched_processes(), 1) << no_number;
  }
  const Environment tasks("SLURM_NTASKS", "8");
  EXPECT_EQ(launched_processes(), 1) << "tasks without PMIx, each of which is alone";
  const Environment rank("PMIX_RANK", "0");
  EXPECT_EQ(launched_processes(), 8);
}

}  // namespace
}  // namespace cloudbow
