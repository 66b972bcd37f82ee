#include "io/deflated_chunks.hpp"

#include <zlib.h>

#include <algorithm>
#include <memory>
#include <new>

#include "cloudbow/core/parallel_errors.hpp"
#include "cloudbow/core/thread_scope.hpp"
#include "io/hdf5_handle.hpp"

namespace cloudbow::hdf5 {
namespace {

constexpr std::size_t chunk_bytes = 1 << 20;  // the size that HDF5's chunk cache holds
constexpr int batch = 32;                     // chunks in memory at a time
constexpr int level = 1;

/// One chunk's place and values: a run of the dataset's, shorter than a chunk at the end of the axis that is cut.
struct Chunk {
  std::vector<hsize_t> offset;
  std::span<const std::byte> values;
};

std::vector<Chunk> chunks_of(const std::vector<hsize_t>& shape, const std::vector<hsize_t>& chunk,
                             std::span<const std::byte> values, std::size_t value_bytes) {
  std::vector<Chunk> chunks;
  std::vector<hsize_t> offset(shape.size(), 0);
  for (std::size_t begin = 0; begin < values.size();) {
    std::size_t size = value_bytes;
    for (std::size_t axis = 0; axis < shape.size(); ++axis) size *= std::min(chunk[axis], shape[axis] - offset[axis]);
    chunks.push_back({offset, values.subspan(begin, size)});
    begin += size;
    for (std::size_t axis = shape.size(); axis-- > 0;) {
      offset[axis] += chunk[axis];
      if (offset[axis] < shape[axis]) break;
      offset[axis] = 0;
    }
  }
  return chunks;
}

/// HDF5's shuffle filter: first the first bytes of all values, then the second ones, and so on. The rest of the chunk
/// after the run is 0.
std::vector<Bytef> shuffled(std::span<const std::byte> values, std::size_t value_bytes, std::size_t chunk_values) {
  std::vector<Bytef> out(chunk_values * value_bytes, 0);
  const std::size_t count = values.size() / value_bytes;
  for (std::size_t byte = 0; byte < value_bytes; ++byte) {
    Bytef* plane = out.data() + byte * chunk_values;
    for (std::size_t i = 0; i < count; ++i) plane[i] = static_cast<Bytef>(values[i * value_bytes + byte]);
  }
  return out;
}

/// Runs are the only repeated strings that are searched for: bytes of one position either repeat or are noise. A full
/// search takes twice as long to save a few per cent.
std::vector<Bytef> deflated(std::vector<Bytef>&& in) {
  z_stream stream{};
  if (deflateInit2(&stream, level, Z_DEFLATED, MAX_WBITS, MAX_MEM_LEVEL, Z_RLE) != Z_OK) throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> open(&stream, deflateEnd);
  std::vector<Bytef> out(deflateBound(&stream, in.size()));
  stream.next_in = in.data();
  stream.avail_in = static_cast<uInt>(in.size());
  stream.next_out = out.data();
  stream.avail_out = static_cast<uInt>(out.size());
  const bool finished = deflate(&stream, Z_FINISH) == Z_STREAM_END;
  if (!finished) throw std::bad_alloc();
  out.resize(stream.total_out);
  return out;
}

}  // namespace

std::vector<hsize_t> chunk_shape(const std::vector<hsize_t>& shape, std::size_t value_bytes) {
  std::vector<hsize_t> chunk(shape.size(), 1);
  hsize_t room = chunk_bytes / value_bytes;
  for (std::size_t axis = shape.size(); axis-- > 0;) {
    chunk[axis] = std::clamp<hsize_t>(room, 1, shape[axis]);
    room = chunk[axis] < shape[axis] ? 1 : room / chunk[axis];
  }
  return chunk;
}

void set_deflated_chunks(hid_t creation_properties, const std::vector<hsize_t>& chunk) {
  check(H5Pset_chunk(creation_properties, static_cast<int>(chunk.size()), chunk.data()), "set chunks");
  check(H5Pset_shuffle(creation_properties), "set the shuffle filter");
  check(H5Pset_deflate(creation_properties, level), "set the deflate filter");
}

void write_deflated(hid_t dataset, const std::vector<hsize_t>& shape, const std::vector<hsize_t>& chunk,
                    std::span<const std::byte> values, std::size_t value_bytes, const std::vector<hsize_t>& leading) {
  std::vector<Chunk> chunks = chunks_of(shape, chunk, values, value_bytes);
  for (Chunk& one : chunks) one.offset.insert(one.offset.begin(), leading.begin(), leading.end());
  std::size_t chunk_values = 1;
  for (const hsize_t length : chunk) chunk_values *= length;
  const auto count = static_cast<int>(chunks.size());
  const ThreadScope threads(0);
  for (int begin = 0; begin < count; begin += batch) {
    const int size = std::min(batch, count - begin);
    std::vector<std::vector<Bytef>> bytes(size);
    ParallelErrors errors;
#pragma omp parallel for schedule(dynamic) if (size > 1)
    for (int c = 0; c < size; ++c)
      errors.run([&] { bytes[c] = deflated(shuffled(chunks[begin + c].values, value_bytes, chunk_values)); });
    errors.rethrow();
    for (int c = 0; c < size; ++c) {
      check(H5Dwrite_chunk(dataset, H5P_DEFAULT, 0, chunks[begin + c].offset.data(), bytes[c].size(), bytes[c].data()),
            "write a variable");
    }
  }
}

}  // namespace cloudbow::hdf5
