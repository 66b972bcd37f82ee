#include <gtest/gtest.h>
#include <omp.h>
#include <stdlib.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>
#include <string>

#include "cloudbow/core/digest.hpp"
#include "cloudbow/core/error.hpp"
#include "cloudbow/optics/scattering_table.hpp"
#include "cloudbow/sphere/gauss_legendre.hpp"

namespace cloudbow {
namespace {

using std::numbers::pi;

Direction sun_at(double mu0, double azimuth) {
  const double sine = std::sqrt(1 - mu0 * mu0);
  return {sine * std::cos(azimuth), sine * std::sin(azimuth), -mu0};
}

Eigen::VectorXd weights(const OrdinateSet& set) {
  return Eigen::Map<const Eigen::VectorXd>(set.weight.data(), set.size());
}

/// Legendre moment about a direction of a function given at the ordinates.
double moment_about(const Direction& axis, int l, const Eigen::VectorXd& value, const OrdinateSet& set) {
  double sum = 0;
  for (int d = 0; d < set.size(); ++d) {
    sum += set.weight[d] * value[d] * std::legendre(l, std::clamp(axis.dot(set.direction[d]), -1.0, 1.0));
  }
  return sum;
}

/// (1/4pi) int_up mu^power P(O.v) dO by brute force.
double half_range_by_quadrature(const PhaseFunction& phase, const Direction& v, int power) {
  const GaussLegendre rule = make_gauss_legendre(100);
  constexpr int azimuths = 200;
  double sum = 0;
  for (std::size_t i = 0; i < rule.node.size(); ++i) {
    const double mu = (1 + rule.node[i]) / 2, sine = std::sqrt(1 - mu * mu);
    for (int k = 0; k < azimuths; ++k) {
      const double azimuth = 2 * pi * (k + 0.5) / azimuths;
      const Direction o(sine * std::cos(azimuth), sine * std::sin(azimuth), mu);
      sum += rule.weight[i] / 2 * (2 * pi / azimuths) * std::pow(mu, power) * phase(o.dot(v));
    }
  }
  return sum / (4 * pi);
}

struct Case {
  const char* name;
  PhaseFunction phase;
  const char* ordinates;
  int control_points;
  FitOptions options;
};
void PrintTo(const Case& c, std::ostream* out) { *out << c.name << ' ' << c.ordinates; }

FitOptions options(FitMethod method, int order, int beam_order, int exact_moments, bool minimax = true) {
  FitOptions o;
  o.method = method;
  o.delta_m_order = order;
  o.beam_delta_m_order = beam_order;
  o.exact_moments = exact_moments;
  o.beam_half_range_rows = std::min(3, exact_moments);
  o.minimax = minimax;
  return o;
}

class EveryFit : public testing::TestWithParam<Case> {
 protected:
  void expect_light_is_conserved() const;
  void expect_moments_of_columns() const;
  void expect_rows_of_beam() const;
  void expect_positive_where_truncated_function_is() const;
  void expect_points_and_ordinates_agree() const;

