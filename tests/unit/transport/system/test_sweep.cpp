#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <vector>

#include "transport/system/sweep.hpp"
#include "transport/system/transport_system.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

constexpr double sky = 1.7, albedo = .4;

// Matter that only absorbs, under a sky of even radiance.
Problem absorbing(const BoxGrid& box, const std::vector<float>& absorption) {
  Problem problem;
  problem.grid = make_grid(box, absorption, {std::vector<float>(absorption.size(), 0.F)});
  problem.phase = {PhaseFunction::isotropic()};
  problem.sky_radiance = sky;
  problem.surface.albedo = albedo;
  return problem;
}

struct Swept {
  TransportSystem<double> system;
  AngularField<double> field;
  SweepFluxes<double> fluxes;

  explicit Swept(const Problem& problem)
      : system(
            make_system<double>(problem, discretise(problem.phase, std::nullopt, coarse_options()), coarse_options())),
        field(system.ordinates.size(), system.cells->size()) {
    SweepWorkspace<double> work;
    fluxes = sweep(system, field, true, work);
  }

  double down_surface() const {
    return std::reduce(fluxes.surface_flux.begin(), fluxes.surface_flux.end()) /
           static_cast<double>(fluxes.surface_flux.size());
  }
};

// Beer's law along each ordinate, to the ground and back: in levels of one extinction all columns are alike.
TEST(Sweep, UniformLevelsFollowBeersLaw) {
  const BoxGrid box = make_box(5, 4, 3);
  std::vector<float> absorption(cells_of(box));
  const double of_level[] = {.2, .7, .4};
  for (std::size_t c = 0; c < absorption.size(); ++c) absorption[c] = static_cast<float>(of_level[c / box.columns()]);
  const Swept swept(absorbing(box, absorption));
  const OrdinateSet& ordinates = swept.system.ordinates;
  const auto transmitted = [&](double depth) {
    double flux = 0;
    for (int d = 0; d < ordinates.size(); ++d) {
      const double mu = ordinates.direction[d].z();
      if (mu > 0) flux += ordinates.weight[d] * mu * std::exp(-depth / mu);
    }
    return flux;
  };
  const double down = sky * transmitted(1.3);
  EXPECT_NEAR(swept.down_surface(), down, 1e-6 * down);  // extinction is stored in float
  EXPECT_NEAR(swept.fluxes.up_top, albedo / std::numbers::pi * down * transmitted(1.3), 1e-6 * down);
  EXPECT_NEAR(swept.fluxes.surface_absorbed, (1 - albedo) * down, 1e-6 * down);
  EXPECT_NEAR(swept.fluxes.profile_down[2], sky * transmitted(.4), 1e-6 * down);
  EXPECT_NEAR(swept.fluxes.profile_down[1], sky * transmitted(1.1), 1e-6 * down);
  EXPECT_NEAR(swept.fluxes.profile_up[1], albedo / std::numbers::pi * down * transmitted(.2), 1e-6 * down);
}

// Cells absorb the light that is lost on the way, in a field of any kind: their mean radiance times their extinction.
TEST(Sweep, CellsAbsorbWhatIsLost) {
  for (const bool periodic : {true, false}) {
    BoxGrid box = make_box(6, 5, 4, periodic);
    const Problem problem = absorbing(box, random_extinction(box, 2, 7));
    const Swept swept(problem);
    double absorbed = 0;
    for (int d = 0; d < swept.field.rows; ++d) {
      for (std::size_t c = 0; c < swept.system.cells->size(); ++c)
        absorbed += swept.system.ordinates.weight[d] * swept.field.row(d)[c] * swept.system.absorption[c];
    }
    absorbed /= static_cast<double>(box.columns());  // cells of 1 m3
    const double arriving = swept.down_surface();
    const double incident = sky * std::numbers::pi;
    const double lost = incident + swept.fluxes.side_gain - swept.fluxes.up_top - swept.fluxes.surface_absorbed -
                        swept.fluxes.side_loss;
    EXPECT_GT(arriving, 0);
    EXPECT_NEAR(absorbed, lost, 1e-6 * incident) << periodic;
  }
}

// Ordinates near the horizon are marched sideways through three runs of levels of one thickness. They are marched along
// z through the two levels between. Each level absorbs the light that is lost between its planes.
TEST(Sweep, EachLevelAbsorbsWhatIsLostBetweenItsPlanes) {
  BoxGrid box = make_box(20, 18, 13);
  box.z_edge_m = {0, 1, 2, 3, 3.3, 3.8, 4.3, 4.8, 5.3, 6, 7, 8, 9, 10};
  const Swept swept(absorbing(box, random_extinction(box, .6, 7, true)));
  const auto most_runs =
      std::max_element(swept.system.paths.begin(), swept.system.paths.end(),
                       [](const auto& one, const auto& two) { return one.sideways.size() < two.sideways.size(); });
  EXPECT_EQ(most_runs->sideways.size(), 3U);
  const ActiveRows& rows = swept.system.cells->rows;
  for (int k = 0; k < box.nz(); ++k) {
    double absorbed = 0;
    for (int d = 0; d < swept.field.rows; ++d) {
      for (std::size_t c = rows.level_cell[k]; c < rows.level_cell[k + 1]; ++c)
        absorbed += swept.system.ordinates.weight[d] * swept.field.row(d)[c] * swept.system.absorption[c];
    }
    absorbed *= box.thickness_m(k) / static_cast<double>(box.columns());
    const auto net_down = [&](int edge) { return swept.fluxes.profile_down[edge] - swept.fluxes.profile_up[edge]; };
    EXPECT_NEAR(absorbed, net_down(k + 1) - net_down(k), 1e-6 * sky) << "level " << k;  // extinction is stored in float
  }
}

// Rays of a periodic box have no origin: fields that are moved horizontally are the same.
TEST(Sweep, MovedFieldsHaveTheSameFluxes) {
  const BoxGrid box = make_box(6, 4, 5);
  const std::vector<float> extinction = random_extinction(box, 3, 11);
  std::vector<float> moved(extinction.size());
  for (std::size_t c = 0; c < extinction.size(); ++c) {
    const std::size_t i = c % 6, j = c / 6 % 4, k = c / 24;
    moved[(k * 4 + (j + 3) % 4) * 6 + (i + 2) % 6] = extinction[c];
  }
  const Swept here(absorbing(box, extinction)), there(absorbing(box, moved));
  EXPECT_NEAR(here.fluxes.up_top, there.fluxes.up_top, 1e-12);
  for (std::size_t c = 0; c < box.columns(); ++c) {
    const std::size_t i = c % 6, j = c / 6;
    EXPECT_NEAR(here.fluxes.surface_flux[c], there.fluxes.surface_flux[(j + 3) % 4 * 6 + (i + 2) % 6], 1e-12);
  }
}

}  // namespace
}  // namespace cloudbow
