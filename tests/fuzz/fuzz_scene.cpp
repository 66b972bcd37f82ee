// Scene files. The files that they name are there, so that mutants get past the names.
#include <fstream>

#include "cloudbow/app/scene.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

namespace {

void write_text(const char* name, const char* text) { std::ofstream(fuzz::folder() / name) << text; }

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const bool has_files = [] {
    write_text("cloud.vdb", "not read with the scene");
    write_text("moments.txt", "0 1\n1 0.5\n2 0.25\n");
    write_text("table.txt", "0 1.6\n90 1\n180 0.4\n");
    write_text("set.csv", "0 1 1\n1 0.5 0.3\n2 0.25 0.1\n");
    return true;
  }();
  static_cast<void>(has_files);
  const auto path = fuzz::write_mutant({data, size}, "scene.toml");
  fuzz::expect_clean([&] { cloudbow::read_scenes(path); });
  return 0;
}
