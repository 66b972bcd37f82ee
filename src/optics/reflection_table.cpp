#include "cloudbow/optics/reflection_table.hpp"

#include <Eigen/SparseCore>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "cloudbow/sphere/gauss_legendre.hpp"

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

// A function of direction becomes control-point values by averaging it over the neighbourhood that each point stands
// for: a glint near the horizon is narrower than the points are apart, and must be caught all the same. Functions of
// half a sphere are known at the directions above the horizon alone.
class NeighbourhoodMeans {
 public:
  explicit NeighbourhoodMeans(const ControlPoints& points) {
    const ControlPoints samples(Polyhedron::icosahedron, sample_subdivisions);
    std::vector<Eigen::Triplet<double>> entries;
    for (const Direction& sample : samples.directions()) {
      const auto [place, is_new] = place_.try_emplace(key(sample), static_cast<int>(directions_.size()));
      if (is_new) directions_.push_back(leaving_side(sample));
      const Stencil stencil = points.stencil(sample);
      for (int k = 0; k < 3; ++k) entries.emplace_back(stencil.index[k], place->second, stencil.weight[k]);
    }
    means_.resize(points.size(), static_cast<Eigen::Index>(directions_.size()));
    means_.setFromTriplets(entries.begin(), entries.end());
    const Eigen::VectorXd sums = means_ * Eigen::VectorXd::Ones(means_.cols());
    means_ = sums.cwiseInverse().asDiagonal() * means_;
  }

  const std::vector<Direction>& directions() const { return directions_; }  // z >= 0
  const Eigen::SparseMatrix<double>& matrix() const { return means_; }      // points x directions
  /// Place among the directions; the set has the x and the y plane as mirrors.
  int place(const Direction& direction) const { return place_.at(key(direction)); }

 private:
  using Key = std::array<long, 3>;
  static Key key(const Direction& d) {
    const Direction up = leaving_side(d) * 1e6;
    return {std::lround(up.x()), std::lround(up.y()), std::lround(up.z())};
  }

  static constexpr int sample_subdivisions = 4;  // 2562 directions
  std::map<Key, int> place_;
  std::vector<Direction> directions_;
  Eigen::SparseMatrix<double> means_;
};

// Flux through the horizontal per value at each control point: integral over the upper hemisphere of mu times the
// interpolant.
Eigen::VectorXd flux_weights(const ControlPoints& points) {
  constexpr int polar_nodes = 48;
  constexpr int azimuths = 96;
  const GaussLegendre gauss = make_gauss_legendre(polar_nodes);
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(points.size());
  for (int i = 0; i < polar_nodes; ++i) {
    const double mu = .5 * (1 + gauss.node[i]);
    const double sine = std::sqrt(1 - mu * mu);
    const double power = .5 * gauss.weight[i] * mu * 2 * std::numbers::pi / azimuths;
    for (int j = 0; j < azimuths; ++j) {
      const double azimuth = 2 * std::numbers::pi * (j + .5) / azimuths;
      const Stencil stencil = points.stencil({sine * std::cos(azimuth), sine * std::sin(azimuth), mu});
      for (int k = 0; k < 3; ++k) weights[stencil.index[k]] += power * stencil.weight[k];
    }
  }
  return weights;
}

