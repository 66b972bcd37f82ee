#include "transport/observers/view.hpp"

#include <cmath>

#include "cloudbow/core/not_negative.hpp"
#include "cloudbow/core/parallel_errors.hpp"
#include "transport/gather/backward_march.hpp"
#include "transport/observers/sight_line.hpp"

namespace cloudbow {
namespace {

// Means over pixels of a grid of the view's own, each line of sight through the cells exactly.
template <class Real>
void fill_pixels(const SightScene<Real>& scene, const View& view, const Real* source, int rays,
                 std::vector<float>& radiance) {
  const BoxGrid& box = scene.box;
  radiance.resize(static_cast<std::size_t>(view.width) * view.height);
  const double across = (scene.x_max_m - box.x_min_m) / view.width;
  const double along = (scene.y_max_m - box.y_min_m) / view.height;
  const double plane = view.travel.z() > 0 ? box.z_edge_m.back() : box.z_edge_m.front();
  ParallelErrors errors;
#pragma omp parallel for schedule(dynamic, 1)
  for (int row = 0; row < view.height; ++row) {
    errors.run([&] {
      for (int column = 0; column < view.width; ++column) {
        double sum = 0;
        for (int r = 0; r < rays * rays; ++r) {
          const int part = r / rays;
          const Eigen::Vector3d eye(box.x_min_m + (column + (r % rays + .5) / rays) * across,
                                    box.y_min_m + (row + (part + .5) / rays) * along, plane);
          sum += radiance_along<Real>(scene, eye, -view.travel,
                                      [source](std::uint32_t cell) { return static_cast<double>(source[cell]); });
        }
        radiance[static_cast<std::size_t>(row) * view.width + column] =
            static_cast<float>(not_negative(sum / (rays * rays)));
      }
    });
  }
  errors.rethrow();
}

}  // namespace

template <class Real>
std::vector<RadianceImage> view_radiances(const ConvergedField<Real>& field, const AngularField<Real>& source,
                                          std::span<const ViewingBeam<Real>> beams, const GroundRadiance<Real>& ground,
                                          const SideRadiance& side) {
  const Problem& problem = field.problem;
  const SolverOptions& options = field.options;
  const TransportSystem<Real>& system = field.system;
  const BoxGrid& box = system.box;
  const GatherScene<Real> scene{.box = box,
                                .cells = *system.cells,
                                .source = nullptr,
                                .side_radiance = side,
                                .sky_radiance = problem.sky_radiance,
                                .ground = &ground,
                                .slopes = field.result.slopes ? &*field.result.slopes : nullptr};
  const LevelRange levels{0, box.nz()};
  const std::vector<Band> all{{0, box.nz(), 0., false}};
  const bool one_column = box.periodic && box.columns() == 1;
  const int rays = one_column ? 1 : static_cast<int>(std::lround(std::sqrt(options.beam_rays)));  // an axis

  std::vector<RadianceImage> images;
  for (std::size_t v = 0; v < options.views.size(); ++v) {
    const View& view = options.views[v];
    const Real* const row = source.row(static_cast<int>(v));
    SourceAlong<Real> along{};
    along.first_order.push_back({Real(1), row});
    LinearSource<Real> linear;
    linear.resize(system.cells->size());
    std::copy_n(row, system.cells->size(), linear.value.begin());
    if (field.result.slopes) {
      linear.from_beam.assign(system.cells->size(), Real(0));
      for (const ViewingBeam<Real>& beam : beams)
        add_first_order<Real>(beam, view.travel.dot(problem.sun->travel), linear.from_beam);
      linear.gradient =
          slopes_seen<Real>(field, std::span(&view.travel, 1), {row, system.cells->size()}, linear.from_beam);
    } else if (system.linear_source) {
      linear.make_gradient(*system.cells, system.thermal_emission());
    }
    if (view.width > 0) {
      const SightScene<Real> exact(box, *system.cells, linear.view(*system.cells).gradient, ground,
                                   problem.sky_radiance, side);
      images.push_back({view, {}});
      fill_pixels(exact, view, row, rays, images.back().radiance);
      continue;
    }
    std::vector<std::vector<double>> of_ray(static_cast<std::size_t>(rays) * rays);
    ParallelErrors errors;
#pragma omp parallel
    {
      GatherWorkspace<Real> work;
      Gathered<Real> seen;
#pragma omp for schedule(dynamic, 1)
      for (int r = 0; r < rays * rays; ++r) {
        errors.run([&] {
          const int part = r / rays;
          const PathPattern pattern = scene.path(make_path_pattern(
              box, -view.travel, (r % rays + .5) / rays, (part + .5) / rays, system.independent_columns, levels));
          seen.clear(all.size(), box.columns());
          work.source.start(scene, along, linear.view(*system.cells).gradient);
          march_back(scene, pattern, all, view.travel, Real(1), work, seen);
          of_ray[r].resize(box.columns());
          for (std::size_t c = 0; c < box.columns(); ++c)
            of_ray[r][c] = static_cast<double>(seen.of_band[0][c]) + static_cast<double>(seen.beyond[c]);
        });
      }
    }
    errors.rethrow();
    RadianceImage image{view, std::vector<float>(box.columns())};
    for (std::size_t c = 0; c < box.columns(); ++c) {
      double sum = 0;
      for (const auto& radiance : of_ray) sum += radiance[c];
      image.radiance[c] = static_cast<float>(not_negative(sum / static_cast<double>(of_ray.size())));
    }
    images.push_back(std::move(image));
  }
  return images;
}

template std::vector<RadianceImage> view_radiances<float>(const ConvergedField<float>&, const AngularField<float>&,
                                                          std::span<const ViewingBeam<float>>,
                                                          const GroundRadiance<float>&, const SideRadiance&);
template std::vector<RadianceImage> view_radiances<double>(const ConvergedField<double>&, const AngularField<double>&,
                                                           std::span<const ViewingBeam<double>>,
                                                           const GroundRadiance<double>&, const SideRadiance&);

}  // namespace cloudbow
