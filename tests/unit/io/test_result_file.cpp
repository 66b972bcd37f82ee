// Truth: the numbers that the solution was filled with, read back by the HDF5 library itself; and the file system, as
// it was before a failed write.
#include <gmock/gmock.h>
#include <hdf5.h>
#include <hdf5_hl.h>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <iterator>

#include "cloudbow/core/error.hpp"
#include "cloudbow/core/output_files.hpp"
#include "cloudbow/io/boundary_result.hpp"
#include "cloudbow/io/result_file.hpp"
#include "sample_solution.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::ThrowsMessage;

class ResultFile : public testing::Test {
 protected:
  ResultFile() {
    std::string name = (fs::temp_directory_path() / "cloudbow-test-XXXXXX").string();
    folder_ = mkdtemp(name.data());
  }
  ~ResultFile() override { fs::remove_all(folder_); }

  std::vector<std::string> files() const {
    std::vector<std::string> name;
    for (const auto& entry : fs::directory_iterator(folder_)) name.push_back(entry.path().filename());
    return name;
  }

  fs::path folder_;
};

std::string read_text(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

void write_text(const fs::path& file, const std::string& text) { std::ofstream(file) << text; }

template <typename T>
std::vector<T> read_values(hid_t file, const char* name, hid_t type, std::vector<hsize_t>* shape = nullptr) {
  const hid_t dataset = H5Dopen2(file, name, H5P_DEFAULT);
  EXPECT_GE(dataset, 0) << name;
  const hid_t space = H5Dget_space(dataset);
  if (shape != nullptr) {
    shape->resize(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space)));
    H5Sget_simple_extent_dims(space, shape->data(), nullptr);
  }
  std::vector<T> value(static_cast<std::size_t>(H5Sget_simple_extent_npoints(space)));
  EXPECT_GE(H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, value.data()), 0) << name;
  H5Sclose(space);
  H5Dclose(dataset);
  return value;
}

double read_number(hid_t file, const char* object, const char* name) {
  double value = 0;
  EXPECT_GE(H5LTget_attribute_double(file, object, name, &value), 0) << object << ' ' << name;
  return value;
}

TEST_F(ResultFile, HoldsEveryFieldAtItsPlace) {
  const Solution solution = sample::solution(3, 4, 2);
  write_result(folder_ / "r.h5", solution, sample::info());
  EXPECT_THAT(files(), ElementsAre("r.h5"));

  const hid_t file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  ASSERT_GE(file, 0);
  std::vector<hsize_t> shape;
  EXPECT_EQ(read_values<float>(file, "upwelling_flux", H5T_NATIVE_FLOAT, &shape), solution.upwelling_flux);
  EXPECT_THAT(shape, ElementsAre(3, 4, 3));
  EXPECT_EQ(read_values<float>(file, "downwelling_diffuse_flux", H5T_NATIVE_FLOAT), solution.downwelling_diffuse_flux);
  EXPECT_EQ(read_values<float>(file, "direct_flux", H5T_NATIVE_FLOAT), solution.direct_flux);
  EXPECT_EQ(read_values<float>(file, "absorbed_power", H5T_NATIVE_FLOAT, &shape), solution.absorbed_power);
  EXPECT_THAT(shape, ElementsAre(2, 4, 3));
  EXPECT_EQ(read_values<double>(file, "profile/upwelling_flux", H5T_NATIVE_DOUBLE), solution.profile_upwelling_flux);
  EXPECT_EQ(read_values<double>(file, "profile/downwelling_diffuse_flux", H5T_NATIVE_DOUBLE),
            solution.profile_downwelling_diffuse_flux);
  EXPECT_EQ(read_values<double>(file, "profile/direct_flux", H5T_NATIVE_DOUBLE), solution.profile_direct_flux);
  EXPECT_EQ(read_values<double>(file, "profile/z_edge", H5T_NATIVE_DOUBLE), solution.box.z_edge_m);
  EXPECT_THAT(read_values<double>(file, "x", H5T_NATIVE_DOUBLE), ElementsAre(112.5, 137.5, 162.5));
  EXPECT_THAT(read_values<double>(file, "y", H5T_NATIVE_DOUBLE), ElementsAre(-25, 25, 75, 125));
  EXPECT_THAT(read_values<double>(file, "z", H5T_NATIVE_DOUBLE), ElementsAre(520, 545));
  EXPECT_THAT(read_values<double>(file, "z_edge", H5T_NATIVE_DOUBLE), ElementsAre(510, 530, 560));

  const EnergyLedger& ledger = solution.ledger;
  EXPECT_EQ(read_number(file, "summary", "reflectance"), ledger.reflectance);
  EXPECT_EQ(read_number(file, "summary", "transmittance"), ledger.transmittance);
  EXPECT_EQ(read_number(file, "summary", "transmittance_direct"), ledger.transmittance_direct);
  EXPECT_EQ(read_number(file, "summary", "absorptance"), ledger.absorptance);
  EXPECT_EQ(read_number(file, "summary", "surface_absorptance"), ledger.surface_absorptance);
  EXPECT_EQ(read_number(file, "summary", "side_gain"), ledger.side_gain);
  EXPECT_EQ(read_number(file, "summary", "side_loss"), ledger.side_loss);
  EXPECT_EQ(read_number(file, "summary", "energy_residual"), ledger.residual);
  EXPECT_EQ(read_number(file, "solver", "converged"), 1);
  EXPECT_EQ(read_number(file, "solver", "active_voxels"), 5e9);
  EXPECT_EQ(read_number(file, "solver", "gather_rescaling"), 1.001);
  EXPECT_EQ(read_number(file, "solver", "seconds_gather"), 1.5);
  H5Fclose(file);
}

