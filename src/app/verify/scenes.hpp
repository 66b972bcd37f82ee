// Scenes for checks, made in memory.
#pragma once

#include <array>
#include <vector>

#include "cloudbow/app/assemble.hpp"

namespace cloudbow {

/// A sun at the position that a scene would give. Its zenith's cosine is mu0.
SceneSun sun_at(double mu0, double azimuth_deg);
/// Direction in which its light travels.
Direction beam_travel(double mu0, double azimuth_deg);

/// Direction in which light travels towards a sensor that stands there; mu < 0: below the scene.
Direction travel_to_sensor(double mu, double azimuth_deg);

/// Henyey-Greenstein with an asymmetry parameter of .85.
PhaseFunction droplets();

/// A homogeneous layer as one column; irradiance 1, black ground.
Problem layer_problem(double optical_depth, double single_scattering_albedo, const PhaseFunction& phase, double mu0,
                      double azimuth_deg = 0);

/// Dense extinction [1/m] at (k*ny + j)*nx + i.
struct ExtinctionField {
  int nx = 1;
  int ny = 1;
  int nz = 1;
  std::vector<float> extinction;
  std::array<double, 3> cell_m{1, 1, 1};

  std::size_t columns() const { return static_cast<std::size_t>(nx) * static_cast<std::size_t>(ny); }
};

/// Extinctions between 0 and `largest` without any order, a third of the cells empty: the same numbers everywhere.
/// Cells of 1 m.
ExtinctionField uneven_field(int nx, int ny, int nz, double largest);

/// Irradiance 1, black ground.
Problem field_problem(const ExtinctionField& field, double single_scattering_albedo, const PhaseFunction& phase,
                      const SceneSun& sun, bool periodic = true);

/// The ladder's options on one thread and without a cache: tables are made anew.
SolverOptions column_options(const char* accuracy = "balanced");
SolverOptions field_options(const char* accuracy = "draft");

}  // namespace cloudbow
