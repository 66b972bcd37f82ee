#include "cloudbow/transport/directional_source.hpp"

#include <algorithm>

namespace cloudbow {

template <class Real>
void SourceAlong<Real>::fill(std::size_t first, std::size_t n, Real* __restrict source) const {
  if (points[0].at_cells == nullptr) {
    std::fill_n(source, n, Real(0));
    for (const Term& term : first_order) {
      const Real* __restrict const from = term.at_cells + first;
      for (std::size_t i = 0; i < n; ++i) source[i] += term.weight * from[i];
    }
    return;
  }
  const Real* __restrict const a = points[0].at_cells + first;
  const Real* __restrict const b = points[1].at_cells + first;
  const Real* __restrict const c = points[2].at_cells + first;
  const Real wa = points[0].weight;
  const Real wb = points[1].weight;
  const Real wc = points[2].weight;
  if (first_order.empty()) {
    for (std::size_t i = 0; i < n; ++i) source[i] = wa * a[i] + wb * b[i] + wc * c[i];
    return;
  }
  const Real wd = first_order[0].weight;
  const Real* __restrict const d = first_order[0].at_cells + first;
  for (std::size_t i = 0; i < n; ++i) source[i] = wa * a[i] + wb * b[i] + wc * c[i] + wd * d[i];
  for (std::size_t t = 1; t < first_order.size(); ++t) {
    const Real we = first_order[t].weight;
    const Real* __restrict const e = first_order[t].at_cells + first;
    for (std::size_t i = 0; i < n; ++i) source[i] += we * e[i];
  }
}

template <class Real>
SourceAlong<Real> DirectionalSource<Real>::along(const Direction& direction, double scale) const {
  SourceAlong<Real> source{};
  if (at_points.rows > 0) {
    const Stencil stencil = points.stencil(direction);
    for (std::size_t k = 0; k < 3; ++k)
      source.points[k] = {static_cast<Real>(scale * stencil.weight[k]), at_points.row(stencil.index[k])};
  }
  for (const auto& beam : first_order)
    source.first_order.push_back(
        {static_cast<Real>(scale * beam.phase(direction.dot(sun_travel))), beam.intensity.data()});
  return source;
}

template <class Real>
void DirectionalSource<Real>::query(const Direction& direction, Real* source) const {
  along(direction).fill(0, at_points.rows > 0 ? at_points.cells : first_order.front().intensity.size(), source);
}

template struct SourceAlong<float>;
template struct SourceAlong<double>;
template struct DirectionalSource<float>;
template struct DirectionalSource<double>;

}  // namespace cloudbow
