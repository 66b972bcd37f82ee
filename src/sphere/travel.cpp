#include "cloudbow/sphere/travel.hpp"

#include <cmath>
#include <numbers>

namespace cloudbow {

Direction travel_from(double zenith_deg, double azimuth_deg) {
  const double zenith = zenith_deg * std::numbers::pi / 180;
  const double azimuth = azimuth_deg * std::numbers::pi / 180;
  return {-std::sin(zenith) * std::cos(azimuth), -std::sin(zenith) * std::sin(azimuth), -std::cos(zenith)};
}

}  // namespace cloudbow
