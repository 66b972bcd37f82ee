// Prints the vertical integral of every column of a grid, a row j of columns i per line: for model_layouts.py.
// usage: column_paths FILE.vdb GRID
#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>
#include <exception>

#include "cloudbow/medium/vdb_file.hpp"

int main(int count, char** argument) {
  if (count != 3) {
    fmt::print(stderr, "usage: column_paths FILE.vdb GRID\n");
    return EXIT_FAILURE;
  }
  try {
    cloudbow::VdbReadOptions options;
    options.grid = argument[2];
    const cloudbow::VdbCloud field = cloudbow::read_cloud_vdb(argument[1], options);
    std::size_t n = 0;
    for (const double path : cloudbow::column_integrals(field)) {
      const bool ends_row = ++n % static_cast<std::size_t>(field.cells[0]) == 0;
      fmt::print("{:.9g}{}", path, ends_row ? '\n' : ' ');
    }
  } catch (const std::exception& error) {
    fmt::print(stderr, "column_paths: {}\n", error.what());
    return EXIT_FAILURE;
  }
  return EXIT_SUCCESS;
}
