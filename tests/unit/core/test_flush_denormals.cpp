// Truth: the smallest normal numbers of float and double, halved.
#include <gtest/gtest.h>
#include <omp.h>

#include <limits>

#include "cloudbow/core/flush_denormals.hpp"

namespace cloudbow {
namespace {

template <class Real>
int threads_that_halve_to_zero() {
  int zeros = 0;
#pragma omp parallel reduction(+ : zeros)
  {
    volatile Real number = std::numeric_limits<Real>::min();
    number = number / 2;
    zeros += number == 0 ? 1 : 0;
  }
  return zeros;
}

TEST(FlushDenormals, ActsInAllThreadsAndEndsWithItsScope) {
#ifndef __SSE2__
  GTEST_SKIP() << "no effect on this processor";
#endif
  const int threads = omp_get_max_threads();
  EXPECT_EQ(threads_that_halve_to_zero<float>(), 0);
  {
    const FlushDenormals flush;
    EXPECT_EQ(threads_that_halve_to_zero<float>(), threads);
    EXPECT_EQ(threads_that_halve_to_zero<double>(), threads);
    {
      const FlushDenormals again;
      EXPECT_EQ(threads_that_halve_to_zero<float>(), threads);
    }
    EXPECT_EQ(threads_that_halve_to_zero<float>(), threads);
  }
  EXPECT_EQ(threads_that_halve_to_zero<float>(), 0);
  EXPECT_EQ(threads_that_halve_to_zero<double>(), 0);
}

}  // namespace
}  // namespace cloudbow
