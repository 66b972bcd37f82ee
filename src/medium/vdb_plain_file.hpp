// Reads ordinary VDB files without OpenVDB, which takes longer to load than small scenes take to solve.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>

#include "vdb_grid.hpp"

namespace cloudbow {

/// The float grid of this name in an ordinary file. Files of versions 222 to 224 are ordinary if they are complete and
/// consistent and all their grids are. Then the result is the same as with OpenVDB.
/// @param memory_bytes that the grid may take as a cloud; counted before it is taken.
/// @returns nothing for any other file: OpenVDB should read it, or say why it cannot.
std::optional<VdbGrid> read_plain_vdb(const std::filesystem::path& path, const std::string& name,
                                      std::uint64_t memory_bytes);

}  // namespace cloudbow
