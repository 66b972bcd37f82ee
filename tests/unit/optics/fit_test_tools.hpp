// Functions that the tests of fits share.
#pragma once

#include <span>
#include <vector>

#include "cloudbow/optics/phase_fit.hpp"

namespace cloudbow {

inline constexpr ResidualScale scales[] = {ResidualScale::absolute, ResidualScale::relative,
                                           ResidualScale::square_root};

inline Eigen::VectorXd values_of(const PhaseFunction& phase, std::span<const Direction> directions,
                                 const Direction& travel) {
  Eigen::VectorXd value(directions.size());
  for (std::size_t i = 0; i < directions.size(); ++i) value[i] = phase(directions[i].dot(travel));
  return value;
}

}  // namespace cloudbow