  const OrdinateSet set = make_ordinate_set(GetParam().ordinates);
  const ControlPoints points{GetParam().control_points,
                             set.is_control_points ? control_point_frame_rotation() : Eigen::Matrix3d::Identity()};
  const Direction sun = sun_at(0.3, 0.7);
  const ScatteringTable table = make_scattering_table(GetParam().phase, points, set, sun, GetParam().options);
};

constexpr auto programme = FitMethod::linear_programming;
INSTANTIATE_TEST_SUITE_P(
    ScatteringTable, EveryFit,
    testing::Values(
        Case{"HG .85", PhaseFunction::henyey_greenstein(0.85), "double-gauss-6x8", 42, options(programme, 6, 8, 2)},
        Case{"HG .85", PhaseFunction::henyey_greenstein(0.85), "double-gauss-8x16", 162, options(programme, 8, 12, 3)},
        Case{"HG .98", PhaseFunction::henyey_greenstein(0.98), "double-gauss-8x16", 162, options(programme, 8, 12, 3)},
        Case{"HG -.5", PhaseFunction::henyey_greenstein(-0.5), "double-gauss-8x16", 162, options(programme, 8, 12, 3)},
        Case{"Rayleigh", PhaseFunction::rayleigh(), "double-gauss-8x16", 162, options(programme, 8, 12, 3)},
        Case{"HG .85", PhaseFunction::henyey_greenstein(0.85), "control-points-162", 162,
             options(programme, 10, 10, 3, false)},
        Case{"HG .85 least squares", PhaseFunction::henyey_greenstein(0.85), "double-gauss-8x16", 162,
             options(FitMethod::least_squares, 8, 12, 3)},
        Case{"HG .85 collocation", PhaseFunction::henyey_greenstein(0.85), "double-gauss-8x16", 162,
             options(FitMethod::collocation, 8, 12, 3)}));

void EveryFit::expect_light_is_conserved() const {
  EXPECT_EQ(table.report.fallbacks, 0);
  EXPECT_LE(table.report.closure, 1e-13);  // rescaled in double; sums of some hundred terms
  const Eigen::VectorXd w = weights(set);
  EXPECT_LE((table.ordinates_from_ordinates.transpose() * w - w).cwiseAbs().maxCoeff(), 1e-13);
  EXPECT_NEAR(w.dot(table.ordinates_from_beam), 1, 1e-13);
}

void EveryFit::expect_moments_of_columns() const {
  const PhaseFunction truncated = delta_m(GetParam().phase, GetParam().options.delta_m_order).truncated;
  for (int l = 0; l <= GetParam().options.exact_moments; ++l) {
    for (int d = 0; d < set.size(); ++d) {
      // 1e-8: solvers stop at 1e-9 in the rows
      EXPECT_NEAR(moment_about(set.direction[d], l, table.ordinates_from_ordinates.col(d), set) / set.weight[d],
                  truncated.moment(l), 1e-8);
    }
  }
}

void EveryFit::expect_rows_of_beam() const {
  const bool own_order = !set.is_control_points;
  const int order = own_order ? GetParam().options.beam_delta_m_order : GetParam().options.delta_m_order;
  const DeltaM scaled = delta_m(GetParam().phase, order);
  EXPECT_EQ(table.beam_forward_fraction, scaled.forward_fraction);
  for (int l = 0; l <= GetParam().options.exact_moments; ++l) {
    EXPECT_NEAR(moment_about(sun, l, table.ordinates_from_beam, set), scaled.truncated.moment(l), 1e-8);
  }
  for (int k = 0; own_order && k < GetParam().options.beam_half_range_rows; ++k) {
    double upward = 0;
    for (int d = 0; d < set.size(); ++d) {
      if (set.direction[d].z() > 0)
        upward += set.weight[d] * std::pow(set.direction[d].z(), k) * table.ordinates_from_beam[d];
    }
    EXPECT_NEAR(upward, half_range_by_quadrature(scaled.truncated, sun, k), 1e-8);
  }
}

void EveryFit::expect_positive_where_truncated_function_is() const {
  if (GetParam().options.method != FitMethod::linear_programming) return;  // corrections may turn values negative
  double least = 0;
  for (const int order : {GetParam().options.delta_m_order, GetParam().options.beam_delta_m_order}) {
    const PhaseFunction truncated = delta_m(GetParam().phase, order).truncated;
    for (int i = 0; i <= 10000; ++i) least = std::min(least, truncated(std::cos(pi * i / 10000)));
  }
  EXPECT_GE(table.report.least_value, least * (1 + 1e-3) - 1e-12);  // the bound comes from a coarser search
}

void EveryFit::expect_points_and_ordinates_agree() const {
  for (int d = 0; d < set.size(); ++d) {
    const auto [index, weight] = points.stencil(set.direction[d]);
    double interpolated = 0;
    for (int k = 0; k < 3; ++k) interpolated += weight[k] * table.points_from_beam[index[k]];
    EXPECT_NEAR(table.ordinates_from_beam[d], interpolated, 1e-15);
  }
}

// One test, because making a table takes longest.
TEST_P(EveryFit, ConservesLightAndHoldsItsRows) {
  expect_light_is_conserved();
  expect_moments_of_columns();
  expect_rows_of_beam();
  expect_positive_where_truncated_function_is();
  expect_points_and_ordinates_agree();
}

TEST(ScatteringTable, IsotropicIsExact) {
  const OrdinateSet set = make_ordinate_set("double-gauss-6x8");
  const ScatteringTable table =
      make_scattering_table(PhaseFunction::isotropic(), ControlPoints(42), set, sun_at(0.5, 0), FitOptions{});
  EXPECT_EQ(table.report.linear_programmes, 0);
  for (int d = 0; d < set.size(); ++d) {
    EXPECT_NEAR(table.points_from_ordinates.col(d).maxCoeff(), set.weight[d] / (4 * pi), 1e-15);
    EXPECT_NEAR(table.points_from_ordinates.col(d).minCoeff(), set.weight[d] / (4 * pi), 1e-15);
    EXPECT_NEAR(table.ordinates_from_beam[d], 1 / (4 * pi), 1e-15);
  }
}

TEST(ScatteringTable, FollowsASmoothFunctionPointByPoint) {
  const OrdinateSet set = make_ordinate_set("double-gauss-8x16");
  const auto phase = PhaseFunction::rayleigh();
  const ControlPoints points(162);
  const ScatteringTable table = make_scattering_table(phase, points, set, std::nullopt, FitOptions{});
  EXPECT_EQ(table.points_from_beam.size(), 0);
  EXPECT_LT(table.report.max_error, 0.02);  // curvature 1.5 over an edge of .32: 1.5 .32^2 / 8 = .019
  for (int d = 0; d < set.size(); ++d) {
    for (int m = 0; m < points.size(); ++m) {
      EXPECT_NEAR(table.points_from_ordinates(m, d) * 4 * pi / set.weight[d],
                  phase(points.directions()[m].dot(set.direction[d])), 0.03);
    }
  }
}

TEST(ScatteringTable, BackwardPeakKeepsItsMomentsAndConservesLight) {
  const OrdinateSet set = make_ordinate_set("double-gauss-8x16");
  const ScatteringTable table = make_scattering_table(PhaseFunction::henyey_greenstein(-0.95), ControlPoints(162), set,
                                                      sun_at(0.2, 1), FitOptions{});
  EXPECT_EQ(table.forward_fraction, 0);
  EXPECT_EQ(table.beam_forward_fraction, 0);
  EXPECT_GE(table.report.least_value, 0);  // without positive solution the rows are relaxed, not the sign
  EXPECT_LE(table.report.closure, 1e-13);
  for (int d = 0; d < set.size(); ++d) {
    EXPECT_NEAR(moment_about(set.direction[d], 1, table.ordinates_from_ordinates.col(d), set) / set.weight[d], -0.95,
                1e-7);
  }
}

TEST(ScatteringTable, NeedsLittleSymmetry) {
  // A turned frame shares only the inversion with the product set: half the columns are solved, and all hold their
  // moments.
  const OrdinateSet set = make_ordinate_set("double-gauss-6x8");
  const ControlPoints points(42, control_point_frame_rotation());
  const auto phase = PhaseFunction::henyey_greenstein(0.5);
  const ScatteringTable table = make_scattering_table(phase, points, set, std::nullopt, options(programme, 6, 8, 2));
  EXPECT_EQ(table.report.linear_programmes, set.size() / 2);
  const double expected = delta_m(phase, 6).truncated.moment(1);
  for (int d = 0; d < set.size(); ++d) {
    EXPECT_NEAR(moment_about(set.direction[d], 1, table.ordinates_from_ordinates.col(d), set) / set.weight[d], expected,
                1e-8);
  }
}

TEST(ScatteringTable, HasTheSameBitsForAnyNumberOfThreads) {
  const OrdinateSet set = make_ordinate_set("double-gauss-8x16");
  const ControlPoints points(162);
  const auto make = [&](int threads) {
    omp_set_num_threads(threads);
    return make_scattering_table(PhaseFunction::henyey_greenstein(0.85), points, set, sun_at(0.3, 0.1), FitOptions{});
  };
  const int before = omp_get_max_threads();
  const ScatteringTable one = make(1), three = make(3);
  omp_set_num_threads(before);
  EXPECT_EQ(one.points_from_ordinates, three.points_from_ordinates);
  EXPECT_EQ(one.points_from_beam, three.points_from_beam);
}

class TableCacheTest : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (std::filesystem::temp_directory_path() / "cloudbow-cache-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    directory = pattern;
  }
  void TearDown() override { std::filesystem::remove_all(directory); }

