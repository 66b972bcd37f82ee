// Makes EXPECT_NEAR write to the report of the test (--gtest_output) how near it was. Of all comparisons of a test it
// writes the one closest to its tolerance, as the properties "deviation" and "tolerance". tests/validation/report.py
// makes its table of unit tests from them. To be included after gtest.h.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

namespace cloudbow {

inline std::string three_digits(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.3g", value);
  return text;
}

inline testing::AssertionResult near_and_told(const char* found_text, const char* expected_text,
                                              const char* tolerance_text, double found, double expected,
                                              double tolerance) {
  static const testing::TestInfo* test = nullptr;
  static double worst = 0;  // share of the tolerance
  if (const auto* const current = testing::UnitTest::GetInstance()->current_test_info(); current != test) {
    test = current;
    worst = -1;
  }
  const double deviation = std::abs(found - expected), share = tolerance > 0 ? deviation / tolerance : deviation;
  if (share > worst) {
    worst = share;
    testing::Test::RecordProperty("deviation", three_digits(deviation));
    testing::Test::RecordProperty("tolerance", three_digits(tolerance));
  }
  return testing::internal::DoubleNearPredFormat(found_text, expected_text, tolerance_text, found, expected, tolerance);
}

}  // namespace cloudbow

#undef EXPECT_NEAR
#define EXPECT_NEAR(found, expected, tolerance) \
  EXPECT_PRED_FORMAT3(::cloudbow::near_and_told, found, expected, tolerance)
