#include "transport/rays/march.hpp"

#include <cmath>

namespace cloudbow {

template <class Real>
void source_gradient(const Cells<Real>& cells, std::size_t first, std::size_t n, const Real* source,
                     Real* __restrict gradient_x, Real* __restrict gradient_y, Real* __restrict gradient_z) {
  const std::uint32_t* __restrict const xl = cells.low[0].data() + first;
  const std::uint32_t* __restrict const xh = cells.high[0].data() + first;
  const std::uint32_t* __restrict const yl = cells.low[1].data() + first;
  const std::uint32_t* __restrict const yh = cells.high[1].data() + first;
  const std::uint32_t* __restrict const zl = cells.low[2].data() + first;
  const std::uint32_t* __restrict const zh = cells.high[2].data() + first;
  const Real* __restrict const sx = cells.scale[0].data() + first;
  const Real* __restrict const sy = cells.scale[1].data() + first;
  const Real* __restrict const sz = cells.scale[2].data() + first;
#pragma omp simd
  for (std::size_t c = 0; c < n; ++c) {
    const Real x = sx[c] * (source[xh[c]] - source[xl[c]]);
    const Real y = sy[c] * (source[yh[c]] - source[yl[c]]);
    const Real z = sz[c] * (source[zh[c]] - source[zl[c]]);
    const Real here = source[first + c] > 0 ? source[first + c] : Real(0);
    const Real swing = Real(.5) * (std::abs(x) + std::abs(y) + std::abs(z));
    const Real relative = here > std::numeric_limits<Real>::min() ? Real(1) / std::max(swing, here) : Real(0);
    gradient_x[c] = x * relative;
    gradient_y[c] = y * relative;
    gradient_z[c] = z * relative;
  }
}

template <class Real>
void source_gradient(const Cells<Real>& cells, const CellEmission<Real>& emission, std::size_t first, std::size_t n,
                     const Real* source, const Real* rest, Real* __restrict gradient_x, Real* __restrict gradient_y,
                     Real* __restrict gradient_z) {
  source_gradient(cells, first, n, rest, gradient_x, gradient_y, gradient_z);
  for (std::size_t c = 0; c < n; ++c) {
    const Real whole = source[first + c], scattered = rest[first + c];
    const Real x = gradient_x[c] * scattered;
    const Real y = gradient_y[c] * scattered;
    const Real z = gradient_z[c] * scattered + emission.step[first + c] * emission.source[first + c];
    const Real relative = limited_inverse(x, y, z, whole);
    gradient_x[c] = x * relative;
    gradient_y[c] = y * relative;
    gradient_z[c] = z * relative;
  }
}

template void source_gradient(const Cells<float>&, std::size_t, std::size_t, const float*, float*, float*, float*);
template void source_gradient(const Cells<float>&, const CellEmission<float>&, std::size_t, std::size_t, const float*,
                              const float*, float*, float*, float*);
template void source_gradient(const Cells<double>&, std::size_t, std::size_t, const double*, double*, double*, double*);
template void source_gradient(const Cells<double>&, const CellEmission<double>&, std::size_t, std::size_t,
                              const double*, const double*, double*, double*, double*);

}  // namespace cloudbow
