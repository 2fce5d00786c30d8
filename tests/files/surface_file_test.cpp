// Grey images and friction factors from files, whole and damaged, and scenes that name them.
#include "lumbrical/surface_file.h"

#include <gtest/gtest.h>

#include "files.h"
#include "lumbrical/scene_file.h"

namespace lumbrical {
namespace {

TEST(SurfaceFile, ReadsPlainAndRawImagesOfAnyWhite) {
  GreyImage plain, raw, wide;
  ASSERT_TRUE(parse_grey_image("P2 # a comment\n3 2\n15\n0 5 15\n15 10 0\n", "a", plain).ok());
  EXPECT_EQ(plain.width, 3u);
  EXPECT_EQ(plain.height, 2u);
  EXPECT_EQ(plain.grey, (std::vector<std::uint16_t>{0, 21845, 65535, 65535, 43690, 0}));
  ASSERT_TRUE(parse_grey_image(std::string("P5\n3 2\n15\n\0\5\17\17\12\0", 17), "a", raw).ok());
  EXPECT_EQ(raw, plain);
  ASSERT_TRUE(parse_grey_image(std::string("P5 1 2 65535 \1\2\377\377", 17), "a", wide).ok());
  EXPECT_EQ(wide.grey, (std::vector<std::uint16_t>{258, 65535}));
}

TEST(SurfaceFile, RefusesDamagedImagesAndSaysWhere) {
  const std::string plain = "P2\n3 2\n15\n0 5 15\n15 10 1", raw("P5\n3 2\n15\n\0\5\17\17\12\1", 16);
  for (const std::string& whole : {plain, raw}) {
    for (std::size_t size = 0; size < whole.size(); ++size) {
      GreyImage image{1, 1, {7}};
      const Status status = parse_grey_image(whole.substr(0, size), "cut.pgm", image);
      EXPECT_FALSE(status.ok()) << size;
      EXPECT_EQ(status.message().rfind("cut.pgm:", 0), 0u) << status.message();
      EXPECT_EQ(image, (GreyImage{1, 1, {7}}));
    }
  }
  const auto refusal = [](const std::string& content) {
    GreyImage image;
    return parse_grey_image(content, "f", image).message();
  };
  EXPECT_NE(refusal("P6 1 1 255 aaa").find("f:1:1: is no PGM"), std::string::npos);
  EXPECT_NE(refusal("P2 2 1 9\n3 10").find("f:2:3: a grey is '10'"), std::string::npos);
  EXPECT_NE(refusal("P2 2 1 9\n3 -1").find("'-1'"), std::string::npos);
  EXPECT_NE(refusal("P5 2 1 9 \x03\x0a").find("byte 10"), std::string::npos);
  EXPECT_NE(refusal("P5 65536 65536 255 a").find("the height"), std::string::npos);
  EXPECT_NE(refusal("P5 4000000 1 255 a").find("ends before"), std::string::npos);
  EXPECT_NE(refusal("P2 1 1 65536 0").find("white"), std::string::npos);
  EXPECT_NE(refusal("P2 0 1 1 0").find("the width"), std::string::npos);
}

TEST(SurfaceFile, DamagedImagesAreRefusedOrSound) {
  const std::string plain = "P2\n3 2\n15\n0 5 15\n15 10 1", raw("P5\n3 2\n15\n\0\5\17\17\12\1", 16);
  for (const std::string& whole : {plain, raw}) {
    for (std::size_t i = 0; i < whole.size(); ++i) {
      for (int byte = 0; byte < 256; ++byte) {
        std::string damaged = whole;
        damaged[i] = static_cast<char>(byte);
        GreyImage image;
        if (!parse_grey_image(damaged, "f", image).ok()) continue;
        EXPECT_EQ(image.grey.size(), std::size_t{image.width} * image.height);
        EXPECT_LT(image.grey.size(), damaged.size());
      }
    }
  }
}

TEST(SurfaceFile, ReadsFactorsAndRefusesWhatIsNone) {
  std::vector<double> factors;
  ASSERT_TRUE(parse_friction_factors("1 0.5 # ice\n\n10\n", "f", factors).ok());
  EXPECT_EQ(factors, (std::vector<double>{1, 0.5, 10}));
  const auto refusal = [](const char* content) {
    std::vector<double> none;
    return parse_friction_factors(content, "f", none).message();
  };
  EXPECT_NE(refusal("1\n 2 x").find("f:2:4: "), std::string::npos);
  EXPECT_NE(refusal("nan").find("not finite"), std::string::npos);
  EXPECT_NE(refusal("-1").find("0 to 10"), std::string::npos);
}

class SurfaceScene : public testing::Test {
 protected:
  void SetUp() override {
    test::write_file("ribs.pgm", "P2 2 1 1  0 1");
    test::write_file("rough.txt", "1 2 3 4 5 6 7 8");
  }
  Status load(const std::string& object, SceneFile& file) {
    const std::string path = test::write_file("scene.json", "{\"objects\": [{\n\"plane\": {\"cells\": 2}, " +
                                                                object + "}],\n\"motion\": {\"grasp\": {}}}");
    return load_scene_file(path, file);
  }
  std::string refusal(const std::string& object) {
    SceneFile file;
    return load(object, file).message();
  }
};

TEST_F(SurfaceScene, HoldsWhatTheFileAndItsFilesSay) {
  SceneFile file;
  const Status status =
      load(R"("friction": 0.5, "surface": {"crease_angle": 0.6, "friction_file": "rough.txt",
      "grip": {"image": "ribs.pgm", "period": 0.02, "black": 0.5, "white": 2},
      "bumps": {"image": "ribs.pgm", "period": 0.004, "white": -0.0003}})",
           file);
  ASSERT_TRUE(status.ok()) << status.message();
  const Texture ribs{{2, 1, {0, 65535}}, 0.02, 0.5, 2};
  const Surface& surface = file.scene.objects[0].surface;
  EXPECT_EQ(surface.crease_angle, 0.6);
  EXPECT_EQ(surface.friction_factor, (std::vector<double>{1, 2, 3, 4, 5, 6, 7, 8}));
  EXPECT_EQ(surface.grip, ribs);
  EXPECT_EQ(surface.bumps, (Texture{ribs.image, 0.004, 0, -0.0003}));
}

TEST_F(SurfaceScene, OfWhichPartsMakeNoSenseIsRefusedWithFileLineAndField) {
  const auto says = [](const std::string& message, const char* what) {
    EXPECT_NE(message.find(what), std::string::npos) << message;
  };
  says(refusal(R"("surface": {"crease_angle": -1})"), "scene.json:2:");
  says(refusal(R"("surface": {"crease_angle": -1})"), "objects[0].surface.crease_angle");
  says(refusal(R"("surface": {"bumps": {"image": "ribs.pgm", "white": 1}})"), "objects[0].surface.bumps");
  says(refusal(R"("surface": {"bumps": {"image": "ribs.pgm", "white": 2, "period": 1}})"), "bumps.white");
  says(refusal(R"("surface": {"bumps": {"image": "none.pgm", "white": 1, "period": 1}})"),
       "none.pgm: there is no such file");
  says(refusal(R"("surface": {"bumps": {"image": "rough.txt", "white": 1, "period": 1}})"),
       "rough.txt:1:1: is no PGM");
  says(refusal(R"("surface": {"friction_file": "rough.txt"})"), "has factors of friction");
  test::write_file("rough.txt", "1 2 3");
  says(refusal(R"("friction": 0.5, "surface": {"friction_file": "rough.txt"})"), "3 numbers for 8 triangles");
}

}  // namespace
}  // namespace lumbrical
