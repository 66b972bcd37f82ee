// The light through top and bottom, read from a result file.
#pragma once

#include <filesystem>

#include "cloudbow/results/tradeoff.hpp"

namespace cloudbow {

/// Of a file by `cloudbow run`. @throws InputError if it is no such file, or its fluxes do not cover the domain from
/// bottom to top.
BoundaryResult read_boundary_result(const std::filesystem::path& file);

}  // namespace cloudbow
