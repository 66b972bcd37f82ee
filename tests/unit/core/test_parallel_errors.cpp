#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "cloudbow/core/parallel_errors.hpp"

namespace cloudbow {
namespace {

TEST(ParallelErrors, OneOfTheExceptionsComesOutWithItsOwnType) {
  ParallelErrors errors;
#pragma omp parallel for num_threads(4)
  for (int n = 0; n < 100; ++n) {
    errors.run([&] {
      if (n % 10 == 3) throw std::out_of_range("number " + std::to_string(n));
    });
  }
  try {
    errors.rethrow();
    FAIL() << "nothing was thrown";
  } catch (const std::out_of_range& error) {
    EXPECT_EQ(std::string(error.what()).substr(0, 7), "number ");
  }
}

TEST(ParallelErrors, AfterAnErrorTheRestIsSkippedAndBarriersAreMet) {
  ParallelErrors errors;
  int done = 0;
#pragma omp parallel num_threads(4)
  {
#pragma omp single
    errors.run([] { throw std::bad_alloc(); });
    for (int round = 0; round < 3; ++round) {
#pragma omp for
      for (int n = 0; n < 100; ++n) {
        errors.run([&] {
#pragma omp atomic
          ++done;
        });
      }
    }
  }
  EXPECT_EQ(done, 0);
  EXPECT_THROW(errors.rethrow(), std::bad_alloc);
}

TEST(ParallelErrors, WithoutAnErrorAllIsDone) {
  ParallelErrors errors;
  std::vector<int> done(1000, 0);
#pragma omp parallel for num_threads(4)
  for (std::size_t n = 0; n < done.size(); ++n) errors.run([&] { ++done[n]; });
  EXPECT_NO_THROW(errors.rethrow());
  EXPECT_EQ(done, std::vector<int>(1000, 1));
}

}  // namespace
}  // namespace cloudbow
