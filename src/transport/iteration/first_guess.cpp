#include "transport/iteration/first_guess.hpp"

#include <cassert>
#include <type_traits>
#include <utility>

namespace cloudbow {
namespace {

template <class To, class From>
std::vector<To> converted(std::vector<From>&& from) {
  if constexpr (std::is_same_v<To, From>) {
    return std::move(from);
  } else {
    return std::vector<To>(from.begin(), from.end());
  }
}

// Adds the moments of the direct beam, times `sign`.
template <class Real, class Value>
void add_beam(const TransportSystem<Real>& system, const std::optional<Sun>& sun, Real sign,
              std::vector<Value>& moments) {
  const std::vector<Real>& irradiance = system.beam.irradiance;
  if (!sun || irradiance.empty()) return;
  const LowMomentValues shape = low_moments_along(sun->travel);
  const std::size_t n = system.cells->size();
  for (std::size_t m = 0; m < shape.size(); ++m) {
    const Real share = sign * static_cast<Real>(shape[m]);
    Value* __restrict const to = moments.data() + m * n;
    for (std::size_t c = 0; c < n; ++c) to[c] += static_cast<Value>(share * irradiance[c]);
  }
}

}  // namespace

template <class Real>
FirstGuess<Real> first_guess(const TransportSystem<Real>& system, const std::optional<Sun>& sun, CellLight&& light,
                             const OrdinateShare* share) {
  const std::size_t n = system.cells->size();
  assert(light.moments.size() == low_moments * n);
  FirstGuess<Real> guess;
  guess.is_given = true;
  guess.moments = converted<Real>(std::move(light.moments));
  add_beam(system, sun, Real(-1), guess.moments);
  for (std::size_t c = 0; c < n; ++c) {
    if (guess.moments[c] >= 0) continue;  // the beam here is more than all light there
    for (std::size_t m = 0; m < low_moments; ++m) guess.moments[m * n + c] = 0;
  }
  if (share != nullptr) {
    std::vector<Real> own;
    for (std::size_t m = 0; m < low_moments; ++m) {
      const Real* const of_all = guess.moments.data() + m * n;
      own.insert(own.end(), of_all + share->range().first, of_all + share->range().last);
    }
    guess.moments = std::move(own);
  }
  if (system.slopes && !light.slopes.empty()) {
    guess.slopes.emplace();
    std::size_t next = 0;
    for (Slope<Real>& octant : guess.slopes->of_octant) {
      for (std::vector<Real>& axis : octant) axis = converted<Real>(std::move(light.slopes[next++]));
    }
    guess.slopes->fitted = true;
  }
  light = {};
  return guess;
}

template <class Real>
CellLight cell_light(const TransportSystem<Real>& system, const SolvePlan& plan, IterationResult<Real>&& solved,
                     const OrdinateShare* share) {
  if (share != nullptr) {
    const std::size_t n = system.cells->size(), own = share->range().size();
    std::vector<Real> of_all(low_moments * n);
    for (std::size_t m = 0; m < low_moments; ++m) {
      share->gather_cells(std::span<const Real>(solved.moments).subspan(m * own, own),
                          std::span(of_all).subspan(m * n, n));
    }
    solved.moments = std::move(of_all);
  }
  CellLight light{plan, converted<float>(std::move(solved.moments)), {}};
  add_beam(system, plan.problem().sun, Real(1), light.moments);
  if (solved.slopes) {
    for (Slope<Real>& octant : solved.slopes->of_octant) {
      for (std::vector<Real>& axis : octant) light.slopes.push_back(converted<float>(std::move(axis)));
    }
    solved.slopes.reset();
  }
  return light;
}

#define CLOUDBOW_INSTANTIATE(Real)                                                                                  \
  template FirstGuess<Real> first_guess<Real>(const TransportSystem<Real>&, const std::optional<Sun>&, CellLight&&, \
                                              const OrdinateShare*);                                                \
  template CellLight cell_light<Real>(const TransportSystem<Real>&, const SolvePlan&, IterationResult<Real>&&,      \
                                      const OrdinateShare*)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow
