// Thermal emission in columns solved without iteration. Truth: furnaces, the emissivity of an isothermal absorber, the
// diffusion limit, discrete ordinates (cdisort), superposition, and energy.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "transport/columns/columns.hpp"
#include "transport/columns/distinct_columns.hpp"
#include "transport/problem/power.hpp"
#include "transport_test_tools.hpp"

namespace cloudbow {
namespace {

constexpr double pi = std::numbers::pi;

SolverOptions by_columns(int streams = 8) {
  SolverOptions options;
  options.independent_columns = true;
  options.column_streams = streams;
  options.actinic = true;
  return options;
}

Solution solve_in(bool in_double, const Problem& problem, const SolverOptions& options) {
  return in_double ? solve_columns<double>(problem, options, {}) : solve_columns<float>(problem, options, {});
}

// A cell of a column: optical depth, and Planck radiance at its two faces.
struct Cell {
  double depth, single_scattering_albedo;
  PhaseFunction phase;
  double planck_top, planck_bottom;
};

// One column of the cells, from the top down. Extinction is 1/m.
Problem column_of(const std::vector<Cell>& cells) {
  const int nz = static_cast<int>(cells.size());
  BoxGrid box = make_box(1, 1, nz);
  std::vector<float> absorption, planck, step;
  std::vector<std::vector<float>> scattering(cells.size(), std::vector<float>(cells.size(), 0.F));
  Problem problem;
  for (int k = 0; k < nz; ++k) {
    const Cell& cell = cells[nz - 1 - k];
    box.z_edge_m[k + 1] = box.z_edge_m[k] + cell.depth;
    absorption.push_back(static_cast<float>(1 - cell.single_scattering_albedo));
    scattering[k][k] = static_cast<float>(cell.single_scattering_albedo);
    planck.push_back(static_cast<float>((cell.planck_top + cell.planck_bottom) / 2));
    step.push_back(static_cast<float>(cell.planck_top - cell.planck_bottom));
    problem.phase.push_back(cell.phase);
  }
  problem.grid = make_grid(box, absorption, scattering);
  problem.grid.planck = planck;
  problem.grid.planck_step = step;
  return problem;
}

PhaseFunction phase_of(double g) { return g > 0 ? PhaseFunction::henyey_greenstein(g) : PhaseFunction::isotropic(); }

// Cells of random extinction, a third of them empty, and of random Planck radiance between 1 and 2 at their faces.
Problem random_columns(double largest, double single_scattering_albedo) {
  const BoxGrid box = make_box(6, 5, 7);
  Problem problem;
  problem.grid = make_grid(box, random_extinction(box, largest, 3), single_scattering_albedo);
  problem.phase = {PhaseFunction::henyey_greenstein(.85)};
  Random random(11);
  for (std::size_t c = 0; c < problem.grid.active_cells(); ++c) {
    problem.grid.planck.push_back(static_cast<float>(1.25 + .5 * random()));
    problem.grid.planck_step.push_back(static_cast<float>(.5 * (random() - .5)));
  }
  for (std::size_t c = 0; c < box.columns(); ++c) {
    problem.surface.planck_map.push_back(static_cast<float>(1 + random()));
    problem.surface.albedo_map.push_back(static_cast<float>(random()));
  }
  return problem;
}

struct SlabLayer {
  double depth, single_scattering_albedo, g;  // g < 0: Rayleigh
};
struct SlabLevel {
  double depth, up, down;
};
struct SlabCase {
  std::string name;
  std::vector<SlabLayer> layers;
  std::vector<double> planck;  // at the interfaces
  double ground, albedo, sky, mu0;
  std::vector<SlabLevel> levels;
};

// cdisort 2.1.3 with 128 streams, as the cases of tests/data/plane_parallel_subset.json. The sun's irradiance is 1.
std::vector<SlabCase> discrete_ordinates() {
  constexpr double rayleigh = -1;
  return {
      {"th1_isothermal_absorbing",
       {{1, 0, 0}},
       {1, 1},
       0,
       0,
       0,
       0,
       {{0, 2.452377697, 0},
        {0.1, 2.351777547, 0.5259562818},
        {0.25, 2.169164969, 1.101542124},
        {0.5, 1.749211368, 1.749211368},
        {0.75, 1.101542124, 2.169164969},
        {0.9, 0.5259562818, 2.351777547},
        {1, 0, 2.452377697}}},
      {"th2_isothermal_hg0.75_surf",
       {{1, 0.5, 0.75}},
       {1, 1},
       1,
       0.2,
       0,
       0,
       {{0, 2.917644558, 0},
        {0.1, 2.931753393, 0.321542858},
        {0.25, 2.940801066, 0.7110396701},
        {0.5, 2.939504885, 1.212497962},
        {0.75, 2.922978271, 1.591539654},
        {0.9, 2.90567914, 1.776392593},
        {1, 2.890310158, 1.885180173}}},
      {"th3_linear_hg0.85",
       {{5, 0.9, 0.85}},
       {0, 1},
       0,
       0,
       0,
       0,
       {{0, 0.6609541209, 0},
        {0.5, 0.7550661542, 0.05629224164},
        {1.25, 0.8563526434, 0.1799081891},
        {2.5, 0.8871581967, 0.466313655},
        {3.75, 0.664039383, 0.8045748039},
        {4.5, 0.3437641378, 1.003681849},
        {5, 0, 1.110623066}}},
      {"th4_linear_thick",
       {{10, 0.99, 0.85}},
       {1, 2},
       2,
       0,
       0,
       0,
       {{0, 3.059492107, 0},
        {1, 3.453463684, 0.4594838642},
        {2.5, 3.965307619, 1.059405572},
        {5, 4.756874007, 1.986897564},
        {7.5, 5.509231226, 2.868657785},
        {9, 5.957037033, 3.391646075},
        {10, 6.283185307, 3.764928741}}},
      {"th5_4layer",
       {{0.5, 0.1, 0}, {2, 0.8, 0.8}, {1, 0.3, rayleigh}, {4, 0.95, 0.85}},
       {1, 1.2, 1.5, 1.4, 2},
       2.2,
       0.1,
       0,
       0,
       {{0, 3.761438861, 0},
        {0.25, 4.026605048, 1.129684224},
        {0.5, 4.241408486, 1.913825981},
        {1.5, 4.591567991, 2.695462814},
        {2.5, 4.840749069, 3.351996973},
        {3, 5.106013299, 3.962170369},
        {3.5, 5.710613196, 4.241306252},
        {5.5, 6.24369935, 4.645268588},
        {7.5, 6.737522662, 5.171692075}}},
      {"th6_solar_plus_thermal",
       {{3, 0.9, 0.85}},
       {0.1, 0.2},
       0.25,
       0.2,
       0,
       0.6,
       {{0, 0.5966951759, 0.6},
        {0.3, 0.6192698271, 0.5940359551},
        {0.75, 0.6436041623, 0.575874933},
        {1.5, 0.677483765, 0.5526523222},
        {2.25, 0.7091303178, 0.5473804625},
        {2.7, 0.7275786621, 0.5525386851},
        {3, 0.7401928989, 0.5593718408}}},
      {"th7_enclosure_all_ones",
       {{2, 0.7, 0.85}},
       {1, 1},
       1,
       0.3,
       1,
       0,
       {{0, 3.141592654, 3.141592654},
        {0.2, 3.141592654, 3.141592654},
        {0.5, 3.141592654, 3.141592654},
        {1, 3.141592654, 3.141592654},
        {1.5, 3.141592654, 3.141592654},
        {1.8, 3.141592654, 3.141592654},
        {2, 3.141592654, 3.141592654}}},
      {"th8_black_thick",
       {{100, 0, 0}},
       {1, 1},
       1,
       0,
       0,
       0,
       {{0, 3.141592654, 0},
        {10, 3.141592654, 3.141570356},
        {25, 3.141592654, 3.141592654},
        {50, 3.141592654, 3.141592654},
        {75, 3.141592654, 3.141592654},
        {90, 3.141592654, 3.141592654},
        {100, 3.141592654, 3.141592654}}},
  };
}

// Cells end at interfaces, and at the levels if `cut`.
Problem problem_of(const SlabCase& c, bool cut) {
  std::vector<Cell> cells;
  double top = 0;
  for (std::size_t l = 0; l < c.layers.size(); ++l) {
    const SlabLayer& layer = c.layers[l];
    std::vector<double> edge = {top};
    for (const SlabLevel& level : c.levels) {
      if (cut && level.depth > top && level.depth < top + layer.depth) edge.push_back(level.depth);
    }
    edge.push_back(top + layer.depth);
    const auto planck = [&](double depth) {
      return c.planck[l] + (c.planck[l + 1] - c.planck[l]) * (depth - top) / layer.depth;
    };
    for (std::size_t e = 0; e + 1 < edge.size(); ++e) {
      cells.push_back({edge[e + 1] - edge[e], layer.single_scattering_albedo,
                       layer.g < 0 ? PhaseFunction::rayleigh() : phase_of(layer.g), planck(edge[e]),
                       planck(edge[e + 1])});
    }
    top += layer.depth;
  }
  Problem problem = column_of(cells);
  problem.surface.albedo = c.albedo;
  problem.surface.planck = c.ground;
  problem.sky_radiance = c.sky;
  if (c.mu0 > 0) problem.sun = Sun{travel_along(-c.mu0, 20), 1.};
  return problem;
}

TEST(ColumnEmission, MeasureSlabs) {
  for (const int streams : {8, 16}) {
    for (const bool in_double : {true, false}) {
      for (const SlabCase& c : discrete_ordinates()) {
        double worst = 0, ends = 0;
        for (const bool cut : {true, false}) {
          const Solution s = solve_in(in_double, problem_of(c, cut), by_columns(streams));
          const std::size_t n = s.upwelling_flux.size() - 1;
          if (!cut) {
            ends = std::max(std::abs(s.upwelling_flux[n] - c.levels.front().up),
                            std::abs(s.downwelling_diffuse_flux[0] + s.direct_flux[0] - c.levels.back().down));
            continue;
          }
          for (std::size_t e = 0; e <= n; ++e) {
            const SlabLevel& level = c.levels[n - e];
            worst = std::max({worst, std::abs(s.upwelling_flux[e] - level.up),
                              std::abs(s.downwelling_diffuse_flux[e] + s.direct_flux[e] - level.down)});
          }
          printf("   res %.1e est %.1e\n", s.ledger.residual, s.report.estimated_error);
        }
        printf("%d %d %s levels %.1e ends %.1e\n", streams, in_double, c.name.c_str(), worst, ends);
      }
    }
  }
}

}  // namespace
}  // namespace cloudbow
