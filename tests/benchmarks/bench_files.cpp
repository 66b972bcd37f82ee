// Cost of files: loading clouds, writing a result of 128 x 128 x 119 cells with fluxes at all levels. The clouds are
// those of clouds/, and of the files that CLOUDBOW_BENCH_VDB names, separated by colons.
#include <benchmark/benchmark.h>
#include <stdlib.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <string>
#include <vector>

#include "cloudbow/io/result_file.hpp"
#include "cloudbow/medium/vdb_file.hpp"

namespace {

using namespace cloudbow;

void load_cloud(benchmark::State& state, const std::filesystem::path& file) {
  std::size_t voxels = 0;
  for (auto _ : state) {
    const CloudField cloud = read_cloud_vdb(file);
    voxels = cloud.value.size();
  }
  state.counters["voxels"] = static_cast<double>(voxels);
}

/// Smooth in the large and rough in the last digits, as fluxes are that were summed in float32.
std::vector<float> field(std::size_t size, double wave) {
  std::vector<float> value(size);
  unsigned random = 1;
  for (std::size_t i = 0; i < size; ++i) {
    random = random * 1664525u + 1013904223u;
    const double x = static_cast<double>(i % 128), y = static_cast<double>(i / 128 % 128);
    const double z = static_cast<double>(i / (128 * 128));
    value[i] = static_cast<float>((300 + 200 * std::sin(wave * x) * std::cos(wave * y) + z) *
                                  (1 + 1e-4 * (random >> 16) / 65536));
  }
  return value;
}

Solution large_solution() {
  Solution solution;
  BoxGrid& box = solution.box;
  box.nx = box.ny = 128;
  box.dx_m = box.dy_m = 30;
  for (int k = 0; k <= 119; ++k) {
    box.z_edge_m.push_back(25. * k);
    solution.flux_level.push_back(k);
  }
  const std::size_t cells = 128 * 128 * 119, faces = 128 * 128 * 120;
  solution.upwelling_flux = field(faces, 0.1);
  solution.downwelling_diffuse_flux = field(faces, 0.17);
  solution.direct_flux = field(faces, 0.23);
  solution.absorbed_power = field(cells, 0.31);
  solution.actinic_flux = field(cells, 0.13);
  return solution;
}

void write_large_result(benchmark::State& state) {
  const Solution solution = large_solution();
  std::string directory = (std::filesystem::temp_directory_path() / "cloudbow-bench-XXXXXX").string();
  if (mkdtemp(directory.data()) == nullptr) return state.SkipWithError("no temporary directory");
  const std::filesystem::path file = std::filesystem::path(directory) / "result.h5";
  for (auto _ : state) write_result(file, solution, {});
  const auto floats = solution.upwelling_flux.size() * 3 + solution.absorbed_power.size() * 2;
  state.SetBytesProcessed(state.iterations() * static_cast<std::int64_t>(floats * sizeof(float)));
  state.counters["file_MB"] = static_cast<double>(std::filesystem::file_size(file)) / 1e6;
  std::filesystem::remove_all(directory);
}

BENCHMARK(write_large_result)->Unit(benchmark::kMillisecond)->UseRealTime();

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::filesystem::path> clouds;
  for (const auto& entry : std::filesystem::directory_iterator(CLOUDBOW_SOURCE_DIR "/clouds")) {
    if (entry.path().extension() == ".vdb") clouds.push_back(entry.path());
  }
  if (const char* more = std::getenv("CLOUDBOW_BENCH_VDB")) {
    std::istringstream names(more);
    for (std::string name; std::getline(names, name, ':');) clouds.emplace_back(name);
  }
  for (const auto& file : clouds) {
    benchmark::RegisterBenchmark(("load_cloud/" + file.filename().string()).c_str(), load_cloud, file)
        ->Unit(benchmark::kMillisecond)
        ->UseRealTime();
  }
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
}
