// `cloudbow gas` on a small made-up gas model. Truth: the exit codes promised, gas_optics(), and one message per error.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "call_cloudbow.hpp"
#include "cloudbow/medium/gas_model.hpp"
#include "ecckd_example.hpp"
#include "io/hdf5_handle.hpp"
#include "temporary_folder.hpp"

namespace cloudbow {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* profile =
    "# z(km) p(mb) T(K) h2o(mol/mol) o3(ppm)\n10 300 220 1e-4 0.5\n5 550 250 1e-3 0.05\n0 1000 280 1e-2 0.03\n";

std::vector<double> values(const std::filesystem::path& file, const char* name) {
  const hdf5::Handle opened = hdf5::open_file(file);
  return hdf5::read_all<double>(hdf5::open_dataset(opened, name));
}

TEST(GasCommands, DescribeAModel) {
  const TemporaryFolder folder;
  const auto solar = ecckd_example::make_file(folder / "solar.nc", {.is_solar = true});
  const Outcome outcome = cloudbow({"gas", "info", solar});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, AllOf(HasSubstr("solar"), HasSubstr("g-points: 2\n"), HasSubstr("h2o, o3, ch4"),
                                    HasSubstr("600 to 900 cm-1 in 2 intervals"), HasSubstr("75.0000")));
  EXPECT_THAT(cloudbow({"gas", "info", ecckd_example::make_file(folder / "longwave.nc")}).output,
              AllOf(HasSubstr("longwave"), HasSubstr("black-body emission at 288 K")));
}

TEST(GasCommands, WriteOpticalDepths) {
  const TemporaryFolder folder;
  const auto air = folder.write("air.txt", profile);
  const auto longwave = ecckd_example::make_file(folder / "longwave.nc");
  const auto file = folder / "optics.h5";
  const Outcome outcome = cloudbow({"gas", "optics", air, "--model", longwave, "--mole-fraction", "ch4=3e-6",
                                    "--heights-m", "0", "2000", "7000", "-o", file});
  EXPECT_EQ(outcome.exit_code, 0) << outcome.errors;
  EXPECT_THAT(outcome.output, HasSubstr("2 layers from 0 to 7000 m"));
  Atmosphere atmosphere = read_atmosphere(air);
  atmosphere.mole_fraction["ch4"] = {3e-6, 3e-6, 3e-6};
  const auto model = read_gas_model(longwave);
  const auto expected = gas_optics(*model, atmosphere, std::vector<double>{0, 2000, 7000});
  EXPECT_THAT(values(file, "absorption_optical_depth"),
              ElementsAre(expected.absorption[0][0], expected.absorption[0][1], expected.absorption[1][0],
                          expected.absorption[1][1]));
  EXPECT_THAT(values(file, "z_edge"), ElementsAre(0, 2000, 7000));
  EXPECT_EQ(values(file, "planck_radiance")[4], model->planck(1, atmosphere.temperature_at(2000)));

  const auto solar = ecckd_example::make_file(folder / "solar.nc", {.is_solar = true});
  EXPECT_EQ(
      cloudbow({"gas", "optics", air, "--model", solar, "--mole-fraction", "ch4=0", "-o", file, "--quiet"}).output, "");
  EXPECT_THAT(values(file, "z_edge"), ElementsAre(0, 5000, 10000));
  EXPECT_THAT(values(file, "solar_share"), ElementsAre(0.75, 0.25));
  EXPECT_EQ(values(file, "rayleigh_optical_depth").size(), 4U);
}

TEST(GasCommands, TellWhatIsWrong) {
  const TemporaryFolder folder;
  const std::string air = folder.write("air.txt", profile), output = folder / "optics.h5";
  const std::string model = ecckd_example::make_file(folder / "model.nc");
  const std::vector<std::string> optics{"gas", "optics", air, "--model", model};
  const auto with = [&](std::vector<std::string> more) {
    more.insert(more.begin(), optics.begin(), optics.end());
    return more;
  };
  struct Case {
    std::vector<std::string> arguments;
    const char* words;
  };
  for (const Case& wrong : {
           Case{{"gas"}, "gas"},
           Case{{"gas", "info"}, "model"},
           Case{{"gas", "info", air}, "no gas model (found neither netCDF nor HDF5"},
           Case{{"gas", "optics", air, "-o", output}, "--model"},
           Case{with({"-o", output}), "lacks gases of the gas model: ch4"},
           Case{with({"-o", output}), "--mole-fraction GAS=X"},
           Case{with({"--mole-fraction", "ch4", "-o", output}), "found 'ch4', allowed GAS=X"},
           Case{with({"--mole-fraction", "ch4=2", "-o", output}), "found 'ch4=2'"},
           Case{with({"--mole-fraction", "=0", "-o", output}), "found '=0'"},
           Case{with({"--mole-fraction", "ch4=0", "--heights-m", "5", "-o", output}), "--heights-m: too few"},
           Case{with({"--mole-fraction", "ch4=0", "--heights-m", "5", "4", "-o", output}), "--heights-m: not in order"},
           Case{with({"--mole-fraction", "ch4=0", "-o", model}), "would overwrite an input"},
           Case{with({"--mole-fraction", "ch4=0", "-o", folder / "optics.png"}), "found .png"},
       }) {
    const Outcome outcome = cloudbow(wrong.arguments);
    EXPECT_EQ(outcome.exit_code, 2) << testing::PrintToString(wrong.arguments);
    EXPECT_EQ(std::count(outcome.errors.begin(), outcome.errors.end(), '\n'), 1) << outcome.errors;
    EXPECT_THAT(outcome.errors, HasSubstr(wrong.words));
    EXPECT_FALSE(std::filesystem::exists(output));
  }
}

}  // namespace
}  // namespace cloudbow
