// Layers of air at g-points. Truth: hand-counted edges, gas_optics() of the same edges, and of the atmosphere's own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <numeric>
#include <string>

#include "app/assembly/gas_layers.hpp"
#include "cloudbow/app/assemble.hpp"
#include "cloudbow/core/error.hpp"
#include "gas_scene.hpp"
#include "usual_memory.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Without pressure, so that heights may be chosen freely.
std::string air_at(const std::string& heights) {
  return "[atmosphere]\nstandard = \"us-1976\"\nheight_m = [" + heights + "]\nh2o = 1e-3\n";
}

class GasLayersTest : public testing::Test {
 protected:
  std::vector<Scene> scenes(const std::string& text) { return read_scenes(files_.write(text)); }
  Scene scene(const std::string& text) { return scenes(text).front(); }

  /// Edges of the absorbing layers, which come first.
  static std::vector<double> edges_of(Scene scene, const CloudField* field = nullptr) {
    add_gas_layers(field, scene);
    std::vector<double> edges{scene.layers.front().bottom_m};
    for (const Layer& layer : scene.layers) {
      if (layer.bottom_m != edges.back()) break;
      edges.push_back(layer.top_m);
    }
    return edges;
  }

  /// 2 x 1 columns; `full` holds the planes of the voxels that are cloud.
  static CloudField field(int planes, double dz, double bottom, const std::vector<int>& full) {
    std::vector<float> dense(static_cast<std::size_t>(2 * planes), 0.F);
    for (const int k : full) dense[static_cast<std::size_t>(2 * k)] = .01F;
    return make_cloud_field({2, 1, planes}, {100, 100, dz}, {0, 0, bottom}, dense, "extinction");
  }

  std::string message(const std::string& text) {
    try {
      for (const Scene& scene : scenes(text)) assemble(scene, memory);
    } catch (const InputError& error) {
      return error.what();
    }
    return "no error";
  }

  gas_scene::Files files_;
  const std::string rest = gas_scene::sun + gas_scene::solar_spectrum;
};

TEST_F(GasLayersTest, AreThinBelowTwelveKilometres) {
  EXPECT_THAT(edges_of(scene(air_at("0, 600, 12000, 14500") + rest)),
              AllOf(Contains(0.), Contains(200.), Contains(400.), Contains(600.), Contains(13250. - 1250. / 3)));
  const std::vector<double> edges = edges_of(scene(air_at("0, 600, 11900, 15000, 40000") + rest));
  EXPECT_EQ(edges.front(), 0);
  EXPECT_EQ(edges.back(), 40000);
  for (std::size_t n = 1; n < edges.size(); ++n) {
    EXPECT_GT(edges[n], edges[n - 1]);
    EXPECT_LE(edges[n] - edges[n - 1], edges[n - 1] < 12000 ? 250. : 1000.) << edges[n - 1];
  }
}

TEST_F(GasLayersTest, TakeFacesOfTheCloudAlone) {
  // Cloud from 540 to 740 m, with a face every 20 m, of which every fifth counts. 600 and 700 m lie inside.
  const CloudField cloud = field(20, 20, 500, {2, 3, 7, 11});
  const std::vector<double> edges = edges_of(scene(air_at("0, 600, 700, 1000") + rest), &cloud);
  EXPECT_THAT(edges, ElementsAre(0, 180, 360, 540, 640, 740, 870, 1000));
  // A face every 60 m: each second is nearest to 100 m. The highest counts too.
  const CloudField coarse = field(5, 60, 0, {0, 1, 2});
  EXPECT_THAT(edges_of(scene(air_at("0, 180, 400") + rest), &coarse), ElementsAre(0, 120, 180, 400));
  // Voxels thicker than air layers may be stay whole.
  const CloudField thick = field(2, 400, 100, {0, 1});
  EXPECT_THAT(edges_of(scene(air_at("0, 300, 1100") + rest), &thick), ElementsAre(0, 100, 500, 900, 1100));
}

TEST_F(GasLayersTest, HeightsBesideFacesGiveWay) {
  const CloudField cloud = field(2, 50, 200, {0, 1});
  EXPECT_THAT(edges_of(scene(air_at("0, 199.4, 300.7, 500, 500.3, 599.8, 600") + rest), &cloud),
              ElementsAre(0, 200, 300, 500, 600));
}

TEST_F(GasLayersTest, AreThoseOfTheDomain) {
  const std::string domain = "[domain]\nmin_m = [0, 0, 100]\nmax_m = [1, 1, 700]\n";
  EXPECT_THAT(edges_of(scene(air_at("0, 400, 90000") + domain + rest)), ElementsAre(100, 250, 400, 550, 700));
  // Ends within a thousandth of a voxel of a face lie on it, as those of the domain do.
  const CloudField cloud = field(2, 100, 200, {0});
  const std::string beside = "[domain]\nmin_m = [0, 0, 99.95]\nmax_m = [200, 100, 500.05]\n";
  const std::vector<double> edges = edges_of(scene(air_at("0, 90000") + beside + rest), &cloud);
  EXPECT_EQ(edges.front(), 100);
  EXPECT_EQ(edges.back(), 500);
  // Without a domain: the ground or the box, to the end of the air or the box.
  const CloudField low = field(4, 100, -200, {0});
  EXPECT_EQ(edges_of(scene(air_at("0, 150") + rest), &low).front(), -200);
  EXPECT_EQ(edges_of(scene(air_at("0, 150") + rest), &low).back(), 200);
}

