#include "cloudbow/results/heating_rate.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace cloudbow {

double mean_density(const Atmosphere& air, double bottom_m, double top_m) {
  // Simpson's rule on parts of a tenth of the scale height: exact to 1e-6 of the density.
  constexpr double part_m = 800;
  const int parts = std::max(1, static_cast<int>(std::ceil((top_m - bottom_m) / part_m)));
  const double step = (top_m - bottom_m) / parts;
  double sum = 0;
  for (int n = 0; n < parts; ++n) {
    const double low = bottom_m + n * step;
    sum += (air.density_at(low) + 4 * air.density_at(low + step / 2) + air.density_at(low + step)) / 6;
  }
  return sum / parts;
}

HeatingRate heating_rate(const Solution& solution, const Atmosphere& air) {
  const BoxGrid& box = solution.box;
  const std::size_t columns = box.columns();
  assert(solution.absorbed_power.size() == columns * static_cast<std::size_t>(box.nz()));
  HeatingRate rate;
  rate.cell.reserve(solution.absorbed_power.size());
  for (int k = 0; k < box.nz(); ++k) {
    const double capacity = specific_heat * mean_density(air, box.z_edge_m[k], box.z_edge_m[k + 1]);  // J m-3 K-1
    double sum = 0;
    for (std::size_t c = 0; c < columns; ++c) {
      const double of_cell = static_cast<double>(solution.absorbed_power[k * columns + c]) / capacity;
      rate.cell.push_back(static_cast<float>(of_cell));
      sum += of_cell;
    }
    rate.profile.push_back(sum / static_cast<double>(columns));
  }
  return rate;
}

}  // namespace cloudbow
