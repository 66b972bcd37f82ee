#include "transport/driver/path_load.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "cloudbow/core/error.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"
#include "cloudbow/transport/solve_plan.hpp"
#include "transport/observers/viewing_source.hpp"
#include "transport/rays/direct_beam.hpp"
#include "transport/rays/path_pattern.hpp"

namespace cloudbow {
namespace {

// A pattern of so many segments takes 360 MB, and a plane of 1000 columns seconds for each direction.
constexpr double most_segments = 5e6;
// Limit relative to the power through the top, to which energy ledgers are relative.
constexpr double most_through_sides = 1000;
// In float the optical path of a beam gains a relative error of up to 6e-8 per segment. The energy ledger gains an
// error of 1e-7 of the power that comes through the sides.
constexpr double longest_beam_in_float = 2e5;
constexpr double most_through_sides_in_float = 100;

bool stays_in_column(const SolverOptions& options) {
  return options.independent_columns && !options.beam_crosses_columns;
}

[[noreturn]] void fail(const char* what, double segments, double most, const BoxGrid& box, const std::string& way_out) {
  throw InputError(
      fmt::format("{}: a ray crosses too many cells (found {:.2g} in {:g} m of height and cells of {:g} m by {:g} m, "
                  "allowed {:.0e}) {}",
                  what, segments, box.z_edge_m.back() - box.z_edge_m.front(), box.dx_m, box.dy_m, most, way_out));
}

// Power that the sun sends through the sides of an open domain, over that through its top.
double through_sides(const Problem& problem, const SolverOptions& options) {
  const BoxGrid& box = problem.grid.box;
  if (!problem.sun || box.periodic || options.independent_columns) return 0;
  const double height = box.z_edge_m.back() - box.z_edge_m.front();
  const Direction& travel = problem.sun->travel;
  return height / std::abs(travel.z()) *
         (std::abs(travel.x()) / (box.nx * box.dx_m) + std::abs(travel.y()) / (box.ny * box.dy_m));
}

}  // namespace

double PathLoad::bytes(int threads) const {
  constexpr int beams_at_once = 4;  // direct_beam() shares its rays out over so many sums
  const double at_once = std::max(longest_diffuse * threads, beam * std::min(threads, beams_at_once));
  return sizeof(Segment) * (ordinates + at_once);
}

double beam_segments(const Problem& problem, const SolverOptions& options) {
  if (!problem.sun || stays_in_column(options)) return 0;
  return pattern_segments(problem.grid.box, problem.sun->travel, false, {0, problem.grid.box.nz()});
}

bool beam_needs_double(const Problem& problem, const SolverOptions& options) {
  return beam_segments(problem, options) > longest_beam_in_float ||
         through_sides(problem, options) > most_through_sides_in_float;
}

PathLoad path_load(const SolvePlan& plan) {
  const Problem& problem = plan.problem();
  const SolverOptions& options = plan.options();
  const BoxGrid& box = problem.grid.box;
  const LevelRange levels{0, box.nz()};
  PathLoad load;
  load.beam = beam_segments(problem, options);
  if (plan.by_polar_streams()) return load;
  const bool independent_columns = options.independent_columns;
  const auto length = [&](const Direction& travel) {
    return pattern_segments(box, travel, independent_columns, levels);
  };
  for (const Direction& d : make_ordinate_set(options.directions).direction) {
    load.longest_diffuse = std::max(load.longest_diffuse, length(d));
    // Directions that are marched along x or y cross two or three cells a sheet.
    const double cells = box.nx + box.ny + box.nz();
    load.ordinates += may_march_sideways(box, independent_columns) ? std::min(length(d), 3 * cells) : length(d);
  }
  if (!independent_columns) {  // the final gather's lowest direction
    const double mu = std::sqrt(.5 / options.gather_directions);
    const double sine = std::sqrt((1 - mu * mu) / 2);
    load.longest_diffuse = std::max(load.longest_diffuse, length({sine, sine, mu}));
  }
  for (const View& view : options.views) {
    if (view.width == 0) load.longest_diffuse = std::max(load.longest_diffuse, length(view.travel));
  }
  if (problem.sun && options.circumsolar_half_angle > 0) {
    const Direction& sun = problem.sun->travel;
    const double lowest = std::acos(-sun.z()) + options.circumsolar_half_angle;
    const double azimuth = std::atan2(sun.y(), sun.x());
    const Direction travel(std::sin(lowest) * std::cos(azimuth), std::sin(lowest) * std::sin(azimuth),
                           std::min(0., -std::cos(lowest)));
    load.longest_diffuse = std::max(load.longest_diffuse, length(off_the_horizon(travel)));
  }
  return load;
}

void check_paths(const SolvePlan& plan) {
  const Problem& problem = plan.problem();
  const SolverOptions& options = plan.options();
  const BoxGrid& box = problem.grid.box;
  const PathLoad load = path_load(plan);
  // Columns without azimuths have their beam in float.
  const double most_of_beam = options.independent_columns ? longest_beam_in_float : most_segments;
  if (load.beam > most_of_beam) {
    const double tangent = std::tan(std::acos(-problem.sun->travel.z())) * most_of_beam / load.beam;
    const double zenith = std::floor(std::atan(tangent) * 180e4 / std::numbers::pi) / 1e4;
    fail("sun", load.beam, most_of_beam, box,
         fmt::format("a zenith angle of at most {:.4f} degrees, wider cells, or solver.mode = "
                     "\"independent-columns\"",
                     zenith));
  }
  if (load.longest_diffuse > most_segments) {
    fail("directions", load.longest_diffuse, most_segments, box,
         "wider cells, or solver.mode = \"independent-columns\"");
  }
  if (through_sides(problem, options) > most_through_sides) {
    throw InputError(
        fmt::format("sun: an open domain is lit through its sides alone (found {:.2g} times the power through its top, "
                    "allowed {:g}); a higher sun, a wider domain, or domain.boundary = \"periodic\"",
                    through_sides(problem, options), most_through_sides));
  }
}

}  // namespace cloudbow
