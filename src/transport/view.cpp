#include "cloudbow/transport/view.hpp"

#include <cmath>

#include "backward_march.hpp"

namespace cloudbow {
namespace {

// Light at the ground: the last gather's where the solution holds it, else the ordinates'.
template <class Real>
GroundRadiance<Real> lit_ground(const TransportSystem<Real>& system, const SweepFluxes<Real>& fluxes,
                                const Solution& solution) {
  const bool gathered = !solution.flux_level.empty() && solution.flux_level.front() == 0;
  std::vector<double> diffuse = fluxes.surface_flux;
  if (gathered) {
    for (std::size_t c = 0; c < diffuse.size(); ++c)
      diffuse[c] = static_cast<double>(solution.downwelling_diffuse_flux[c]) + solution.direct_flux[c];
  }
  for (std::size_t c = 0; c < system.beam_surface_flux.size(); ++c)
    diffuse[c] = std::max(0., diffuse[c] - system.beam_surface_flux[c]);
  return system.ground.radiance_seen(fluxes.surface_arriving, diffuse, system.beam_surface_flux, system.ordinates);
}

}  // namespace

template <class Real>
std::vector<RadianceImage> view_radiances(const Problem& problem, const SolverOptions& options,
                                          const TransportSystem<Real>& system, const IterationResult<Real>& solved,
                                          const AngularField<Real>& source, const Surroundings* surroundings,
                                          const Solution& solution) {
  const BoxGrid& box = system.box;
  const GroundRadiance<Real> ground = lit_ground(system, solved.fluxes, solution);
  SideRadiance side;
  if (surroundings != nullptr)
    side = [surroundings](const Direction& travel) { return surroundings->radiance(travel); };
  const GatherScene<Real> scene{box, *system.cells, nullptr, side, problem.sky_radiance, &ground};
  const LevelRange levels{0, box.nz()};
  const std::vector<Band> all{{0, box.nz(), 0., false}};
  const bool one_column = box.periodic && box.columns() == 1;
  const int rays = one_column ? 1 : static_cast<int>(std::lround(std::sqrt(options.beam_rays)));  // an axis

  std::vector<RadianceImage> images;
  for (std::size_t v = 0; v < options.views.size(); ++v) {
    const View& view = options.views[v];
    const Real* const row = source.row(static_cast<int>(v));
    const SourceAlong<Real> along{{{{Real(1), row}, {Real(0), row}, {Real(0), row}}}, {}};
    LinearSource<Real> linear;
    linear.resize(system.cells->size());
    std::copy_n(row, system.cells->size(), linear.value.begin());
    linear.make_gradient(*system.cells);
    std::vector<std::vector<double>> of_ray(static_cast<std::size_t>(rays) * rays);
#pragma omp parallel
    {
      GatherWorkspace<Real> work;
      Gathered<Real> seen;
#pragma omp for schedule(dynamic, 1)
      for (int r = 0; r < rays * rays; ++r) {
        const PathPattern pattern = make_path_pattern(box, -view.travel, (r % rays + .5) / rays, (r / rays + .5) / rays,
                                                      system.vertical, levels);
        seen.clear(all.size(), box.columns());
        march_back(scene, pattern, all, view.travel, along, Real(1), linear.view(*system.cells), work, seen);
        of_ray[r].resize(box.columns());
        for (std::size_t c = 0; c < box.columns(); ++c)
          of_ray[r][c] = static_cast<double>(seen.of_band[0][c]) + static_cast<double>(seen.beyond[c]);
      }
    }
    RadianceImage image{view, std::vector<float>(box.columns())};
    for (std::size_t c = 0; c < box.columns(); ++c) {
      double sum = 0;
      for (const auto& radiance : of_ray) sum += radiance[c];
      image.radiance[c] = static_cast<float>(sum / static_cast<double>(of_ray.size()));
    }
    images.push_back(std::move(image));
  }
  return images;
}

#define CLOUDBOW_INSTANTIATE(Real)                                                                      \
  template std::vector<RadianceImage> view_radiances<Real>(                                             \
      const Problem&, const SolverOptions&, const TransportSystem<Real>&, const IterationResult<Real>&, \
      const AngularField<Real>&, const Surroundings*, const Solution&)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow
