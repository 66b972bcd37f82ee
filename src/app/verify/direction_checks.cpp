// Directions of light: shadows, sensors, scenes that are shifted, mirrored and turned together with their sun.
#include <cmath>
#include <numbers>

#include "app/verify/checks.hpp"
#include "app/verify/scenes.hpp"
#include "cloudbow/transport/solver.hpp"

namespace cloudbow {
namespace {

constexpr int width = 9;  // columns along x and y
constexpr std::array<double, 3> cell{1, .8, .75};
const double slant_cosine = std::sqrt(.5);        // of the zenith angle
constexpr double sight_distance = 3.5 * cell[2];  // horizontal offset: equal to the height

constexpr int middle_column = width / 2;

std::size_t voxel_index(int i, int j, int k = 0) { return (static_cast<std::size_t>(k) * width + j) * width + i; }

// One voxel in an empty box of four levels.
ExtinctionField one_voxel(int k, float extinction) {
  ExtinctionField field{width, width, 4, std::vector<float>(voxel_index(0, 0, 4), 0.F), cell};
  field.extinction[voxel_index(middle_column, middle_column, k)] = extinction;
  return field;
}

// Distance [m] of the centre of gravity of a plane of columns from its expected position: `off` from the voxel's own.
template <class Weight>
double centre_off(const Weight& weight, double off_x, double off_y) {
  double sum = 0, sum_x = 0, sum_y = 0;
  for (int j = 0; j < width; ++j) {
    for (int i = 0; i < width; ++i) {
      const double w = weight(voxel_index(i, j));
      sum += w;
      sum_x += w * (i - middle_column) * cell[0];
      sum_y += w * (j - middle_column) * cell[1];
    }
  }
  return std::hypot(sum_x / sum - off_x, sum_y / sum - off_y);
}

constexpr std::array<double, 6> sun_azimuths{0, 90, 180, 270, 30, 205};

SolverOptions with_many_rays() {
  SolverOptions options = field_options();
  options.beam_rays = 64;
  return options;
}

// The shadow of a voxel lies on the side away from the sun. Its distance is the voxel's height.
double shadow() {
  Worst worst;
  for (const double azimuth : sun_azimuths) {
    const Solution solution = solve(
        field_problem(one_voxel(3, 1), 0, PhaseFunction::isotropic(), sun_at(slant_cosine, azimuth)), with_many_rays());
    const double angle = azimuth * std::numbers::pi / 180;
    worst.meet(centre_off([&](std::size_t c) { return slant_cosine - static_cast<double>(solution.direct_flux[c]); },
                          -sight_distance * std::cos(angle), -sight_distance * std::sin(angle)));
  }
  return worst.value();
}

// A sensor sees a voxel near the ground, along a slanted line, through the top nearer to itself.
double parallax() {
  SolverOptions options = with_many_rays();
  for (const double azimuth : sun_azimuths) options.views.push_back({"view", travel_to_sensor(slant_cosine, azimuth)});
  const Solution solution =
      solve(field_problem(one_voxel(0, .01F), 1, PhaseFunction::isotropic(), sun_at(1, 0)), options);
  Worst worst;
  for (std::size_t v = 0; v < sun_azimuths.size(); ++v) {
    const double angle = sun_azimuths[v] * std::numbers::pi / 180;
    worst.meet(centre_off([&](std::size_t c) { return static_cast<double>(solution.images.at(v).radiance.at(c)); },
                          sight_distance * std::cos(angle), sight_distance * std::sin(angle)));
  }
  return worst.value();
}

// ---- maps of a square field onto itself -----------------------------------------------------------------------------

constexpr int field_side = 6;

// x' = xx x + xy y, y' = yx x + yy y about the field's centre, then a periodic shift by columns.
struct Map {
  int xx, xy, yx, yy, shift_x, shift_y;

