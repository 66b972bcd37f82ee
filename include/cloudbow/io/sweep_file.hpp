// Results of a sweep in one file: HDF5 that is also netCDF-4 (docs/howto-sweeps.md).
#pragma once

#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace cloudbow {

/// A swept key of the scene: a dimension and its coordinate.
struct SweepDimension {
  std::string name;                ///< of dimension and coordinate
  std::string key;                 ///< dotted, as the scene has it
  std::vector<double> numbers;     ///< values, or none if they are texts
  std::vector<std::string> texts;  ///< values that are not numbers
  std::string units;               ///< of numbers

  std::size_t size() const { return texts.empty() ? numbers.size() : texts.size(); }
};

struct SweptRun {
  std::filesystem::path result;  ///< file of write_result(); empty: the run failed
  int exit_code = 0;             ///< as `cloudbow run` would end
  std::string message;           ///< sentences on what went wrong; empty: nothing did
  std::string scene;             ///< the whole scene as run
};

struct SweepInfo {
  std::string source;   ///< program name and version
  std::string history;  ///< command of the sweep
  std::string scene;    ///< the scene before keys are swept
};

/// Joins results. Each variable has the swept dimensions first. Coordinates and meshes are stored once. Numbers in the
/// attributes of groups become variables. Values of failed runs are missing. The values are those of the results, bit
/// by bit. The file appears when it is complete, as that of write_result().
/// @param runs in the order of the product, the last dimension fastest; at least one has a result.
/// @throws InputError if the file can't be written, or the results have different coordinates. Also if they have
/// attributes or variables of one name and different kinds.
void write_sweep(const std::filesystem::path& file, std::span<const SweepDimension> dimensions,
                 std::span<const SweptRun> runs, const SweepInfo& info);

/// Whether a file has this ResultInfo::run_key and can be read to its last value. Reads it in a child process.
bool is_whole_result(const std::filesystem::path& file, const std::string& run_key);

/// A sentence on solutions in a result that did not converge; empty if all did. @throws InputError if the file can't be
/// read.
std::string shortcoming_of_result(const std::filesystem::path& file);

}  // namespace cloudbow
