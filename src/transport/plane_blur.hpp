// Gaussian blur of a field over the columns of a box.
#pragma once

#include <vector>

#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {

/// Spreads each value of `field` [columns] over its neighbours by a Gaussian of width `sigma_m`, cut at three sigma and
/// at half the box; what would fall out of an open side stays in the part of the kernel that is inside. The sum is
/// kept.
template <class Real>
void blur_plane(std::vector<Real>& field, const BoxGrid& box, double sigma_m);

}  // namespace cloudbow
