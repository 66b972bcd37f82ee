// A few g-points in place of all, in three dimensions (docs/theory.md, "Few g-points"). The clouds are those of
// `cloudbow cloud make`, under two suns and in the longwave. Truth: the sum over all g-points with the same directions.
// Prints the errors of columns and of heating rates beside the residual that foretells them.
//
// usage: few_points stratocumulus|cumulus SEED [SOLAR LONGWAVE]
//   SOLAR, LONGWAVE  text files of g-points (read_gas). Without them the gas is made up.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fstream>
#include <functional>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "app/planning/column_answers.hpp"
#include "cloudbow/medium/cloud_makers.hpp"
#include "cloudbow/medium/emission.hpp"
#include "cloudbow/transport/output_fields.hpp"
#include "cloudbow/transport/probe_columns.hpp"
#include "cloudbow/transport/solver.hpp"

namespace {

using namespace cloudbow;
using Clock = std::chrono::steady_clock;

constexpr double pi = std::numbers::pi;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

// Optics of one g-point.
struct Point {
  double share = 0;  // of the irradiance of the sun
  double cloud = 1;  // extinction of the cloud, relative to that of the field
  double single_scattering_albedo = 1;
  double asymmetry_parameter = .85;
  double surface_albedo = .06;
  std::vector<double> absorption, rayleigh;  // optical depths of layers
  std::function<double(double)> planck;
};

struct Gas {
  std::vector<double> edges_m, temperature_k, pressure_pa;
  std::vector<Point> points;

