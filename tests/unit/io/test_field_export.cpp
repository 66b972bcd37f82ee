// Truth: the numbers that the result was filled with and ControlPoints::stencil. The grids are read back by the reader
// of clouds and by OpenVDB itself; and the file system, as it was before a failed export.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>
#include <openvdb/openvdb.h>

#include <cstdlib>
#include <fstream>
#include <map>

#include "cloudbow/core/error.hpp"
#include "cloudbow/io/field_export.hpp"
#include "cloudbow/medium/vdb_file.hpp"
#include "cloudbow/sphere/ordinate_set.hpp"
#include "sample_solution.hpp"

namespace cloudbow {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::DoubleNear;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::ThrowsMessage;

using Cell = std::array<std::int32_t, 3>;
using Values = std::map<Cell, float>;

// Doubles that are rounded to float at the end: half a unit in its last place.
constexpr double float_type = 6e-8;

/// Active voxels of a grid.
Values values_of(const CloudField& field) {
  Values values;
  for (int k = 0; k < field.cells[2]; ++k) {
    for (int j = 0; j < field.cells[1]; ++j) {
      const int row = k * field.cells[1] + j;
      for (auto s = field.row_begin[row]; s < field.row_begin[row + 1]; ++s) {
        const RowSpan& span = field.spans[s];
        for (int n = 0; n < span.n; ++n) values[{span.i + n, j, k}] = field.value[span.offset + n];
      }
    }
  }
  return values;
}

class FieldExport : public testing::Test {
 protected:
  FieldExport() {
    std::string name = (fs::temp_directory_path() / "cloudbow-test-XXXXXX").string();
    folder_ = mkdtemp(name.data());
    options_.result_file = folder_ / "result.h5";
    options_.vdb_file = folder_ / "fields.vdb";
  }
  ~FieldExport() override { fs::remove_all(folder_); }

  /// 3 x 2 columns, 4 levels of 20 m from 500 m on.
  static Solution even_solution() {
    Solution solution = sample::solution(3, 2, 4);
    solution.box.z_edge_m = {500, 520, 540, 560, 580};
    return solution;
  }

  Values read(const std::string& grid) const {
    VdbReadOptions options;
    options.grid = grid;
    return values_of(read_cloud_vdb(options_.vdb_file, options));
  }

  auto exporting() const {
    return [this] { export_fields(options_); };
  }

  fs::path folder_;
  FieldExportOptions options_;
  const ControlPoints points_{42, control_point_frame_rotation()};
  const std::vector<Cell> cells_{{0, 0, 0}, {2, 0, 0}, {1, 1, 1}, {0, 1, 3}};
};

TEST_F(FieldExport, RadianceIsInterpolatedAsByTheLibrary) {
  Solution solution = even_solution();
  solution.radiance_field = sample::radiance_field(points_, cells_);
  write_result(options_.result_file, solution, sample::info());
  const std::vector<Direction> directions = sample::directions();
  for (std::size_t d = 0; d < directions.size(); d += 6) {
    const Direction& travel = directions[d];
    options_.travel = 5 * travel;
    const FieldExportReport report = export_fields(options_);
    EXPECT_THAT(report.grids, ElementsAre("radiance"));
    EXPECT_TRUE(report.whole_domain);
    const Values values = read("radiance");
    ASSERT_EQ(values.size(), cells_.size());
    for (std::size_t c = 0; c < cells_.size(); ++c) {
      const double expected = sample::queried(points_, *solution.radiance_field, c, travel);
      EXPECT_NEAR(values.at(cells_[c]), expected, float_type * expected);
    }
  }
}

TEST_F(FieldExport, GridsStandWhereTheVoxelsOfTheCloudDo) {
  Solution solution = even_solution();
  solution.radiance_field = sample::radiance_field(points_, cells_);
  write_result(options_.result_file, solution, sample::info());
  options_.travel = Direction(0, 0, 2);
  export_fields(options_);
  openvdb::initialize();
  openvdb::io::File file(options_.vdb_file);
  file.open();
  const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid("radiance"));
  EXPECT_EQ(grid->indexToWorld(openvdb::Vec3d(0, 0, 0)), openvdb::Vec3d(112.5, -25, 510));  // centres
  EXPECT_EQ(grid->voxelSize(), openvdb::Vec3d(25, 50, 20));
  EXPECT_EQ(grid->metaValue<openvdb::Vec3d>("domain_min_m"), openvdb::Vec3d(100, -50, 500));
  EXPECT_EQ(grid->metaValue<openvdb::Vec3d>("domain_max_m"), openvdb::Vec3d(175, 50, 580));
  EXPECT_EQ(grid->metaValue<openvdb::Vec3d>("direction"), openvdb::Vec3d(0, 0, 1));
  EXPECT_EQ(grid->metaValue<std::string>("quantity"), "radiance");
  EXPECT_EQ(grid->metaValue<std::string>("units"), "W m-2 sr-1");
  EXPECT_EQ(grid->activeVoxelCount(), cells_.size());
  EXPECT_EQ(grid->background(), 0);
}

