#include "transport/scattering/directional_source.hpp"

#include <algorithm>
#include <array>
#include <span>

namespace cloudbow {

namespace {

constexpr std::size_t block_cells = 128;  // unpacked at a time

template <class Real>
void add_terms(std::span<const typename SourceAlong<Real>::Term> terms, std::size_t first, std::size_t n,
               Real* __restrict source) {
  for (const auto& term : terms) {
    const Real* __restrict const from = term.at_cells + first;
    for (std::size_t i = 0; i < n; ++i) source[i] += term.weight * from[i];
  }
}

}  // namespace

template <class Real>
void SourceAlong<Real>::fill(std::size_t first, std::size_t n, Real* __restrict source) const {
  fill_scattered(first, n, source);
  if (emission.at_cells != nullptr) add_terms<Real>(std::span(&emission, 1), first, n, source);
}

template <class Real>
void SourceAlong<Real>::fill_scattered(std::size_t first, std::size_t n, Real* __restrict source) const {
  if (!any_points) {
    std::fill_n(source, n, Real(0));
    add_terms<Real>(first_order, first, n, source);
    return;
  }
  const Real wa = points[0].weight;
  const Real wb = points[1].weight;
  const Real wc = points[2].weight;
  if (points[0].at_cells.packed != nullptr) {
    std::array<std::array<Real, block_cells>, 3> room{};
    for (std::size_t begin = 0; begin < n; begin += block_cells) {
      const std::size_t count = std::min(block_cells, n - begin);
      const auto unpacked = [&](std::size_t k) {
        return points[k].at_cells.read(first + begin, count, room[k].data());
      };
      const Real* __restrict const a = unpacked(0);
      const Real* __restrict const b = unpacked(1);
      const Real* __restrict const c = unpacked(2);
      Real* __restrict const to = source + begin;
      for (std::size_t i = 0; i < count; ++i) to[i] = wa * a[i] + wb * b[i] + wc * c[i];
    }
    add_terms<Real>(first_order, first, n, source);
    return;
  }
  const Real* __restrict const a = points[0].at_cells.plain + first;
  const Real* __restrict const b = points[1].at_cells.plain + first;
  const Real* __restrict const c = points[2].at_cells.plain + first;
  if (first_order.empty()) {
    for (std::size_t i = 0; i < n; ++i) source[i] = wa * a[i] + wb * b[i] + wc * c[i];
    return;
  }
  const Real wd = first_order[0].weight;
  const Real* __restrict const d = first_order[0].at_cells + first;
  for (std::size_t i = 0; i < n; ++i) source[i] = wa * a[i] + wb * b[i] + wc * c[i] + wd * d[i];
  add_terms<Real>(std::span(first_order).subspan(1), first, n, source);
}

template <class Real>
SourceAlong<Real> DirectionalSource<Real>::along(const Direction& direction, double scale) const {
  SourceAlong<Real> source{};
  if (at_points.rows > 0) {
    const Stencil stencil = points.stencil(direction);
    for (std::size_t k = 0; k < 3; ++k)
      source.points[k] = {static_cast<Real>(scale * stencil.weight[k]), at_points.stored_row(stencil.index[k])};
    source.any_points = true;
  }
  for (const auto& beam : first_order)
    source.first_order.push_back(
        {static_cast<Real>(scale * beam.phase(direction.dot(sun_travel))), beam.intensity.data()});
  if (emission.source != nullptr) source.emission = {static_cast<Real>(scale), emission.source};
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
