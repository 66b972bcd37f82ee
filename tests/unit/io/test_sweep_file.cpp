// Truth: the numbers that the solutions were filled with, read back by the HDF5 library itself.
#include <gmock/gmock.h>
#include <hdf5.h>
#include <hdf5_hl.h>
#include <unistd.h>

#include <cmath>
#include <fstream>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/result_file.hpp"
#include "cloudbow/io/sweep_file.hpp"
#include "sample_solution.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

class SweepFile : public testing::Test {
 protected:
  SweepFile() {
    std::string name = (fs::temp_directory_path() / "cloudbow-test-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~SweepFile() override {
    if (file_ >= 0) H5Fclose(file_);
    fs::remove_all(folder_);
  }

  /// A result whose fluxes are those of sample::solution() times a factor.
  SweptRun run(double factor, double zenith_deg, int n = 3) {
    Solution solution = sample::solution(n, 4, 2);
    for (float& flux : solution.upwelling_flux) flux *= static_cast<float>(factor);
    solution.ledger.reflectance = factor / 16;
    solution.report.sweeps = static_cast<int>(factor);
    solution.report.mode = factor > 1 ? "3d" : "2d";
    ResultInfo info = sample::info();
    info.sun = SunPosition{zenith_deg, 90};
    info.run_key = "0123456789abcdef";
    const fs::path file = folder_ / ("run-" + std::to_string(count_++) + ".h5");
    write_result(file, solution, info);
    return {file, 0, "", "scene of " + std::to_string(static_cast<int>(factor))};
  }

  void write(const std::vector<SweepDimension>& dimensions, const std::vector<SweptRun>& runs) {
    write_sweep(folder_ / "sweep.h5", dimensions, runs, {"cloudbow 1", "then", "the scene"});
    file_ = H5Fopen((folder_ / "sweep.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    ASSERT_GE(file_, 0);
  }

  template <class T>
  std::vector<T> read(const char* name, hid_t type, std::vector<hsize_t>* shape = nullptr) const {
    const hid_t dataset = H5Dopen2(file_, name, H5P_DEFAULT);
    EXPECT_GE(dataset, 0) << name;
    const hid_t space = H5Dget_space(dataset);
    std::vector<T> value(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
    if (shape != nullptr) {
      shape->resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
      H5Sget_simple_extent_dims(space, shape->data(), nullptr);
    }
    EXPECT_GE(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()), 0) << name;
    H5Sclose(space);
    H5Dclose(dataset);
    return value;
  }

  std::vector<std::string> texts(const char* name) const {
    const hid_t type = H5Tcopy(H5T_C_S1);
    H5Tset_size(type, H5T_VARIABLE);
    H5Tset_cset(type, H5T_CSET_UTF8);
    std::vector<std::string> result;
    for (char* text : read<char*>(name, type)) {
      result.emplace_back(text);
      H5free_memory(text);
    }
    H5Tclose(type);
    return result;
  }

  fs::path folder_;
  hid_t file_ = -1;
  int count_ = 0;
};

const SweepDimension zenith{"zenith_deg", "sun.zenith_deg", {0, 30, 60}, {}, "degree"};
const SweepDimension accuracy{"accuracy", "solver.accuracy", {}, {"draft", "fine"}, ""};

TEST_F(SweepFile, VariablesHaveTheSweptDimensionsFirst) {
  std::vector<SweptRun> runs;
  for (int n = 0; n < 6; ++n) runs.push_back(run(n + 1, 30 * (n / 2)));
  write({zenith, accuracy}, runs);
  std::vector<hsize_t> shape;
  const std::vector<float> up = read<float>("upwelling_flux", H5T_NATIVE_FLOAT, &shape);
  EXPECT_THAT(shape, ElementsAre(3, 2, 3, 4, 3));
  const std::vector<float> one = sample::solution(3, 4, 2).upwelling_flux;
  for (std::size_t n = 0; n < up.size(); ++n)
    ASSERT_EQ(up[n], one[n % one.size()] * static_cast<float>(n / one.size() + 1)) << n;
  EXPECT_THAT(read<double>("summary/reflectance", H5T_NATIVE_DOUBLE, &shape),
              ElementsAre(1. / 16, 2. / 16, 3. / 16, 4. / 16, 5. / 16, 6. / 16));
  EXPECT_THAT(shape, ElementsAre(3, 2));
  EXPECT_THAT(read<int>("solver/sweeps", H5T_NATIVE_INT), ElementsAre(1, 2, 3, 4, 5, 6));
  // Texts that differ are variables, the others remain attributes.
  EXPECT_THAT(texts("solver/mode"), ElementsAre("2d", "3d", "3d", "3d", "3d", "3d"));
  EXPECT_GT(H5Aexists_by_name(file_, "solver", "directions", H5P_DEFAULT), 0);
  EXPECT_THAT(texts("runs/scene"), testing::Contains("scene of 4"));
  EXPECT_THAT(texts("accuracy"), ElementsAre("draft", "fine"));
  EXPECT_THAT(read<double>("profile/zenith_deg", H5T_NATIVE_DOUBLE), ElementsAre(0, 30, 60));
}

TEST_F(SweepFile, StoresOnceWhatDoesNotChange) {
  std::vector<SweptRun> runs;
  for (int n = 0; n < 6; ++n) runs.push_back(run(n + 1, 30 * (n / 2)));
  write({zenith, accuracy}, runs);
  std::vector<hsize_t> shape;
  read<double>("z", H5T_NATIVE_DOUBLE, &shape);
  EXPECT_THAT(shape, ElementsAre(2));
  read<double>("z_bounds", H5T_NATIVE_DOUBLE, &shape);
  EXPECT_THAT(shape, ElementsAre(2, 2));
  // Scalars have the dimensions along which they vary.
  EXPECT_THAT(read<double>("solar_zenith_angle", H5T_NATIVE_DOUBLE, &shape), ElementsAre(0, 30, 60));
  EXPECT_THAT(shape, ElementsAre(3));
  EXPECT_THAT(read<double>("solar_azimuth_angle", H5T_NATIVE_DOUBLE, &shape), ElementsAre(90));
  EXPECT_THAT(shape, ElementsAre());
}

TEST_F(SweepFile, LargeVariablesAreChunkedByRun) {
  std::vector<SweptRun> runs{run(1, 0, 3000), run(2, 30, 3000), run(3, 60, 3000)};
  write({zenith}, runs);
  const std::vector<float> one = sample::solution(3000, 4, 2).upwelling_flux;
  const std::vector<float> up = read<float>("upwelling_flux", H5T_NATIVE_FLOAT);
  for (std::size_t n = 0; n < up.size(); ++n)
    ASSERT_EQ(up[n], one[n % one.size()] * static_cast<float>(n / one.size() + 1)) << n;
}

TEST_F(SweepFile, ValuesOfFailedRunsAreMissing) {
  for (const int n : {3, 3000}) {
    const std::vector<SweptRun> runs{run(1, 0, n), {"", 1, "it diverges", "scene of 2"}, run(3, 60, n)};
    write({zenith}, runs);
    const std::vector<float> up = read<float>("upwelling_flux", H5T_NATIVE_FLOAT);
    for (std::size_t at = 0; at < up.size(); ++at) ASSERT_EQ(std::isnan(up[at]), at / (up.size() / 3) == 1) << at;
    const std::vector<double> reflectance = read<double>("summary/reflectance", H5T_NATIVE_DOUBLE);
    EXPECT_TRUE(std::isnan(reflectance[1]) && !std::isnan(reflectance[2]));
    EXPECT_THAT(read<int>("runs/exit_code", H5T_NATIVE_INT), ElementsAre(0, 1, 0));
    EXPECT_THAT(texts("runs/message"), ElementsAre("", "it diverges", ""));
    EXPECT_GT(H5Aexists_by_name(file_, "solver/sweeps", "_FillValue", H5P_DEFAULT), 0);
    H5Fclose(file_);
    file_ = -1;
  }
}

TEST_F(SweepFile, RefusesResultsOnDifferentCells) {
  const std::vector<SweptRun> runs{run(1, 0, 3), run(2, 30, 4), run(3, 60, 3)};
  EXPECT_THAT([&] { write_sweep(folder_ / "sweep.h5", std::vector{zenith}, runs, {}); },
              ThrowsMessage<InputError>(testing::AllOf(HasSubstr("/x"), HasSubstr(folder_.string()))));
  EXPECT_FALSE(fs::exists(folder_ / "sweep.h5"));
}

TEST_F(SweepFile, KnowsWholeResults) {
  const SweptRun whole = run(1, 0, 3000);
  const std::string key = "0123456789abcdef";
  EXPECT_TRUE(is_whole_result(whole.result, key));
  EXPECT_EQ(shortcoming_of_result(whole.result), "");
  EXPECT_FALSE(is_whole_result(whole.result, "0123456789abcdee")) << "the result of another run";
  fs::resize_file(whole.result, fs::file_size(whole.result) / 2);
  EXPECT_FALSE(is_whole_result(whole.result, key));
  std::ofstream(folder_ / "text.h5") << "no result";
  EXPECT_FALSE(is_whole_result(folder_ / "text.h5", key));
  write_result(folder_ / "single.h5", sample::solution(2, 2, 2), sample::info());
  EXPECT_FALSE(is_whole_result(folder_ / "single.h5", "")) << "of no sweep";
}

/// Replaces an attribute of a group or variable.
void set_attribute(const fs::path& file, const char* object, const char* name, hid_t type, hid_t space,
                   const void* value) {
  const hid_t open = H5Fopen(file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  const hid_t at = H5Oopen(open, object, H5P_DEFAULT);
  H5Adelete(at, name);
  const hid_t attribute = H5Acreate2(at, name, type, space, H5P_DEFAULT, H5P_DEFAULT);
  EXPECT_GE(attribute, 0) << name;
  if (value != nullptr) {
    EXPECT_GE(H5Awrite(attribute, type, value), 0) << name;
  }
  H5Aclose(attribute);
  H5Oclose(at);
  H5Fclose(open);
}

TEST_F(SweepFile, RefusesAttributesOfDifferentKinds) {
  const hid_t one = H5Screate(H5S_SCALAR), none = H5Screate(H5S_NULL);
  const double number = 1;
  struct Case {
    const char* object;
    const char* name;
  };
  for (const Case& wrong : {Case{"solver", "mode"},
                            {"solver", "directions"},
                            {"ledger", "units"},
                            {"upwelling_flux", "units"},
                            {"z", "units"}}) {
    const std::vector<SweptRun> runs{run(1, 0), run(2, 30), run(3, 60)};
    set_attribute(runs[1].result, wrong.object, wrong.name, H5T_NATIVE_DOUBLE, one, &number);
    EXPECT_THAT([&] { write_sweep(folder_ / "sweep.h5", std::vector{zenith}, runs, {}); },
                ThrowsMessage<InputError>(HasSubstr("do not have the same")))
        << wrong.object << ' ' << wrong.name;
    EXPECT_FALSE(fs::exists(folder_ / "sweep.h5"));
  }
  // In all of them.
  std::vector<SweptRun> runs{run(1, 0), run(2, 30), run(3, 60)};
  for (const SweptRun& other : runs) set_attribute(other.result, "ledger", "units", H5T_NATIVE_DOUBLE, one, &number);
  write_sweep(folder_ / "sweep.h5", std::vector{zenith}, runs, {});
  for (const char* name : {"converged", "estimated_error", "sweeps"}) {
    const SweptRun empty = run(1, 0);
    const std::int32_t no = 0;
    set_attribute(empty.result, "solver", "converged", H5T_NATIVE_INT32, one, &no);
    set_attribute(empty.result, "solver", name, H5T_NATIVE_DOUBLE, none, nullptr);
    EXPECT_THAT([&] { shortcoming_of_result(empty.result); },
                ThrowsMessage<InputError>(testing::AllOf(HasSubstr(name), HasSubstr("has no numbers"))));
  }
  H5Sclose(one);
  H5Sclose(none);
}

TEST_F(SweepFile, SaysWhatDidNotConverge) {
  Solution solution = sample::solution(2, 2, 2);
  solution.report.converged = false;
  Solution columns = solution;
  write_result(folder_ / "r.h5", std::span(&solution, 1), sample::info(), std::span(&columns, 1));
  EXPECT_THAT(shortcoming_of_result(folder_ / "r.h5"),
              testing::AllOf(HasSubstr("not converged: estimated error 5.00e-05 after 17 sweeps"),
                             HasSubstr("as independent columns")));
}

}  // namespace
}  // namespace cloudbow
