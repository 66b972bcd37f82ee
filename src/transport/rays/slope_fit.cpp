#include "transport/rays/slope_fit.hpp"

#include <Eigen/LU>

namespace cloudbow {

Eigen::Matrix3d spread_of_places(const PathPattern& pattern, int step) {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  for (std::uint32_t s = pattern.level_begin[step]; s < pattern.level_begin[step + 1]; ++s) {
    const Segment& segment = pattern.segments[s];
    const Eigen::Vector3d from(segment.from.data());
    const Eigen::Vector3d to(segment.to.data());
    const Eigen::Vector3d both = from + to;
    spread += segment.fraction / 6 * (from * from.transpose() + to * to.transpose() + both * both.transpose());
  }
  return spread;
}

Eigen::Matrix3d regular_inverse(const Eigen::Matrix3d& spread, double scale) {
  constexpr double least = 2e-3;
  const double e = least * scale;
  return (spread * spread + e * e * Eigen::Matrix3d::Identity()).inverse() * spread;
}

}  // namespace cloudbow
