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

// Single scattering by the phase function as it is; higher orders from the control points (Nakajima & Tanaka 1988,
// "TMS"). The beam is the iteration's own.
template <class Real>
void set_seen_first_order(const Problem& problem, const TransportSystem<Real>& system,
                          DirectionalSource<Real>& source) {
  source.first_order.clear();
  if (!problem.sun) return;
  source.sun_travel = problem.sun->travel;
  for (std::size_t p = 0; p < problem.phase.size(); ++p)
    add_single_scattering<Real>(source, problem.phase[p], problem.grid.scattering[p], 1., system.cells->extinction,
                                system.beam_irradiance);
}

}  // namespace

template <class Real>
std::vector<RadianceImage> view_radiances(const Problem& problem, const SolverOptions& options,
                                          const TransportSystem<Real>& system, const IterationResult<Real>& solved,
                                          DirectionalSource<Real>& source, const Surroundings* surroundings,
                                          const Solution& solution) {
  const BoxGrid& box = system.box;
  set_seen_first_order(problem, system, source);
  const GroundRadiance<Real> ground = lit_ground(system, solved.fluxes, solution);
  SideRadiance side;
  if (surroundings != nullptr)
    side = [surroundings](const Direction& travel) { return surroundings->radiance(travel); };
  const GatherScene<Real> scene{box, *system.cells, source, side, problem.sky_radiance, &ground};
  const LevelRange levels{0, box.nz()};
  const std::vector<Band> all{{0, box.nz(), 0., false}};
  const bool one_column = box.periodic && box.columns() == 1;
  const int rays = one_column ? 1 : static_cast<int>(std::lround(std::sqrt(options.beam_rays)));  // an axis

  std::vector<RadianceImage> images;
  for (const View& view : options.views) {
    LinearSource<Real> linear;
    linear.resize(system.cells->size());
    source.query(view.travel, linear.value.data());
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
        march_back(scene, pattern, all, view.travel, Real(1), linear.view(*system.cells), work, seen);
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
      DirectionalSource<Real>&, const Surroundings*, const Solution&)
CLOUDBOW_INSTANTIATE(float);
CLOUDBOW_INSTANTIATE(double);
#undef CLOUDBOW_INSTANTIATE

}  // namespace cloudbow
