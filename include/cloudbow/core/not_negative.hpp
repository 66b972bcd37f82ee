// Lower bounds that hide nothing.
#pragma once

namespace cloudbow {

/// The value, or 0 if it is less. What is not a number stays so, which std::max(0., value) would turn into 0.
template <class Real>
constexpr Real not_negative(Real value) {
  return value <= 0 ? Real(0) : value;
}

}  // namespace cloudbow
