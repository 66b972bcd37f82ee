// Writes the result files that read_samples.py opens into the folder given.
#include <cstdio>
#include <exception>
#include <filesystem>
#include <fstream>
#include <iomanip>

#include "cloudbow/sphere/ordinate_set.hpp"
#include "sample_solution.hpp"

int main(int argc, char** argv) try {
  using namespace cloudbow;
  if (argc != 2) return 1;
  const std::filesystem::path folder = argv[1];
  std::filesystem::create_directories(folder);

  Solution full = sample::solution(64, 48, 8);  // large enough to be compressed
  full.radiance_field = sample::radiance_field();
  write_result(folder / "full.h5", full, sample::info());

  ResultInfo long_scene = sample::info();
  long_scene.title.clear();
  long_scene.scene = std::string(100'000, '#');  // more than the 64 KiB of an attribute in an object's header
  Solution boundaries = sample::solution(5, 4, 3, {0, 3});
  boundaries.absorbed_power.clear();
  boundaries.actinic_flux.clear();
  boundaries.radiance_field.emplace();
  boundaries.radiance_field->direction = sample::radiance_field().direction;
  write_result(folder / "boundaries.h5", boundaries, long_scene);

  // A field that queries in Python and by the library are compared on.
  Solution sphere = sample::solution(3, 2, 2);
  const ControlPoints points(42, control_point_frame_rotation());
  sphere.radiance_field = sample::radiance_field(points, {{0, 0, 0}, {2, 0, 0}, {1, 1, 0}, {0, 1, 1}});
  write_result(folder / "sphere.h5", sphere, sample::info());
  std::ofstream queries(folder / "sphere_queries.txt");
  queries << std::setprecision(17);
  for (const Direction& travel : sample::directions()) {
    queries << travel.x() << ' ' << travel.y() << ' ' << travel.z();
    for (std::size_t c = 0; c < sphere.radiance_field->voxel.size(); ++c) {
      queries << ' ' << sample::queried(points, *sphere.radiance_field, c, travel);
    }
    queries << '\n';
  }

  Solution column = sample::solution(1, 1, 3);
  column.sun = Sun{{.6, 0, -.8}, 1};
  column.circumsolar_flux = sample::field(6, column.flux_level, 1, 1);
  ResultInfo with_cone = sample::info();
  with_cone.circumsolar_deg = 2.5;
  write_result(folder / "column.h5", column, with_cone);

  ResultInfo spectrum = sample::info();
  spectrum.wavelengths_um = {0.67, 0.55};
  write_result(folder / "spectrum.h5", std::vector{sample::solution(4, 3, 2), sample::solution(4, 3, 2)}, spectrum);
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
