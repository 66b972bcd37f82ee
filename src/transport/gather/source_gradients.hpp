// The converged source along the directions of a final gather, and its slopes within cells, relative to it.
#pragma once

#include <array>
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
    mix_slopes(scene.slopes->of_octant[octant_of(travel)], *scene.beam_slope, scene.source->emission, 0, n,
               own.value.data(), own.from_beam.data(), own.gradient);
  } else {
    // A truncated phase function can be negative in some directions; gradients relative to it are the same.
    for (Real& value : own.value) value = std::abs(value);
    own.make_gradient(scene.cells, scene.source->emission);
  }
  CellView<Real> view = own.view(scene.cells);
  view.extinction = scene.extinction();
  return view;
}

/// The source along one direction, level by level: that of a level stays in the nearest cache while rays cross it.
template <class Real>
class SourceByLevel {
 public:
  /// The source of the scene's cells, with slopes as those of cells_along().
  void start(const GatherScene<Real>& scene, const Direction& travel) {
    scene_ = &scene;
    source_ = scene.source->along(travel);
    octant_ = octant_of(travel);
    mixes_ = scene.linear_source && scene.slopes != nullptr;
    if (mixes_) {
      from_beam_ = SourceAlong<Real>{false, {}, source_.first_order};
    } else {
      gradient_ = cells_along(scene, travel, all_).gradient;
    }
  }
  /// A source whose slopes [n] of all cells are at hand. @param gradient null: constant in each cell.
  void start(const GatherScene<Real>& scene, const SourceAlong<Real>& source,
             const std::array<const Real*, 3>& gradient) {
    scene_ = &scene;
    source_ = source;
    mixes_ = false;
    gradient_ = gradient;
  }

  /// Makes the cells [first, first + n) those of value() and of the view, both by cell - first.
  CellView<Real> level(std::size_t first, std::size_t n) {
    level_.value.resize(n + lane_padding);
    source_.fill(first, n, level_.value.data());
    const Real* const extinction = scene_->extinction() + first;
    if (!mixes_) {
      if (gradient_[0] == nullptr) return {extinction, {}};
      return {extinction, {gradient_[0] + first, gradient_[1] + first, gradient_[2] + first}};
    }
    level_.from_beam.resize(n);
    from_beam_.fill(first, n, level_.from_beam.data());
    mix_slopes(scene_->slopes->of_octant[octant_], *scene_->beam_slope, scene_->source->emission, first, n,
               level_.value.data(), level_.from_beam.data(), level_.gradient);
    return {extinction, {level_.gradient[0].data(), level_.gradient[1].data(), level_.gradient[2].data()}};
  }
  std::vector<Real>& value() { return level_.value; }

 private:
  const GatherScene<Real>* scene_ = nullptr;
  SourceAlong<Real> source_{}, from_beam_{};
  int octant_ = 0;
  bool mixes_ = false;
  std::array<const Real*, 3> gradient_{};
  LinearSource<Real> all_, level_;
};

}  // namespace cloudbow
