// The checks by subject.
#pragma once

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "app/verify/verify.hpp"

namespace cloudbow {

inline constexpr double pi = std::numbers::pi;

std::vector<PhysicalCheck> sphere_checks();
std::vector<PhysicalCheck> optics_checks();
std::vector<PhysicalCheck> column_checks();
std::vector<PhysicalCheck> energy_checks();
std::vector<PhysicalCheck> thermal_checks();
std::vector<PhysicalCheck> direction_checks();
std::vector<PhysicalCheck> field_checks();

/// The largest deviation met. NaN is worse than any number.
class Worst {
 public:
  void meet(double deviation) {
    value_ = std::isnan(deviation) ? std::numeric_limits<double>::infinity() : std::max(value_, std::abs(deviation));
  }
  void meet(double found, double wanted) { meet(found - wanted); }
  double value() const { return value_; }

 private:
  double value_ = 0;
};

}  // namespace cloudbow
