// The sweep of columns, from arguments to the file. Truth: single runs, counts of the product, exit codes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "../commands/call_cloudbow.hpp"
#include "../temporary_folder.hpp"
#include "app/runs/sweep.hpp"
#include "app/runs/sweep_parts.hpp"
#include "cloudbow/core/error.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

SweepOptions options_of(const TemporaryFolder& folder, const std::vector<std::string>& lists) {
  SweepOptions options;
  options.run.scene = folder.write("scene.toml", slab_toml);
  options.run.output = folder / "out.h5";
  options.run.quiet = true;
  for (const std::string& list : lists) options.keys.push_back(parse_swept_key(list));
  return options;
}

TEST(Sweep, PlansTheProduct) {
  const TemporaryFolder folder;
  const SweepPlan plan =
      plan_sweep(options_of(folder, {"sun.zenith_deg=0:80:40", "solver.accuracy=draft", "surface.albedo=0,0.5"}));
  ASSERT_EQ(plan.runs.size(), 6);
  EXPECT_EQ(plan.to_solve, 6);
  EXPECT_THAT(plan.runs[1].settings, testing::ElementsAre("sun.zenith_deg=0", "surface.albedo=0.5"));
  EXPECT_THAT(plan.runs[2].settings, testing::ElementsAre("sun.zenith_deg=40", "surface.albedo=0"));
  EXPECT_THAT(plan.runs[2].scene, HasSubstr("zenith_deg = 40"));
  ASSERT_EQ(plan.dimensions.size(), 2);
  EXPECT_EQ(plan.dimensions[0].name, "zenith_deg");
  EXPECT_EQ(plan.dimensions[0].units, "degree");
  EXPECT_GT(plan.memory_bytes, 0);
  EXPECT_THAT(plan.text, AllOf(HasSubstr("3 (zenith_deg) x 2 (albedo): 6"), HasSubstr("memory")));
  EXPECT_FALSE(std::filesystem::exists(folder / "out.h5.parts"));
}

TEST(Sweep, RefusesBeforeAnythingIsSolved) {
  const TemporaryFolder folder;
  const auto plan = [&folder](const std::vector<std::string>& lists) {
    return [&folder, lists] { plan_sweep(options_of(folder, lists)); };
  };
  // The last scene of the product is wrong.
  EXPECT_THAT(plan({"sun.zenith_deg=0,30,95"}), ThrowsMessage<InputError>(HasSubstr("zenith_deg=95")));
  EXPECT_THAT(plan({"sun.zenit=0,30"}), ThrowsMessage<InputError>(HasSubstr("zenit")));
  EXPECT_THAT(plan({"sun.zenith_deg=0"}), ThrowsMessage<InputError>(HasSubstr("nothing to sweep")));
  EXPECT_THAT(plan({"sun.zenith_deg=[0,30]"}),
              ThrowsMessage<InputError>(
                  AllOf(HasSubstr("one value that is an array"), HasSubstr("allowed sun.zenith_deg=0,30 or"))));
  EXPECT_THAT(plan({"sun.zenith_deg=0,1", "sun.zenith_deg=2,3"}), ThrowsMessage<InputError>(HasSubstr("twice")));
  const std::string suns = "sun={zenith_deg=0,azimuth_deg=0},{zenith_deg=60,azimuth_deg=0}";
  for (const char* inner : {"sun.zenith_deg=10,20", "sun.zenith_deg=10"}) {
    EXPECT_THAT(plan({inner, suns}), ThrowsMessage<InputError>(HasSubstr("inside a key that has a list"))) << inner;
    EXPECT_THAT(plan({suns, inner}), ThrowsMessage<InputError>(HasSubstr("inside a key that has a list"))) << inner;
  }
  EXPECT_THAT(plan({"sun.zenith_deg=0:89:0.1", "surface.albedo=0:1:0.01"}),
              ThrowsMessage<InputError>(HasSubstr("too many runs")));
  const std::string many = "=0:1:0.0002";
  EXPECT_THAT(plan({"a" + many, "b" + many, "c" + many, "d" + many, "e" + many}),
              ThrowsMessage<InputError>(HasSubstr("(found 3.12812625e+18, allowed")));
  for (const std::vector<std::string>& lists :
       std::vector<std::vector<std::string>>{{"output.file=a.h5,b.h5"},
                                             {"output.file=a.h5", "sun.zenith_deg=0,40"},
                                             {"output={file=\"a.h5\"},{file=\"b.h5\"}"},
                                             {"output={flux_levels=\"all\"},{file=\"b.h5\"}"}})
    EXPECT_THAT(plan(lists), ThrowsMessage<InputError>(HasSubstr("output.file: has no effect in a sweep")));
  EXPECT_THAT(plan({"layer.0.top_m=100,200"}), ThrowsMessage<InputError>(AllOf(HasSubstr("z_edge"), HasSubstr("200"))));
}

TEST(Sweep, GoesOnWithTheResultsThatAreThere) {
  const TemporaryFolder folder;
  const SweepOptions few = options_of(folder, {"sun.zenith_deg=0,40"});
  const SweepPlan plan = plan_sweep(few);
  // Finished runs of a sweep that was ended before it was complete.
  const SweepOptions other = options_of(folder, {"sun.zenith_deg=40,80"});
  EXPECT_EQ(plan_sweep(other).runs[0].key, plan.runs[1].key);
  EXPECT_NE(plan_sweep(other).runs[1].key, plan.runs[1].key);
  EXPECT_EQ(solve_sweep(few, plan).exit_code, 0);
  EXPECT_EQ(plan_sweep(other).to_solve, 2) << "a complete sweep leaves nothing";
}