  double at(const std::vector<double>& profile, double z) const {
    const auto above = std::clamp<std::ptrdiff_t>(std::upper_bound(edges_m.begin(), edges_m.end(), z) - edges_m.begin(),
                                                  1, static_cast<std::ptrdiff_t>(edges_m.size()) - 1);
    const double share = (z - edges_m[above - 1]) / (edges_m[above] - edges_m[above - 1]);
    return profile[above - 1] + share * (profile[above] - profile[above - 1]);
  }
  double temperature(double z) const { return at(temperature_k, z); }
  double density(double z) const { return at(pressure_pa, z) / (287.05 * temperature(z)); }
};

// Gas from transparent to opaque, between clouds that scatter as differently as they can.
Gas made_up_gas(bool longwave) {
  constexpr int points = 24;
  // Some number in [0, 1), without pattern.
  const auto number = [](int g, double factor) { return factor * (g + 1) - std::floor(factor * (g + 1)); };
  Gas gas;
  for (int k = 0; k <= 20; ++k) gas.edges_m.push_back(200 * k);
  for (int k = 5; k <= 20; ++k) gas.edges_m.push_back(1000 * k);
  for (const double z : gas.edges_m) {
    gas.temperature_k.push_back(std::max(210., 290 - .0065 * z));
    gas.pressure_pa.push_back(1e5 * std::exp(-z / 8000));
  }
  double sum = 0;
  for (int g = 0; g < points; ++g) {
    Point point;
    const double depth = 1e-4 * std::pow(1e6, g / (points - 1.)), height = g % 3 == 2 ? 8000 : 2000;
    point.share = (1.2 - g / static_cast<double>(points)) * (.3 + number(g, .618034));
    sum += point.share;
    point.cloud = longwave ? .5 + .5 * number(g, .414214) : 1 + .05 * number(g, .414214);
    point.single_scattering_albedo =
        longwave ? .35 + .35 * number(g, .732051) : 1 - std::pow(10, -6 + 5 * number(g, .732051));
    point.asymmetry_parameter = longwave ? .9 : .85;
    point.surface_albedo = longwave ? .02 : .05 + .2 * number(g, .88);
    for (std::size_t e = 0; e + 1 < gas.edges_m.size(); ++e) {
      const auto share = [&](double h) { return std::exp(-gas.edges_m[e] / h) - std::exp(-gas.edges_m[e + 1] / h); };
      point.absorption.push_back(depth * share(height));
      point.rayleigh.push_back(longwave ? 0 : .1 * number(g, .259921) * share(8000));
    }
    const double slope = 3 * (number(g, .324718) - .3), share = point.share;
    point.planck = [=](double t) {
      return share / 15 * 5.67e-8 * std::pow(t, 4) / pi * std::exp(slope * (t / 288 - 1));
    };
    gas.points.push_back(point);
  }
  for (Point& point : gas.points) point.share /= sum;
  return gas;
}

// Numbers: g-points, edges of layers, temperatures n of Planck radiances (0: sunlight). Then heights [m], temperatures
// [K] and pressures [Pa] of the edges. Then for each g-point: share of the irradiance, extinction, single-scattering
// albedo and asymmetry parameter of the cloud; optical depths of absorption; of scattering; n Planck radiances at
// 120 K, 121 K and so on.
Gas read_gas(const char* name) {
  std::ifstream file(name);
  std::size_t points = 0, edges = 0, temperatures = 0;
  file >> points >> edges >> temperatures;
  const auto numbers = [&](std::size_t n) {
    std::vector<double> values(n);
    for (double& v : values) file >> v;
    return values;
  };
  Gas gas{numbers(edges), numbers(edges), numbers(edges), {}};
  for (std::size_t g = 0; g < points; ++g) {
    const std::vector<double> cloud = numbers(4);
    Point point{cloud[0],           cloud[1],           cloud[2], cloud[3], temperatures > 0 ? .02 : .06,
                numbers(edges - 1), numbers(edges - 1), {}};
    const std::vector<double> planck = numbers(temperatures);
    point.planck = [planck](double t) {
      const auto i = static_cast<std::size_t>(t - 120);
      const double share = t - 120 - static_cast<double>(i);
      return planck.at(i) + share * (planck.at(i + 1) - planck.at(i));
    };
    gas.points.push_back(point);
  }
  if (!file) throw std::runtime_error(fmt::format("{}: not a table of g-points", name));
  return gas;
}

struct Light {
  std::string name;
  double mu0;  // 0: longwave
};

Problem make_problem(const CloudField& cloud, const Light& light, const Gas& gas, const Point& point) {
  CloudOptics optics;
  optics.extinction_per_value = point.cloud;
  optics.single_scattering_albedo = point.single_scattering_albedo;
  std::vector<Layer> layers;
  for (std::size_t e = 0; e + 1 < gas.edges_m.size(); ++e) {
    const double depth = std::max(point.absorption[e] + point.rayleigh[e], 1e-12);
    layers.push_back({gas.edges_m[e], gas.edges_m[e + 1], depth, point.rayleigh[e] / depth, 1});
  }
  LevelOptions levels;
  levels.air = AirCells::automatic;
  levels.max_optical_depth = levels.edge_optical_depth = 1e9;  // the same levels for all g-points
  Problem problem;
  problem.phase = {PhaseFunction::henyey_greenstein(point.asymmetry_parameter), PhaseFunction::henyey_greenstein(0)};
  const std::array<double, 3> corner{cloud.max_m(0), cloud.max_m(1), gas.edges_m.back()};
  problem.grid = make_optical_grid(&cloud, optics, layers, {0, 0, 0}, corner, true, 2, {.5, 0}, levels);
  problem.surface.albedo = point.surface_albedo;
  if (light.mu0 == 0) {
    set_emission(
        problem.grid, [&](double z) { return gas.temperature(z); }, point.planck);
    problem.surface.planck = point.planck(gas.temperature(0) + 2);
  } else {
    problem.sun = Sun{{std::sqrt(1 - light.mu0 * light.mu0), 0, -light.mu0}, 1361 * point.share};
  }
  return problem;
}

// Sums over g-points.
struct Fields {
  std::vector<double> up, down, absorbed, profile;  // [columns] W m-2; [levels] K/day
  std::vector<double> heating;                      // [levels, columns] W m-3
};

Fields fields_of(const Solution& solution, const Gas& gas) {
  const std::size_t columns = solution.box.columns();
  Fields fields;
  fields.absorbed.assign(columns, 0.);
  const std::size_t top = solution.upwelling_flux.size() - columns;
  for (std::size_t c = 0; c < columns; ++c) {
    fields.up.push_back(solution.upwelling_flux[top + c]);
    fields.down.push_back(static_cast<double>(solution.downwelling_diffuse_flux[c]) +
                          static_cast<double>(solution.direct_flux[c]));
  }
  for (int k = 0; k < solution.box.nz(); ++k) {
    double mean = 0;
    for (std::size_t c = 0; c < columns; ++c) {
      const double absorbed = solution.absorbed_power[static_cast<std::size_t>(k) * columns + c];
      fields.absorbed[c] += absorbed * solution.box.thickness_m(k);
      mean += absorbed / static_cast<double>(columns);
      fields.heating.push_back(absorbed);
    }
    const double z = .5 * (solution.box.z_edge_m[k] + solution.box.z_edge_m[k + 1]);
    fields.profile.push_back(mean / gas.density(z) / 1004 * 86400);
  }
  return fields;
}

void add(std::vector<double>& sum, double factor, const std::vector<double>& value) {
  sum.resize(value.size());
  for (std::size_t i = 0; i < value.size(); ++i) sum[i] += factor * value[i];
}

void add(Fields& sum, double factor, const Fields& fields) {
  add(sum.up, factor, fields.up);
  add(sum.down, factor, fields.down);
  add(sum.absorbed, factor, fields.absorbed);
  add(sum.profile, factor, fields.profile);
  add(sum.heating, factor, fields.heating);
}

void add_missing(const LevelMeans& missing, const BoxGrid& box, const Gas& gas, Fields& fields) {
  const std::size_t columns = fields.up.size();
  for (std::size_t c = 0; c < columns; ++c) {
    fields.up[c] += missing.up.back();
    fields.down[c] += missing.down_diffuse.front() + missing.direct.front();
  }
  for (int k = 0; k < box.nz(); ++k) {
    const double absorbed = missing.absorbed[k];
    const double z = .5 * (box.z_edge_m[k] + box.z_edge_m[k + 1]);
    fields.profile[k] += absorbed / gas.density(z) / 1004 * 86400;
    for (std::size_t c = 0; c < columns; ++c) {
      fields.absorbed[c] += absorbed * box.thickness_m(k);
      fields.heating[static_cast<std::size_t>(k) * columns + c] += absorbed;
    }
  }
}

double mean(const std::vector<double>& a) {
  double sum = 0;
  for (const double v : a) sum += v;
  return sum / static_cast<double>(a.size());
}
double rms(const std::vector<double>& a, const std::vector<double>& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) sum += (a[i] - b[i]) * (a[i] - b[i]);
  return std::sqrt(sum / static_cast<double>(a.size()));
}

