// Parts of a solve, on a field of small clouds: one sweep, scattering, moments, the low-order correction, the
// final gather. Items are (cell, ordinate) pairs, so that the inverse rate is the time of one. Beside them, what one
// core of the machine can do: products and sums in registers, and sums of arrays that no cache holds.
#include <benchmark/benchmark.h>
#include <omp.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <filesystem>
#include <vector>

#include "transport/acceleration/low_order_correction.hpp"
#include "transport/observers/flux_fields.hpp"
#include "transport/system/transport_system.hpp"

namespace cloudbow {
namespace {

// Spheres of 9 cells across, at random in the middle of a box of n x n x n/2 cells. A quarter of the cells is cloudy.
OpticalGrid sphere_field(int n) {
  OpticalGrid grid;
  grid.box.nx = grid.box.ny = n;
  grid.box.dx_m = grid.box.dy_m = 50;
  const int levels = n / 2;
  for (int k = 0; k <= levels; ++k) grid.box.z_edge_m.push_back(25. * k);
  std::vector<char> cloudy(static_cast<std::size_t>(n) * n * levels, 0);
  std::uint32_t state = 1;
  const auto random = [&](int below) {
    state = state * 1664525U + 1013904223U;
    return static_cast<int>((state >> 8) % static_cast<std::uint32_t>(below));
  };
  constexpr int radius = 4;
  const int spheres = n * n * levels / 4 / 270;
  for (int s = 0; s < spheres; ++s) {
    const int x = random(n), y = random(n), z = radius + random(levels - 2 * radius);
    for (int k = -radius; k <= radius; ++k) {
      for (int j = -radius; j <= radius; ++j) {
        for (int i = -radius; i <= radius; ++i) {
          if (i * i + j * j + k * k > radius * radius + 2) continue;
          cloudy[(static_cast<std::size_t>(z + k) * n + (y + j + n) % n) * n + (x + i + n) % n] = 1;
        }
      }
    }
  }
  grid.scattering.resize(1);
  grid.layer_absorption.assign(levels, 0.);
  grid.layer_scattering.assign(1, grid.layer_absorption);
  for (int row = 0; row < levels * n; ++row) {
    grid.row_begin.push_back(static_cast<std::uint32_t>(grid.spans.size()));
    bool in_span = false;
    for (int i = 0; i < n; ++i) {
      const bool here = cloudy[static_cast<std::size_t>(row) * n + i] != 0;
      if (here) {
        if (!in_span) grid.spans.push_back({i, 0, static_cast<std::uint32_t>(grid.absorption.size())});
        ++grid.spans.back().n;
        grid.absorption.push_back(0);
        grid.scattering[0].push_back(.01F + .03F * static_cast<float>(random(1000)) / 1000);
      }
      in_span = here;
    }
  }
  grid.row_begin.push_back(static_cast<std::uint32_t>(grid.spans.size()));
  return grid;
}

Problem lit_spheres(int n) {
  Problem problem;
  problem.grid = sphere_field(n);
  problem.phase = {PhaseFunction::henyey_greenstein(.85)};
  problem.sun = Sun{Direction(std::sqrt(.75), .01, -.5).normalized(), 1.};
  return problem;
}

SolverOptions balanced() {
  SolverOptions options;
  options.fit.delta_m_order = 8;
  options.fit.beam_delta_m_order = 12;
  options.fit.cache_directory = std::filesystem::temp_directory_path() / "cloudbow-bench-transport";
  return options;
}

struct Scene {
  Problem problem;
  SolverOptions options = balanced();
  Discretisation discretisation;
  TransportSystem<float> system;
  AngularField<float> field;
  LightSlopes<float> slopes;  // of the first light

  explicit Scene(int n)
      : problem(lit_spheres(n)),
        discretisation(discretise(problem.phase, problem.sun->travel, options)),
        system(make_system<float>(problem, discretisation, options)),
        field(system.ordinates.size(), system.cells->size()) {
    system.scatter(field, {}, true);
    slopes = system.slopes->none(system.cells->size());
    slopes.frozen = false;
    SweepWorkspace<float> work;
    sweep(system, field, false, work, &slopes);
    slopes.frozen = true;
  }

