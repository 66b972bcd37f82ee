#include "cloudbow/optics/forward_peak.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>

namespace cloudbow {
namespace {

constexpr int intervals = 2000;
constexpr double least_phase = 10;  // angle times order at which a peak ends at the earliest: some three lobes
constexpr double wide_share = .1;
constexpr double wide_asymmetry = .85;

// Angles that are densest near 0, because peaks are there.
double angle_at(double step) {
  const double x = step / intervals;
  return std::numbers::pi * x * x * x;
}

// 1/2 int dcos of one interval.
double weight_of(int interval) {
  const double low = angle_at(interval);
  const double high = angle_at(interval + 1);
  return std::sin(.5 * (high - low)) * std::sin(.5 * (high + low));
}

double middle_of(int interval) { return std::cos(angle_at(interval + .5)); }

}  // namespace

ForwardPeak::ForwardPeak(const DeltaM& fine, const DeltaM& coarse)
    : fine_(fine), coarse_(coarse), share_(std::max(0., coarse.forward_fraction - fine.forward_fraction)) {
  if (share_ == 0) return;
  const double order = static_cast<double>(coarse_.truncated.moments().size());
  cos_end_ = -1;
  for (int i = 1; i < intervals; ++i) {
    if (angle_at(i) * order < least_phase || beyond(middle_of(i - 1)) * beyond(middle_of(i)) > 0) continue;
    cos_end_ = std::cos(angle_at(i));
    break;
  }
}

double ForwardPeak::beyond(double cos_angle) const {
  return (1 - fine_.forward_fraction) * fine_.truncated(cos_angle) -
         (1 - coarse_.forward_fraction) * coarse_.truncated(cos_angle);
}

double ForwardPeak::peak(double cos_angle) const { return share_ > 0 && cos_angle > cos_end_ ? beyond(cos_angle) : 0.; }

double ForwardPeak::rest(double cos_angle) const {
  const DeltaM& seen = share_ > 0 && cos_angle <= cos_end_ ? fine_ : coarse_;
  return (1 - seen.forward_fraction) * seen.truncated(cos_angle);
}

std::vector<PeakAngle> peak_angles(std::span<const ForwardPeak> peaks, std::span<const double> weight, int count) {
  const auto sum_at = [&](double cos_angle) {
    constexpr double g = wide_asymmetry;
    const double wide = wide_share * (1 - g * g) / std::pow(1 + g * g - 2 * g * cos_angle, 1.5);
    double peak = 0;
    double share = 0;
    for (std::size_t p = 0; p < peaks.size(); ++p) {
      if (weight[p] == 0) continue;
      peak += weight[p] * peaks[p].peak(cos_angle);
      share += weight[p] * peaks[p].share();
    }
    return std::abs(peak) + wide * share;
  };
  std::vector<double> within(intervals + 1, 0.);
  for (int i = 0; i < intervals; ++i) within[i + 1] = within[i] + weight_of(i) * sum_at(middle_of(i));
  const double all = within.back();
  assert(all > 0);
  std::vector<PeakAngle> angles;
  int interval = 0;
  for (int n = 0; n < count; ++n) {
    const double wanted = (n + .5) / count * all;
    while (within[interval + 1] < wanted) ++interval;
    const double low = std::cos(angle_at(interval));
    const double high = std::cos(angle_at(interval + 1));
    const double inside = (wanted - within[interval]) / (within[interval + 1] - within[interval]);
    const double cos_angle = low + inside * (high - low);
    angles.push_back({cos_angle, sum_at(cos_angle) / (4 * std::numbers::pi * all)});
  }
  return angles;
}

}  // namespace cloudbow