TEST_F(FieldExport, AllDirectionsAreThoseOfTheFileHoweverManyAreReadAtOnce) {
  Solution solution = even_solution();
  solution.radiance_field = sample::radiance_field(points_, cells_);
  write_result(options_.result_file, solution, sample::info());
  options_.all_directions = true;
  for (const std::size_t bytes : {std::size_t{0}, 5 * 4 * cells_.size(), std::size_t{1} << 20}) {
    options_.batch_bytes = bytes;
    EXPECT_EQ(export_fields(options_).grids.size(), 42U);
    openvdb::initialize();
    openvdb::io::File file(options_.vdb_file);
    file.open();
    for (int d = 0; d < 42; ++d) {
      const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(
          file.readGrid("radiance_0" + std::to_string(d / 10) + std::to_string(d % 10)));
      const Direction& travel = points_.directions()[d];
      EXPECT_EQ(grid->metaValue<openvdb::Vec3d>("direction"), openvdb::Vec3d(travel.x(), travel.y(), travel.z()));
      for (std::size_t c = 0; c < cells_.size(); ++c) {
        const auto [i, j, k] = cells_[c];
        EXPECT_EQ(grid->tree().getValue({i, j, k}), solution.radiance_field->radiance[42 * c + d]);
      }
    }
  }
}

// Enough cells for several chunks of the file: 42 x 4 bytes x 30000 = 5 MB.
TEST_F(FieldExport, FieldsOfManyChunksAreReadWhole) {
  Solution solution = sample::solution(100, 100, 3);
  solution.box.z_edge_m = {0, 10, 20, 30};
  std::vector<Cell> cells;
  for (int c = 0; c < 30000; ++c) cells.push_back({c % 100, c / 100 % 100, c / 10000});
  solution.radiance_field = sample::radiance_field(points_, cells);
  write_result(options_.result_file, solution, sample::info());
  options_.travel = Direction(1, 2, 3).normalized();
  export_fields(options_);
  const Values values = read("radiance");
  ASSERT_EQ(values.size(), cells.size());
  for (std::size_t c = 0; c < cells.size(); c += 7) {
    const double expected = sample::queried(points_, *solution.radiance_field, c, *options_.travel);
    ASSERT_NEAR(values.at(cells[c]), expected, float_type * expected);
  }
}

TEST_F(FieldExport, CellFieldsAreThoseOfTheFile) {
  Solution solution = even_solution();
  solution.absorbed_power[5] = 0;
  write_result(options_.result_file, solution, sample::info());
  options_.actinic = options_.absorption = true;
  EXPECT_THAT(export_fields(options_).grids, ElementsAre("actinic_flux", "absorbed_power"));
  const Values actinic = read("actinic_flux"), absorbed = read("absorbed_power");
  EXPECT_EQ(actinic.size(), 23U);   // one is not a number
  EXPECT_EQ(absorbed.size(), 23U);  // one is 0
  EXPECT_FALSE(actinic.contains(Cell{0, 0, 0}));
  EXPECT_EQ(actinic.at({2, 1, 3}), sample::field_value(5, 3, 1, 2));
  EXPECT_EQ(absorbed.at({1, 0, 2}), sample::field_value(4, 2, 0, 1));
}

// Net power and cooling are negative; their grids have the spectral unit of the result.
TEST_F(FieldExport, OfScenesThatEmitNetPowerAndHeatingRatesAreExported) {
  Solution solution = even_solution();
  solution.emits = true;
  solution.absorbed_power[5] = -2;
  ResultInfo info = sample::info();
  info.thermal = {{PlanckFunction::at(10.8), 10.8, {}, "us-1976", 288., "", "", {}}};
  info.heating_rates = {{solution.absorbed_power, std::vector<double>(4, 0.)}};
  write_result(options_.result_file, solution, info);
  options_.absorption = options_.heating_rate = true;
  EXPECT_THAT(export_fields(options_).grids, ElementsAre("net_absorbed_power", "heating_rate"));
  openvdb::io::File file(options_.vdb_file.string());
  file.open();
  for (const auto& [name, units] :
       {std::pair("net_absorbed_power", "W m-3 um-1"), std::pair("heating_rate", "K s-1 um-1")}) {
    const auto grid = openvdb::gridPtrCast<openvdb::FloatGrid>(file.readGrid(name));
    EXPECT_EQ(grid->metaValue<std::string>("units"), units);
    EXPECT_EQ(grid->getConstAccessor().getValue({2, 1, 0}), -2.F) << name;
  }
}

