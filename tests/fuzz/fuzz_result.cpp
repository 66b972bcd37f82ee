// Result files, as `render`, `tradeoff` and `export` read them: each mutant by one of them, because every reading takes
// a child process.
#include <numeric>

#include "cloudbow/io/boundary_result.hpp"
#include "cloudbow/io/field_export.hpp"
#include "cloudbow/io/flux_image.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

namespace {

void export_all(const std::filesystem::path& path) {
  cloudbow::FieldExportOptions fields;
  fields.result_file = path;
  fields.vdb_file = fuzz::folder() / "fields.vdb";
  fields.all_directions = fields.actinic = fields.absorption = true;
  cloudbow::export_fields(fields);
}

void read_as(std::uint32_t reader, const std::filesystem::path& path) {
  switch (reader) {
    case 0:
      cloudbow::read_flux_image(path, "upwelling_flux", {});
      break;
    case 1:
      cloudbow::read_boundary_result(path);
      break;
    default:
      export_all(path);
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::write_mutant({data, size}, "result.h5");
  const auto sum = std::accumulate(data, data + size, std::uint32_t{0});
  fuzz::expect_clean([&] { read_as(sum % 3, path); });
  return 0;
}
