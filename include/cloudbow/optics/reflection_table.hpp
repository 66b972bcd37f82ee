// A surface's reflectance on control points: a family of control-point functions of the leaving direction, one per
// arriving direction. The solver's matrices are computed from it.
#pragma once

#include <Eigen/Core>
#include <optional>

#include "cloudbow/optics/surface_brdf.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"

namespace cloudbow {

/// The reflectance as a function of two directions, interpolated in both: column i contains, at all control points, the
/// light that leaves when it arrives at control point i. Each value is the mean over the neighbourhoods that the two
/// points represent. Below the horizon the functions continue as mirror images (|z|). So interpolation near the horizon
/// stays on the surface's side.
class ControlPointBrdf {
 public:
  ControlPointBrdf(const SurfaceBrdf& brdf, const ControlPoints& points);

  /// Values at the control points for one arriving direction of travel.
  Eigen::VectorXd lobe(const Direction& arriving) const;
  double operator()(const Direction& arriving, const Direction& leaving) const;

 private:
  const ControlPoints& points_;
  Eigen::MatrixXd leaving_by_arriving_;
};

/// Orientation of the surface's own normal in the scene's frame. The ground of a scene is a horizontal plane. A slope
/// means that it consists of facets, all tilted alike. Together they receive the light that reaches the plane.
struct SurfaceTilt {
  double slope_deg = 0;   ///< 0 <= slope < 90
  double aspect_deg = 0;  ///< azimuth that the slope faces, counter-clockwise from +x

  Direction normal() const;
};

/// Direct light reflected once, exactly: what an observer sees.
struct BeamReflection {
  SurfaceBrdf brdf;
  Eigen::Matrix3d to_surface;  ///< from the scene's frame
  Direction beam;
  double factor;  ///< so that no more leaves than arrives

  /// Radiance per W m-2 of direct light through the horizontal.
  double operator()(const Direction& leaving) const;
};

/// Radiance that leaves the ground, per radiance that arrives along the ordinates. All matrices in double.
struct ReflectionTable {
  ControlPoints points;                   ///< M, on which leaving radiance can be queried
  std::vector<int> down = {};             ///< the D_d ordinates that travel down
  std::vector<int> up = {};               ///< the D_u that travel up
  Eigen::MatrixXd points_from_down = {};  ///< M x D_d, quadrature weight and cosine included
  Eigen::MatrixXd up_from_down = {};      ///< D_u x D_d
  Eigen::VectorXd points_from_beam = {};  ///< M: per W m-2 of direct light through the horizontal; empty without beam
  Eigen::VectorXd up_from_beam = {};      ///< D_u
  Eigen::VectorXd albedo = {};            ///< D_d: share of the arriving light that leaves, 0 to 1
  double beam_albedo = 0;
  std::optional<BeamReflection> beam = {};
  double bihemispherical_albedo = 0;  ///< of light that arrives equally from everywhere above
  double largest_albedo = 0;          ///< before it was held to 1
  double largest_correction = 0;      ///< worst |factor - 1| that gave a column its directional albedo
};

/// Columns are scaled so that the ordinates' quadrature returns the directional-hemispherical albedo, and never more
/// than arrives. The beam's column comes from its own direction, the others are interpolated in the arriving direction.
/// A tilted surface's functions are turned into its frame by interpolation (re-weighting), and nothing leaves below its
/// own horizon.
/// @param beam direction of travel of the direct sunlight, if any.
ReflectionTable make_reflection_table(const SurfaceBrdf& brdf, const SurfaceTilt& tilt, const OrdinateSet& ordinates,
                                      const std::optional<Direction>& beam);

}  // namespace cloudbow
