// SPDX-License-Identifier: Apache-2.0
// A raster beneath the scene: where its pixels lie, what it is refused for, what pages are told.
#include <unistd.h>

#include <filesystem>
#include <numbers>

#include <gmock/gmock.h>

#include "framework/core/error.h"
#include "framework/core/files.h"
#include "framework/studio/backdrop.h"
#include "framework/survey/reference_system.h"
#include "tests/studio/kinds_fixture.h"
#include "tests/survey/made_rasters.h"
#include "tests/tool.h"

namespace lapwing {
namespace {

using Eigen::Vector2d;
using testing::AllOf;
using testing::HasSubstr;

const GeodeticOrigin kOrigin{52.0116, 4.3571, 40, HeightOf::ellipsoid, 0};
const Eigen::AlignedBox2d kAround(Vector2d(-500, -500), Vector2d(500, 500));

// In the Mercator map of web pages, m; and back. Formulas of a sphere, without PROJ.
constexpr double kEarth = 6378137;
constexpr double kDegree = std::numbers::pi / 180;
Vector2d mercator(const GeodeticPoint& p) {
  return {kEarth * p.longitude_deg * kDegree,
          kEarth * std::log(std::tan(std::numbers::pi / 4 + p.latitude_deg * kDegree / 2))};
}
GeodeticPoint from_mercator(const Vector2d& p) {
  return {(2 * std::atan(std::exp(p.y() / kEarth)) - std::numbers::pi / 2) / kDegree,
          p.x() / kEarth / kDegree, kOrigin.altitude().value()};
}

// The place of a pixel's middle by the picture's corners, as the page draws them.
Vector2d place_in(const PlacedPicture& picture, double x, double y) {
  const double u = x / picture.width * picture.cells, v = y / picture.height * picture.cells;
  const int column = std::min(static_cast<int>(u), picture.cells - 1);
  const int row = std::min(static_cast<int>(v), picture.cells - 1);
  const double s = u - column, t = v - row;
  const auto at = [&](int right, int down) {
    return picture
        .corners[static_cast<std::size_t>((row + down) * (picture.cells + 1) + column + right)];
  };
  if (t > s) return at(0, 0) * (1 - t) + at(0, 1) * (t - s) + at(1, 1) * s;
  return at(0, 0) * (1 - s) + at(1, 0) * (s - t) + at(1, 1) * t;
}

class BackdropRasters : public testing::Test {
 protected:
  void SetUp() override {
    if (!rasters_available()) GTEST_SKIP() << "Lapwing was built without libgdal-dev";
    if (!ReferenceSystem::available()) GTEST_SKIP() << "Lapwing was built without libproj-dev";
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }
  std::filesystem::path written(const std::string& bytes, const std::string& name = "a.tif") const {
    write_file_atomically(folder_ / name, bytes);
    return folder_ / name;
  }
  // Red at one pixel, green elsewhere.
  static MadePicture marked(int column, int row) {
    MadePicture made;
    made.system = 3857;
    const Vector2d middle = mercator(kOrigin.point());
    made.transform = {middle.x() - 20, 1, 0, middle.y() + 20, 0, -1};
    made.value_at = [=](int c, int r, int band) {
      return (c == column && r == row) == (band == 0) && band < 2 ? 255 : 0;
    };
    return made;
  }
  std::string refusal(const std::string& bytes, const GeodeticOrigin& origin = kOrigin) const {
    try {
      placed_picture(written(bytes), origin, kAround);
    } catch (const InputError& error) {
      return error.what();
    }
    return "";
  }
  static std::array<int, 4> colour(const PlacedPicture& picture, int column, int row) {
    const std::uint8_t* at =
        &picture.colours[4 * static_cast<std::size_t>(row * picture.width + column)];
    return {at[0], at[1], at[2], at[3]};
  }

