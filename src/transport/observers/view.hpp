// Radiance along parallel lines of sight: the image of an instrument far above (or below) the scene.
#pragma once

#include "cloudbow/transport/solution.hpp"
#include "transport/observers/gather.hpp"
#include "transport/observers/viewing_source.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {

/// Images of options.views, in their order. The formal solution along each line of sight (docs/theory.md, "Radiance").
/// @param slopes of multiply scattered light; null: from differences. @param beams for the part of the source from the
/// direct beam. @param source along the views' directions, in its first rows.
/// @param ground for instruments. @param side radiance at open sides; may be empty.
template <class Real>
std::vector<RadianceImage> view_radiances(const Problem& problem, const SolverOptions& options,
                                          const TransportSystem<Real>& system, const LightSlopes<Real>* slopes,
                                          const AngularField<Real>& source, std::span<const ViewingBeam<Real>> beams,
                                          const GroundRadiance<Real>& ground, const SideRadiance& side);

}  // namespace cloudbow
