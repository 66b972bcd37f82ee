// The values of a chunked HDF5 dataset, shuffled and deflated by threads: HDF5's own filters work on one.
#pragma once

#include <hdf5.h>

#include <cstddef>
#include <span>
#include <vector>

namespace cloudbow::hdf5 {

/// Shape of chunks of about 1 MiB, for axes that are not empty: whole trailing axes as far as they fit. So a chunk is
/// one run of the values. A map at one height touches few chunks, and a column of one cell isn't one chunk per value.
std::vector<hsize_t> chunk_shape(const std::vector<hsize_t>& shape, std::size_t value_bytes);

/// Sets the filters that write_deflated() applies: shuffle and deflate.
void set_deflated_chunks(hid_t creation_properties, const std::vector<hsize_t>& chunk);

/// Writes a whole dataset that was created so, or one block of it. The bytes do not depend on the number of threads.
/// @param values in the dataset's own type and byte order.
/// @param leading indices on axes before those of `shape`; along them chunks have length 1.
/// @throws Error
void write_deflated(hid_t dataset, const std::vector<hsize_t>& shape, const std::vector<hsize_t>& chunk,
                    std::span<const std::byte> values, std::size_t value_bytes,
                    const std::vector<hsize_t>& leading = {});

}  // namespace cloudbow::hdf5
