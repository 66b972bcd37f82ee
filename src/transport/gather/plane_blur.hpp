// Gaussian blur of a field over the columns of a box.
#pragma once

#include <vector>

#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {

/// Spreads each value of `field` [columns] over its neighbours by a Gaussian of width `sigma_m`. It is cut at three
/// sigma and at half the box. At an open side the Gaussian is reflected, which conserves the sum and leaves a uniform
/// field unchanged.
template <class Real>
void blur_plane(std::vector<Real>& field, const BoxGrid& box, double sigma_m);

/// Narrower blurs change nothing.
double least_blur_m(const BoxGrid& box);

}  // namespace cloudbow
