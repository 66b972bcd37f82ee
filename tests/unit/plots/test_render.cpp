// Truth: pictures small enough to compute every pixel by hand; for the colours the definition of the CIE 1976
// lightness, inverted here.
#include <hdf5.h>

#include <array>
#include <cmath>
#include <fstream>
#include <iterator>
#include <limits>

#include "cloudbow/core/error.hpp"
#include "plots/colormap.hpp"
#include "render_fixture.hpp"

namespace cloudbow {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST_F(Render, MapHasXToTheRightAndYUp) {
  Solution solution = sample::solution(3, 2, 1, {0, 1});
  solution.box.dy_m = 25;
  solution.upwelling_flux = {9, 9, 9, 9, 9, 9,  // bottom
                             0, 1, 2, 3, 4, 5};
  write(solution);
  options_.scale = 4;
  const Picture picture = draw();
  ASSERT_EQ(picture.width, 12);
  ASSERT_EQ(picture.height, 8);
  EXPECT_EQ(picture.red(0, 7), 0);     // smallest value, black: x and y lowest, bottom left
  EXPECT_EQ(picture.red(11, 0), 255);  // largest, white: top right
  EXPECT_EQ(picture.red(3, 4), 0);     // the same cell up to its corner
  // Along x values rise by 1, along y by 3.
  EXPECT_GT(picture.red(4, 7), picture.red(3, 7));
  EXPECT_GT(picture.red(0, 3), picture.red(8, 7));
  EXPECT_EQ(report_.min, 0);
  EXPECT_EQ(report_.max, 5);
  EXPECT_EQ(report_.image.place, "z = 530 m");
  EXPECT_EQ(report_.image.units, "W m-2");
}

TEST_F(Render, CellsKeepTheirProportions) {
  write(sample::solution(3, 2, 1));  // cells of 25 x 50 m
  options_.scale = 4;
  const Picture picture = draw();
  EXPECT_EQ(picture.width, 12);
  EXPECT_EQ(picture.height, 16);
}

TEST_F(Render, DefaultSizeIsAbout768) {
  Solution solution = sample::solution(5, 4, 1);
  solution.box.dy_m = 25;
  write(solution);
  const Picture picture = draw();
  EXPECT_EQ(picture.width, 770);  // 5 x 154, the multiple of 5 nearest to 768
  EXPECT_EQ(picture.height, 616);
}

TEST_F(Render, FindsTheNearestLevel) {
  write(sample::solution(2, 2, 3));  // interfaces at 510, 530, 560, 600 m
  options_.level = "bottom";
  draw();
  EXPECT_EQ(report_.min, sample::field_value(1, 0, 0, 0));
  options_.level = "540";
  draw();
  EXPECT_EQ(report_.min, sample::field_value(1, 1, 0, 0));
  EXPECT_EQ(report_.image.place, "z = 530 m");
  options_.variable = "absorbed_power";
  draw();
  EXPECT_EQ(report_.min, sample::field_value(4, 1, 0, 0));
  EXPECT_EQ(report_.image.place, "z = 545 m");
}

TEST_F(Render, RangeClampsAndMissingIsTransparent) {
  Solution solution = sample::solution(4, 1, 1, {1});
  solution.upwelling_flux = {-10, 2, std::nanf(""), 99};
  write(solution);
  options_.scale = 1;
  options_.range = {1, 3};
  const Picture picture = draw();
  EXPECT_EQ(picture.red(0, 0), 0);
  EXPECT_EQ(picture.red(3, 0), 255);
  options_.range = {3, 1};
  const Picture round = draw();
  EXPECT_EQ(round.red(0, 0), 255) << "cold cloud tops are white in pictures of the infrared";
  EXPECT_EQ(round.red(3, 0), 0);
  EXPECT_EQ(picture.alpha(2, 0), 0);
  EXPECT_EQ(picture.alpha(1, 0), 255);
  EXPECT_EQ(picture.red(1, 0), make_colormap("grey", 255)[127][0]);
}

TEST_F(Render, OneRowOfCellsIsDrawnAsSectionWithZUp) {
  Solution solution = sample::solution(4, 1, 2);
  solution.box.z_edge_m = {0, 50, 100};  // 100 m wide, 100 m high
  solution.absorbed_power = {0, 1, 2, 3, 4, 5, 6, 7};
  write(solution);
  options_.variable = "absorbed_power";
  options_.scale = 2;
  const Picture picture = draw();
  ASSERT_EQ(picture.width, 8);
  ASSERT_EQ(picture.height, 8);
  EXPECT_EQ(report_.image.place, "section x-z");
  EXPECT_EQ(picture.red(0, 7), 0);
  EXPECT_EQ(picture.red(7, 0), 255);
  EXPECT_EQ(picture.red(0, 4), 0);
  EXPECT_GT(picture.red(0, 3), picture.red(7, 4));
}

TEST_F(Render, SectionFollowsUnevenLevels) {
  Solution solution = sample::solution(4, 1, 2);
  solution.box.z_edge_m = {0, 25, 100};
  solution.absorbed_power = {0, 0, 0, 0, 1, 1, 1, 1};
  write(solution);
  options_.variable = "absorbed_power";
  options_.scale = 10;
  const Picture picture = draw();
  ASSERT_EQ(picture.height, 40);
  EXPECT_EQ(picture.red(0, 29), 255);
  EXPECT_EQ(picture.red(0, 30), 0);  // the lowest quarter
}

TEST_F(Render, SectionAlongYAndColumnAndUniformValuesAreDrawn) {
  write(sample::solution(1, 4, 2));
  draw();
  EXPECT_EQ(report_.image.place, "section y-z");
  write(sample::solution(1, 1, 6));
  draw();
  EXPECT_EQ(report_.image.place, "column");
  EXPECT_EQ(report_.width, report_.height);
  Solution uniform = sample::solution(2, 2, 1);
  uniform.upwelling_flux.assign(uniform.upwelling_flux.size(), 7);
  write(uniform);
  draw();
  EXPECT_EQ(report_.min, report_.max);
}

TEST_F(Render, ListsWhatIsThere) {
  write(sample::solution(3, 2, 2));
  const auto expect = [this](const RenderOptions& options, const auto& message) {
    EXPECT_THAT([&] { render(options); }, ThrowsMessage<InputError>(message));
    EXPECT_FALSE(fs::exists(options_.image_file));
  };
  RenderOptions wrong = options_;
  wrong.variable = "radiance_nadir";
  expect(wrong, HasSubstr("upwelling_flux, downwelling_diffuse_flux, direct_flux, absorbed_power, actinic_flux"));
  wrong = options_;
  wrong.variable = "z_edge";
  expect(wrong, HasSubstr("no map \"z_edge\""));
  for (const char* level : {"middle", "700", "nan", "", "520m"}) {
    wrong = options_;
    wrong.level = level;
    expect(wrong, HasSubstr("is not top, bottom or a height from 510 to 560 m"));
  }
  wrong = options_;
  wrong.colormap = "jet";
  expect(wrong, HasSubstr("grey, blue-yellow, viridis, cividis, blue-red"));
  wrong = options_;
  wrong.range = {3, 3};
  expect(wrong, HasSubstr("range"));
  wrong.range = {0, std::nan("")};
  expect(wrong, HasSubstr("range"));
  wrong = options_;
  wrong.scale = -1;
  expect(wrong, HasSubstr("scale"));
  wrong.scale = 10000;
  expect(wrong, HasSubstr("at most 16384"));
  wrong = options_;
  wrong.image_file = options_.result_file;
  expect(wrong, HasSubstr("the picture would overwrite an input"));
  wrong = options_;
  wrong.image_file = folder_ / "missing" / "r.png";
  expect(wrong, HasSubstr("there is no folder"));
}

TEST_F(Render, NamesFilesThatAreNoResults) {
  const auto expect = [this](const fs::path& file, const std::string& reason) {
    options_.result_file = file;
    EXPECT_THAT([&] { render(options_); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(file.string()), HasSubstr(reason))));
  };
  write(sample::solution(30, 30, 10));
  const fs::path whole = options_.result_file;
  expect(folder_ / "missing.h5", "no such file");
  expect(folder_, "a directory");
  std::ofstream(folder_ / "text.h5") << "not HDF5";
  expect(folder_ / "text.h5", "can't be read as a result file");
  fs::copy(whole, folder_ / "cut.h5");
  fs::resize_file(folder_ / "cut.h5", fs::file_size(whole) / 2);
  expect(folder_ / "cut.h5", "can't be read as a result file");
}

