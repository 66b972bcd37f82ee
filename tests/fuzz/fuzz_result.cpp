// Result files, as `render`, `tradeoff` and `export` read them, and as maps of the surface.
#include "cloudbow/results/field_export.hpp"
#include "cloudbow/results/flux_image.hpp"
#include "cloudbow/results/raster_file.hpp"
#include "cloudbow/results/tradeoff.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::write_mutant({data, size}, "result.h5");
  fuzz::expect_clean([&] { cloudbow::list_flux_images(path); });
  fuzz::expect_clean([&] { cloudbow::read_flux_image(path, "upwelling_flux", {}); });
  fuzz::expect_clean([&] { cloudbow::read_boundary_result(path); });
  fuzz::expect_clean([&] { cloudbow::read_raster(path, "albedo"); });
  cloudbow::FieldExportOptions fields;
  fields.result_file = path;
  fields.vdb_file = fuzz::folder() / "fields.vdb";
  fields.all_directions = fields.actinic = fields.absorption = true;
  fuzz::expect_clean([&] { cloudbow::export_fields(fields); });
  return 0;
}
