// The final gather: fluxes through horizontal planes from many directions of the converged source, without ray effects
// (docs/theory.md, "Final gather").
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "cloudbow/optics/forward_peak.hpp"
#include "cloudbow/transport/solution.hpp"
#include "transport/rays/march.hpp"
#include "transport/scattering/directional_source.hpp"
#include "transport/system/ground.hpp"
#include "transport/system/ordinate_share.hpp"
#include "transport/system/source_slopes.hpp"

namespace cloudbow {

struct GatherDirection {
  Direction travel;
  double weight;   ///< sr
  double spacing;  ///< [sr] per direction of its own set: the spiral, or those about the sun
};

/// Cosine-weighted golden spiral over one hemisphere of travel. With a sun, those of count/4 more in that hemisphere
/// that crowd about its direction as HG(.85) does: upward as well, because grazing light leaves upward after small
/// deflections. Weights make cosine-weighted means exact in the limit (multiple importance sampling, balance heuristic:
/// Veach 1997), and the flux of isotropic light exact.
std::vector<GatherDirection> gather_directions(int count, bool upward, const std::optional<Direction>& sun_travel);

/// Downward directions about the sun's, one for each of the angles; their weights are one over the density of these.
std::vector<GatherDirection> peak_directions(std::span<const PeakAngle> angles, const Direction& sun_travel);

/// Radiance that comes in through open sides along a direction, at each interface by height [nz+1]; an empty vector:
/// none.
using SideRadiance = std::function<std::vector<double>(const Direction&)>;

template <class Real>
struct GatherScene {
  const BoxGrid& box;
  const Cells<Real>& cells;
  const DirectionalSource<Real>* source;  ///< needed for fluxes
  SideRadiance side_radiance{};           ///< called only if the box is open; may be empty
  double sky_radiance = 0;
  const GroundRadiance<Real>* ground = nullptr;  ///< needed for light that travels up
  std::span<const Real> own_extinction{};        ///< [n + lane_padding] in place of that of the cells; empty: theirs

  /// A radiance that fulfils the transport equation if it is the same everywhere. All light is counted from it here.
  /// The flux contains it again in the end. Only the difference is smoothed. It is small in thermal scenes, 0 in
  /// equilibrium.
  double reference = 0;

  bool fill_columns = false;                  ///< rays start in another place of their columns for each direction
  bool linear_source = true;                  ///< as the system's
  const Slope<Real>* beam_slope = nullptr;    ///< of the direct beam's irradiance, and
  const LightSlopes<Real>* slopes = nullptr;  ///< those of multiply scattered light; null: from differences

  /// The path of rays that see the source as `slopes` describe it.
  PathPattern path(PathPattern pattern) const {
    return slopes != nullptr ? at_true_places(std::move(pattern)) : std::move(pattern);
  }
  const Real* extinction() const { return own_extinction.empty() ? cells.extinction.data() : own_extinction.data(); }
};

/// Diffuse flux [columns] through the plane at z_edge[edge], of light that travels up or down. It is marched backwards.
/// Light of distant cells is smoothed over the spread of the beams that represent it (distance bands).
/// @param share each rank marches the directions of its octants, and the first has the flux; the others have none.
/// Null: there is one rank.
template <class Real>
std::vector<double> gather_flux(const GatherScene<Real>& scene, int edge, bool upward,
                                const std::vector<GatherDirection>& directions, const OrdinateShare* share = nullptr);

inline constexpr double most_sum_bytes = 1e9;
/// Diffuse fluxes [edges][columns] through the interfaces z_edge[edges], of those between bottom and top, ascending:
/// one forward march for all of them, its light in distance bands that are smoothed as those of gather_flux.
/// @param share as of gather_flux
/// @param most_bytes sums of a quarter of the directions that may be kept twice; larger ones are kept once, which takes
/// more time
template <class Real>
std::vector<float> gather_level_fluxes(const GatherScene<Real>& scene, std::span<const int> edges, bool upward,
                                       const std::vector<GatherDirection>& directions,
                                       const OrdinateShare* share = nullptr, double most_bytes = most_sum_bytes);

/// The most memory that gather_level_fluxes takes, with this many directions.
/// @param cells whose source and slopes each direction keeps: those of the largest level, or all if slopes are from
/// differences.
template <class Real>
std::size_t level_gather_bytes(const BoxGrid& box, std::size_t cells, std::span<const int> edges, int directions,
                               int threads);

}  // namespace cloudbow