Solution with_images(float factor) {
  Solution solution = sample::solution(3, 2, 1);
  solution.sun = Sun{Direction(0, 0.8, -0.6), 10};
  solution.images.resize(2);
  solution.images[0].view.name = "columns";
  solution.images[0].view.travel = Direction(0, 0, 1);
  solution.images[0].radiance = {0, 1, 2, 3, 4, 5};
  solution.images[1].view.name = "pixels";
  solution.images[1].view.travel = Direction(0, 0, -1);
  solution.images[1].view.width = 2;
  solution.images[1].view.height = 4;
  solution.images[1].radiance = {0, 1, 2, 3, 4, 5, 6, 7};
  const Camera camera =
      make_camera("eye", Camera::Projection::fisheye, {{1, 2, 3}, {1, 2, 9}, {0, 1, 0}}, std::acos(-1.), 2, 2);
  solution.camera_images.push_back({camera, {0, 1, std::numeric_limits<float>::quiet_NaN(), 3}});
  for (RadianceImage& image : solution.images) {
    for (float& value : image.radiance) value *= factor;
  }
  return solution;
}

TEST_F(ResultFile, ImagesHaveTheirOwnPixels) {
  write_result(folder_ / "r.h5", with_images(1), sample::info());
  const hid_t file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  std::vector<hsize_t> shape;
  EXPECT_THAT(read_values<float>(file, "radiance_columns", H5T_NATIVE_FLOAT, &shape), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(shape, ElementsAre(2, 3));
  EXPECT_THAT(read_values<float>(file, "radiance_pixels", H5T_NATIVE_FLOAT, &shape),
              ElementsAre(0, 1, 2, 3, 4, 5, 6, 7));
  EXPECT_THAT(shape, ElementsAre(4, 2));
  // The domain reaches from 100 to 175 m and from -50 to 50 m.
  EXPECT_THAT(read_values<double>(file, "x_pixels", H5T_NATIVE_DOUBLE), ElementsAre(118.75, 156.25));
  EXPECT_THAT(read_values<double>(file, "y_pixels", H5T_NATIVE_DOUBLE), ElementsAre(-37.5, -12.5, 12.5, 37.5));
  EXPECT_EQ(H5Lexists(file, "x_columns", H5P_DEFAULT), 0);
  const auto camera = read_values<float>(file, "camera_eye", H5T_NATIVE_FLOAT, &shape);
  EXPECT_THAT(shape, ElementsAre(2, 2));
  EXPECT_EQ(camera[3], 3);
  EXPECT_TRUE(std::isnan(camera[2]));
  EXPECT_THAT(read_values<double>(file, "row_eye", H5T_NATIVE_DOUBLE), ElementsAre(1.5, 0.5));
  EXPECT_EQ(read_number(file, "camera_eye", "field_of_view_deg"), 180);
  std::array<double, 3> position{};
  EXPECT_GE(H5LTget_attribute_double(file, "camera_eye", "position_m", position.data()), 0);
  EXPECT_THAT(position, ElementsAre(1, 2, 3));
  // pi I over mu0 F0 = 0.6 * 10.
  const auto factor = read_values<float>(file, "reflectance_factor_columns", H5T_NATIVE_FLOAT);
  EXPECT_FLOAT_EQ(factor[5], static_cast<float>(std::acos(-1.) * 5 / 6));
  EXPECT_FLOAT_EQ(read_values<float>(file, "reflectance_factor_eye", H5T_NATIVE_FLOAT)[3],
                  static_cast<float>(std::acos(-1.) * 3 / 6));
  H5Fclose(file);
}

TEST_F(ResultFile, NoReflectanceFactorWithoutASun) {
  Solution solution = with_images(1);
  solution.sun.reset();
  write_result(folder_ / "r.h5", solution, sample::info());
  const hid_t file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_EQ(H5Lexists(file, "reflectance_factor_columns", H5P_DEFAULT), 0);
  EXPECT_EQ(H5Lexists(file, "radiance_columns", H5P_DEFAULT), 1);
  H5Fclose(file);
}

std::string read_attribute(hid_t file, const char* object, const char* name) {
  std::string text(256, '\0');
  EXPECT_GE(H5LTget_attribute_string(file, object, name, text.data()), 0) << object << ' ' << name;
  return text.substr(0, text.find('\0'));
}

// Brightness temperature of a radiance B(T) is T; fractions of what enters mean nothing if matter emits.
TEST_F(ResultFile, OfASceneThatEmitsHoldsFluxesAndTemperatures) {
  const PlanckFunction planck = PlanckFunction::at(10.8);
  Solution solution = sample::thermal_solution(3, 2, 1);
  solution.sun = Sun{Direction(0, 0.8, -0.6), 10};
  const Solution with_image = with_images(1);
  solution.images = {with_image.images[0]};
  solution.camera_images = with_image.camera_images;
  for (std::size_t n = 0; n < 6; ++n)
    solution.images[0].radiance[n] = n == 0 ? 0 : static_cast<float>(planck(200 + 20 * static_cast<double>(n)));
  ResultInfo info = sample::info();
  info.thermal = {{planck, 10.8, {}, "us-1976", 288.2, "", "temperature", 3.}};
  info.brightness_temperatures = {"columns", "eye"};
  info.heating_rates = {{std::vector<float>(6, 2e-3F), {1e-3}}};
  write_result(folder_ / "r.h5", solution, info);
  const hid_t file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  const auto kelvin = read_values<float>(file, "brightness_temperature_columns", H5T_NATIVE_FLOAT);
  EXPECT_EQ(kelvin[0], 0);
  for (std::size_t n = 1; n < 6; ++n)
    EXPECT_NEAR(kelvin[n], 200 + 20 * static_cast<double>(n), 1e-3) << "radiance in float";
  EXPECT_TRUE(std::isnan(read_values<float>(file, "brightness_temperature_eye", H5T_NATIVE_FLOAT)[2]));
  EXPECT_EQ(H5Lexists(file, "reflectance_factor_columns", H5P_DEFAULT), 0);
  EXPECT_EQ(H5Lexists(file, "absorbed_power", H5P_DEFAULT), 0);
  EXPECT_EQ(H5LTfind_dataset(file, "net_absorbed_power"), 1);
  for (const auto& [variable, units] :
       {std::pair("upwelling_flux", "W m-2 um-1"), std::pair("radiance_columns", "W m-2 sr-1 um-1"),
        std::pair("net_absorbed_power", "W m-3 um-1"), std::pair("heating_rate", "K s-1 um-1"),
        std::pair("brightness_temperature_eye", "K")})
    EXPECT_EQ(read_attribute(file, variable, "units"), units) << variable;
  EXPECT_EQ(read_attribute(file, "heating_rate", "units_metadata"), "temperature: difference");
  EXPECT_THAT(read_values<double>(file, "profile/heating_rate", H5T_NATIVE_DOUBLE), ElementsAre(1e-3));
  EXPECT_THAT(read_values<double>(file, "profile/z", H5T_NATIVE_DOUBLE), ElementsAre(520));
  EXPECT_EQ(read_number(file, "ledger", "power"), 8);
  EXPECT_EQ(read_number(file, "ledger", "upwelling_top"), 4);
  EXPECT_EQ(read_number(file, "ledger", "surface_emitted"), 6);
  EXPECT_EQ(read_number(file, "ledger", "incident"), 2);
  EXPECT_EQ(read_attribute(file, "ledger", "units"), "W m-2 um-1");
  EXPECT_EQ(read_number(file, "summary", "energy_residual"), solution.ledger.residual);
  EXPECT_EQ(H5Aexists_by_name(file, "summary", "reflectance", H5P_DEFAULT), 0);
  EXPECT_EQ(read_number(file, "thermal", "wavelength_um"), 10.8);
  EXPECT_EQ(read_number(file, "thermal", "surface_temperature_k"), 288.2);
  EXPECT_EQ(read_attribute(file, "thermal", "cloud_temperature_grid"), "temperature");
  H5Fclose(file);

  const BoundaryResult boundary = read_boundary_result(folder_ / "r.h5");
  EXPECT_EQ(boundary.fluxes[0].reflectance, solution.ledger.reflectance) << "of power, for trade-offs";
  EXPECT_EQ(boundary.fluxes[0].transmittance, solution.ledger.transmittance);
}

TEST_F(ResultFile, OfABandHasTheUnitsOfSunlight) {
  Solution solution = sample::thermal_solution(3, 2, 1);
  ResultInfo info = sample::info();
  info.thermal = {{PlanckFunction::over({8, 12}), {}, std::array<double, 2>{8, 12}, "inline", {}, "t.nc", "", {}}};
  info.heating_rates = {{std::vector<float>(6, 2e-3F), {1e-3}}};
  write_result(folder_ / "r.h5", solution, info);
  const hid_t file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_EQ(read_attribute(file, "upwelling_flux", "units"), "W m-2");
  EXPECT_EQ(read_attribute(file, "upwelling_flux", "standard_name"), "upwelling_longwave_flux_in_air");
  EXPECT_EQ(read_attribute(file, "heating_rate", "standard_name"),
            "tendency_of_air_temperature_due_to_longwave_heating");
  std::array<double, 2> band{};
  EXPECT_GE(H5LTget_attribute_double(file, "thermal", "band_um", band.data()), 0);
  EXPECT_THAT(band, ElementsAre(8, 12));
  EXPECT_EQ(read_attribute(file, "thermal", "surface_temperature_map"), "t.nc");
  H5Fclose(file);
}

TEST_F(ResultFile, HoldsTheExtinctionOfTheCloud) {
  ResultInfo info = sample::info();
  info.cloud_extinction = {{0, 1, 2, 3, 4, 5}};
  info.cloud_optical_depth_um = .55;
  write_result(folder_ / "r.h5", sample::solution(3, 1, 2), info);
  const hid_t file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  std::vector<hsize_t> shape;
  EXPECT_THAT(read_values<float>(file, "extinction", H5T_NATIVE_FLOAT, &shape), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(shape, ElementsAre(2, 1, 3));
  EXPECT_EQ(read_attribute(file, "extinction", "units"), "m-1");
  EXPECT_EQ(read_number(file, "extinction", "wavelength_um"), .55);
  H5Fclose(file);
}

TEST_F(ResultFile, HoldsTheOpticalDepthOfTheCloud) {
  const Solution solution = sample::solution(3, 2, 1);
  ResultInfo info = sample::info();
  info.cloud_optical_depth = {{0, 1, 2, 3, 4, 5}};
  info.cloud_optical_depth_um = .55;
  write_result(folder_ / "r.h5", solution, info);
  hid_t file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  std::vector<hsize_t> shape;
  EXPECT_THAT(read_values<float>(file, "optical_depth", H5T_NATIVE_FLOAT, &shape), ElementsAre(0, 1, 2, 3, 4, 5));
  EXPECT_THAT(shape, ElementsAre(2, 3));
  EXPECT_EQ(read_attribute(file, "optical_depth", "units"), "1");
  EXPECT_EQ(read_attribute(file, "optical_depth", "standard_name"), "atmosphere_optical_thickness_due_to_cloud");
  EXPECT_EQ(read_number(file, "optical_depth", "wavelength_um"), .55);
  H5Fclose(file);

  const std::vector<Solution> solutions{solution, solution};
  info.wavelengths_um = {0.67, 0.55};
  info.cloud_optical_depth = {{0, 1, 2, 3, 4, 5}, {10, 11, 12, 13, 14, 15}};
  info.cloud_optical_depth_um.reset();
  write_result(folder_ / "r.h5", solutions, info);
  file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_EQ(read_values<float>(file, "optical_depth", H5T_NATIVE_FLOAT, &shape).back(), 15);
  EXPECT_THAT(shape, ElementsAre(2, 2, 3));
  EXPECT_EQ(H5Aexists_by_name(file, "optical_depth", "wavelength_um", H5P_DEFAULT), 0);
  H5Fclose(file);
}

TEST_F(ResultFile, HoldsBands) {
  const Solution solution = sample::solution(3, 2, 1);
  ResultInfo info = sample::info();
  info.bands = {{{100, 700}, {1, 2}, {3, 4}, {5, 6}, {7}}, {{700, 900}, {11, 12}, {13, 14}, {15, 16}, {17}}};
  write_result(folder_ / "r.h5", solution, info);
  const hid_t file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  std::vector<hsize_t> shape;
  const auto values = [&](const char* name) { return read_values<double>(file, name, H5T_NATIVE_DOUBLE, &shape); };
  EXPECT_THAT(values("bands/wavenumber_bounds"), ElementsAre(100, 700, 700, 900));
  EXPECT_THAT(shape, ElementsAre(2, 2));
  EXPECT_THAT(values("bands/upwelling_flux"), ElementsAre(1, 2, 11, 12));
  EXPECT_THAT(values("bands/downwelling_diffuse_flux"), ElementsAre(3, 4, 13, 14));
  EXPECT_THAT(values("bands/direct_flux"), ElementsAre(5, 6, 15, 16));
  EXPECT_THAT(values("bands/absorbed_power"), ElementsAre(7, 17));
  EXPECT_THAT(shape, ElementsAre(2, 1));
  EXPECT_EQ(read_attribute(file, "bands/wavenumber_bounds", "units"), "cm-1");
  EXPECT_EQ(read_attribute(file, "bands/direct_flux", "units"), "W m-2");
  EXPECT_THAT(values("bands/z"), ElementsAre(520));
  H5Fclose(file);
}

TEST_F(ResultFile, ASpectrumIsADimensionMore) {
  std::vector<Solution> solutions{with_images(1), with_images(2)};
  solutions[1].ledger.reflectance = 0.25;
  solutions[1].report.sweeps = 5;
  for (float& flux : solutions[1].upwelling_flux) flux += 1;
  ResultInfo info = sample::info();
  info.wavelengths_um = {0.67, 0.55};
  info.phase_classes = {3, 4};
  info.phase_class_error = {1e-3, 2e-3};
  write_result(folder_ / "r.h5", solutions, info);
  const hid_t file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  EXPECT_THAT(read_values<double>(file, "wavelength", H5T_NATIVE_DOUBLE), ElementsAre(0.67, 0.55));
  std::vector<hsize_t> shape;
  const auto flux = read_values<float>(file, "upwelling_flux", H5T_NATIVE_FLOAT, &shape);
  EXPECT_THAT(shape, ElementsAre(2, 2, 2, 3));
  EXPECT_EQ(flux.front(), solutions[0].upwelling_flux.front());
  EXPECT_EQ(flux.back(), solutions[1].upwelling_flux.back());
  EXPECT_EQ(read_values<float>(file, "radiance_pixels", H5T_NATIVE_FLOAT, &shape).back(), 14);
  EXPECT_THAT(shape, ElementsAre(2, 4, 2));
  read_values<double>(file, "profile/upwelling_flux", H5T_NATIVE_DOUBLE, &shape);
  EXPECT_THAT(shape, ElementsAre(2, 2));
  std::array<double, 2> reflectance{};
  EXPECT_GE(H5LTget_attribute_double(file, "summary", "reflectance", reflectance.data()), 0);
  EXPECT_THAT(reflectance, ElementsAre(0.5, 0.25));
  std::array<int, 2> sweeps{}, classes{};
  EXPECT_GE(H5LTget_attribute_int(file, "solver", "sweeps", sweeps.data()), 0);
  EXPECT_THAT(sweeps, ElementsAre(17, 5));
  EXPECT_GE(H5LTget_attribute_int(file, "solver", "phase_classes", classes.data()), 0);
  EXPECT_THAT(classes, ElementsAre(3, 4));
  H5Fclose(file);
}

TEST_F(ResultFile, HoldsTheDifferenceFromIndependentColumns) {
  for (const std::vector<int>& levels : {std::vector<int>{}, std::vector<int>{0, 2}}) {
    const Solution solution = sample::solution(3, 4, 2, levels);
    Solution columns = solution;
    for (float& value : columns.upwelling_flux) value -= 0.25F;
    for (float& value : columns.direct_flux) value += 0.5F;
    columns.ledger.reflectance = 0.75;
    write_result(folder_ / "r.h5", std::span(&solution, 1), sample::info(), std::span(&columns, 1));
    const hid_t file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    ASSERT_GE(file, 0);
    std::vector<hsize_t> shape;
    EXPECT_THAT(read_values<float>(file, "difference_upwelling_flux", H5T_NATIVE_FLOAT, &shape), testing::Each(0.25F));
    EXPECT_THAT(shape, ElementsAre(solution.flux_level.size(), 4, 3));
    EXPECT_THAT(read_values<float>(file, "difference_downwelling_diffuse_flux", H5T_NATIVE_FLOAT), testing::Each(0.0F));
    EXPECT_THAT(read_values<float>(file, "difference_direct_flux", H5T_NATIVE_FLOAT), testing::Each(-0.5F));
    EXPECT_EQ(read_values<float>(file, "independent_columns_upwelling_flux", H5T_NATIVE_FLOAT), columns.upwelling_flux);
    EXPECT_EQ(read_values<float>(file, "independent_columns_direct_flux", H5T_NATIVE_FLOAT), columns.direct_flux);
    EXPECT_EQ(read_values<double>(file, "independent_columns/upwelling_flux", H5T_NATIVE_DOUBLE),
              columns.profile_upwelling_flux);
    EXPECT_EQ(read_number(file, "independent_columns", "reflectance"), 0.75);
    H5Fclose(file);
  }
}

TEST_F(ResultFile, HoldsTheSunAndTheFacesOfCells) {
  ResultInfo info = sample::info();
  info.sun = SunPosition{60, 75};
  write_result(folder_ / "r.h5", sample::solution(2, 2, 2), info);
  const hid_t file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  std::vector<hsize_t> shape;
  EXPECT_THAT(read_values<double>(file, "solar_zenith_angle", H5T_NATIVE_DOUBLE, &shape), ElementsAre(60));
  EXPECT_THAT(shape, IsEmpty());
  EXPECT_THAT(read_values<double>(file, "solar_azimuth_angle", H5T_NATIVE_DOUBLE), ElementsAre(75));
  EXPECT_THAT(read_values<double>(file, "z_bounds", H5T_NATIVE_DOUBLE, &shape), ElementsAre(510, 530, 530, 560));
  EXPECT_THAT(shape, ElementsAre(2, 2));
  std::array<char, 100> text{};
  EXPECT_GE(H5LTget_attribute_string(file, "upwelling_flux", "coordinates", text.data()), 0);
  EXPECT_STREQ(text.data(), "solar_zenith_angle solar_azimuth_angle");
  EXPECT_GE(H5LTget_attribute_string(file, "z", "bounds", text.data()), 0);
  EXPECT_EQ(std::string(text.data(), 8), "z_bounds");
  H5Fclose(file);
}

TEST_F(ResultFile, LeavesOutWhatTheSolutionLacks) {
  Solution solution = sample::solution(2, 2, 2);
  solution.absorbed_power.clear();
  solution.actinic_flux.clear();
  write_result(folder_ / "r.h5", solution, sample::info());
  const hid_t file = H5Fopen((folder_ / "r.h5").c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
  for (const char* name : {"absorbed_power", "actinic_flux", "radiance_field", "z_flux"}) {
    EXPECT_EQ(H5Lexists(file, name, H5P_DEFAULT), 0) << name;
  }
  H5Fclose(file);
}

TEST_F(ResultFile, EqualSolutionsMakeEqualBytes) {
  write_result(folder_ / "a.h5", sample::solution(40, 40, 12), sample::info());
  sleep(1);  // times of creation, if stored, count in seconds
  write_result(folder_ / "b.h5", sample::solution(40, 40, 12), sample::info());
  EXPECT_EQ(read_text(folder_ / "a.h5"), read_text(folder_ / "b.h5"));
}

TEST_F(ResultFile, ReplacesAnOlderFileAndKeepsLinks) {
  write_text(folder_ / "real.h5", "older");
  fs::create_symlink("real.h5", folder_ / "link.h5");
  write_result(folder_ / "link.h5", sample::solution(2, 2, 2), sample::info());
  EXPECT_TRUE(fs::is_symlink(folder_ / "link.h5"));
  EXPECT_GT(H5Fis_hdf5((folder_ / "real.h5").c_str()), 0);
}

/// Writes of this process past `bytes` fail while the object lives, as on a full disk.
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    setrlimit(RLIMIT_FSIZE, &limit);
    handler_ = std::signal(SIGXFSZ, SIG_IGN);
  }
  ~FileSizeLimit() {
    std::signal(SIGXFSZ, handler_);
    setrlimit(RLIMIT_FSIZE, &before_);
  }

 private:
  rlimit before_{};
  void (*handler_)(int);
};

// HDF5's own filters invert the work of the threads: several chunks, of which the last is not full. They are cut along
// the first axis (1 MiB holds some maps) and along the second (less than one).
TEST_F(ResultFile, HoldsFieldsOfManyChunks) {
  for (const auto& [nx, ny, nz] : {std::array{150, 90, 45}, std::array{520, 600, 2}}) {
    const Solution solution = sample::solution(nx, ny, nz);
    const fs::path file = folder_ / "r.h5";
    write_result(file, solution, sample::info());
    const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    ASSERT_GE(opened, 0);
    EXPECT_EQ(read_values<float>(opened, "upwelling_flux", H5T_NATIVE_FLOAT), solution.upwelling_flux);
    EXPECT_EQ(read_values<float>(opened, "direct_flux", H5T_NATIVE_FLOAT), solution.direct_flux);
    EXPECT_EQ(read_values<float>(opened, "absorbed_power", H5T_NATIVE_FLOAT), solution.absorbed_power);
    H5Fclose(opened);
    EXPECT_LT(fs::file_size(file), solution.upwelling_flux.size() * 5 * sizeof(float));  // compressed at all
  }
}

/// In a separate process, because HDF5 keeps objects that it could not close.
[[noreturn]] void write_on_full_disk(const fs::path& file, const Solution& solution, rlim_t limit) {
  std::string message;
  {
    const FileSizeLimit full(limit);  // stderr may be a file too: print without the limit
    try {
      write_result(file, solution, sample::info());
    } catch (const InputError& error) {
      message = error.what();
    }
  }
  std::fputs(message.c_str(), stderr);
  _exit(message.empty() ? 0 : 2);
}

TEST_F(ResultFile, FullDiskLeavesTheOlderFileAndNothingElse) {
  const Solution solution = sample::solution(40, 40, 12);
  const fs::path file = folder_ / "r.h5";
  write_result(file, solution, sample::info());
  const auto size = fs::file_size(file);
  write_text(file, "older");
  // Limits from nothing to one byte too few: HDF5 then fails while creating, writing, flushing and closing.
  constexpr unsigned steps = 60;
  for (unsigned step = 0; step <= steps; ++step) {
    const rlim_t limit = (size - 1) * step / steps;
    EXPECT_EXIT(write_on_full_disk(file, solution, limit), testing::ExitedWithCode(2),
                "r\\.h5: can't be written \\(File too large\\)")
        << limit;
    ASSERT_EQ(read_text(file), "older") << limit;
    ASSERT_THAT(files(), ElementsAre("r.h5")) << limit;
  }
  EXPECT_EXIT(write_on_full_disk(file, solution, 2 * size), testing::ExitedWithCode(0), "");
  EXPECT_EQ(fs::file_size(file), size);
}

/// Both say the same: one before the solve, one after.
void expect_unwritable(const fs::path& file, const std::string& reason) {
  const auto message = AllOf(HasSubstr(file.string()), HasSubstr(reason));
  EXPECT_THAT([&] { check_writable(file); }, ThrowsMessage<InputError>(message));
  EXPECT_THAT([&] { write_result(file, sample::solution(2, 2, 2), sample::info()); },
              ThrowsMessage<InputError>(message));
}

TEST_F(ResultFile, NamesWhatIsWrongWithTheTarget) {
  expect_unwritable(folder_ / "missing" / "r.h5", "there is no folder " + (folder_ / "missing").string());
  expect_unwritable(folder_, "it is a directory");
  write_text(folder_ / "file", "");
  expect_unwritable(folder_ / "file" / "r.h5", "is not a folder");
  expect_unwritable("/dev/null", "it is a device");
  expect_unwritable("", "the name of a file is missing");
  expect_unwritable(folder_ / std::string(300, 'n'), "File name too long");
  EXPECT_THAT(files(), ElementsAre("file"));
}

TEST_F(ResultFile, NamesFoldersWithoutPermission) {
  // The superuser may write anywhere: take another user's place.
  const bool superuser = geteuid() == 0;
  const fs::path locked = folder_ / "locked";
  fs::create_directory(locked);
  write_text(locked / "older.h5", "older");
  chmod(folder_.c_str(), 0755);
  chmod(locked.c_str(), 0555);
  ASSERT_EQ(superuser ? seteuid(65534) : 0, 0);
  expect_unwritable(locked / "new.h5", "Permission denied");
  expect_unwritable(locked / "older.h5", "Permission denied");
  ASSERT_EQ(superuser ? seteuid(0) : 0, 0);
  chmod(locked.c_str(), 0755);
  EXPECT_EQ(read_text(locked / "older.h5"), "older");
}

TEST_F(ResultFile, CheckTouchesNothing) {
  write_text(folder_ / "r.h5", "older");
  const auto time = fs::last_write_time(folder_ / "r.h5");
  check_writable(folder_ / "r.h5");
  check_writable(folder_ / "new.h5");
  EXPECT_EQ(fs::last_write_time(folder_ / "r.h5"), time);
  EXPECT_EQ(read_text(folder_ / "r.h5"), "older");
  EXPECT_THAT(files(), ElementsAre("r.h5"));
}

}  // namespace
}  // namespace cloudbow