  std::int64_t pairs() const {
    return static_cast<std::int64_t>(system.cells->size()) * static_cast<std::int64_t>(system.ordinates.size());
  }
  void report(benchmark::State& state, std::int64_t items) const {
    state.SetItemsProcessed(state.iterations() * items);
    state.counters["cells"] = static_cast<double>(system.cells->size());
  }
};

Scene& scene_of(benchmark::State& state) {
  static std::vector<std::pair<int, std::unique_ptr<Scene>>> made;
  const int n = static_cast<int>(state.range(0));
  omp_set_num_threads(1);
  for (auto& [size, scene] : made) {
    if (size == n) return *scene;
  }
  made.clear();  // one at a time: they are large
  return *made.emplace_back(n, std::make_unique<Scene>(n)).second;
}

void sweep_all(benchmark::State& state) {
  Scene& scene = scene_of(state);
  SweepWorkspace<float> work;
  for (auto _ : state) {
    state.PauseTiming();  // a sweep replaces the source by radiance
    scene.system.scatter(scene.field, {}, true);
    state.ResumeTiming();
    benchmark::DoNotOptimize(sweep(scene.system, scene.field, false, work, &scene.slopes).up_top);
  }
  scene.report(state, scene.pairs());
  double runs = 0;
  for (const OrdinatePath& path : scene.system.paths) runs += path.cost;
  state.counters["runs_a_pair"] = runs / static_cast<double>(scene.pairs());
  state.counters["sideways"] = static_cast<double>(std::count_if(scene.system.paths.begin(), scene.system.paths.end(),
                                                                 [](const auto& p) { return !p.sideways.empty(); }));
}

void scatter_all(benchmark::State& state) {
  Scene& scene = scene_of(state);
  for (auto _ : state) scene.system.scatter(scene.field, {}, false);
  scene.report(state, scene.pairs());
}

void moments_all(benchmark::State& state) {
  Scene& scene = scene_of(state);
  std::vector<float> moments(low_moments * scene.system.cells->size());
  for (auto _ : state) scene.system.moments(scene.field, moments);
  scene.report(state, scene.pairs());
}

void low_order(benchmark::State& state) {
  Scene& scene = scene_of(state);
  LowOrderCorrection<float> correction(scene.system, .1);
  std::vector<float> moments(low_moments * scene.system.cells->size());
  for (auto _ : state) correction.guess(moments);
  scene.report(state, scene.pairs());
  state.counters["sweeps"] = static_cast<double>(correction.sweeps()) / static_cast<double>(state.iterations());
}

void gather_plane(benchmark::State& state) {
  Scene& scene = scene_of(state);
  const auto beam =
      beam_with<float>(scene.problem, scene.system.cells->rows, scene.discretisation.gather_fraction(), scene.options);
  auto source = scattered_source<float>(scene.discretisation, scene.system, scene.field);
  set_first_order<float>(scene.problem, scene.discretisation, scene.system, &beam, source);
  GatherScene<float> gathered{scene.system.box, *scene.system.cells, &source, {}, 0, nullptr};
  gathered.beam_slope = &scene.system.slopes->beam();
  gathered.slopes = &scene.slopes;
  const auto directions = gather_directions(128, false, scene.problem.sun->travel);
  for (auto _ : state) benchmark::DoNotOptimize(gather_flux<float>(gathered, 0, false, directions).data());
  scene.report(state, static_cast<std::int64_t>(scene.system.cells->size() * directions.size()));
}

void direct_light(benchmark::State& state) {
  Scene& scene = scene_of(state);
  for (auto _ : state) {
    benchmark::DoNotOptimize(
        beam_with<float>(scene.problem, scene.system.cells->rows, scene.discretisation.beam_fraction(), scene.options)
            .irradiance.data());
  }
  scene.report(state, static_cast<std::int64_t>(scene.system.cells->size()) * scene.options.beam_rays);
}

// Rate of multiplications and additions in registers, 1/s.
void arithmetic(benchmark::State& state) {
  constexpr int chains = 10;  // enough to hide the latency of two units
  constexpr int rounds = 1000;
  Lanes<float> x[chains];
  for (int i = 0; i < chains; ++i) x[i] = Lanes<float>{} + 1e-3F * static_cast<float>(i);
  const Lanes<float> by = Lanes<float>{} + .999F, more = Lanes<float>{} + 1e-3F;
  for (auto _ : state) {
    for (int r = 0; r < rounds; ++r) {
      for (Lanes<float>& value : x) value = value * by + more;
    }
    benchmark::DoNotOptimize(x);
  }
  state.SetItemsProcessed(state.iterations() * 2 * lanes * chains * rounds);
}

// Rate of bytes of to += from, two read and one written, 1/s.
void memory(benchmark::State& state) {
  constexpr std::size_t n = std::size_t{1} << 26;
  std::vector<float> to(n, 1.F), from(n, 1.F);
  for (auto _ : state) {
    for (std::size_t i = 0; i < n; ++i) to[i] += from[i];
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(3 * n * sizeof(float)));
}

BENCHMARK(arithmetic);
BENCHMARK(memory)->Unit(benchmark::kMillisecond);
BENCHMARK(sweep_all)->Arg(32)->Arg(96)->Arg(224)->Unit(benchmark::kMillisecond);
BENCHMARK(scatter_all)->Arg(32)->Arg(96)->Arg(224)->Unit(benchmark::kMillisecond);
BENCHMARK(moments_all)->Arg(32)->Arg(96)->Arg(224)->Unit(benchmark::kMillisecond);
BENCHMARK(low_order)->Arg(32)->Arg(96)->Arg(224)->Unit(benchmark::kMillisecond);
BENCHMARK(gather_plane)->Arg(32)->Arg(96)->Arg(224)->Unit(benchmark::kMillisecond);
BENCHMARK(direct_light)->Arg(32)->Arg(96)->Arg(224)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace cloudbow

BENCHMARK_MAIN();
