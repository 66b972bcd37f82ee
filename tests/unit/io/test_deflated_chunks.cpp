// Chunks of a dataset, deflated by threads. Truth: HDF5 reads what was written; the bytes are those of one thread.
#include <gtest/gtest.h>
#include <hdf5.h>
#include <omp.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <string>
#include <vector>

#include "io/deflated_chunks.hpp"
#include "io/hdf5_handle.hpp"
#include "temporary_folder.hpp"

namespace cloudbow::hdf5 {
namespace {

TEST(DeflatedChunks, AreOneRunOfTheValuesOfAboutAMebibyte) {
  EXPECT_EQ(chunk_shape({10, 20, 30}, 4), (std::vector<hsize_t>{10, 20, 30}));
  const std::vector<hsize_t> shape{100, 512, 512};
  const std::vector<hsize_t> chunk = chunk_shape(shape, 4);
  EXPECT_EQ(chunk[2], 512U) << "whole trailing axes";
  EXPECT_LE(chunk[0] * chunk[1] * chunk[2] * 4, hsize_t{1} << 20);
  EXPECT_GT(2 * chunk[0] * chunk[1] * chunk[2] * 4, hsize_t{1} << 20);
  EXPECT_EQ(chunk_shape({5000000}, 8), (std::vector<hsize_t>{131072}));
}

/// A file with one dataset of these values.
std::string written(const std::filesystem::path& path, const std::vector<hsize_t>& shape,
                    const std::vector<float>& values, int threads) {
  const int before = omp_get_max_threads();
  omp_set_num_threads(threads);
  {
    Handle file = create_file(path);
    const Handle creation = property_list(H5P_DATASET_CREATE);
    H5Pset_obj_track_times(creation, false);
    const std::vector<hsize_t> chunk = chunk_shape(shape, sizeof(float));
    set_deflated_chunks(creation, chunk);
    {
      const Handle dataset(
          H5Dcreate2(file, "a", H5T_NATIVE_FLOAT, dataspace(shape), H5P_DEFAULT, creation, H5P_DEFAULT), H5Dclose,
          "create");
      write_deflated(dataset, shape, chunk, std::as_bytes(std::span(values)), sizeof(float));
    }
    finish_file(file);
  }
  omp_set_num_threads(before);
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(DeflatedChunks, HoldTheValuesWithTheSameBytesForAnyThreads) {
  const TemporaryFolder folder;
  // The last chunk of each axis sticks out.
  const std::vector<hsize_t> shape{7, 301, 503};
  std::vector<float> values(7 * 301 * 503);
  for (std::size_t n = 0; n < values.size(); ++n)
    values[n] = static_cast<float>(std::sin(1e-3 * static_cast<double>(n)));
  const std::string one = written(folder / "one.h5", shape, values, 1);
  EXPECT_EQ(one, written(folder / "two.h5", shape, values, 2));
  EXPECT_LT(one.size(), values.size() * sizeof(float));
  const Handle file = open_file(folder / "one.h5");
  EXPECT_EQ(read_all<float>(open_dataset(file, "a")), values);
}

}  // namespace
}  // namespace cloudbow::hdf5
