// Where light goes to: shadows, sensors, scenes that are shifted, mirrored and turned together with their sun.
#include <cmath>
#include <numbers>

#include "checks.hpp"
#include "scenes.hpp"

namespace cloudbow {
namespace {

constexpr int kWidth = 9;   // columns along x and y
constexpr int kHeight = 4;  // levels
const double kTangent = 1;  // of the zenith angle
const double kCosine = std::sqrt(.5);

// One voxel in an empty box, k levels above the ground.
ExtinctionField one_voxel(int k, float extinction) {
  ExtinctionField field{kWidth, kWidth, kHeight, std::vector<float>(kWidth * kWidth * kHeight, 0.F)};
  field.extinction[(static_cast<std::size_t>(k) * kWidth + kWidth / 2) * kWidth + kWidth / 2] = extinction;
  return field;
}

// Distance [m] of the centre of gravity of a plane of columns from where it should be.
template <class Weight>
double centre_off(const Weight& weight, double x, double y) {
  double sum = 0, sum_x = 0, sum_y = 0;
  for (int j = 0; j < kWidth; ++j) {
    for (int i = 0; i < kWidth; ++i) {
      const double w = weight(static_cast<std::size_t>(j * kWidth + i));
      sum += w;
      sum_x += w * (i + .5);
      sum_y += w * (j + .5);
    }
  }
  return std::hypot(sum_x / sum - x, sum_y / sum - y);
}

constexpr std::array<double, 6> kAzimuths{0, 90, 180, 270, 30, 205};

// The shadow of a voxel lies on the side away from the sun, as far off as the voxel is high.
double shadow() {
  Worst worst;
  for (const double azimuth : kAzimuths) {
    const Solution solution =
        solve(field_problem(one_voxel(3, 1), 0, PhaseFunction::isotropic(), sun_at(kCosine, azimuth)), field_options());
    const double angle = azimuth * std::numbers::pi / 180;
    const double off = 3.5 * kTangent;
    worst.meet(centre_off([&](std::size_t c) { return kCosine - static_cast<double>(solution.direct_flux[c]); },
                          4.5 - off * std::cos(angle), 4.5 - off * std::sin(angle)));
  }
  return worst.value();
}

// A sensor sees a voxel near the ground, along a slanted line, through the top nearer to itself.
double parallax() {
  SolverOptions options = field_options();
  for (const double azimuth : kAzimuths) options.views.push_back({"view", travel_to_sensor(kCosine, azimuth)});
  const Solution solution =
      solve(field_problem(one_voxel(0, .01F), 1, PhaseFunction::isotropic(), sun_at(1, 0)), options);
  Worst worst;
  for (std::size_t v = 0; v < kAzimuths.size(); ++v) {
    const double angle = kAzimuths[v] * std::numbers::pi / 180;
    const double off = 3.5 * kTangent;
    worst.meet(centre_off([&](std::size_t c) { return static_cast<double>(solution.images.at(v).radiance.at(c)); },
                          4.5 + off * std::cos(angle), 4.5 + off * std::sin(angle)));
  }
  return worst.value();
}

// ---- maps of a square field onto itself -----------------------------------------------------------------------------

constexpr int kSide = 6;

// x' = xx x + xy y, y' = yx x + yy y about the field's centre, then a shift by columns, round the periodic box.
struct Map {
  int xx, xy, yx, yy, shift_x, shift_y;

  std::size_t column(std::size_t c) const {
    const int x = 2 * (static_cast<int>(c) % kSide) - (kSide - 1);
    const int y = 2 * (static_cast<int>(c) / kSide) - (kSide - 1);
    const auto place = [](int doubled, int shift) { return ((doubled + kSide - 1) / 2 + shift) % kSide; };
    return static_cast<std::size_t>(place(yx * x + yy * y, shift_y) * kSide + place(xx * x + xy * y, shift_x));
  }
  Direction direction(const Direction& d) const { return {xx * d.x() + xy * d.y(), yx * d.x() + yy * d.y(), d.z()}; }
};

struct MapDeviation {
  double mean = 0;    // of domain means, W m-2 of an irradiance of 1
  double column = 0;  // RMS over columns
};

MapDeviation under(const Map& map) {
  constexpr std::size_t columns = kSide * kSide;
  const ExtinctionField field = uneven_field(kSide, kSide, 4, 3);
  ExtinctionField mapped = field;
  for (std::size_t c = 0; c < field.extinction.size(); ++c)
    mapped.extinction[c / columns * columns + map.column(c % columns)] = field.extinction[c];
  const SceneSun sun = sun_at(.6, 37);
  SolverOptions options = field_options();
  options.tolerance = 1e-6;
  options.gather_directions = 1024;  // they and the places their rays start from do not turn
  Problem problem = field_problem(field, .99, PhaseFunction::henyey_greenstein(.85), sun);
  const Solution here = solve(problem, options);
  const Direction travel = map.direction(problem.sun->travel);
  problem = field_problem(mapped, .99, PhaseFunction::henyey_greenstein(.85), sun);
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

MapDeviation turned() {
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
      // Rays stand a quarter of a column (1 m) apart, and the voxel is not black: a part of that.
      {"shadow", "a shadow lies on the side away from the sun, as far off as what casts it is high", "m", .05, shadow},
      // A pixel is the mean of a few lines of sight; light scattered twice by the voxel is 1 %.
      {"parallax", "a slanted sensor sees what is low through the top nearer to itself", "m", .05, parallax},
      // The same arithmetic column by column; sums over columns round elsewhere.
      {"shift", "a field moved round the periodic box has its fluxes moved", "W m-2, F0 = 1", 1e-6, shift_columns},
      // Ordinates and control points map onto themselves; float rounds elsewhere, on the way to a tolerance of 1e-6.
      {"mirror", "a field mirrored with its sun has the same mean fluxes", "W m-2, F0 = 1", 2e-6, mirror_means},
      // Control points do not: their fits differ, by 5e-4 with the 42 of `draft`, column by column by 3e-3.
      {"turn", "a field turned by 90 degrees, or with x and y exchanged, has the same mean fluxes", "W m-2, F0 = 1",
       1e-3, [] { return turned().mean; }},
      {"turn-columns", "and its columns have the same fluxes", "W m-2, F0 = 1", 5e-3, [] { return turned().column; }},
  };
}

}  // namespace cloudbow
