// Images, solver and output of a scene. Truth: the table of keys that the scene format promises.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "scene/scene_test_tools.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string with_camera(const std::string& keys, const std::string& more = "") {
  return layers_toml + "[[camera]]\nname = \"eye\"\nwidth = 40\nheight = 30\n" + keys + "\n" + more;
}

TEST(SceneSettings, CamerasArrive) {
  const TemporaryFolder folder;
  const Scene scene = read_scene(folder.write("scene.toml", with_camera(R"(position_m = [10, 20, 30]
look_at_m = [10, 120, 30]
[[camera]]
name = "sky"
type = "fisheye"
position_m = [1, 2, 0]
width = 8
height = 8
rays = 1
[[camera]]
name = "round"
type = "panorama"
position_m = [0, 0, 10]
look_at_m = [-5, 0, 0]
field_of_view_deg = 90
width = 16
height = 4
[[radiance]]
name = "nadir"
zenith_deg = 0
width = 7
height = 5)")));
  ASSERT_EQ(scene.cameras.size(), 3u);
  const Camera& eye = scene.cameras[0];
  EXPECT_EQ(eye.projection, Camera::Projection::perspective);
  EXPECT_EQ(eye.position_m, Eigen::Vector3d(10, 20, 30));
  EXPECT_EQ(eye.forward, Direction(0, 1, 0));
  EXPECT_EQ(eye.up, Direction(0, 0, 1));
  EXPECT_NEAR(eye.field_of_view, std::acos(0.5), 1e-15);  // 60 degrees, rounding
  EXPECT_EQ(eye.width, 40);
  EXPECT_EQ(eye.height, 30);
  EXPECT_EQ(eye.rays, 2);
  const Camera& sky = scene.cameras[1];
  EXPECT_EQ(sky.projection, Camera::Projection::fisheye);
  EXPECT_EQ(sky.forward, Direction(0, 0, 1));  // straight up, north on top
  EXPECT_EQ(sky.up, Direction(0, 1, 0));
  EXPECT_NEAR(sky.field_of_view, std::acos(-1.), 1e-15);
  EXPECT_EQ(sky.rays, 1);
  EXPECT_EQ(scene.cameras[2].forward, Direction(-1, 0, 0));  // at the horizon
  ASSERT_EQ(scene.radiances.size(), 1u);
  EXPECT_EQ(scene.radiances[0].width, 7);
  EXPECT_EQ(scene.radiances[0].height, 5);
}

TEST(SceneSettings, CameraMistakes) {
  const std::string good = "position_m = [0, 0, 0]\nlook_at_m = [1, 0, 0]";
  EXPECT_EQ(message_of(with_camera(good)), "no error");
  EXPECT_THAT(message_of(with_camera("look_at_m = [1, 0, 0]")),
              AllOf(HasSubstr("camera.0.position_m"), HasSubstr("missing")));
  EXPECT_THAT(message_of(with_camera("position_m = [1, 0, 0]")),
              AllOf(HasSubstr("camera.0.look_at_m"), HasSubstr("missing")));
  EXPECT_THAT(message_of(with_camera("position_m = [1, 0, 0]\nlook_at_m = [1, 0, 0]")),
              HasSubstr("looks at its own position"));
  EXPECT_THAT(message_of(with_camera(good + "\nup = [2, 0, 0]")), AllOf(HasSubstr("parallel"), HasSubstr("[2, 0, 0]")));
  EXPECT_THAT(message_of(with_camera(good + "\nup = [0, 0, 0]")), HasSubstr("without length"));
  EXPECT_THAT(message_of(with_camera(good + "\ntype = \"wide\"")), HasSubstr("perspective, fisheye, panorama"));
  EXPECT_THAT(message_of(with_camera(good + "\nfield_of_view_deg = 180")), AllOf(HasSubstr("180"), HasSubstr("170")));
  EXPECT_THAT(message_of(with_camera(good + "\nrays = 0")), AllOf(HasSubstr("camera.0.rays"), HasSubstr("1 to 16")));
  EXPECT_THAT(message_of(with_camera(good + "\nfocus = 2")), HasSubstr("unknown key"));
  EXPECT_THAT(message_of(with_camera(good, "[[radiance]]\nname = \"eye\"\nzenith_deg = 0")),
              AllOf(HasSubstr("camera.0.name"), HasSubstr("already in use")));
  EXPECT_THAT(message_of(layers_toml + "[[radiance]]\nname = \"a\"\nzenith_deg = 0\nwidth = 3"),
              AllOf(HasSubstr("radiance.0.height"), HasSubstr("missing")));
}

TEST(SceneSettings, FieldsOfTheOutputAreThoseOfTheList) {
  const auto output_of = [](const std::string& fields) {
    const TemporaryFolder folder;
    return read_scene(folder.write("scene.toml", layers_toml + "[output]\nfields = " + fields + "\n"));
  };
  const Scene some = output_of("[\"fluxes\", \"absorption\", \"errors\"]");
  EXPECT_TRUE(some.output.absorption);
  EXPECT_TRUE(some.output.errors);
  EXPECT_FALSE(some.output.actinic);
  EXPECT_TRUE(output_of("[\"fluxes\", \"actinic\"]").output.actinic);
  EXPECT_THAT(message_of(layers_toml + "[output]\nfields = [\"fluxes\", \"actinick\"]\n"),
              AllOf(HasSubstr("output.fields"), HasSubstr("found \"actinick\"")));
}

TEST(SceneSettings, ConeAboutTheSun) {
  const TemporaryFolder folder;
  const std::string cone = "[output]\ncircumsolar_deg = ";
  const Scene scene = read_scene(folder.write("scene.toml", layers_toml + cone + "2.5\n"));
  EXPECT_NEAR(scene.output.circumsolar_half_angle, 2.5 * std::acos(-1.) / 180, 1e-15);
  EXPECT_EQ(read_scene(folder.write("scene.toml", layers_toml)).output.circumsolar_half_angle, 0);
  for (const char* angle : {"0", "-1", "10.5"}) {
    EXPECT_THAT(message_of(layers_toml + cone + angle + "\n"),
                AllOf(HasSubstr("output.circumsolar_deg"), HasSubstr("0.05 to 10")));
  }
  const auto sun = layers_toml.find("[sun]");
  ASSERT_NE(sun, std::string::npos);
  const std::string dark = layers_toml.substr(0, sun) + "[sky]\nradiance_w_m2_sr = 1\n";
  EXPECT_THAT(message_of(dark + cone + "3\n"),
              AllOf(HasSubstr("output.circumsolar_deg"), HasSubstr("no sun"), HasSubstr("[sun]")));
}

}  // namespace
}  // namespace cloudbow
