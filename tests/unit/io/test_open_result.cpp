// Readers of one run refuse sweeps. Truth: files that the writers made.
#include <gmock/gmock.h>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/boundary_result.hpp"
#include "cloudbow/io/flux_image.hpp"
#include "cloudbow/io/result_file.hpp"
#include "cloudbow/io/sweep_file.hpp"
#include "io/result_input.hpp"
#include "sample_solution.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

class OpenResult : public testing::Test {
 protected:
  OpenResult() {
    std::string name = (fs::temp_directory_path() / "cloudbow-test-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    write_result(folder_ / "run.h5", sample::solution(3, 4, 2), sample::info());
  }
  ~OpenResult() override { fs::remove_all(folder_); }

  fs::path folder_;
};

TEST_F(OpenResult, EveryReaderOfOneRunRefusesASweep) {
  const fs::path run = folder_ / "run.h5", sweep = folder_ / "suns.h5";
  const std::vector<SweepDimension> dimensions{{"zenith_deg", "sun.zenith_deg", {0, 30, 60}, {}, "degree"},
                                               {"accuracy", "solver.accuracy", {}, {"draft", "fine"}, ""}};
  write_sweep(sweep, dimensions, std::vector<SweptRun>(6, SweptRun{run, 0, "", "scene"}), {"cloudbow 1", "then", ""});
  const auto refusal = ThrowsMessage<InputError>(
      AllOf(HasSubstr("suns.h5: it holds a sweep (found 6 runs, allowed the result of one run)"),
            HasSubstr(".isel(accuracy=0, zenith_deg=0)")));
  EXPECT_THAT([&] { read_flux_profile(sweep, "upwelling_flux", {}); }, refusal);
  EXPECT_THAT([&] { list_flux_profiles(sweep); }, refusal);
  EXPECT_THAT([&] { read_flux_image(sweep, "upwelling_flux", {}); }, refusal);
  EXPECT_THAT([&] { list_flux_images(sweep); }, refusal);
  EXPECT_THAT([&] { read_wavelengths(sweep); }, refusal);
  EXPECT_THAT([&] { read_boundary_result(sweep); }, refusal);
  EXPECT_THAT([&] { ResultInput input(sweep); }, refusal);
  EXPECT_NO_THROW(ResultInput input(run));
}

}  // namespace
}  // namespace cloudbow
