// Tables of droplets: HDF5, netCDF and text. Those by humidity need one.
#include <optional>
#include <string_view>

#include "cloudbow/io/droplet_table_file.hpp"
#include "fuzz_input.hpp"

namespace fuzz = cloudbow::fuzz;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const auto path = fuzz::write_mutant({data, size}, "droplets.h5");
  const std::string_view text(reinterpret_cast<const char*>(data), size);
  const bool by_humidity = text.find("hum") != std::string_view::npos;
  const auto humidity_percent = by_humidity ? std::optional(60.0) : std::nullopt;
  fuzz::expect_clean([&] { cloudbow::read_droplet_table(path, 0.67, humidity_percent); });
  return 0;
}
