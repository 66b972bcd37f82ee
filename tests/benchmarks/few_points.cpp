// A few g-points in place of all, in three dimensions (docs/theory.md, "Few g-points"): made-up gas of 24 g-points in
// the clouds of `cloudbow cloud make`, under two suns and in the longwave. Truth: the sum over all g-points with the
// same directions. Prints the errors of columns and of the heating profile beside the residual that foretells them.
//
// usage: few_points [stratocumulus|cumulus] [seed] [HEATING_ROWS]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <numbers>
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

constexpr int g_points = 24;
constexpr double pi = std::numbers::pi;

double seconds_since(Clock::time_point start) { return std::chrono::duration<double>(Clock::now() - start).count(); }

double air_temperature(double z) { return std::max(210., 290 - .0065 * z); }
double air_density(double z) { return 1.2 * std::exp(-z / 8500); }

// Some number in [0, 1), without pattern.
double scatter(int g, double factor) {
  const double value = factor * (g + 1);
  return value - std::floor(value);
}

struct Spectrum {
  // Gas from transparent to opaque.
  static double gas_depth(int g) { return 1e-4 * std::pow(1e6, g / (g_points - 1.)); }
  static double scale_height(int g) { return g % 3 == 2 ? 8000 : 2000; }
  static double share(int g) {
    const auto raw = [](int i) { return (1.2 - i / double(g_points)) * (.3 + scatter(i, .618034)); };
    double sum = 0;
    for (int i = 0; i < g_points; ++i) sum += raw(i);
    return raw(g) / sum;
  }
};

struct Light {
  std::string name;
  double mu0;  // 0: longwave
};

Problem make_problem(const CloudField& cloud, double top_m, const Light& light, int g) {
  const bool longwave = light.mu0 == 0;
  CloudOptics optics;
  optics.extinction_per_value = longwave ? .5 + .5 * scatter(g, .414214) : 1 + .05 * scatter(g, .414214);
  optics.single_scattering_albedo =
      longwave ? .35 + .35 * scatter(g, .732051) : 1 - std::pow(10, -6 + 5 * scatter(g, .732051));
  std::vector<Layer> layers;
  const std::vector<double> edges{0, 500, 1000, 1500, 2000, 3000, 5000, 8000, 12000, top_m};
  const double h = Spectrum::scale_height(g);
  for (std::size_t e = 0; e + 1 < edges.size(); ++e) {
    const double share = std::exp(-edges[e] / h) - std::exp(-edges[e + 1] / h);
    const double air = std::exp(-edges[e] / 8000) - std::exp(-edges[e + 1] / 8000);
    const double absorption = Spectrum::gas_depth(g) * share, rayleigh = longwave ? 0 : .1 * scatter(g, .259921) * air;
    layers.push_back({edges[e], edges[e + 1], absorption + rayleigh, rayleigh / (absorption + rayleigh), 1});
  }
  LevelOptions levels;
  levels.air = AirCells::automatic;
  for (double z = 200; z < 4000; z += 200) levels.edges_m.push_back(z);
  for (double z = 4000; z < top_m; z += 1000) levels.edges_m.push_back(z);
  levels.max_optical_depth = levels.edge_optical_depth = 1e9;  // the same levels for all g-points
  const PhaseFunction rayleigh = PhaseFunction::henyey_greenstein(0);
  Problem problem;
  problem.phase = {PhaseFunction::henyey_greenstein(longwave ? .9 : .85 + .02 * std::floor(2 * scatter(g, .5))),
                   rayleigh};
  const std::array<double, 3> corner{cloud.max_m(0), cloud.max_m(1), top_m};
  problem.grid = make_optical_grid(&cloud, optics, layers, {0, 0, 0}, corner, true, 2, {.5, 0}, levels);
  problem.surface.albedo = longwave ? .02 : .05 + .2 * scatter(g, .88);
  if (longwave) {
    const double slope = 3 * (scatter(g, .324718) - .3);
    const auto planck = [&](double t) {
      return Spectrum::share(g) * 5.67e-8 * std::pow(t, 4) / pi * std::exp(slope * (t - 288) / 288);
    };
    set_emission(problem.grid, air_temperature, planck);
    problem.surface.planck = planck(291);
  } else {
    problem.sun = Sun{{std::sqrt(1 - light.mu0 * light.mu0), 0, -light.mu0}, 1361 * Spectrum::share(g)};
  }
  return problem;
}

// Sums over g-points.
struct Fields {
  std::vector<double> up, down, absorbed, profile, cloud_heating;  // W m-2; [columns] and [levels] K s-1
  std::vector<double> heating;                                     // [levels, columns] W m-3
};

Fields fields_of(const Solution& solution) {
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
    fields.profile.push_back(mean / air_density(z) / 1004 * 86400);
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

void run(const CloudField& cloud, const Light& light, bool heating_rows) {
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
  for (int g = 0; g < g_points; ++g) {
    const Problem problem = make_problem(cloud, 20000, light, g);
    box = problem.grid.box;
    if (columns.empty()) columns = representative_columns(problem.grid, columns_of_choice);
    auto start = Clock::now();
    answers.push_back(column_answers(problem, options, columns));
    if (!heating_rows) answers.back().heating.clear();
    seconds_answers += seconds_since(start);
    start = Clock::now();
    const Solution solution = solve(problem, options);
    seconds_3d += seconds_since(start);
    if (!solution.report.converged)
      fmt::print("g {} not converged: {:.1e} {:.1e}\n", g, solution.report.estimated_error, solution.ledger.residual);
    fields.push_back(fields_of(solution));
    add(truth, 1, fields.back());
    SolverOptions independent = options;
    independent.independent_columns = true;
    add(of_columns, 1, fields_of(solve(problem, independent)));
  }
  fmt::print("\n{}: {} levels, up {:.1f} down {:.1f} absorbed {:.2f} W m-2; all in 3D {:.1f} s, answers {:.2f} s\n",
             light.name, box.nz(), mean(truth.up), mean(truth.down), mean(truth.absorbed), seconds_3d, seconds_answers);
  fmt::print(
      "   points  residual |      up    down absorbed |    up   down absorbed       | heating < 3 km, all | voxels\n");
  print_errors("columns", 0, of_columns, truth, box);
  const auto start = Clock::now();
  for (int k = 3; k <= 10; ++k) {
    const SpectralChoice choice = choose_points(answers, 0, k);
    Fields sum;
    for (std::size_t i = 0; i < choice.point.size(); ++i)
      add(sum, choice.weight[i] / answers[choice.point[i]].power, fields[choice.point[i]]);
    print_errors(std::to_string(choice.point.size()), choice.residual, sum, truth, box);
  }
  fmt::print("choices {:.3f} s\n", seconds_since(start));
  std::fflush(stdout);
}

}  // namespace

int main(int argc, char** argv) {
  CloudMakerOptions maker;
  maker.kind = argc > 1 ? argv[1] : "cumulus";
  maker.seed = argc > 2 ? std::strtoull(argv[2], nullptr, 10) : 77;
  const bool heating_rows = argc <= 3 || argv[3][0] != '0';
  maker.cells = {32, 32, 24};
  maker.voxel_size_m = {100, 100, 100};
  if (maker.kind == "stratocumulus") maker.voxel_size_m = {100, 100, 40};
  const CloudField cloud = make_cloud(maker);
  for (const Light& light : {Light{"sun .85", .85}, Light{"sun .4", .4}, Light{"longwave", 0}})
    run(cloud, light, heating_rows);
  return 0;
}
