// How near a hand comes, and motions moved so that it meets an object: held against known distances, brute
// force and ticks.
#include "lumbrical/clearance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>

#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"

namespace lumbrical {
namespace {

Mesh moved(Mesh mesh, Vec3 shift) {
  for (Vec3& v : mesh.vertices) v += shift;
  return mesh;
}

// The built-in grasp round the z axis, and a scene in which its hand meets nothing yet.
struct Setting {
  Scene scene;
  Motion motion;
  Setting() {
    scene.hand = default_hand(Side::right);
    motion = make_grasp(scene.hand, 0.037, 0.095, 4);
  }
  void add(const std::string& name, const Mesh& mesh) { scene.objects.push_back({name, mesh}); }
};

std::uint64_t contacts_of(const Setting& setting) {
  Model model;
  EXPECT_TRUE(build_model(setting.scene, {}, model).ok());
  State state;
  Scratch scratch = make_scratch(model);
  std::uint64_t contacts = 0;
  for (const MotionSample& sample : setting.motion.samples)
    contacts += tick(model, state, scratch, sample.frame).contact_count;
  return contacts;
}

TEST(Clearance, OfAFlatFloorIsTheHandsLowestPoint) {
  Setting setting;
  setting.add("floor", moved(make_plane(4, 40, 0.3), {0, 0, -0.5}));
  const Clearance clearance = find_clearance(setting.scene, setting.motion, 1e9);
  ASSERT_EQ(clearance.approach.size(), 1u);
  const Approach& approach = clearance.approach[0];
  EXPECT_NEAR(approach.distance, clearance.hand.lower.z + 0.5, 1e-9);
  EXPECT_NEAR(approach.hand.z, clearance.hand.lower.z, 1e-9);
  EXPECT_NEAR(approach.object.z, -0.5, 1e-12);
  EXPECT_NEAR(norm(approach.hand - approach.object), approach.distance, 1e-9);
}

TEST(Clearance, IsToldOfEachObjectWithItsBox) {
  Setting setting;
  setting.add("near", moved(make_box({0.1, 0.1, 0.1}, 2), {1, 0, 0}));
  setting.add("far", moved(make_sphere(0.05, 4), {0, 9, 0}));
  setting.add("nothing", {});
  const Clearance clearance = find_clearance(setting.scene, setting.motion, 1e9);
  ASSERT_EQ(clearance.object.size(), 3u);
  EXPECT_NEAR(clearance.object[0].lower.x, 0.95, 1e-12);
  EXPECT_NEAR(clearance.object[1].upper.y, 9.05, 1e-12);
  EXPECT_LT(clearance.approach[0].distance, clearance.approach[1].distance);
  EXPECT_GT(clearance.approach[1].distance, 8.5);
  EXPECT_EQ(clearance.approach[2].distance, 1e300);
}

TEST(Clearance, IsNotToWhatHasNoAreaAndIsNeverFelt) {
  Setting setting;
  Mesh floor = moved(make_plane(4, 40, 0.3), {0, 0, -0.5});
  const auto first = static_cast<std::uint32_t>(floor.vertices.size());
  floor.vertices.insert(floor.vertices.end(), {{0, 0, -0.4}, {0.1, 0, -0.4}, {0.2, 0, -0.4}});
  floor.triangles.push_back({first, first + 1, first + 2});
  setting.add("floor", floor);
  EXPECT_NEAR(find_clearance(setting.scene, setting.motion, 1e9).approach[0].object.z, -0.5, 1e-12);
}

// Fine meshes and coarse ones, and pieces all over: the tree must not lose the nearest of them.
TEST(Clearance, IsTheSameWhateverTheOrderOfTriangles) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> place(-1, 1);
  for (int round = 0; round < 5; ++round) {
    Setting setting;
    Mesh pieces;
    for (std::uint32_t i = 0; i < 3000; ++i) {
      const Vec3 at{2 + place(random), place(random), place(random)};
      for (int k = 0; k < 3; ++k)
        pieces.vertices.push_back(at + 0.02 * Vec3{place(random), place(random), place(random)});
      pieces.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    setting.add("pieces", pieces);
    const double together = find_clearance(setting.scene, setting.motion, 1e9).approach[0].distance;
    setting.scene.objects.clear();
    for (int part = 0; part < 3; ++part) {
      Mesh third = pieces;
      third.triangles.assign(pieces.triangles.begin() + 1000 * part,
                             pieces.triangles.begin() + 1000 * (part + 1));
      setting.add("part", third);
    }
    const Clearance apart = find_clearance(setting.scene, setting.motion, 1e9);
    double nearest = 1e300;
    for (const Approach& approach : apart.approach) nearest = std::min(nearest, approach.distance);
    EXPECT_EQ(together, nearest);
    EXPECT_GT(together, 0);
  }
}

TEST(Clearance, OfAHandThatTouchesIsZeroAndOneWithoutAHandIsNone) {
  Setting setting;
  setting.add("mug", make_mug({}));
  EXPECT_EQ(find_clearance(setting.scene, setting.motion, 1e9).approach[0].distance, 0);
  for (MotionSample& sample : setting.motion.samples) sample.frame.flags |= kTrackingLost;
  const Clearance blind = find_clearance(setting.scene, setting.motion, 1e9);
  EXPECT_EQ(blind.approach[0].distance, 1e300);
  EXPECT_GT(blind.hand.lower.x, blind.hand.upper.x);
}

TEST(Clearance, OfAMotionWithoutSamplesIsNone) {
  Setting setting;
  setting.add("mug", make_mug({}));
  setting.motion.samples.clear();
  EXPECT_EQ(find_clearance(setting.scene, setting.motion, 1e9).approach[0].distance, 1e300);
  Vec3 shift;
  EXPECT_FALSE(find_shift(setting.scene, setting.motion, 1e9, *parse_alignment("centre"), shift).ok());
}

TEST(Clearance, LooksNoFartherThanTheSession) {
  Setting setting;
  setting.add("mug", make_mug({}));
  EXPECT_GT(find_clearance(setting.scene, setting.motion, 0.1).approach[0].distance, 0.01);
}

Vec3 shift_of(const Setting& setting, const char* alignment) {
  Vec3 shift;
  const Status status = find_shift(setting.scene, setting.motion, 1e9, *parse_alignment(alignment), shift);
  EXPECT_TRUE(status.ok()) << status.message();
  return shift;
}

TEST(Alignment, ByContactTheHandTouchesBarelyAndBeforeItDidNot) {
  for (const Mesh& mesh :
       {moved(make_sphere(0.05, 12), {0.6, -0.4, 1.3}), moved(make_box({0.2, 0.1, 0.3}, 3), {-2, 0.3, 0}),
        moved(make_plane(1, 9, 0.2), {0, 0, -0.7})}) {
    Setting setting;
    setting.add("thing", mesh);
    EXPECT_EQ(contacts_of(setting), 0u);
    const double distance = find_clearance(setting.scene, setting.motion, 1e9).approach[0].distance;
    const Vec3 shift = shift_of(setting, "thing:contact");
    EXPECT_NEAR(norm(shift), distance + 0.001, 1e-9);
    ASSERT_TRUE(place_motion({{shift, {}}, 1}, setting.motion).ok());
    EXPECT_GT(contacts_of(setting), 0u);
    EXPECT_EQ(shift_of(setting, "contact"), Vec3{});  // it touches
  }
}

TEST(Alignment, ByCentreTheGraspCloseOnTheObject) {
  Setting setting;
  const Vec3 away{1.7, -0.2, 0.4};
  setting.add("decoy", moved(make_box({0.1, 0.1, 0.1}, 1), {-5, 0, 0}));
  setting.add("mug", moved(make_mug({}), away));
  const Vec3 shift = shift_of(setting, "mug:centre");
  ASSERT_TRUE(place_motion({{shift, {}}, 1}, setting.motion).ok());
  EXPECT_GT(contacts_of(setting), 0u);
  EXPECT_NEAR(norm(shift_of(setting, "mug:centre")), 0, 1e-6);
}

TEST(Alignment, NamedPointsAreThoseOfTheBox) {
  Setting setting;
  setting.add("box", make_box({0.2, 0.4, 0.6}, 1));
  const Vec3 centre = shift_of(setting, "centre");
  const std::pair<const char*, Vec3> points[] = {
      {"left", {-0.1, 0, 0}},   {"right", {0.1, 0, 0}}, {"front", {0, -0.2, 0}},        {"back", {0, 0.2, 0}},
      {"bottom", {0, 0, -0.3}}, {"top", {0, 0, 0.3}},   {"0.5,-1e-1,2", {0.5, -0.1, 2}}};
  for (const auto& [name, offset] : points)
    EXPECT_NEAR(norm(shift_of(setting, name) - centre - offset), 0, 1e-12) << name;
}

TEST(Alignment, RefusesWhatItCannotDoByName) {
  Setting setting;
  setting.add("box", make_box({0.2, 0.4, 0.6}, 1));
  Vec3 shift{1, 2, 3};
  EXPECT_NE(
      find_shift(setting.scene, setting.motion, 1, *parse_alignment("cup:top"), shift).message().find("cup"),
      std::string::npos);
  for (MotionSample& sample : setting.motion.samples) sample.frame.flags |= kTrackingLost;
  EXPECT_FALSE(find_shift(setting.scene, setting.motion, 1, *parse_alignment("contact"), shift).ok());
  EXPECT_FALSE(find_shift(setting.scene, setting.motion, 1, *parse_alignment("centre"), shift).ok());
  EXPECT_EQ(shift, (Vec3{1, 2, 3}));
  for (const char* const text :
       {"", "middle", "1,2", "1,2,", "1,2,3,4", "1;2;3", "nan,0,0", "1,2,1e999", "box:", "0, 1, 2"})
    EXPECT_FALSE(parse_alignment(text)) << text;
}

}  // namespace
}  // namespace lumbrical