  std::size_t column(std::size_t c) const {
    const int x = 2 * (static_cast<int>(c) % field_side) - (field_side - 1);
    const int y = 2 * (static_cast<int>(c) / field_side) - (field_side - 1);
    const auto place = [](int doubled, int shift) { return ((doubled + field_side - 1) / 2 + shift) % field_side; };
    return static_cast<std::size_t>(place(yx * x + yy * y, shift_y)) * field_side + place(xx * x + xy * y, shift_x);
  }
  Direction direction(const Direction& d) const { return {xx * d.x() + xy * d.y(), yx * d.x() + yy * d.y(), d.z()}; }
};

struct MapDeviation {
  double mean = 0;    // of domain means, W m-2 of an irradiance of 1
  double column = 0;  // RMS over columns
};

MapDeviation under(const Map& map) {
  constexpr std::size_t columns = std::size_t{field_side} * field_side;
  const ExtinctionField field = uneven_field(field_side, field_side, 4, 3);
  ExtinctionField mapped = field;
  for (std::size_t c = 0; c < field.extinction.size(); ++c)
    mapped.extinction[c / columns * columns + map.column(c % columns)] = field.extinction[c];
  const SceneSun sun = sun_at(.6, 37);
  SolverOptions options = field_options();
  options.tolerance = 1e-6;
  options.gather_directions = 1024;  // they and the places their rays start from do not turn
  Problem problem = field_problem(field, .99, PhaseFunction::henyey_greenstein(.85), sun);
  problem.surface.albedo = .5;
  const Solution here = solve(problem, options);
  const Direction travel = map.direction(problem.sun->travel);
  problem.grid = field_problem(mapped, .99, PhaseFunction::henyey_greenstein(.85), sun).grid;
  problem.sun->travel = travel;
  const Solution there = solve(problem, options);

  Worst mean, column;
  for (std::size_t e = 0; e < here.profile_upwelling_flux.size(); ++e) {
    mean.meet(here.profile_upwelling_flux[e], there.profile_upwelling_flux[e]);
    mean.meet(here.profile_downwelling_diffuse_flux[e], there.profile_downwelling_diffuse_flux[e]);
    mean.meet(here.profile_direct_flux[e], there.profile_direct_flux[e]);
  }
  for (const auto flux : {&Solution::upwelling_flux, &Solution::downwelling_diffuse_flux, &Solution::direct_flux}) {
    double squares = 0;
    const std::vector<float>& one = here.*flux;
    const std::vector<float>& other = there.*flux;
    for (std::size_t c = 0; c < one.size(); ++c) {
      const double off = one[c] - other[c / columns * columns + map.column(c % columns)];
      squares += off * off / static_cast<double>(one.size());
    }
    column.meet(std::sqrt(squares));
  }
  return {mean.value(), column.value()};
}

double shift_columns() { return under({1, 0, 0, 1, 2, 5}).column; }

double mirror_means() {
  Worst worst;
  worst.meet(under({-1, 0, 0, 1, 0, 0}).mean);
  worst.meet(under({1, 0, 0, -1, 0, 0}).mean);
  return worst.value();
}

MapDeviation transposed() {
  Worst mean, column;
  for (const Map& map : {Map{0, -1, 1, 0, 0, 0}, Map{0, 1, 1, 0, 0, 0}}) {
    const MapDeviation deviation = under(map);
    mean.meet(deviation.mean);
    column.meet(deviation.column);
  }
  return {mean.value(), column.value()};
}

}  // namespace

std::vector<PhysicalCheck> direction_checks() {
  return {
      // Rays are an eighth of a column (1 m) apart and are shared out over whole columns: a fraction of an eighth.
      {"shadow", "a shadow lies on the side away from the sun, as far off as what casts it is high", "m", .03, shadow},
      // The same; light that the voxel scatters twice, some 1 %, comes from its own location too.
      {"parallax", "a slanted sensor sees what is low through the top nearer to itself", "m", .01, parallax},
      // The same arithmetic column by column; sums over columns round elsewhere.
      {"shift", "a field moved round the periodic box has its fluxes moved", "W m-2, F0 = 1", 1e-6, shift_columns},
      // Ordinates and control points map onto themselves; float rounds elsewhere, on the way to a tolerance of 1e-6.
      {"mirror", "a field mirrored with its sun has the same mean fluxes", "W m-2, F0 = 1", 2e-6, mirror_means},
      // Control points do not: their fits differ, by 5e-4 with the 42 of `draft`, column by column by 3e-3.
      {"turn", "a field turned by 90 degrees, or with x and y exchanged, has the same mean fluxes", "W m-2, F0 = 1",
       1e-3, [] { return transposed().mean; }},
      {"turn-columns", "and its columns have the same fluxes", "W m-2, F0 = 1", 5e-3,
       [] { return transposed().column; }},
  };
}

}  // namespace cloudbow
