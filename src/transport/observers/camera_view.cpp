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
    value_.reserve((angles + 1) * BeamPhase::nodes);
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

// The mean over the directions of view: its relative gradient is used for all of them.
template <class Real>
LinearSource<Real> mean_source(const Problem& problem, const Cells<Real>& cells, const SightPoints& sight,
                               const AngularField<Real>& source, int first_row,
                               std::span<const ViewingBeam<Real>> beams) {
  LinearSource<Real> mean;
  mean.resize(cells.size());
  const std::span<Real> sum = std::span<Real>(mean.value).first(cells.size());
  std::fill(mean.value.begin(), mean.value.end(), Real(0));
  for (std::size_t i = 0; i < sight.travel.size(); ++i) {
    const Real* const row = source.row(first_row + static_cast<int>(i));
    for (std::size_t c = 0; c < sum.size(); ++c) sum[c] += row[c];
    for (const ViewingBeam<Real>& beam : beams)
      add_first_order<Real>(beam, sight.travel[i].dot(problem.sun->travel), sum);
  }
  mean.make_gradient(cells);
  return mean;
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
std::vector<CameraImage> camera_images(const Problem& problem, const SolverOptions& options,
                                       const TransportSystem<Real>& system, const SightPoints& sight,
                                       const AngularField<Real>& source, int first_row,
                                       std::span<const ViewingBeam<Real>> beams, const GroundRadiance<Real>& ground,
                                       const SideRadiance& side) {
  std::vector<CameraImage> images;
  if (options.cameras.empty()) return images;
  LinearSource<Real> mean;
  if (system.linear_source) mean = mean_source(problem, *system.cells, sight, source, first_row, beams);
  const SightScene<Real> scene(system.box, *system.cells, mean.view(*system.cells).gradient, ground,
                               problem.sky_radiance, side);
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

#define CLOUDBOW_INSTANTIATE(Real)                                                                     \
  template std::vector<CameraImage> camera_images<Real>(                                               \
      const Problem&, const SolverOptions&, const TransportSystem<Real>&, const SightPoints&,          \
      const AngularField<Real>&, int, std::span<const ViewingBeam<Real>>, const GroundRadiance<Real>&, \
      const SideRadiance&)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow
