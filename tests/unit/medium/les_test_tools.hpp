// An LES file of a few cells in an isentropic atmosphere, whose pressure, temperature and density are closed forms.
#pragma once

#include <gtest/gtest.h>
#include <unistd.h>

#include <array>
#include <cmath>
#include <filesystem>
#include <functional>
#include <numeric>
#include <string>
#include <vector>

#include "cloud_test_tools.hpp"
#include "cloudbow/medium/cloud_import.hpp"
#include "netcdf_builder.hpp"

namespace cloudbow::les_test {

inline constexpr int nx = 2, ny = 3, nz = 10, columns = nx * ny;
inline constexpr double theta = 300, gravity = 9.80665, gas_constant = 287.05, heat_capacity = 3.5 * gas_constant;

inline double height(int k) { return 420 + 40.0 * k; }
inline double exner(int k) { return 1 - gravity * height(k) / (heat_capacity * theta); }
inline double pressure(int k) { return 1e5 * std::pow(exner(k), 3.5); }
inline double kelvin(int k) { return theta * exner(k); }
inline double density(int k) { return pressure(k) / (gas_constant * kelvin(k)); }
/// kg/kg, different in all cells of the levels with cloud
inline double water(int k, int j, int i) { return k < 3 || k > 6 ? 0 : 1e-4 * (k + 1) + 1e-5 * (1 + i + nx * j); }

/// Values of a field (z, y, x) from a function of its indices.
inline std::vector<double> field(const std::function<double(int k, int j, int i)>& value, int levels = nz) {
  std::vector<double> values;
  for (int k = 0; k < levels; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) values.push_back(value(k, j, i));
    }
  }
  return values;
}

inline std::vector<double> profile(const std::function<double(int k)>& value, int levels = nz) {
  std::vector<double> values;
  for (int k = 0; k < levels; ++k) values.push_back(value(k));
  return values;
}

class LesImport : public testing::Test {
 protected:
  LesImport() {
    folder_ = std::filesystem::temp_directory_path() /
              (std::string("cloudbow-les-") + testing::UnitTest::GetInstance()->current_test_info()->name() + "-" +
               std::to_string(getpid()));
    std::filesystem::create_directories(folder_);
  }
  ~LesImport() override {
    std::error_code error;
    std::filesystem::remove_all(folder_, error);
  }

  /// Axes z, y, x with coordinates in metres.
  static void add_axes(NetcdfBuilder& file) {
    file.dimension("z", nz);
    file.dimension("y", ny);
    file.dimension("x", nx);
    file.variable("z", {"z"}, "m", profile(height));
    file.variable("y", {"y"}, "m", {50, 150, 250});
    file.variable("x", {"x"}, "m", {50, 150});
  }
  static void add_water(NetcdfBuilder& file, const std::string& name = "qc", const std::string& units = "kg/kg",
                        double factor = 1) {
    file.variable(name, {"z", "y", "x"}, units,
                  field([factor](int k, int j, int i) { return factor * water(k, j, i); }));
  }

  /// A file with axes and water, and the additions of the test.
  CloudImportOptions with(const std::function<void(NetcdfBuilder&)>& add, bool has_water = true) const {
    NetcdfBuilder file(folder_ / "les.nc");
    add_axes(file);
    if (has_water) add_water(file);
    add(file);
    CloudImportOptions options;
    options.file = file.close();
    return options;
  }
  static std::string error_of(const CloudImportOptions& options) {
    return message_of([&] { import_cloud(options); });
  }

  std::filesystem::path folder_;
};

inline std::string notes_of(const ImportedCloud& cloud) {
  return std::accumulate(cloud.notes.begin(), cloud.notes.end(), std::string(),
                         [](const std::string& all, const std::string& note) { return all + note + "\n"; });
}

/// All cells by the closed forms. Numbers in files are of 32 bits, and pressure to the power 5/7 comes from them.
inline void expect_truth(const ImportedCloud& cloud, double factor = 1, double tolerance = 1e-5) {
  const CloudField& found = cloud.field;
  ASSERT_EQ(found.cells, (std::array<int, 3>{nx, ny, nz}));
  ASSERT_EQ(found.value.size(), std::size_t{4 * nx * ny});
  std::size_t n = 0;
  for (int k = 3; k <= 6; ++k) {
    for (int j = 0; j < ny; ++j) {
      for (int i = 0; i < nx; ++i) {
        EXPECT_NEAR(found.value[n++] / (1e3 * factor * water(k, j, i) * density(k)), 1, tolerance) << k << j << i;
      }
    }
  }
  EXPECT_NEAR(found.cell_size_m[0], 100, 1e-9);
  EXPECT_NEAR(found.cell_size_m[2], 40, 1e-9);
}

}  // namespace cloudbow::les_test
