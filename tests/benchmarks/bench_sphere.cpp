// Control points against spherical harmonics: query, scale and add, rotation, of 1, 1000 and a million functions in
// float32. Names: Representation/size/functions. 162 points and 169 harmonics take equal storage; 42 points and 49.
// Each query takes the next of 64 directions. So a million functions are read from memory and not from a cache.
#include <benchmark/benchmark.h>

#include "cloudbow/sphere/harmonic_series.hpp"
#include "cloudbow/sphere/rotation.hpp"
#include "cloudbow/sphere/spherical_function.hpp"
#include "representations.hpp"

namespace {

using namespace cloudbow;

constexpr int direction_count = 64;

int degree_of(std::size_t count) { return static_cast<int>(std::lround(std::sqrt(count))) - 1; }

const Eigen::Matrix3d ten_degrees = Eigen::AngleAxisd(M_PI / 18, Direction(1, 2, 3).normalized()).toRotationMatrix();

void count_functions(benchmark::State& state) {
  state.SetItemsProcessed(state.iterations() * state.range(1));  // functions per second
}

/// The whole query: stencil and values.
void query_control_points(benchmark::State& state) {
  const std::size_t size = state.range(0), functions = state.range(1);
  const ControlPoints points(static_cast<int>(size));
  const auto values = filled(size, functions);
  std::vector<float> result(functions);
  const auto directions = random_directions(direction_count);
  int d = 0;
  for (auto _ : state) {
    query<float>(points.stencil(directions[d++ % direction_count]), values, result);
    benchmark::DoNotOptimize(result.data());
    benchmark::ClobberMemory();
  }
  count_functions(state);
}

/// The whole query: harmonics and values.
void query_harmonic_series(benchmark::State& state) {
  const std::size_t size = state.range(0), functions = state.range(1);
  const HarmonicBasis basis(degree_of(size));
  const auto coefficients = filled(size, functions);
  std::vector<double> harmonics(size);
  std::vector<float> result(functions);
  const auto directions = random_directions(direction_count);
  int d = 0;
  for (auto _ : state) {
    basis.evaluate(directions[d++ % direction_count], harmonics);
    query_harmonics<float>(harmonics, coefficients, result);
    benchmark::DoNotOptimize(result.data());
    benchmark::ClobberMemory();
  }
  count_functions(state);
}

void scale_and_add(benchmark::State& state) {
  const std::size_t size = state.range(0), functions = state.range(1);
  const auto values = filled(size, functions);
  auto sum = values;
  for (auto _ : state) {
    add_scaled<float>(1e-6f, values, sum);
    benchmark::DoNotOptimize(sum.data());
    benchmark::ClobberMemory();
  }
  count_functions(state);
}

void rotate_by_permutation(benchmark::State& state) {
  const std::size_t size = state.range(0), functions = state.range(1);
  const auto source = nearest_permutation(ControlPoints(static_cast<int>(size)), ten_degrees, Matching::least_squares);
  const auto values = filled(size, functions);
  std::vector<float> rotated(values.size());
  for (auto _ : state) {
    permute<float>(source, values, rotated);
    benchmark::DoNotOptimize(rotated.data());
    benchmark::ClobberMemory();
  }
  count_functions(state);
}

void rotate_by_reweighting(benchmark::State& state) {
  const std::size_t size = state.range(0), functions = state.range(1);
  const auto stencils = reweighting(ControlPoints(static_cast<int>(size)), ten_degrees);
  const auto values = filled(size, functions);
  std::vector<float> rotated(values.size());
  for (auto _ : state) {
    reweight<float>(stencils, values, rotated);
    benchmark::DoNotOptimize(rotated.data());
    benchmark::ClobberMemory();
  }
  count_functions(state);
}

void rotate_harmonic_series(benchmark::State& state) {
  const std::size_t size = state.range(0), functions = state.range(1);
  const HarmonicRotation rotation(ten_degrees, degree_of(size));
  const auto coefficients = filled(size, functions);
  std::vector<float> rotated(coefficients.size());
  for (auto _ : state) {
    rotation.apply<float>(coefficients, rotated);
    benchmark::DoNotOptimize(rotated.data());
    benchmark::ClobberMemory();
  }
  count_functions(state);
}

void prepare_rotation_of_control_points(benchmark::State& state) {
  const ControlPoints points(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(reweighting(points, ten_degrees));
}

void prepare_rotation_of_harmonics(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(HarmonicRotation(ten_degrees, degree_of(state.range(0))));
}

void points_by_functions(benchmark::internal::Benchmark* b) { b->ArgsProduct({{42, 162}, {1, 1000, 1000000}}); }
void harmonics_by_functions(benchmark::internal::Benchmark* b) {
  b->ArgsProduct({{16, 49, 64, 169}, {1, 1000, 1000000}});
}

BENCHMARK(query_control_points)->Apply(points_by_functions);
BENCHMARK(query_harmonic_series)->Apply(harmonics_by_functions);
BENCHMARK(scale_and_add)->ArgsProduct({{16, 42, 64, 162, 169}, {1, 1000, 1000000}});
BENCHMARK(rotate_by_permutation)->Apply(points_by_functions);
BENCHMARK(rotate_by_reweighting)->Apply(points_by_functions);
BENCHMARK(rotate_harmonic_series)->Apply(harmonics_by_functions);
BENCHMARK(prepare_rotation_of_control_points)->Arg(42)->Arg(162);
BENCHMARK(prepare_rotation_of_harmonics)->Arg(16)->Arg(49)->Arg(169);

}  // namespace
