#include "transport/observers/camera_view.hpp"

#include <cmath>
#include <limits>
#include <numbers>

#include "cloudbow/core/not_negative.hpp"
#include "cloudbow/core/parallel_errors.hpp"
#include "transport/observers/sight_line.hpp"

namespace cloudbow {
namespace {

// Values of the source at the points: about those of 160 directions of a million cells.
constexpr std::size_t most_values = 160'000'000;

// BeamPhase on a grid of angles that is fine about the forward direction, linear between.
class AngleTable {
 public:
  explicit AngleTable(const BeamPhase& phase) {
    value_.reserve(static_cast<std::size_t>(angles + 1) * BeamPhase::nodes);
    for (int n = 0; n <= angles; ++n) {
      const double share = static_cast<double>(n) / angles;
      const std::vector<double> at = phase.at(std::cos(std::numbers::pi * share * share));
      value_.insert(value_.end(), at.begin(), at.end());
    }
  }
  // At the nodes, for one angle.
  std::array<double, BeamPhase::nodes> at(double cos_angle) const {
    const double place = angles * std::sqrt(std::acos(std::clamp(cos_angle, -1., 1.)) / std::numbers::pi);
    const int n = std::min(static_cast<int>(place), angles - 1);
    const double share = place - n;
    std::array<double, BeamPhase::nodes> result;
    const double* const low = value_.data() + static_cast<std::size_t>(n) * BeamPhase::nodes;
    for (int i = 0; i < BeamPhase::nodes; ++i)
      result[static_cast<std::size_t>(i)] = (1 - share) * low[i] + share * low[i + BeamPhase::nodes];
    return result;
  }

