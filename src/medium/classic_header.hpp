// Names in the headers of classic netCDF files.
#pragma once

#include <cstdint>
#include <istream>

namespace cloudbow {

/// Bytes of the longest name of a dimension, variable or attribute; 0 if the stream is no classic netCDF. The library
/// copies names of any length into buffers of NC_MAX_NAME + 1 bytes. Names after a damage are not seen: the library
/// opens no such file.
std::uint64_t longest_classic_name(std::istream& stream);

}  // namespace cloudbow