TEST_F(Render, RefusesFilesWhosePartsDoNotFit) {
  const auto expect = [this](const std::string& reason) {
    EXPECT_THAT([&] { render(options_); }, ThrowsMessage<InputError>(AllOf(HasSubstr("r.h5"), HasSubstr(reason))));
  };
  write(sample::solution(3, 2, 2));
  hid_t file = H5Fopen(options_.result_file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(H5Lmove(file, "x", file, "other", H5P_DEFAULT, H5P_DEFAULT), 0);  // the scale's own name stays
  const hsize_t two = 2, eight = 8;
  const hid_t short_axis = H5Screate_simple(1, &two, nullptr);
  H5Dclose(H5Dcreate2(file, "x", H5T_NATIVE_DOUBLE, short_axis, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Fclose(file);
  expect("coordinate x is damaged (found 2 numbers, allowed 3");

  write(sample::solution(3, 2, 2));
  file = H5Fopen(options_.result_file.c_str(), H5F_ACC_RDWR, H5P_DEFAULT);
  ASSERT_GE(H5Adelete_by_name(file, "upwelling_flux", "units", H5P_DEFAULT), 0);
  const hid_t many = H5Screate_simple(1, &eight, nullptr);
  const hid_t text = H5Tcopy(H5T_C_S1);
  H5Aclose(H5Acreate_by_name(file, "upwelling_flux", "units", text, many, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
  H5Tclose(text);
  H5Sclose(many);
  H5Sclose(short_axis);
  H5Fclose(file);
  expect("attribute units has 8 values, allowed one text");
}

// A PNG file by the name of another kind would deceive those who open it.
TEST_F(Render, EndingsSayTheKindOfPicture) {
  write(sample::solution(3, 2, 1, {0, 1}));
  for (const char* name : {"r.jpg", "r.gif", "r.tif", "r.h5.bak"}) {
    options_.image_file = folder_ / name;
    EXPECT_THAT([&] { render(options_); },
                ThrowsMessage<InputError>(AllOf(HasSubstr(name), HasSubstr("allowed .png, .svg, .pdf, .exr"))));
    EXPECT_FALSE(fs::exists(options_.image_file));
  }
  for (const char* name : {"r.PNG", "picture", ".png"}) {
    options_.image_file = folder_ / name;
    draw();
  }
  options_.image_file = folder_ / "r.EXR";
  render(options_);
  std::ifstream exr(options_.image_file, std::ios::binary);
  EXPECT_EQ(exr.get(), 0x76);  // the first byte of the magic number
}

std::string bytes_of(const fs::path& file) {
  std::ifstream in(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(in), {}};
}

// A figure of a map of 300 x 100 m: the cells of the first and last value have the first and last colour of viridis.
TEST_F(Render, FigureHasTheColoursOfTheValuesInAFrame) {
  Solution solution = sample::solution(3, 1, 1, {0, 1});
  solution.box.ny = 2;
  solution.upwelling_flux = {9, 9, 9, 9, 9, 9, 0, 1, 2, 3, 4, 5};
  for (auto* flux : {&solution.downwelling_diffuse_flux, &solution.direct_flux}) flux->resize(12, 1.F);
  for (auto* cells : {&solution.absorbed_power, &solution.actinic_flux}) cells->resize(6, 1.F);
  write(solution);
  options_.form = RenderForm::automatic;
  options_.width = 600;
  const Picture picture = draw();
  EXPECT_EQ(picture.width, 600);
  EXPECT_EQ(picture.red(0, 0), 255);  // white margins
  const std::vector<Rgb> colours = make_colormap("viridis", 511);
  const auto pixels_of = [&picture](const Rgb& colour) {
    int count = 0;
    for (int y = 0; y < picture.height; ++y) {
      for (int x = 0; x < picture.width; ++x)
        count += picture.channel(x, y, 0) == colour[0] && picture.channel(x, y, 1) == colour[1] &&
                 picture.channel(x, y, 2) == colour[2];
    }
    return count;
  };
  // A cell takes a sixth of a frame that is 75 x 100 m, on at least half the picture.
  EXPECT_GT(pixels_of(colours.front()), 5000);
  EXPECT_NEAR(pixels_of(colours.front()), pixels_of(colours.back()), 0.1 * pixels_of(colours.back()));
  EXPECT_EQ(report_.min, 0);
  EXPECT_EQ(report_.max, 5);
}

TEST_F(Render, FiguresAreWrittenByTheEndingAndTwiceTheSame) {
  write(sample::solution(3, 2, 2));
  options_.form = RenderForm::automatic;
  for (const auto& [name, magic] :
       {std::pair("f.png", "\x89PNG"), std::pair("f.svg", "<?xml"), std::pair("f.PDF", "%PDF")}) {
    options_.image_file = folder_ / name;
    report_ = render(options_);
    EXPECT_THAT(bytes_of(options_.image_file), testing::StartsWith(magic));
    EXPECT_EQ(report_.size_unit, std::string(name) == "f.png" ? "pixels" : "points");
    EXPECT_EQ(report_.width, std::string(name) == "f.png" ? 1200 : 450);
  }
  // SVG numbers its parts through the life of a process; processes give the same bytes (tests/robustness/files.py).
  for (const char* name : {"f.png", "f.PDF"}) {
    options_.image_file = folder_ / name;
    const std::string before = bytes_of(options_.image_file);
    render(options_);
    EXPECT_EQ(bytes_of(options_.image_file), before) << name;
  }
}

TEST_F(Render, SectionIsAPlaneOfCells) {
  write(sample::solution(3, 4, 2));  // rows of cells at y = -25, 25, 75, 125; columns at x = 112.5, 137.5, 162.5
  options_.variable = "absorbed_power";
  options_.section = "y=80";
  draw();
  EXPECT_EQ(report_.image.place, "section x-z at y = 75 m");
  EXPECT_THAT(report_.image.value,
              testing::ElementsAre(sample::field_value(4, 0, 2, 0), sample::field_value(4, 0, 2, 1),
                                   sample::field_value(4, 0, 2, 2), sample::field_value(4, 1, 2, 0),
                                   sample::field_value(4, 1, 2, 1), sample::field_value(4, 1, 2, 2)));
  EXPECT_THAT(report_.image.row_edge_m, testing::ElementsAre(510, 530, 560));
  EXPECT_EQ(report_.image.column_start_m, 100);
  options_.section = "x=1e2";  // the very edge of the domain
  options_.form = RenderForm::figure;
  draw();
  EXPECT_EQ(report_.image.place, "section y-z at x = 112.5 m");
  EXPECT_EQ(report_.image.columns, 4);
  EXPECT_EQ(report_.image.value[5], sample::field_value(4, 1, 1, 0));
  EXPECT_EQ(report_.image.column_start_m, -50);
  EXPECT_EQ(report_.image.column_width_m, 50);
}

// Extinctions are the numbers of the cells. Sections of fluxes have them too, on rows of cells.
TEST_F(Render, SectionsHaveTheCloudsOfTheResult) {
  const Solution solution = sample::solution(3, 4, 2);
  ResultInfo info = sample::info();
  info.cloud_extinction.emplace_back();
  for (int n = 0; n < 24; ++n) info.cloud_extinction[0].push_back(static_cast<float>(n));
  write_result(options_.result_file, solution, info);
  options_.form = RenderForm::figure;
  for (const char* variable : {"absorbed_power", "upwelling_flux"}) {
    options_.variable = variable;
    options_.section = "y=80";
    draw();
    ASSERT_TRUE(report_.image.clouds.has_value());
    EXPECT_THAT(report_.image.clouds->extinction, testing::ElementsAre(6, 7, 8, 18, 19, 20)) << variable;
    EXPECT_THAT(report_.image.clouds->row_edge_m, testing::ElementsAre(510, 530, 560));
    options_.section = "x=120";
    draw();
    EXPECT_THAT(report_.image.clouds->extinction, testing::ElementsAre(0, 3, 6, 9, 12, 15, 18, 21)) << variable;
  }
  const std::string with = bytes_of(options_.image_file);
  options_.outline = 0;
  draw();
  EXPECT_NE(bytes_of(options_.image_file), with);
  options_.outline = 10;
  options_.section = "";
  EXPECT_THAT([this] { render(options_); }, ThrowsMessage<InputError>(HasSubstr("found a map, allowed a section")));

  info.wavelengths_um = {.5, .6};
  info.cloud_extinction.push_back(info.cloud_extinction[0]);
  for (float& value : info.cloud_extinction[1]) value += 100;
  const std::vector<Solution> solutions{solution, solution};
  write_result(options_.result_file, solutions, info);
  options_.section = "y=80";
  options_.wavelength_um = .6;
  draw();
  EXPECT_THAT(report_.image.clouds->extinction, testing::ElementsAre(106, 107, 108, 118, 119, 120));

  write(solution);
  options_.wavelength_um.reset();
  EXPECT_THAT([this] { render(options_); }, ThrowsMessage<InputError>(HasSubstr("found no variable extinction")));
}

TEST_F(Render, ProfilesAreThoseOfTheFileOrMeans) {
  write(sample::solution(3, 4, 2));
  const FluxProfile stored = read_flux_profile(options_.result_file, "direct_flux", {});
  EXPECT_THAT(stored.value, testing::ElementsAre(3, 3.125, 3.25));
  EXPECT_THAT(stored.height_m, testing::ElementsAre(510, 530, 560));
  const FluxProfile mean = read_flux_profile(options_.result_file, "absorbed_power", {});
  EXPECT_THAT(mean.height_m, testing::ElementsAre(520, 545));
  EXPECT_THAT(stored.face_m, testing::IsEmpty());
  EXPECT_THAT(mean.face_m, testing::ElementsAre(510, 530, 560));
  EXPECT_NEAR(mean.value[1], 4000 + 100 + 15 + 1 / 16., 1e-3);  // the mean of a linear function; floats
  EXPECT_EQ(mean.units, "W m-3");
  EXPECT_EQ(mean.bottom_m, 510);
  EXPECT_EQ(mean.top_m, 560);
  EXPECT_TRUE(std::isnan(read_flux_profile(options_.result_file, "actinic_flux", {}).value[0]));
  options_.profile = true;
  options_.form = RenderForm::automatic;
  options_.all_fluxes = true;
  draw();
  EXPECT_EQ(report_.image.variable, "upwelling_flux, downwelling_diffuse_flux, direct_flux");
  EXPECT_THAT([this] { read_flux_profile(options_.result_file, "optical_depth", {}); },
              ThrowsMessage<InputError>(AllOf(HasSubstr("no profile"), HasSubstr("absorbed_power"))));
}

TEST_F(Render, OneColumnIsACurveByHeight) {
  write(sample::solution(1, 1, 6));
  options_.form = RenderForm::automatic;
  draw();
  EXPECT_EQ(report_.image.place, "column");
  EXPECT_EQ(report_.width, 1200);
}

TEST_F(Render, OptionsThatExcludeEachOther) {
  write(sample::solution(3, 4, 2));
  const auto expect = [this](auto change, const auto& message) {
    RenderOptions wrong = options_;
    wrong.form = RenderForm::automatic;
    change(wrong);
    EXPECT_THAT([&] { render(wrong); }, ThrowsMessage<InputError>(message));
    EXPECT_FALSE(fs::exists(wrong.image_file));
  };
  expect([](auto& o) { o.range = {0, 1}, o.min = 0; }, HasSubstr("range: excludes min and max"));
  expect([](auto& o) { o.min = 1e9; }, HasSubstr("min, max: 1e+09 to"));
  // Ticks that no double separates, and a difference that is infinite.
  for (const auto& [first, last] : std::vector<std::pair<double, double>>{
           {0, 0}, {1, 1 + 1e-15}, {0.43, 0.43 * (1 + 1e-14)}, {1e16, 1e16 + 2}, {-1e308, 1e308}, {1e308, -1e308}}) {
    expect([&](auto& o) { o.range = {first, last}; }, HasSubstr("is not a range"));
    expect([&](auto& o) { o.min = first, o.max = last; }, HasSubstr("is not a range"));
  }
  expect([](auto& o) { o.form = RenderForm::bare, o.width = 600; }, HasSubstr("bare: excludes size"));
  expect([](auto& o) { o.scale = 2, o.title = "T"; }, HasSubstr("scale: excludes title"));
  expect([](auto& o) { o.scale = 2, o.form = RenderForm::figure; }, HasSubstr("excludes figure"));
  expect([](auto& o) { o.width = 100; }, HasSubstr("found 100, allowed a width from 400 to 10000"));
  expect([](auto& o) { o.profile = true, o.section = "y=0"; }, HasSubstr("profile: excludes section"));
  expect([](auto& o) { o.section = "y=0", o.level = "bottom"; }, HasSubstr("section: excludes level"));
  expect([](auto& o) { o.profile = true, o.level = "nonsense"; }, HasSubstr("profile: excludes level"));
  expect([](auto& o) { o.profile = true, o.form = RenderForm::bare; }, HasSubstr("profile: excludes bare"));
  expect([](auto& o) { o.profile = true, o.scale = 2; }, HasSubstr("profile: excludes scale"));
  expect([](auto& o) { o.profile = true, o.outline = 1; }, HasSubstr("profile: excludes outline"));
  expect([](auto& o) { o.scale = 2, o.outline = 1; }, HasSubstr("scale: excludes outline"));
  expect([](auto& o) { o.section = "y=0", o.outline = -1; }, HasSubstr("found -1, allowed an extinction >= 0"));
  expect([](auto& o) { o.profile = true, o.max = 2; }, HasSubstr("profile: excludes range"));
  expect([](auto& o) { o.profile = true, o.colormap = "grey"; }, HasSubstr("profile: excludes colormap"));
  expect([](auto& o) { o.profile = true, o.exposure = 2; }, HasSubstr("profile: excludes tone"));
  for (const char* section : {"z=3", "y", "x=", "y=12m", "x=nan", "3200"}) {
    expect([section](auto& o) { o.section = section; },
           AllOf(HasSubstr(section), HasSubstr("allowed x=METRES or y=METRES")));
  }
  expect([](auto& o) { o.section = "y=200"; }, HasSubstr("found y = 200 m, allowed -50 to 150 m"));
  expect([](auto& o) { o.image_file.replace_extension(".svg"), o.scale = 1; }, HasSubstr("found .svg"));
  expect([](auto& o) { o.image_file.replace_extension(".svg"), o.width = 600; },
         HasSubstr("width of a PNG figure: excludes SVG"));
  expect([](auto& o) { o.image_file.replace_extension(".exr"), o.title = "T"; }, HasSubstr("found .exr"));
  // The numbers of OpenEXR have no colours.
  for (const auto change : std::initializer_list<void (*)(RenderOptions&)>{
           [](RenderOptions& o) {
             o.range = {0, 1};
           },
           [](RenderOptions& o) { o.min = 0; }, [](RenderOptions& o) { o.max = 1; },
           [](RenderOptions& o) { o.colormap = "grey"; }, [](RenderOptions& o) { o.tone = "filmic"; },
           [](RenderOptions& o) { o.exposure = 2; }, [](RenderOptions& o) { o.automatic_exposure = true; }}) {
    expect([change](auto& o) { o.image_file.replace_extension(".exr"), change(o); },
           HasSubstr("OpenEXR holds numbers and excludes range"));
  }
  write(sample::solution(1, 1, 6));
  expect([](auto& o) { o.range = {0, 1}; }, HasSubstr("a curve (a result of one column): excludes range"));
}

}  // namespace
}  // namespace cloudbow