 private:
  static constexpr int angles = 2048;
  std::vector<double> value_;
};

// Means over the directions of view in `rows`: the whole source, and in from_beam its first order of scattering.
template <class Real>
LinearSource<Real> mean_source(const Problem& problem, std::size_t cells, const SightPoints& sight,
                               const AngularField<Real>& source, int first_row, std::span<const int> rows,
                               std::span<const ViewingBeam<Real>> beams) {
  LinearSource<Real> mean;
  mean.resize(cells);
  std::fill(mean.value.begin(), mean.value.end(), Real(0));
  mean.from_beam.assign(cells, Real(0));
  for (const int i : rows) {
    const Real* const row = source.row(first_row + i);
    for (std::size_t c = 0; c < cells; ++c) mean.value[c] += row[c];
    for (const ViewingBeam<Real>& beam : beams)
      add_first_order<Real>(beam, sight.travel[static_cast<std::size_t>(i)].dot(problem.sun->travel), mean.from_beam);
  }
  const Real share = Real(1) / static_cast<Real>(rows.size());
  for (std::size_t c = 0; c < cells; ++c) {
    mean.from_beam[c] *= share;
    mean.value[c] = share * mean.value[c] + mean.from_beam[c];
  }
  return mean;
}

// The cells as lines of sight see them: with one slope for all lines, or one for each octant of them.
template <class Real>
SightScene<Real> sight_scene(const ConvergedField<Real>& field, const SightPoints& sight,
                             const AngularField<Real>& source, int first_row, std::span<const ViewingBeam<Real>> beams,
                             const GroundRadiance<Real>& ground, const SideRadiance& side) {
  const TransportSystem<Real>& system = field.system;
  const std::size_t n = system.cells->size();
  std::array<std::vector<int>, octants> rows;
  for (std::size_t i = 0; i < sight.travel.size(); ++i)
    rows[field.result.slopes ? octant_of(sight.travel[i]) : 0].push_back(static_cast<int>(i));
  const auto mean_over = [&](const std::vector<int>& some) {
    return mean_source(field.problem, n, sight, source, first_row, std::span<const int>(some), beams);
  };
  LinearSource<Real> all;
  if (system.linear_source && !field.result.slopes) {
    all = mean_over(rows[0]);
    all.make_gradient(*system.cells, system.thermal_emission());
  }
  SightScene<Real> scene(system.box, *system.cells, all.view(*system.cells).gradient, ground,
                         field.problem.sky_radiance, side);
  for (int q = 0; field.result.slopes && q < octants; ++q) {
    if (rows[q].empty()) continue;
    const LinearSource<Real> mean = mean_over(rows[q]);
    std::vector<Direction> travel;
    for (const int i : rows[q]) travel.push_back(sight.travel[static_cast<std::size_t>(i)]);
    const Slope<Real> slope =
        slopes_seen<Real>(field, travel, std::span<const Real>(mean.value).first(n), mean.from_beam);
    scene.set_octant(q, *system.cells, {slope[0].data(), slope[1].data(), slope[2].data()});
  }
  return scene;
}

}  // namespace

SightPoints sight_points(std::span<const Camera> cameras, std::size_t cells) {
  for (int subdivisions = 4;; --subdivisions) {
    SightPoints sight{ControlPoints(Polyhedron::icosahedron, subdivisions, control_point_frame_rotation()), {}, {}};
    sight.row.assign(static_cast<std::size_t>(sight.points.size()), -1);
    const auto need = [&sight](const Direction& line) {
      for (const int point : sight.points.stencil(-line).index) {
        if (sight.row[static_cast<std::size_t>(point)] >= 0) continue;
        sight.row[static_cast<std::size_t>(point)] = static_cast<int>(sight.travel.size());
        sight.travel.push_back(sight.points.directions()[static_cast<std::size_t>(point)]);
      }
    };
    for (const Camera& camera : cameras) {
      for (int row = 0; row < camera.height; ++row) {
        for (int column = 0; column < camera.width; ++column) for_lines_of_sight(camera, row, column, need);
      }
    }
    if (subdivisions == 2 || sight.travel.size() * cells <= most_values) return sight;
  }
}

template <class Real>
std::vector<CameraImage> camera_images(const ConvergedField<Real>& field, const SightPoints& sight,
                                       const AngularField<Real>& source, int first_row,
                                       std::span<const ViewingBeam<Real>> beams, const GroundRadiance<Real>& ground,
                                       const SideRadiance& side) {
  const Problem& problem = field.problem;
  const SolverOptions& options = field.options;
  std::vector<CameraImage> images;
  if (options.cameras.empty()) return images;
  const SightScene<Real> scene = sight_scene(field, sight, source, first_row, beams, ground, side);
  // A beam's intensity and depth, side by side in memory.
  std::vector<std::vector<std::array<float, 2>>> lit(beams.size());
  for (std::size_t b = 0; b < beams.size(); ++b) {
    lit[b].resize(source.cells);
    for (std::size_t c = 0; c < source.cells; ++c)
      lit[b][c] = {static_cast<float>(beams[b].intensity[c]), beams[b].place[c]};
  }
  std::vector<AngleTable> phase;
  for (const ViewingBeam<Real>& beam : beams) phase.emplace_back(beam.phase);

  for (const Camera& camera : options.cameras) {
    CameraImage image{camera, std::vector<float>(static_cast<std::size_t>(camera.width) * camera.height)};
    ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
    for (int row = 0; row < camera.height; ++row) {
      errors.run([&] {
        std::vector<std::array<double, BeamPhase::nodes>> scattered(beams.size());
        for (int column = 0; column < camera.width; ++column) {
          double sum = 0;
          int rays = 0;
          for_lines_of_sight(camera, row, column, [&](const Direction& line) {
            const Stencil stencil = sight.points.stencil(-line);
            std::array<const Real*, 3> at;
            for (std::size_t n = 0; n < 3; ++n)
              at[n] = source.row(first_row + sight.row[static_cast<std::size_t>(stencil.index[n])]);
            for (std::size_t b = 0; b < beams.size(); ++b) scattered[b] = phase[b].at(-line.dot(problem.sun->travel));
            sum += radiance_along<Real>(scene, camera.position_m, line, [&](std::uint32_t cell) {
              double emitted = 0;
              for (std::size_t n = 0; n < 3; ++n) emitted += stencil.weight[n] * static_cast<double>(at[n][cell]);
              for (std::size_t b = 0; b < beams.size(); ++b) {
                const auto& [intensity, depth] = lit[b][cell];
                const double place = static_cast<double>(depth);
                const auto node = static_cast<std::size_t>(std::min(place, BeamPhase::nodes - 2.));
                const double share = place - static_cast<double>(node);
                emitted += ((1 - share) * scattered[b][node] + share * scattered[b][node + 1]) *
                           static_cast<double>(intensity);
              }
              return emitted;
            });
            ++rays;
          });
          image.radiance[static_cast<std::size_t>(row) * camera.width + column] =
              rays > 0 ? static_cast<float>(not_negative(sum / rays)) : std::numeric_limits<float>::quiet_NaN();
        }
      });
    }
    errors.rethrow();
    images.push_back(std::move(image));
  }
  return images;
}

template std::vector<CameraImage> camera_images<float>(const ConvergedField<float>&, const SightPoints&,
                                                       const AngularField<float>&, int,
                                                       std::span<const ViewingBeam<float>>,
                                                       const GroundRadiance<float>&, const SideRadiance&);
template std::vector<CameraImage> camera_images<double>(const ConvergedField<double>&, const SightPoints&,
                                                        const AngularField<double>&, int,
                                                        std::span<const ViewingBeam<double>>,
                                                        const GroundRadiance<double>&, const SideRadiance&);

}  // namespace cloudbow
