// Gaussian blur of a field over the columns of a box.
#pragma once

#include <vector>

#include "cloudbow/medium/optical_grid.hpp"

namespace cloudbow {

/// Spreads each value of `field` [columns] over its neighbours by a Gaussian of width `sigma_m`. It is cut at three
/// sigma and at half the box. From ten columns on, three moving means with the same variance replace it: a quadratic
/// spline, at most as wide as the box. Boxes of at most 40 columns keep the Gaussian. At an open side both are
/// reflected, which conserves the sum and leaves a uniform field unchanged.
template <class Real>
void blur_plane(std::vector<Real>& field, const BoxGrid& box, double sigma_m);

/// Widths of blurs, rounded to powers of a factor: light with nearly the same width is blurred in one step.
class BlurWidths {
 public:
  /// @param growth factor between one width and the next, above 1.
  BlurWidths(const BoxGrid& box, double growth);

  int count() const { return widest_ + 1; }
  /// From 1 for the narrowest blur on; 0: so narrow that it changes nothing. A blur as wide as the box is the widest.
  int number(double width_m) const;
  double width_m(int number) const;  ///< [m] 0 for number 0

 private:
  double least_m_, growth_;
  int widest_ = 0;
};

}  // namespace cloudbow