// Columns of the table: functions in the surface's frame, seen from the scene's.
class Columns {
 public:
  Columns(const SurfaceBrdf& brdf, const SurfaceTilt& tilt, const ControlPoints& points, const OrdinateSet& ordinates)
      : brdf_(brdf),
        points_(points),
        means_(points),
        flux_weights_(flux_weights(points)),
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
    double albedo = 0;      // as the model has it
    double correction = 0;  // of the ordinates' values
    double factor = 1;      // of the values at the control points
  };

  // Light arriving along an ordinate, by the family of functions.
  Column of_ordinate(const Direction& arriving) {
    const Direction local = arriving_side(to_surface_ * arriving);
    const Eigen::VectorXd lobe = family_.lobe(local);
    Column column;
    column.at_points.resize(points_.size());
    for (int m = 0; m < points_.size(); ++m) {
      const Direction leaving = to_surface_ * leaving_side(points_.directions()[m]);
      column.at_points[m] = visible(leaving) ? interpolated(points_.stencil(leaving), lobe) : 0.;
    }
    finish(column, -local.z());
    return column;
  }

  // The direct beam, by its own function.
  Column of_beam(const Direction& arriving) {
    const Direction local = arriving_side(to_surface_ * arriving);
    Eigen::VectorXd lobe(static_cast<Eigen::Index>(means_.directions().size()));
    for (Eigen::Index s = 0; s < lobe.size(); ++s) {
      const Direction leaving = to_surface_ * means_.directions()[static_cast<std::size_t>(s)];
      lobe[s] = visible(leaving) ? brdf_(local, leaving) : 0.;
    }
    Column column;
    column.at_points = means_.matrix() * lobe;
    finish(column, -local.z());
    return column;
  }

 private:
  // Points on the horizon itself count.
  static bool visible(const Direction& leaving) { return leaving.z() > -1e-9; }

  void finish(Column& column, double mu) {
    column.albedo = albedo(mu);
    const double wanted = std::min(1., column.albedo);
    const double integral = flux_weights_.dot(column.at_points);
    column.factor = integral > 0 ? wanted / integral : 1.;
    column.at_points *= column.factor;
    column.at_up.resize(static_cast<Eigen::Index>(up_stencil_.size()));
    double returned = 0;
    for (std::size_t u = 0; u < up_stencil_.size(); ++u) {
      column.at_up[u] = interpolated(up_stencil_[u], column.at_points);
      returned += up_power_[u] * column.at_up[u];
    }
    if (returned > 0) {
      column.correction = std::abs(wanted / returned - 1);
      column.at_up *= wanted / returned;
    }
  }

  double albedo(double mu) {
    const double cosine = std::clamp(mu, .02, 1.);
    const auto [place, is_new] = albedo_.try_emplace(cosine, 0.);
    if (is_new) place->second = brdf_.directional_albedo(cosine);
    return place->second;
  }

  const SurfaceBrdf& brdf_;
  const ControlPoints& points_;
  NeighbourhoodMeans means_;
  Eigen::VectorXd flux_weights_;
  Eigen::Matrix3d to_surface_;
  ControlPointBrdf family_;
  std::vector<Stencil> up_stencil_;
  std::vector<double> up_power_;
  std::map<double, double> albedo_;
};

}  // namespace

ControlPointBrdf::ControlPointBrdf(const SurfaceBrdf& brdf, const ControlPoints& points) : points_(points) {
  const NeighbourhoodMeans means(points);
  const auto& directions = means.directions();
  const auto count = static_cast<Eigen::Index>(directions.size());
  // Only the azimuth between the two directions counts, and they may change places: of the pairs that the mirrors x = 0
  // and y = 0 and the exchange make alike, the model is asked for one.
  std::array<std::vector<int>, 4> mirror;
  for (int g = 0; g < 4; ++g) {
    for (const Direction& d : directions) {
      mirror[g].push_back(means.place({g & 1 ? -d.x() : d.x(), g & 2 ? -d.y() : d.y(), d.z()}));
    }
  }
  // Each direction is mirrored to the first of its kind.
  std::vector<int> to_first(directions.size());
  const auto first = [&](Eigen::Index i) { return mirror[to_first[i]][i]; };
  for (Eigen::Index i = 0; i < count; ++i) {
    for (int g = 1; g < 4; ++g) {
      if (mirror[g][i] < first(i)) to_first[i] = g;
    }
  }
  Eigen::MatrixXd sampled(count, count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const auto& mirrored = mirror[to_first[i]];
    if (const Eigen::Index same = first(i); same < i) {
      for (Eigen::Index m = 0; m < count; ++m) sampled(m, i) = sampled(mirrored[m], same);
      continue;
    }
    const Direction arriving = arriving_side(directions[i]);
    for (Eigen::Index m = 0; m < count; ++m) {
      const Eigen::Index known = first(m);
      sampled(m, i) = known < i ? sampled(mirror[to_first[m]][i], known) : brdf(arriving, directions[m]);
    }
  }
  leaving_by_arriving_ = means.matrix() * Eigen::MatrixXd((means.matrix() * sampled).transpose());
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

double BeamReflection::operator()(const Direction& leaving) const {
  const Direction local = to_surface * leaving;
  return local.z() > 0 ? factor * brdf(arriving_side(to_surface * beam), local) : 0.;
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
    const Columns::Column column = columns.of_ordinate(ordinates.direction[d]);
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
    const Columns::Column column = columns.of_beam(*beam);
    note(column);
    table.points_from_beam = column.at_points;
    table.up_from_beam = column.at_up;
    table.beam_albedo = std::min(1., column.albedo);
    table.beam =
        BeamReflection{brdf, Eigen::Quaterniond::FromTwoVectors(tilt.normal(), Direction::UnitZ()).toRotationMatrix(),
                       *beam, tilt.slope_deg > 0 ? column.factor : table.beam_albedo / column.albedo};
  }
  return table;
}

}  // namespace cloudbow
