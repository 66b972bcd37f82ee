// Relative gradients of a converged source along the directions of a final gather.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <vector>

#include "transport/observers/gather.hpp"
#include "transport/observers/gather_classes.hpp"

namespace cloudbow {

/// Gradient of the source, relative to it: of the mean over directions of one quadrant if cells are varied, else of
/// each direction's own. None if the source is constant in each cell.
template <class Real>
class SourceGradients {
 public:
  explicit SourceGradients(const GatherScene<Real>& scene) : scene_(scene) {}

  /// For the directions of the next calls of along().
  void prepare(std::span<const GatherDirection> directions) {
    if (!scene_.linear_source || scene_.slopes != nullptr || !scene_.cells.heterogeneous) return;
    const DirectionalSource<Real>& source = *scene_.source;
    for (int q = 0; q < quadrants; ++q) {
      std::vector<double> of_point(source.points.size(), 0.);
      std::vector<double> of_beam(source.first_order.size(), 0.);
      for (const GatherDirection& d : directions) {
        if (quadrant(d.travel) != q) continue;
        if (source.at_points.rows > 0) {
          const Stencil stencil = source.points.stencil(d.travel);
          for (int k = 0; k < 3; ++k) of_point[stencil.index[k]] += power(d) * stencil.weight[k];
        }
        for (std::size_t b = 0; b < of_beam.size(); ++b)
          of_beam[b] += power(d) * std::abs(source.first_order[b].phase(d.travel.dot(source.sun_travel)));
      }
      make_mean(of_point, of_beam);
      make_gradient(gradient_[q]);
    }
  }

  /// @param own holds the gradient if it is the direction's own.
  CellView<Real> along(const Direction& travel, LinearSource<Real>& own) const {
    const Cells<Real>& cells = scene_.cells;
    if (!scene_.linear_source) return {scene_.extinction(), {}};
    if (scene_.slopes != nullptr) return along_own_slopes(travel, own);
    if (cells.heterogeneous) {
      const Gradient& gradient = gradient_[quadrant(travel)];
      return {scene_.extinction(), gradient[0], gradient[1], gradient[2]};
    }
    own.resize(cells.size());
    scene_.source->query(travel, own.value.data());
    // A truncated phase function can be negative in some directions; gradients relative to it are the same.
    for (Real& value : own.value) value = std::abs(value);
    own.make_gradient(cells);
    CellView<Real> view = own.view(cells);
    view.extinction = scene_.extinction();
    return view;
  }

 private:
  CellView<Real> along_own_slopes(const Direction& travel, LinearSource<Real>& own) const {
    const std::size_t n = scene_.cells.size();
    const SourceAlong<Real> source = scene_.source->along(travel);
    own.resize(n);
    source.fill(0, n, own.value.data());
    std::vector<Real>& from_beam = own.from_beam;
    from_beam.resize(n);
    SourceAlong<Real>{false, {}, source.first_order}.fill(0, n, from_beam.data());
    mix_slopes(scene_.slopes->of_octant[octant_of(travel)], *scene_.beam_slope, own.value.data(), from_beam.data(), n,
               own.gradient);
    CellView<Real> view = own.view(scene_.cells);
    view.extinction = scene_.extinction();
    return view;
  }

  static constexpr int quadrants = 4;
  static constexpr std::size_t block_cells = 4096;    // a thread's share of loops over cells
  using Gradient = std::array<std::vector<Real>, 3>;  // [n + lane_padding] along x, y, z

  static int quadrant(const Direction& travel) { return (travel.x() > 0 ? 1 : 0) + (travel.y() > 0 ? 2 : 0); }

  void make_mean(const std::vector<double>& of_point, const std::vector<double>& of_beam) {
    const std::size_t n = scene_.cells.size();
    mean_.resize(n);
    // Nothing throws here.
#pragma omp parallel for schedule(static)
    for (std::size_t first = 0; first < n; first += block_cells) {
      const std::size_t count = std::min(block_cells, n - first);
      Real* __restrict const to = mean_.data() + first;
      std::fill_n(to, count, Real(0));
      const auto add = [&](double weight, const Real* __restrict from) {
        const Real scale = static_cast<Real>(weight);
        for (std::size_t c = 0; c < count; ++c) to[c] += scale * from[c];
      };
      std::array<Real, block_cells> room{};
      for (std::size_t m = 0; m < of_point.size(); ++m) {
        if (of_point[m] > 0)
          add(of_point[m], scene_.source->at_points.stored_row(static_cast<int>(m)).read(first, count, room.data()));
      }
      for (std::size_t b = 0; b < of_beam.size(); ++b)
        add(of_beam[b], scene_.source->first_order[b].intensity.data() + first);
    }
  }

  void make_gradient(Gradient& gradient) {
    const std::size_t n = scene_.cells.size();
    for (auto& axis : gradient) axis.resize(n + lane_padding);
      // Nothing throws here.
#pragma omp parallel for schedule(static)
    for (std::size_t first = 0; first < n; first += block_cells) {
      source_gradient(scene_.cells, first, std::min(block_cells, n - first), mean_.data(), gradient[0].data() + first,
                      gradient[1].data() + first, gradient[2].data() + first);
    }
  }

  const GatherScene<Real>& scene_;
  std::vector<Real> mean_;
  std::array<Gradient, quadrants> gradient_;
};

}  // namespace cloudbow
