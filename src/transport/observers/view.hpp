// Radiance along parallel lines of sight: the image of an instrument far above (or below) the scene.
#pragma once

#include "cloudbow/transport/solution.hpp"
#include "transport/gather/gather.hpp"
#include "transport/observers/viewing_source.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {

/// Images of options.views, in their order. The formal solution along each line of sight (docs/theory.md, "Radiance").
/// @param source along the views' directions, in its first rows. @param beams for the part of it from the direct beam.
/// @param ground for instruments. @param side radiance at open sides; may be empty.
template <class Real>
std::vector<RadianceImage> view_radiances(const ConvergedField<Real>& field, const AngularField<Real>& source,
                                          std::span<const ViewingBeam<Real>> beams, const GroundRadiance<Real>& ground,
                                          const SideRadiance& side);

}  // namespace cloudbow