  ScatteringTable make(double g = 0.5, const std::filesystem::path& in = {}) const {
    FitOptions o = options(programme, 6, 8, 2);
    o.cache_directory = in.empty() ? directory : in;
    return make_scattering_table(PhaseFunction::henyey_greenstein(g), ControlPoints(42),
                                 make_ordinate_set("double-gauss-6x8"), sun_at(0.6, 0.2), o);
  }
  static void expect_equal(const ScatteringTable& a, const ScatteringTable& b) {
    EXPECT_EQ(a.points_from_ordinates, b.points_from_ordinates);
    EXPECT_EQ(a.ordinates_from_ordinates, b.ordinates_from_ordinates);
    EXPECT_EQ(a.points_from_beam, b.points_from_beam);
    EXPECT_EQ(a.report.linear_programmes, b.report.linear_programmes);
    EXPECT_EQ(a.report.max_error, b.report.max_error);
  }
  std::filesystem::path directory;
};

TEST_F(TableCacheTest, GivesBackTheSameBits) {
  const ScatteringTable fresh = make(), cached = make();
  EXPECT_FALSE(fresh.report.from_cache);
  EXPECT_TRUE(cached.report.from_cache);
  expect_equal(fresh, cached);
}

TEST_F(TableCacheTest, IsKeyedByItsInputs) {
  make(0.5);
  EXPECT_FALSE(make(0.6).report.from_cache);
  EXPECT_TRUE(make(0.6).report.from_cache);
}

TEST_F(TableCacheTest, RemakesDamagedFiles) {
  const ScatteringTable fresh = make();
  const auto damage = [&](auto&& change) {
    for (const auto& entry : std::filesystem::directory_iterator(directory)) {
      std::ifstream in(entry.path(), std::ios::binary);
      std::string text{std::istreambuf_iterator<char>(in), {}};
      in.close();
      change(text);
      std::ofstream(entry.path(), std::ios::binary) << text;
    }
    const ScatteringTable remade = make();
    EXPECT_FALSE(remade.report.from_cache);
    expect_equal(fresh, remade);
    EXPECT_TRUE(make().report.from_cache);
  };
  damage([](std::string& text) { text.clear(); });
  damage([](std::string& text) { text.resize(text.size() / 2); });
  damage([](std::string& text) { text[text.size() / 2] ^= 1; });
  damage([](std::string& text) { text = "something else altogether"; });
  damage([](std::string& text) { text += "more"; });
}

TEST_F(TableCacheTest, RemakesTablesOfAnotherVersion) {
  const ScatteringTable fresh = make();
  const auto change_version = [&](char from, char to) {
    for (const auto& entry : std::filesystem::directory_iterator(directory)) {
      std::ifstream in(entry.path(), std::ios::binary);
      std::string text{std::istreambuf_iterator<char>(in), {}};
      in.close();
      const std::string begin = "cloudbow scattering table ";
      ASSERT_EQ(text.substr(0, begin.size() + 1), begin + from);
      text[begin.size()] = to;
      // The hash of all before it ends the file: only the version distinguishes this one from a current table.
      text.resize(text.size() - sizeof(std::uint64_t));
      Digest digest;
      digest.add_bytes(text.data(), text.size());
      const std::uint64_t hash = digest.value();
      text.append(reinterpret_cast<const char*>(&hash), sizeof hash);
      std::ofstream(entry.path(), std::ios::binary) << text;
    }
  };
  change_version('4', '3');
  const ScatteringTable remade = make();
  EXPECT_FALSE(remade.report.from_cache);
  expect_equal(fresh, remade);
  EXPECT_TRUE(make().report.from_cache);
}

TEST_F(TableCacheTest, LeavesNothingButFinishedFiles) {
  make();
  int files = 0;
  for (const auto& entry : std::filesystem::directory_iterator(directory)) {
    EXPECT_EQ(entry.path().extension(), ".table");
    ++files;
  }
  EXPECT_EQ(files, 2);  // the diffuse columns and the beam's
}

TEST_F(TableCacheTest, DoesWithoutATableWhoseNameIsTaken) {
  const ScatteringTable fresh = make();
  const auto take_names = [&](auto&& take) {
    std::vector<std::filesystem::path> tables;
    for (const auto& entry : std::filesystem::directory_iterator(directory)) tables.push_back(entry.path());
    for (const auto& table : tables) {
      std::filesystem::remove_all(table);
      take(table);
    }
    const ScatteringTable remade = make();
    EXPECT_FALSE(remade.report.from_cache);
    expect_equal(fresh, remade);
  };
  take_names([](const std::filesystem::path& table) { std::filesystem::create_directory(table); });
  take_names([](const std::filesystem::path& table) { mkfifo(table.c_str(), 0600); });
  // A link may lead to a file of the user's, which stays as it is.
  const std::filesystem::path cloud = directory.string() + ".vdb";
  std::ofstream(cloud) << "a cloud";
  take_names([&](const std::filesystem::path& table) { std::filesystem::create_symlink(cloud, table); });
  std::ifstream in(cloud);
  EXPECT_EQ(std::string(std::istreambuf_iterator<char>(in), {}), "a cloud");
  std::filesystem::remove(cloud);
}

TEST_F(TableCacheTest, DoesWithoutADirectoryThatCannotBe) {
  std::ofstream(directory / "file") << "not a directory";
  expect_equal(make(), make(0.5, directory / "file" / "below"));
}

TEST(ScatteringTable, RejectsOptionsOutOfRange) {
  const OrdinateSet set = make_ordinate_set("double-gauss-6x8");
  const auto make = [&](int order, int beam_order, int moments, int rows) {
    FitOptions o = options(programme, order, beam_order, moments);
    o.beam_half_range_rows = rows;
    return make_scattering_table(PhaseFunction::isotropic(), ControlPoints(42), set, std::nullopt, o);
  };
  EXPECT_NO_THROW(make(6, 8, 3, 3));
  EXPECT_THROW(make(0, 8, 3, 3), InputError);
  EXPECT_THROW(make(8, 6, 3, 3), InputError);
  EXPECT_THROW(make(6, 65, 3, 3), InputError);
  EXPECT_THROW(make(6, 8, -1, 3), InputError);
  EXPECT_THROW(make(6, 8, 13, 3), InputError);
  EXPECT_THROW(make(6, 8, 3, 7), InputError);
}

}  // namespace
}  // namespace cloudbow
