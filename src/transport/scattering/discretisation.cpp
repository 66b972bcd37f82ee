#include "transport/scattering/discretisation.hpp"

namespace cloudbow {

std::vector<double> Discretisation::diffuse_fraction() const {
  std::vector<double> f;
  for (const auto& d : diffuse) f.push_back(d.forward_fraction);
  return f;
}

std::vector<double> Discretisation::beam_fraction() const {
  std::vector<double> f;
  for (const auto& d : beam) f.push_back(d.forward_fraction);
  return f;
}

std::vector<double> Discretisation::gather_fraction() const {
  std::vector<double> f;
  for (const auto& d : gather) f.push_back(d.forward_fraction);
  return f;
}

Discretisation discretise(const std::vector<PhaseFunction>& phase, const std::optional<Direction>& sun_travel,
                          const AngularOptions& options) {
  OrdinateSet ordinates = make_ordinate_set(options.directions);
  ControlPoints points(options.control_points,
                       ordinates.is_control_points ? control_point_frame_rotation() : Eigen::Matrix3d::Identity());
  Discretisation result{std::move(points), std::move(ordinates), {}, {}, {}, {}, {}};
  for (const PhaseFunction& p : phase) {
    result.table.push_back(make_scattering_table(p, result.points, result.ordinates, sun_travel, options.fit));
    result.diffuse.push_back(delta_m(p, options.fit.delta_m_order));
    result.beam.push_back(delta_m(p, options.fit.beam_delta_m_order));
    result.gather.push_back(delta_m(p, Discretisation::gather_order));
    result.peak.emplace_back(result.gather.back(), result.beam.back());
  }
  return result;
}

}  // namespace cloudbow