// RMS below a height, % of the largest there.
double profile_error(const std::vector<double>& a, const std::vector<double>& truth, const BoxGrid& box, double below) {
  double sum = 0, most = 0;
  int n = 0;
  for (std::size_t k = 0; k < a.size() && box.z_edge_m[k + 1] <= below; ++k, ++n) {
    sum += (a[k] - truth[k]) * (a[k] - truth[k]);
    most = std::max(most, std::abs(truth[k]));
  }
  return 100 * std::sqrt(sum / n) / most;
}

void print_errors(const std::string& name, double residual, const Fields& fields, const Fields& truth,
                  const BoxGrid& box) {
  const auto relative = [](const std::vector<double>& a, const std::vector<double>& b) {
    return 100 * rms(a, b) / std::abs(mean(b));
  };
  const std::vector<double> none(truth.heating.size(), 0.);
  fmt::print("{:>9} {:9.2e} | {:7.3f} {:7.3f} {:7.3f} % | {:6.3f} {:6.3f} {:6.3f} W m-2 | {:6.3f} {:6.3f} | {:6.3f}\n",
             name, residual, relative(fields.up, truth.up), relative(fields.down, truth.down),
             relative(fields.absorbed, truth.absorbed), rms(fields.up, truth.up), rms(fields.down, truth.down),
             rms(fields.absorbed, truth.absorbed), profile_error(fields.profile, truth.profile, box, 3000),
             profile_error(fields.profile, truth.profile, box, 1e9),
             100 * rms(fields.heating, truth.heating) / rms(truth.heating, none));
}

