// Which triangles are felt by samples, and that a hand feels both those and the others.
#include <gtest/gtest.h>

#include "lumbrical/shapes.h"
#include "model/primitive.h"
#include "pressed_hand.h"
#include "sampled_hand.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

Mesh strip(double length, double width) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {length, 0, 0}, {0, width, 0}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

bool is_felt_by_samples(const Mesh& mesh) {
  const Model model = model_at(sampled_scene(default_hand(Side::right), {{"mesh", mesh}}), 1e-4);
  return felt_by_samples(model, kPalmSegment, 0);
}

TEST(Patches, CutTrianglesUpToSomeMetresAndShortSlivers) {
  EXPECT_TRUE(is_felt_by_samples(make_plane(0.01, 1)));
  EXPECT_TRUE(is_felt_by_samples(make_plane(0.8, 1))) << "half a table";
  EXPECT_FALSE(is_felt_by_samples(make_plane(10, 1))) << "half a hall";
  EXPECT_TRUE(is_felt_by_samples(strip(1.8, 0.5))) << "half a desk";
  EXPECT_TRUE(is_felt_by_samples(strip(1.8, 0.03))) << "half of its front";
  EXPECT_TRUE(is_felt_by_samples(strip(0.05, 0.001)));
  EXPECT_FALSE(is_felt_by_samples(strip(0.5, 0.001)));
}

TEST(Patches, AreNoMoreThanHalfAMillionBesideTheTriangles) {
  EXPECT_TRUE(is_felt_by_samples(make_plane(2, 4)));
  EXPECT_FALSE(is_felt_by_samples(make_plane(10, 20))) << "800 triangles as large";
}

// A floor that the exact rung has, and a bumpy field in it that it has not.
TEST(Patches, AreFeltTogetherWithTrianglesThatAreLeftToTheExactRung) {
  const Scene scene =
      sampled_scene(default_hand(Side::right),
                    {{"floor", make_plane(10, 1)}, {"field", make_height_field(0.3, 40, 0.003, 0.05)}});
  FeelingHand samples(scene, 1e-4), exact(scene, 0);
  ASSERT_NE(samples.model().rest, nullptr);
  EXPECT_FALSE(felt_by_samples(samples.model(), kPalmSegment, 0));
  EXPECT_TRUE(felt_by_samples(samples.model(), kPalmSegment, 2));
  for (int i = 0; i < 40; ++i) {
    const DeviceFrame frame = pressed_frame(scene.hand, 0.0005 + 1e-4 * i, 0.2);
    const ActuatorFrame felt = samples(frame), right = exact(frame);
    const double size = force_size(right);
    ASSERT_GT(size, 0.1);
    EXPECT_LT(norm(total_force(felt) - total_force(right)), 1e-4 * size) << i;
  }
}

// A table that samples have, above a floor that they have not.
TEST(Patches, ShapesForTheExactRungAreMadeOnlyWhereItsTrianglesAreNear) {
  Mesh floor = make_plane(10, 1);
  move(floor, {0, 0, -0.7});
  const Scene scene =
      sampled_scene(default_hand(Side::right), {{"floor", floor}, {"table", make_plane(0.6, 1)}});
  const Model model = model_at(scene, 1e-4);
  ASSERT_NE(model.rest, nullptr);
  Scratch scratch = make_scratch(model);
  for (const double lower : {0.0, 0.7}) {
    DeviceFrame frame = pressed_frame(scene.hand, 0.002, 0.2);
    frame.base.position.z -= lower;
    State state;
    EXPECT_GT(force_size(tick(model, state, scratch, frame)), 0.1);
    EXPECT_EQ(scratch.primitives->count > 0, lower > 0);
    EXPECT_EQ(scratch.contact_count > 0, lower > 0);
  }
}

}  // namespace
}  // namespace lumbrical::test