  const std::filesystem::path folder_ = std::filesystem::path(testing::TempDir()) /
                                        ("lapwing_backdrop_" + std::to_string(::getpid()));
};

// The marked pixel is at the place that the formulas give, within half a pixel; much closer in
// fact.
TEST_F(BackdropRasters, PixelsLieWhereTheirSystemSays) {
  for (const bool turned : {false, true}) {
    MadePicture made = marked(33, 6);
    auto& t = made.transform;
    if (turned) t = {t[0], 0.8, 0.6, t[3], 0.6, -0.8};
    const PlacedPicture picture = placed_picture(written(tiff_bytes(made)), kOrigin, kAround);
    ASSERT_EQ(picture.width, 40);
    ASSERT_EQ(picture.height, 40);
    for (int row = 0; row < 40; ++row)
      for (int column = 0; column < 40; ++column)
        EXPECT_EQ(colour(picture, column, row)[0], column == 33 && row == 6 ? 255 : 0);
    const Vector2d there(t[0] + 33.5 * t[1] + 6.5 * t[2], t[3] + 33.5 * t[4] + 6.5 * t[5]);
    const Vector2d expected = to_local(kOrigin.point(), from_mercator(there)).head<2>();
    EXPECT_LT((place_in(picture, 33.5, 6.5) - expected).norm(), 0.01) << turned;
    // A metre of that map is less on the ground of 52 degrees north.
    EXPECT_NEAR(picture.pixel, std::cos(kOrigin.latitude_deg * kDegree), 0.01);
  }
}

// Of a large raster the part around the scene, made smaller; still within half of its own pixel.
TEST_F(BackdropRasters, LargeOnesAreCutAndMadeSmaller) {
  MadePicture made = marked(0, 0);
  made.width = made.height = 6000;
  made.bands = 1;
  const Vector2d middle = mercator(kOrigin.point());
  made.transform = {middle.x() - 3000 + 100, 1, 0, middle.y() + 3000, 0, -1};
  // A square of 100 pixels, 600 to the east and 1000 to the north of the origin.
  made.value_at = [](int c, int r, int) {
    return c >= 3500 && c < 3600 && r >= 1950 && r < 2050 ? 255 : 9;
  };
  const std::filesystem::path file = written(tiff_bytes(made));
  const PlacedPicture part = placed_picture(file, kOrigin, kAround);
  EXPECT_LT(part.width, 1700);
  EXPECT_NEAR(part.pixel, part.pixel_of_file, 1e-9);
  const PlacedPicture whole =
      placed_picture(file, kOrigin, {Vector2d(-9e3, -9e3), Vector2d(9e3, 9e3)});
  EXPECT_LE(whole.width * whole.height, 1 << 23);
  EXPECT_GT(whole.pixel, 1.9 * whole.pixel_of_file);
  Vector2d sum = Vector2d::Zero();
  double weight = 0;
  for (int row = 0; row < whole.height; ++row)
    for (int column = 0; column < whole.width; ++column) {
      const double bright = colour(whole, column, row)[0] - 9;
      sum += bright * place_in(whole, column + 0.5, row + 0.5);
      weight += bright;
    }
  const Vector2d expected =
      to_local(kOrigin.point(), from_mercator({made.transform[0] + 3550, made.transform[3] - 2000}))
          .head<2>();
  EXPECT_LT((sum / weight - expected).norm(), whole.pixel / 2);
  std::filesystem::remove(file);
}

TEST_F(BackdropRasters, OtherSystems) {
  // Degrees.
  MadePicture made = marked(10, 10);
  made.system = 4326;
  made.geographic = true;
  made.transform = {4.3571 - 10.5e-5, 1e-5, 0, 52.0116 + 10.5e-5, 0, -1e-5};
  PlacedPicture picture = placed_picture(written(tiff_bytes(made)), kOrigin, kAround);
  EXPECT_LT(place_in(picture, 10.5, 10.5).norm(), 0.01);
  // UTM, whose north is not that of the world: 4 degrees east of the zone's middle, turned by more
  // than a degree.
  made = marked(39, 20);
  made.system = 32631;
  const Eigen::Vector3d utm = ReferenceSystem::of("EPSG:32631").from_geodetic({52.0116, 4.3571, 0});
  made.transform = {utm.x() - 0.5, 1, 0, utm.y() + 20.5, 0, -1};
  picture = placed_picture(written(tiff_bytes(made)), kOrigin, kAround);
  const Vector2d east = place_in(picture, 39.5, 20.5);
  EXPECT_NEAR(east.norm(), 39, 0.05);
  EXPECT_NEAR(std::abs(std::atan2(east.y(), east.x())) / kDegree, 1.07, 0.02);
}

TEST_F(BackdropRasters, BandsOfAllKinds) {
  MadePicture made = marked(3, 4);
  made.bands = 1;
  made.value_at = [](int c, int r, int) { return 10 * c % 200 + r; };
  PlacedPicture picture = placed_picture(written(tiff_bytes(made)), kOrigin, kAround);
  EXPECT_EQ(colour(picture, 7, 9), (std::array<int, 4>{79, 79, 79, 255})) << "grey";
  made.empty = "79.0";
  picture = placed_picture(written(tiff_bytes(made)), kOrigin, kAround);
  EXPECT_EQ(colour(picture, 7, 9)[3], 0) << "no data";
  EXPECT_EQ(colour(picture, 7, 8)[3], 255);
  made = marked(3, 4);
  made.bands = 4;
  made.opacity = true;
  made.value_at = [](int c, int, int band) { return band == 3 ? (c < 20 ? 255 : 0) : 50 * band; };
  picture = placed_picture(written(tiff_bytes(made)), kOrigin, kAround);
  EXPECT_EQ(colour(picture, 2, 9), (std::array<int, 4>{0, 50, 100, 255}));
  EXPECT_EQ(colour(picture, 30, 9)[3], 0) << "opacity";
  // Numbers of 16 bits are stretched.
  made = marked(3, 4);
  made.bits = 16;
  made.value_at = [](int c, int, int band) { return 1000 + 100 * c + band; };
  picture = placed_picture(written(tiff_bytes(made)), kOrigin, kAround);
  EXPECT_LT(colour(picture, 0, 0)[0], 10);
  EXPECT_GT(colour(picture, 39, 0)[0], 245);
  EXPECT_NEAR(colour(picture, 20, 0)[1], 128, 12);
}

// A roof: its north-western side is light, its south-eastern one dark.
TEST_F(BackdropRasters, HeightsAreHillsInTheLight) {
  MadeRaster made;
  made.system = 3857;
  const Vector2d middle = mercator(kOrigin.point());
  made.left = middle.x() - 20;
  made.upper = middle.y() + 20;
  made.height_at = [&](double x, double y) {
    const double along = x - middle.x() - (y - middle.y());  // to the south-east
    if (x - middle.x() > 18) return std::nanf("");
    return static_cast<float>(10 - std::abs(along) / 2);
  };
  const std::filesystem::path file = written(tiff_bytes(made));
  EXPECT_TRUE(backdrop_look(file).heights);
  const PlacedPicture picture = placed_picture(file, kOrigin, kAround);
  const int light = colour(picture, 8, 8)[0], dark = colour(picture, 30, 30)[0];
  // n = (-g, g, 1) on the light side with g = 1/2: (1 / 2 + sqrt(1 / 2)) / sqrt(3 / 2).
  EXPECT_NEAR(light, 255 * (0.5 + std::sqrt(0.5)) / std::sqrt(1.5), 1);
  EXPECT_NEAR(dark, 255 * (std::sqrt(0.5) - 0.5) / std::sqrt(1.5), 1);
  EXPECT_EQ(colour(picture, 39, 5)[3], 0) << "no data";
}

// A degree of longitude has half as many metres at 60 degrees north.
TEST_F(BackdropRasters, HillsInDegreesAreAsSteepAsTheyAre) {
  const GeodeticOrigin north{60, 4.3571, 40, HeightOf::ellipsoid, 0};
  MadeRaster made;
  made.system = 4326;
  made.geographic = true;
  made.pixel = 1e-5;
  made.left = 4.3571 - 20e-5;
  made.upper = 60 + 20e-5;
  // Half a metre up for each metre to the east.
  made.height_at = [&](double x, double) {
    return static_cast<float>(0.5 * (x - made.left) * kDegree * kEarth / 2);
  };
  const PlacedPicture picture = placed_picture(written(tiff_bytes(made)), north, kAround);
  EXPECT_NEAR(colour(picture, 20, 20)[0], 255 * (0.25 + std::sqrt(0.5)) / std::sqrt(1.25), 1.5);
}

TEST_F(BackdropRasters, WhatIsWrongIsSaid) {
  MadePicture made = marked(3, 4);
  made.system = 0;
  EXPECT_THAT(refusal(tiff_bytes(made)), AllOf(HasSubstr("a.tif'"), HasSubstr("reference system"),
                                               HasSubstr("gdal_edit.py -a_srs")));
  EXPECT_THROW(backdrop_look(written(tiff_bytes(made))), InputError);
  EXPECT_THAT(refusal("not a raster"), HasSubstr("expected a GeoTIFF"));
  const std::string good = tiff_bytes(marked(3, 4));
  EXPECT_THAT(refusal(good, {52.1116, 4.3571, 40, HeightOf::ellipsoid, 0}),
              AllOf(HasSubstr("does not reach to the flight"), HasSubstr("11.1 km"),
                    HasSubstr("origin.latitude_deg")));
  made = marked(3, 4);
  made.system = 28992;  // of the Netherlands; the flight is in Australia
  made.transform = {84900, 1, 0, 447500, 0, -1};
  EXPECT_THAT(refusal(tiff_bytes(made), {-33.9, 151.2, 40, HeightOf::ellipsoid, 0}),
              AllOf(HasSubstr("does not reach to the flight"), HasSubstr("Amersfoort")));
  EXPECT_THAT(refusal(good.substr(0, good.size() - 200)), HasSubstr("a.tif'"));
}

// Two gigabytes that are not there: of so many pixels none is read, but where there are few.
TEST_F(BackdropRasters, FilesTooLargeAreRefused) {
  if (tool_on_path({"gdal_create"}).empty())
    GTEST_SKIP() << "no gdal_create: apt-get install gdal-bin";
  const Vector2d middle = mercator(kOrigin.point());
  const auto corner = [&](double x, double y) {
    return " " + std::to_string(middle.x() + x) + " " + std::to_string(middle.y() + y);
  };
  const std::string file = (folder_ / "large.tif").string();
  ASSERT_EQ(std::system(("gdal_create -q -outsize 50000 50000 -bands 1 -co SPARSE_OK=TRUE "
                         "-co TILED=YES -a_srs EPSG:3857 -a_ullr" +
                         corner(-25000, 25000) + corner(25000, -25000) + " '" + file + "'")
                            .c_str()),
            0);
  try {
    placed_picture(file, kOrigin, {Vector2d(-2e4, -2e4), Vector2d(2e4, 2e4)});
    FAIL();
  } catch (const InputError& error) {
    EXPECT_THAT(error.what(), AllOf(HasSubstr("large.tif'"), HasSubstr("gdaladdo -r average")));
  }
  EXPECT_NEAR(placed_picture(file, kOrigin, kAround).pixel, 0.616, 1e-3);
}

// ---- the program
// ----------------------------------------------------------------------------------

class StudioBackdrop : public StudioKinds {
 protected:
  void SetUp() override {
    StudioKinds::SetUp();
    if (!rasters_available() || !ReferenceSystem::available())
      GTEST_SKIP() << "Lapwing was built without libgdal-dev or libproj-dev";
    use("filming/castle_flyover.lua");
  }
  static MadePicture photo(int red) {
    MadePicture made;
    made.system = 3857;
    const Vector2d middle = mercator(kOrigin.point());
    made.transform = {middle.x() - 40, 2, 0, middle.y() + 40, 0, -2};
    made.value_at = [=](int, int, int band) { return band == 0 ? red : 20; };
    return made;
  }
  static Value backdrop(PageClient& page) {
    return page.until([](const Value& m) { return m.at("type") == Value("backdrop"); });
  }
  std::string blob_of(const Value& message) const { return blob(*address_, message.at("picture")); }
  std::optional<StudioAddress> address_;
};

const std::vector<std::string> kPlace{
    "--set",
    "origin={latitude_deg: 52.0116, longitude_deg: 4.3571, height: 40, height_of: ellipsoid}",
    "--backdrop", "photo.tif"};

TEST_F(StudioBackdrop, IsToldToEveryPageAndFollowsItsFile) {
  write_file_atomically(folder_ / "photo.tif", tiff_bytes(photo(200)));
  address_ = serve(kPlace);
  PageClient page(*address_, "a");
  const Value first = backdrop(page);
  EXPECT_EQ(first.at("file"), Value("photo.tif"));
  EXPECT_EQ(first.at("width"), Value(40));
  EXPECT_EQ(blob_of(first).substr(0, 4), "WLP1");
  EXPECT_EQ(blob_of(first).size(), 12u + 4 * 40 * 40);
  EXPECT_EQ(static_cast<std::uint8_t>(blob_of(first).at(12)), 200);
  const Value::List& corners = first.at("corners").as_list();
  const auto along = static_cast<std::size_t>(first.at("cells").as_integer()) + 1;
  ASSERT_EQ(corners.size(), 2 * along * along);
  const Vector2d expected =
      to_local(kOrigin.point(), from_mercator(mercator(kOrigin.point()) + Vector2d(-40, 40)))
          .head<2>();
  EXPECT_NEAR(corners[0].as_number(), expected.x(), 0.01);
  EXPECT_NEAR(corners[1].as_number(), expected.y(), 0.01);
  // A page that comes later.
  PageClient other(*address_, "b");
  EXPECT_EQ(backdrop(other), first);
  // The file changes; then it is damaged; nothing of it is shown any more.
  write_file_atomically(folder_ / "photo.tif", tiff_bytes(photo(77)));
  const Value second = backdrop(page);
  EXPECT_EQ(static_cast<std::uint8_t>(blob_of(second).at(12)), 77);
  write_file_atomically(folder_ / "photo.tif", "no picture");
  const Value third = backdrop(page);
  EXPECT_FALSE(third.find("picture"));
  EXPECT_THAT(third.at("why").as_text(), HasSubstr("expected a GeoTIFF"));
  // Nothing of it is part of what is planned.
  EXPECT_EQ(journal().find("backdrop"), std::string::npos);
}

TEST_F(StudioBackdrop, OfAMissionWithoutAnOriginItSaysWhatToState) {
  write_file_atomically(folder_ / "photo.tif", tiff_bytes(photo(200)));
  address_ = serve({"--backdrop", "photo.tif"});
  PageClient page(*address_, "a");
  const Value told = backdrop(page);
  EXPECT_FALSE(told.find("picture"));
  EXPECT_THAT(told.at("why").as_text(), HasSubstr("origin.latitude_deg"));
  // It is stated in the studio.
  page.send_text(R"({"type": "gesture", "id": "g", "base": 0, "label": "Place", "patch": [
    {"path": "origin", "value": {"latitude_deg": 52.0116, "longitude_deg": 4.3571,
     "height": 40, "height_of": "ellipsoid"}}]})");
  EXPECT_TRUE(backdrop(page).find("picture"));
}

TEST_F(StudioBackdrop, WhatCanBeNoBackdropIsRefusedAtTheStart) {
  MadePicture made = photo(200);
  made.system = 0;
  write_file_atomically(folder_ / "photo.tif", tiff_bytes(made));
  EXPECT_NE(
      run({"studio", script_.string(), "--no-open", "--assets", "page", "--backdrop", "photo.tif"}),
      0);
  EXPECT_THAT(errors_, HasSubstr("states no reference system"));
  EXPECT_NE(
      run({"studio", script_.string(), "--no-open", "--assets", "page", "--backdrop", "none.tif"}),
      0);
  EXPECT_THAT(errors_, HasSubstr("none.tif"));
}

}  // namespace
}  // namespace lapwing
