// A lower bound of 0 that keeps NaN.
#pragma once

namespace cloudbow {

/// The value, or 0 if it is less. NaN stays NaN; std::max(0., value) would turn it into 0.
template <class Real>
constexpr Real not_negative(Real value) {
  return value <= 0 ? Real(0) : value;
}

}  // namespace cloudbow
