// Cost of a scattering table: one column, all columns of a level of accuracy (HG .85 with a beam, one thread), and
// a table that is in the cache; a surface's reflection table.
#include <benchmark/benchmark.h>
#include <omp.h>
#include <stdlib.h>

#include <filesystem>
#include <string>

#include "cloudbow/optics/phase_fit.hpp"
#include "cloudbow/optics/reflection_table.hpp"
#include "cloudbow/optics/scattering_table.hpp"

namespace {

using namespace cloudbow;

struct Level {
  const char* name;
  const char* ordinates;
  int control_points, delta_m_order, beam_delta_m_order, exact_moments, half_range_rows;
  bool minimax;
};
// As src/app/accuracy.cpp.
constexpr Level levels[] = {{"draft", "double-gauss-6x8", 42, 6, 8, 2, 2, true},
                            {"balanced", "double-gauss-8x16", 162, 8, 12, 3, 3, true},
                            {"fine", "double-gauss-12x24", 162, 10, 14, 3, 3, true},
                            {"reference", "double-gauss-18x36", 642, 16, 20, 5, 3, false}};

const Direction beam = Direction(0.6, 0.2, -0.5).normalized();

ScatteringTable make_table(const Level& level, const std::filesystem::path& cache) {
  FitOptions options;
  options.delta_m_order = level.delta_m_order;
  options.beam_delta_m_order = level.beam_delta_m_order;
  options.exact_moments = level.exact_moments;
  options.beam_half_range_rows = level.half_range_rows;
  options.minimax = level.minimax;
  options.cache_directory = cache;
  return make_scattering_table(PhaseFunction::henyey_greenstein(0.85), ControlPoints(level.control_points),
                               make_ordinate_set(level.ordinates), beam, options);
}

void fit_column(benchmark::State& state, PhaseFitMethod method) {
  const auto points = static_cast<int>(state.range(0));
  const OrdinateSet ordinates = make_ordinate_set(points == 42 ? "double-gauss-6x8" : "double-gauss-8x16");
  const ControlPoints control_points(points);
  const PhaseFunction phase = delta_m(PhaseFunction::henyey_greenstein(0.85), 8).truncated;
  for (auto _ : state) {
    const auto fits = fit_phase_function(phase, control_points, ordinates, std::span(&method, 1), PhaseFitOptions{});
    state.SetIterationTime(fits.front().seconds);
  }
}

void cold_table(benchmark::State& state) {
  const Level& level = levels[state.range(0)];
  omp_set_num_threads(1);
  FitReport report;
  for (auto _ : state) report = make_table(level, {}).report;
  state.SetLabel(level.name);
  state.counters["programmes"] = report.linear_programmes;
  state.counters["fallbacks"] = report.fallbacks;
}

void table_from_cache(benchmark::State& state) {
  const Level& level = levels[state.range(0)];
  std::string directory = (std::filesystem::temp_directory_path() / "cloudbow-bench-XXXXXX").string();
  if (mkdtemp(directory.data()) == nullptr) return state.SkipWithError("no temporary directory");
  make_table(level, directory);
  for (auto _ : state) benchmark::DoNotOptimize(make_table(level, directory));
  state.SetLabel(level.name);
  std::filesystem::remove_all(directory);
}

// Samples and the quadrature of the interpolant take longer than the fit: a few runs do.
void reflection_table(benchmark::State& state, const SurfaceBrdf& brdf) {
  const OrdinateSet ordinates = make_ordinate_set("double-gauss-8x16");
  for (auto _ : state) benchmark::DoNotOptimize(make_reflection_table(brdf, {}, ordinates, beam));
}

BENCHMARK_CAPTURE(reflection_table, rpv, SurfaceBrdf::rpv(0.1, 0.7, -0.2, 0.1))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(reflection_table, ross_li, SurfaceBrdf::ross_li(0.1, 0.05, 0.02))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(reflection_table, cox_munk, SurfaceBrdf::cox_munk(5, 1.34))->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(fit_column, linear_programming, PhaseFitMethod::linear_programming)
    ->Arg(42)
    ->Arg(162)
    ->UseManualTime()
    ->Iterations(10);
BENCHMARK_CAPTURE(fit_column, bounded, PhaseFitMethod::linear_programming_bounded)
    ->Arg(162)
    ->UseManualTime()
    ->Iterations(10);
BENCHMARK(cold_table)->DenseRange(0, 3)->Unit(benchmark::kMillisecond);
BENCHMARK(table_from_cache)->DenseRange(0, 3)->Unit(benchmark::kMillisecond);

}  // namespace