// The name of a finished run is no proof of what is in the file.
TEST(Sweep, ResultsOfOtherRunsUnderTheNameOfOneAreNotUsed) {
  const TemporaryFolder folder;
  SweepOptions options = options_of(folder, {"sun.zenith_deg=0:80:40"});
  options.share = parse_job_share("--share", "2/2");
  const SweepPlan second = plan_sweep(options);
  solve_sweep(options, second);
  const auto part = [&folder](std::uint64_t key) { return folder / ("out.h5.parts/run-" + run_key_text(key) + ".h5"); };
  std::filesystem::copy_file(part(second.runs[1].key), part(second.runs[0].key));
  options.share.reset();
  const SweepPlan plan = plan_sweep(options);
  EXPECT_FALSE(plan.runs[0].done);
  EXPECT_TRUE(plan.runs[1].done);
  EXPECT_EQ(plan.to_solve, 2);
}

TEST(Sweep, AFileThatIsThereIsNotThatOfASweepWithoutResults) {
  const TemporaryFolder folder;
  SweepOptions options = options_of(folder, {"sun.zenith_deg=0,40"});
  EXPECT_TRUE(solve_sweep(options, plan_sweep(options)).written);
  const SweepPlan plan = plan_sweep(options);
  // The scene is gone before a run reads it.
  std::filesystem::remove(options.run.scene);
  const SweepOutcome outcome = solve_sweep(options, plan);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_FALSE(outcome.written);
  EXPECT_TRUE(std::filesystem::exists(options.run.output));
}

TEST(Sweep, ADryRunRefusesOutputsThatCannotBeWritten) {
  const TemporaryFolder folder;
  SweepOptions options = options_of(folder, {"sun.zenith_deg=0,40"});
  options.run.dry_run = true;
  EXPECT_NO_THROW(plan_sweep(options));
  folder.write("out.h5.parts", "a file");
  EXPECT_THAT([&] { plan_sweep(options); }, ThrowsMessage<InputError>(HasSubstr("out.h5.parts: can't be made")));
  options.run.output = folder / "missing/out.h5";
  EXPECT_THAT([&] { plan_sweep(options); }, ThrowsMessage<InputError>(HasSubstr("there is no folder")));
}

TEST(Sweep, FinishedRunsOfAnotherSweepStay) {
  const TemporaryFolder folder;
  SweepOptions interrupted = options_of(folder, {"sun.zenith_deg=40,80"});
  interrupted.share = parse_job_share("--share", "2/2");
  EXPECT_EQ(solve_sweep(interrupted, plan_sweep(interrupted)).kept, 0u);
  const SweepOptions other = options_of(folder, {"sun.zenith_deg=0,40"});
  EXPECT_EQ(solve_sweep(other, plan_sweep(other)).kept, 1u);
  interrupted.share.reset();
  const SweepPlan plan = plan_sweep(interrupted);
  EXPECT_EQ(plan.to_solve, 1u);
  EXPECT_EQ(solve_sweep(interrupted, plan).kept, 0u);
  EXPECT_FALSE(std::filesystem::exists(folder / "out.h5.parts"));
}

// The single key of a table and the list of a key in it do not contradict each other.
TEST(Sweep, ListsInsideATableThatAllRunsHave) {
  const TemporaryFolder folder;
  const SweepPlan plan =
      plan_sweep(options_of(folder, {"surface={type=\"lambertian\",albedo=0}", "surface.albedo=0.1,0.3"}));
  EXPECT_THAT(plan.runs[1].scene, HasSubstr("albedo = 0.3"));
}

// A group of results has the name of the key.
TEST(Sweep, AKeyThatNamesAGroup) {
  const TemporaryFolder folder;
  const SweepOptions options = options_of(folder, {"output.error_estimate=true,false"});
  const SweepPlan plan = plan_sweep(options);
  EXPECT_EQ(plan.dimensions[0].name, "output_error_estimate");
  EXPECT_EQ(solve_sweep(options, plan).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(options.run.output));
}

TEST(Sweep, NoMoreRunsAtATimeThanThereAre) {
  const TemporaryFolder folder;
  SweepOptions options = options_of(folder, {"sun.zenith_deg=0,40"});
  options.jobs = 99;
  EXPECT_THAT(plan_sweep(options).text, HasSubstr("predicted, 2 at a time"));
}

TEST(Sweep, SharesAreSolvedApartAndJoined) {
  const TemporaryFolder folder;
  SweepOptions options = options_of(folder, {"sun.zenith_deg=0:80:40"});
  options.share = parse_job_share("--share", "2/2");
  const SweepPlan second = plan_sweep(options);
  EXPECT_EQ(second.to_solve, 1);
  EXPECT_EQ(solve_sweep(options, second).exit_code, 0);
  EXPECT_FALSE(std::filesystem::exists(options.run.output));
  options.share = parse_job_share("--share", "1/2");
  const SweepPlan first = plan_sweep(options);
  EXPECT_EQ(first.to_solve, 2);
  EXPECT_TRUE(first.runs[1].done);
  EXPECT_EQ(solve_sweep(options, first).exit_code, 0);
  options.share.reset();
  const SweepPlan joined = plan_sweep(options);
  EXPECT_EQ(joined.to_solve, 0);
  EXPECT_EQ(solve_sweep(options, joined).exit_code, 0);
  EXPECT_TRUE(std::filesystem::exists(options.run.output));
  for (const char* wrong : {"", "2", "0/2", "3/2", "1/0", "1/2/3", "a/b", "-1/2", "1/2 "})
    EXPECT_THROW(parse_job_share("--share", wrong), InputError) << wrong;
}

}  // namespace
}  // namespace cloudbow