void run(const CloudField& cloud, const Light& light, const Gas& gas) {
  SolverOptions options;
  options.control_points = 42;
  options.directions = "double-gauss-6x8";
  options.fit.delta_m_order = 6;
  options.fit.beam_delta_m_order = 8;
  options.fit.exact_moments = 2;
  options.fit.beam_half_range_rows = 2;
  options.gather_directions = 64;
  options.beam_rays = 4;
  options.flux_levels = FluxLevels::boundaries;
  Fields truth, of_columns;
  std::vector<Fields> fields;
  std::vector<ColumnAnswers> answers;
  BoxGrid box;
  double seconds_3d = 0, seconds_answers = 0;
  std::vector<std::size_t> columns;
  for (std::size_t g = 0; g < gas.points.size(); ++g) {
    const Problem problem = make_problem(cloud, light, gas, gas.points[g]);
    box = problem.grid.box;
    if (columns.empty()) columns = representative_columns(problem.grid, columns_of_choice);
    auto start = Clock::now();
    answers.push_back(column_answers(problem, options, columns));
    seconds_answers += seconds_since(start);
    start = Clock::now();
    const Solution solution = solve(problem, options);
    seconds_3d += seconds_since(start);
    if (!solution.report.converged)
      fmt::print("g {} not converged: {:.1e} {:.1e}\n", g, solution.report.estimated_error, solution.ledger.residual);
    fields.push_back(fields_of(solution, gas));
    add(truth, 1, fields.back());
    SolverOptions independent = options;
    independent.independent_columns = true;
    add(of_columns, 1, fields_of(solve(problem, independent), gas));
  }
  fmt::print("\n{}: {} levels, up {:.1f} down {:.1f} absorbed {:.2f} W m-2; all in 3D {:.1f} s, answers {:.2f} s\n",
             light.name, box.nz(), mean(truth.up), mean(truth.down), mean(truth.absorbed), seconds_3d, seconds_answers);
  fmt::print(
      "   points  residual |      up    down absorbed |    up   down absorbed       | heating < 3 km, all | voxels\n");
  print_errors("columns", 0, of_columns, truth, box);
  for (int k = 4; k <= 10; ++k) {
    const SpectralChoice choice = choose_points(answers, 0, k);
    Fields sum;
    for (std::size_t i = 0; i < choice.point.size(); ++i)
      add(sum, choice.weight[i] / answers[choice.point[i]].power, fields[choice.point[i]]);
    print_errors(std::to_string(choice.point.size()), choice.residual, sum, truth, box);
    add_missing(choice.missing, box, gas, sum);
    print_errors("+ missing", choice.residual, sum, truth, box);
  }
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CloudMakerOptions maker;
  maker.kind = argc > 1 ? argv[1] : "cumulus";
  maker.seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 77;
  maker.cells = {20, 20, 24};
  maker.voxel_size_m = {100, 100, maker.kind == "stratocumulus" ? 40. : 100.};
  const CloudField cloud = make_cloud(maker);
  const Gas solar = argc > 3 ? read_gas(argv[3]) : made_up_gas(false);
  const Gas longwave = argc > 4 ? read_gas(argv[4]) : made_up_gas(true);
  run(cloud, {"sun at a cosine of .85", .85}, solar);
  run(cloud, {"sun at a cosine of .4", .4}, solar);
  run(cloud, {"longwave", 0}, longwave);
}
