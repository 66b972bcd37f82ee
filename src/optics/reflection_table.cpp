#include "cloudbow/optics/reflection_table.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

namespace cloudbow {
namespace {

// A glint over calm water is some ten degrees wide; the table is made once and its size does not grow with the scene.
constexpr int surface_control_points = 642;

Direction arriving_side(const Direction& d) { return {d.x(), d.y(), -std::abs(d.z())}; }
Direction leaving_side(const Direction& d) { return {d.x(), d.y(), std::abs(d.z())}; }

double interpolated(const Stencil& stencil, const Eigen::VectorXd& value) {
  double sum = 0;
  for (int k = 0; k < 3; ++k) sum += stencil.weight[k] * value[stencil.index[k]];
  return sum;
}

// Columns of the table: functions in the surface's frame, seen from the scene's.
class Columns {
 public:
  Columns(const SurfaceBrdf& brdf, const SurfaceTilt& tilt, const ControlPoints& points, const OrdinateSet& ordinates)
      : brdf_(brdf),
        points_(points),
        to_surface_(Eigen::Quaterniond::FromTwoVectors(tilt.normal(), Direction::UnitZ()).toRotationMatrix()),
        family_(brdf, points) {
    for (int d = 0; d < ordinates.size(); ++d) {
      if (ordinates.direction[d].z() <= 0) continue;
      up_stencil_.push_back(points.stencil(ordinates.direction[d]));
      up_power_.push_back(ordinates.weight[d] * ordinates.direction[d].z());
    }
  }

  struct Column {
    Eigen::VectorXd at_points;
    Eigen::VectorXd at_up;
    double albedo;  // as the model has it
    double correction = 0;
  };

  // The reflectance of light arriving along a direction of the scene; its own lobe where exact, else of the family.
  Column column(const Direction& arriving, bool exact) {
    const Direction local = arriving_side(to_surface_ * arriving);
    const Eigen::VectorXd lobe = exact ? Eigen::VectorXd() : family_.lobe(local);
    Column column{Eigen::VectorXd(points_.size()), Eigen::VectorXd(up_stencil_.size()), albedo(-local.z())};
    for (int m = 0; m < points_.size(); ++m) {
      const Direction leaving = to_surface_ * leaving_side(points_.directions()[m]);
      const bool visible = leaving.z() > -1e-9;  // points on the horizon itself count
      column.at_points[m] = !visible ? 0 : exact ? brdf_(local, leaving) : interpolated(points_.stencil(leaving), lobe);
    }
    double returned = 0;
    for (std::size_t u = 0; u < up_stencil_.size(); ++u) {
      column.at_up[u] = interpolated(up_stencil_[u], column.at_points);
      returned += up_power_[u] * column.at_up[u];
    }
    if (returned > 0) {
      const double factor = std::min(1., column.albedo) / returned;
      column.correction = std::abs(std::max(1., column.albedo) * factor - 1);
      column.at_points *= factor;
      column.at_up *= factor;
    }
    return column;
  }

 private:
  double albedo(double mu) {
    const double cosine = std::clamp(mu, .02, 1.);
    const auto [place, is_new] = albedo_.try_emplace(cosine, 0.);
    if (is_new) place->second = brdf_.directional_albedo(cosine);
    return place->second;
  }

  const SurfaceBrdf& brdf_;
  const ControlPoints& points_;
  Eigen::Matrix3d to_surface_;
  ControlPointBrdf family_;
  std::vector<Stencil> up_stencil_;
  std::vector<double> up_power_;
  std::map<double, double> albedo_;
};

}  // namespace

ControlPointBrdf::ControlPointBrdf(const SurfaceBrdf& brdf, const ControlPoints& points)
    : points_(points), leaving_by_arriving_(points.size(), points.size()) {
  const auto directions = points.directions();
  for (int i = 0; i < points.size(); ++i) {
    const Direction arriving = arriving_side(directions[i]);
    for (int m = 0; m < points.size(); ++m) leaving_by_arriving_(m, i) = brdf(arriving, leaving_side(directions[m]));
  }
}

Eigen::VectorXd ControlPointBrdf::lobe(const Direction& arriving) const {
  const Stencil stencil = points_.stencil(arriving_side(arriving));
  Eigen::VectorXd values = Eigen::VectorXd::Zero(points_.size());
  for (int k = 0; k < 3; ++k) values += stencil.weight[k] * leaving_by_arriving_.col(stencil.index[k]);
  return values;
}

double ControlPointBrdf::operator()(const Direction& arriving, const Direction& leaving) const {
  return interpolated(points_.stencil(leaving_side(leaving)), lobe(arriving));
}

Direction SurfaceTilt::normal() const {
  const double slope = slope_deg * std::numbers::pi / 180;
  const double aspect = aspect_deg * std::numbers::pi / 180;
  return {std::sin(slope) * std::cos(aspect), std::sin(slope) * std::sin(aspect), std::cos(slope)};
}

ReflectionTable make_reflection_table(const SurfaceBrdf& brdf, const SurfaceTilt& tilt, const OrdinateSet& ordinates,
                                      const std::optional<Direction>& beam) {
  ReflectionTable table{.points = ControlPoints(surface_control_points)};
  for (int d = 0; d < ordinates.size(); ++d) (ordinates.direction[d].z() < 0 ? table.down : table.up).push_back(d);
  Columns columns(brdf, tilt, table.points, ordinates);
  const auto note = [&](const Columns::Column& column) {
    table.largest_albedo = std::max(table.largest_albedo, column.albedo);
    table.largest_correction = std::max(table.largest_correction, column.correction);
  };

  const auto count = static_cast<Eigen::Index>(table.down.size());
  table.points_from_down.resize(table.points.size(), count);
  table.up_from_down.resize(static_cast<Eigen::Index>(table.up.size()), count);
  table.albedo.resize(count);
  double arriving_power = 0;
  for (Eigen::Index c = 0; c < count; ++c) {
    const int d = table.down[c];
    const Columns::Column column = columns.column(ordinates.direction[d], false);
    note(column);
    const double power = ordinates.weight[d] * -ordinates.direction[d].z();
    table.points_from_down.col(c) = power * column.at_points;
    table.up_from_down.col(c) = power * column.at_up;
    table.albedo[c] = std::min(1., column.albedo);
    table.bihemispherical_albedo += power * table.albedo[c];
    arriving_power += power;
  }
  table.bihemispherical_albedo /= arriving_power;
  if (beam) {
    const Columns::Column column = columns.column(*beam, true);
    note(column);
    table.points_from_beam = column.at_points;
    table.up_from_beam = column.at_up;
    table.beam_albedo = std::min(1., column.albedo);
  }
  return table;
}

}  // namespace cloudbow
