// Functions that the tests of phase functions share.
#pragma once

#include <gmock/gmock.h>

#include <cmath>
#include <functional>
#include <string>
#include <vector>

#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/phase_function.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {

/// (1/2) int P P_l dmu
inline double integrated_moment(const PhaseFunction& phase, int l, int nodes = 400) {
  const GaussLegendre rule = make_gauss_legendre(nodes);
  double sum = 0;
  for (int i = 0; i < nodes; ++i) sum += rule.weight[i] / 2 * phase(rule.node[i]) * std::legendre(l, rule.node[i]);
  return sum;
}

inline void expect_rejected(const std::function<void()>& make, const std::string& found, const std::string& allowed) {
  try {
    make();
    ADD_FAILURE() << "accepted " << found;
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), testing::AllOf(testing::HasSubstr(found), testing::HasSubstr(allowed)));
  }
}

}  // namespace cloudbow
