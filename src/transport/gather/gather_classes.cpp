#include "transport/gather/gather_classes.hpp"

#include <algorithm>

namespace cloudbow {
namespace {

constexpr double class_growth = 1.4;  // directions of one class differ in spread by at most this factor
constexpr int most_classes = 16;

double fraction(double x) { return x - std::floor(x); }

// Distance over which the beam of one direction spreads, per unit height. Its own set alone gives the spacing: the
// density of both sets together would smooth rays too little (columns up, sun at 84 degrees: 1 in place of .7 %).
double beam_spread(const GatherDirection& direction) {
  const double mu2 = direction.travel.z() * direction.travel.z();
  return std::sqrt(.5 * direction.spacing * (1 / (mu2 * mu2) + 1 / mu2));
}

}  // namespace

std::vector<SpreadClass> spread_classes(std::vector<GatherDirection>& directions) {
  double least = beam_spread(directions.front());
  for (const auto& d : directions) least = std::min(least, beam_spread(d));
  const auto class_of = [&](const GatherDirection& d) {
    return std::min(most_classes - 1,
                    static_cast<int>(std::log(beam_spread(d) / least * (1 + 1e-12)) / std::log(class_growth)));
  };
  std::stable_sort(directions.begin(), directions.end(),
                   [&](const auto& a, const auto& b) { return class_of(a) < class_of(b); });
  std::vector<SpreadClass> classes;
  for (std::size_t first = 0; first < directions.size();) {
    std::size_t last = first;
    double spread_sum = 0;
    double weight_sum = 0;
    for (; last < directions.size() && class_of(directions[last]) == class_of(directions[first]); ++last) {
      const double spread = beam_spread(directions[last]);
      spread_sum += power(directions[last]) * spread * spread;
      weight_sum += power(directions[last]);
    }
    classes.push_back({first, last, std::sqrt(spread_sum / weight_sum)});
    first = last;
  }
  return classes;
}

std::array<std::vector<std::size_t>, quadrants> by_quadrant(std::span<const GatherDirection> directions,
                                                            std::size_t first, std::size_t last) {
  std::array<std::vector<std::size_t>, quadrants> of_quadrant;
  for (std::size_t q = first; q < last; ++q)
    of_quadrant[static_cast<std::size_t>(octant_of(directions[q].travel) % quadrants)].push_back(q);
  return of_quadrant;
}

LaunchPlace launch_place(std::size_t direction, bool filling) {
  const double q = static_cast<double>(direction);
  if (!filling) return {.5, .5};
  return {fraction(.5 + .7548776662466927 * q), fraction(.5 + .5698402909980532 * q)};
}

}  // namespace cloudbow