TEST_F(GasLayersTest, TheDomainMayEndWithinTheBox) {
  const std::string text = air_at("0, 20000") + gas_scene::cloud + rest;
  // The box is from 500 to 700 m, the cloud from 550 to 650 m.
  const auto with_top = [&](const std::string& top) { return text + "[domain]\nmax_m = [400, 300, " + top + "]\n"; };
  EXPECT_EQ(assemble(scene(with_top("650")), memory).problem.grid.box.z_edge_m.back(), 650);
  EXPECT_EQ(assemble(scene(with_top("699.98")), memory).problem.grid.box.z_edge_m.back(), 700);
  EXPECT_THAT(message(with_top("600")), AllOf(HasSubstr("domain.max_m"), HasSubstr("cuts the cloud")));
  EXPECT_THAT(message(with_top("-50")), AllOf(HasSubstr("domain.max_m"), Not(HasSubstr("layer"))));
}

TEST_F(GasLayersTest, LevelsAreTheSameAtAllPoints) {
  for (const std::string& text : {gas_scene::solar, gas_scene::longwave}) {
    std::vector<std::vector<double>> levels;
    for (const Scene& scene : scenes(gas_scene::cloud + text))
      levels.push_back(assemble(scene, memory).problem.grid.box.z_edge_m);
    ASSERT_EQ(levels.size(), gas_scene::points);
    for (const auto& other : levels) EXPECT_EQ(other, levels.front());
  }
}

TEST_F(GasLayersTest, OpticalDepthsAreThoseOfTheModel) {
  for (const std::string& text : {gas_scene::solar, gas_scene::longwave}) {
    for (Scene& scene : scenes(text)) {
      const std::vector<double> edges = edges_of(scene);
      const auto of_model = gas_optics(*scene.broadband->model, scene.atmosphere->air, edges);
      const auto point = static_cast<std::size_t>(scene.gas_point);
      add_gas_layers(nullptr, scene);
      const bool scatters = scene.broadband->model->light() == GasModel::Light::solar;
      const std::size_t layers = edges.size() - 1;
      ASSERT_EQ(scene.layers.size(), scatters ? 2 * layers : layers);
      for (std::size_t l = 0; l < layers; ++l) {
        EXPECT_EQ(scene.layers[l].optical_depth, of_model.absorption[point][l]);
        EXPECT_EQ(scene.layers[l].single_scattering_albedo, 0);
        if (!scatters) continue;
        EXPECT_EQ(scene.layers[layers + l].optical_depth, of_model.rayleigh[point][l]);
        EXPECT_EQ(scene.layers[layers + l].single_scattering_albedo, 1);
        EXPECT_EQ(scene.phase_functions[static_cast<std::size_t>(scene.layers[layers + l].phase_function)].name,
                  "rayleigh");
      }
    }
  }
}

// The absorption of `composite` is k times the moles of air, however these are cut into layers. Here k varies by 50 %
// over the profile, so layers of 250 and of 62.5 m agree to a part in ten thousand.
TEST_F(GasLayersTest, TotalsDoNotDependOnTheCuts) {
  Scene given = scene(gas_scene::solar);
  const Atmosphere& air = given.atmosphere->air;
  const std::vector<double> edges = edges_of(given);
  std::vector<double> fine{edges.front()};
  for (std::size_t n = 1; n < edges.size(); ++n) {
    for (int part = 1; part <= 4; ++part) fine.push_back(edges[n - 1] + (edges[n] - edges[n - 1]) * part / 4);
  }
  const auto total = [](const std::vector<double>& depth) { return std::accumulate(depth.begin(), depth.end(), 0.); };
  const auto coarse_optics = gas_optics(*given.broadband->model, air, edges);
  const auto fine_optics = gas_optics(*given.broadband->model, air, fine);
  for (std::size_t g = 0; g < gas_scene::points; ++g) {
    EXPECT_NEAR(total(coarse_optics.absorption[g]) / total(fine_optics.absorption[g]), 1, 1e-3);
    EXPECT_NEAR(total(coarse_optics.rayleigh[g]) / total(fine_optics.rayleigh[g]), 1, 1e-12) << "moles of air";
  }
}

TEST_F(GasLayersTest, SayWhichGasesAreMissing) {
  EXPECT_THAT(message("[atmosphere]\nstandard = \"us-1976\"\n" + rest),
              AllOf(HasSubstr("scene.toml:1: atmosphere"), HasSubstr("h2o"), HasSubstr("found none")));
}

}  // namespace
}  // namespace cloudbow
