// Slopes within cells of a converged source along the directions of a final gather, relative to it.
#pragma once

#include <cmath>
#include <vector>

#include "transport/gather/gather.hpp"

namespace cloudbow {

/// The cells as light along `travel` meets them. The source has the slopes of the light (docs/theory.md, Eq. 20g). If
/// the scene has none, it has those of differences between neighbours; none if it is constant in each cell.
/// @param own holds the slopes.
template <class Real>
CellView<Real> cells_along(const GatherScene<Real>& scene, const Direction& travel, LinearSource<Real>& own) {
  if (!scene.linear_source) return {scene.extinction(), {}};
  const std::size_t n = scene.cells.size();
  own.resize(n);
  const SourceAlong<Real> source = scene.source->along(travel);
  source.fill(0, n, own.value.data());
  if (scene.slopes != nullptr) {
    own.from_beam.resize(n);
    SourceAlong<Real>{false, {}, source.first_order}.fill(0, n, own.from_beam.data());
    mix_slopes(scene.slopes->of_octant[octant_of(travel)], *scene.beam_slope, scene.source->emission, own.value.data(),
               own.from_beam.data(), n, own.gradient);
  } else {
    // A truncated phase function can be negative in some directions; gradients relative to it are the same.
    for (Real& value : own.value) value = std::abs(value);
    own.make_gradient(scene.cells, scene.source->emission);
  }
  CellView<Real> view = own.view(scene.cells);
  view.extinction = scene.extinction();
  return view;
}

}  // namespace cloudbow