// Voxels of 20 m from 520 m to 580 m; a layer's edge cuts the second at 545 m; below and above are levels of other
// heights.
TEST_F(FieldExport, OfUnevenLevelsTheCloudsVoxelsAreExported) {
  Solution solution = sample::solution(3, 2, 6);
  solution.box.z_edge_m = {400, 520, 540, 545, 560, 580, 1000};
  solution.box.cloud = {3, 520, 20};
  solution.radiance_field =
      sample::radiance_field(points_, {{0, 0, 0}, {1, 0, 1}, {1, 0, 2}, {1, 0, 3}, {2, 1, 3}, {2, 1, 4}, {2, 1, 5}});
  write_result(options_.result_file, solution, sample::info());
  options_.travel = points_.directions()[7];
  options_.actinic = true;
  const FieldExportReport report = export_fields(options_);
  EXPECT_FALSE(report.whole_domain);
  EXPECT_THAT(report.voxels, ElementsAre(3, 2, 3));
  EXPECT_THAT(report.min_m, ElementsAre(100, -50, 520));
  EXPECT_THAT(report.max_m, ElementsAre(175, 50, DoubleNear(580, 1e-9)));
  const auto radiance = [&](std::size_t cell) { return solution.radiance_field->radiance[42 * cell + 7]; };
  const Values values = read("radiance");
  ASSERT_EQ(values.size(), 4U);
  EXPECT_EQ(values.at({1, 0, 0}), radiance(1));
  EXPECT_FLOAT_EQ(values.at({1, 0, 1}), 0.25F * radiance(2) + 0.75F * radiance(3));
  EXPECT_EQ(values.at({2, 1, 1}), radiance(4));  // the part that has a value
  EXPECT_EQ(values.at({2, 1, 2}), radiance(5));
  const Values actinic = read("actinic_flux");
  EXPECT_EQ(actinic.size(), 18U);
  EXPECT_FLOAT_EQ(actinic.at({2, 1, 1}),
                  0.25F * sample::field_value(5, 2, 1, 2) + 0.75F * sample::field_value(5, 3, 1, 2));
}

TEST_F(FieldExport, UnevenLevelsWithoutACloudAreNamed) {
  write_result(options_.result_file, sample::solution(3, 2, 4), sample::info());
  options_.actinic = true;
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(AllOf(HasSubstr("uneven"), HasSubstr("20 m at z = 510 m"),
                                                           HasSubstr("50 m at z = 600 m"))));
  EXPECT_FALSE(fs::exists(options_.vdb_file));
}

TEST_F(FieldExport, SeveralNumbersInPlaceOfOneAreRefused) {
  write_result(options_.result_file, even_solution(), sample::info());
  const hid_t file = H5Fopen(options_.result_file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(H5Adelete_by_name(file, "x", "cell_size_m", H5P_DEFAULT), 0);
  const hsize_t eight = 8;
  const hid_t many = H5Screate_simple(1, &eight, nullptr);
  H5Aclose(H5Acreate_by_name(file, "x", "cell_size_m", H5T_NATIVE_DOUBLE, many, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Sclose(many);
  H5Fclose(file);
  options_.actinic = true;
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(
                               AllOf(HasSubstr("result.h5"), HasSubstr("attribute cell_size_m has 8 values"))));
}

TEST_F(FieldExport, WhatIsMissingOrWrongIsNamedAndLeavesNothing) {
  options_.travel = Direction(0, 0, 1);
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(AllOf(HasSubstr("result.h5"), HasSubstr("no such file"))));
  std::ofstream(options_.result_file) << "not HDF5";
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(AllOf(HasSubstr("result.h5"), HasSubstr("can't be read"))));
  H5Fclose(H5Fcreate(options_.result_file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(HasSubstr("not a result file of cloudbow run")));

  Solution solution = even_solution();
  ResultInfo spectrum = sample::info();
  spectrum.wavelengths_um = {0.67, 0.55};
  write_result(options_.result_file, std::vector{solution, solution}, spectrum);
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(AllOf(HasSubstr("result.h5"), HasSubstr("[spectrum]"))));
  solution.actinic_flux.clear();
  write_result(options_.result_file, solution, sample::info());
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(HasSubstr("\"radiance_field\" among output.fields")));
  options_.travel.reset();
  options_.actinic = true;
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(HasSubstr("\"actinic\" among output.fields")));

  solution.radiance_field = sample::radiance_field(points_, cells_);
  write_result(options_.result_file, solution, sample::info());
  options_.travel = Direction(0, 0, 0);
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(HasSubstr("direction")));
  // The radiances stand there when the other field turns out to be missing.
  options_.travel = Direction(0, 0, 1);
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(HasSubstr("actinic_flux")));
  options_.actinic = false;
  solution.radiance_field->voxel.back() = {3, 0, 0};
  write_result(options_.result_file, solution, sample::info());
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(AllOf(HasSubstr("voxel"), HasSubstr("index 3"))));
  std::vector<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder_)) names.push_back(entry.path().filename());
  EXPECT_THAT(names, ElementsAre("result.h5"));

  options_.vdb_file = folder_ / "nowhere" / "fields.vdb";
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(HasSubstr("nowhere")));
  options_.vdb_file = folder_;
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(HasSubstr("directory")));
  options_.vdb_file = options_.result_file;
  EXPECT_THAT(exporting(), ThrowsMessage<InputError>(HasSubstr("the grids would overwrite an input")));
}

}  // namespace
}  // namespace cloudbow
