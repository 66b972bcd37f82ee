#include "cloudbow/transport/directional_source.hpp"

namespace cloudbow {

template <class Real>
void DirectionalSource<Real>::query(const Direction& direction, Real* __restrict source) const {
  const Stencil stencil = points.stencil(direction);
  const Real* __restrict const a = at_points.row(stencil.index[0]);
  const Real* __restrict const b = at_points.row(stencil.index[1]);
  const Real* __restrict const c = at_points.row(stencil.index[2]);
  const Real wa = static_cast<Real>(stencil.weight[0]);
  const Real wb = static_cast<Real>(stencil.weight[1]);
  const Real wc = static_cast<Real>(stencil.weight[2]);
  for (std::size_t i = 0; i < at_points.cells; ++i) source[i] = wa * a[i] + wb * b[i] + wc * c[i];
  for (const auto& beam : first_order) {
    const Real value = static_cast<Real>(beam.phase(direction.dot(sun_travel)));
    const Real* __restrict const intensity = beam.intensity.data();
    for (std::size_t i = 0; i < at_points.cells; ++i) source[i] += value * intensity[i];
  }
}

template struct DirectionalSource<float>;
template struct DirectionalSource<double>;

}  // namespace cloudbow
