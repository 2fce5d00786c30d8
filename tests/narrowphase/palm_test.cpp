// The palm: a convex polygon with thickness against triangles, with values known by hand.
#include <gtest/gtest.h>

#include <cmath>

#include "box_prism.h"
#include "random.h"
#include "section/prism.h"
#include "session.h"

namespace lumbrical {
namespace {

struct Sum {
  double area = 0, volume = 0, depth = 0;
  Vec3 centroid, centre;
};

Sum press(const Mesh& plane, const Prism& prism, Law law, const Pose& X) {
  Sum sum;
  const Pose back = inverse(X);
  for (const Triangle& t : plane.triangles) {
    Contact contact;
    if (!collide_prism(prism, law, 1e-4, transform(X, plane.vertices[t[0]]),
                       transform(X, plane.vertices[t[1]]), transform(X, plane.vertices[t[2]]), contact)) {
      continue;
    }
    sum.area += contact.area;
    sum.volume += contact.volume;
    sum.depth = std::fmax(sum.depth, contact.depth);
    sum.centroid += contact.area * transform(back, contact.centroid);
    sum.centre += contact.volume * transform(back, contact.centre);
  }
  if (sum.area > 0) sum.centroid = sum.centroid / sum.area;
  if (sum.volume > 0) sum.centre = sum.centre / sum.volume;
  return sum;
}

TEST(Palm, FlatOnAPlaneFeelsItsAreaTimesItsDepth) {
  test::Random random(11);
  for (const std::uint32_t cells : {1u, 4u, 23u}) {
    const Mesh plane = make_plane(0.3, cells, 1);
    const Pose X = random.pose(0.4);
    const Prism prism = test::box_prism(0.04, 0.03, 0.002, 0.024, X);
    for (const Law law : {Law::field, Law::column, Law::max_depth, Law::centroid}) {
      const Sum sum = press(plane, prism, law, X);
      EXPECT_NEAR(sum.area / (0.08 * 0.06), 1, 1e-11) << law_name(law);
      EXPECT_NEAR(sum.volume / (0.08 * 0.06 * 0.002), 1, 1e-10) << law_name(law);
      EXPECT_NEAR(sum.depth / 0.002, 1, 1e-10);
      EXPECT_LT(norm(sum.centroid), 1e-12);
      EXPECT_LT(norm(sum.centre), 1e-11);
    }
  }
}

TEST(Palm, TiltedPalmFeelsAWedge) {
  // The plane z = 0 seen from a box that is turned about y by `tilt`: inside, between x = 0 and x = reach,
  // depth along -n grows from 0 to reach tan(tilt), and the field is depth cos(tilt).
  test::Random random(12);
  const double tilt = 0.1, b = 0.03;
  const Mesh plane = make_plane(0.3, 9, 1);
  for (int i = 0; i < 5; ++i) {
    const Pose X = random.pose(0.4);
    const Quat turn{std::cos(0.5 * tilt), 0, std::sin(0.5 * tilt), 0};
    const Prism prism = test::box_prism(0.04, b, 0, 0.024, X * Pose{{}, turn});
    const double reach = 0.04 / std::cos(tilt);  // to the side face, along the plane
    const double area = 2 * b * reach;
    const Sum column = press(plane, prism, Law::column, X), field = press(plane, prism, Law::field, X);
    EXPECT_NEAR(column.area / area, 1, 1e-10);
    EXPECT_NEAR(field.volume / (0.5 * area * reach * std::sin(tilt)), 1, 1e-10);
    EXPECT_NEAR(norm(field.centre) / (2.0 / 3 * reach), 1, 1e-9);
    // Columns leave through the palmar face up to x = reach cos^2, beyond that through the side face.
    EXPECT_NEAR(column.volume / (b * reach * reach * std::sin(tilt) * std::cos(tilt)), 1, 1e-10);
    EXPECT_NEAR(column.depth / (reach * std::sin(tilt) * std::cos(tilt)), 1, 1e-10);
  }
}

TEST(Palm, TriangleThatMissesEveryFaceCornerStillCounts) {
  const Prism prism = test::box_prism(0.04, 0.03, 0.002, 0.024, {});
  Contact contact;
  EXPECT_TRUE(collide_prism(prism, Law::field, 1e-4, {-9, -9, 0}, {9, -9, 0}, {0, 9, 0}, contact));
  EXPECT_NEAR(contact.area / (0.08 * 0.06), 1, 1e-12);
  EXPECT_FALSE(collide_prism(prism, Law::field, 1e-4, {1, 1, 0}, {2, 1, 0}, {1, 2, 0}, contact));
  EXPECT_FALSE(collide_prism(prism, Law::field, 1e-4, {0, 0, 0}, {0, 0, 0}, {1, 2, 0}, contact));
}

TEST(Palm, APolygonOfTheSceneReplacesTheDefault) {
  Scene scene = test::mug_scene(Law::field);
  scene.objects = {{"plane", make_plane(0.6, 30, 1)}};
  scene.settings.fade_time = 0;
  scene.settings.max_force = 1e5;
  scene.hand.palm_joint.orientation = {};
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  // Palm down over z = 0, the palmar face 2 mm below.
  const double height = scene.hand.palm.height - 0.002 -
                        rotate({std::sqrt(0.5), std::sqrt(0.5), 0, 0}, scene.hand.palm_joint.position).z;
  frame.base = {{0, 0, height}, {std::sqrt(0.5), std::sqrt(0.5), 0, 0}};
  const auto palm_force = [&] {
    const Model model = test::model_of(scene);
    State state;
    Scratch scratch = make_scratch(model);
    return tick(model, state, scratch, frame).segment[kPalmSegment].force;
  };
  const double x = 0.01, z = 0.02;
  scene.hand.palm.polygon = {{-x, 0, -z}, {x, 0, -z}, {x, 0, z}, {-x, 0, z}};
  EXPECT_LT(norm(palm_force() - Vec3{0, 0, 2e7 * 0.002 * 4 * x * z}), 1e-6);
  scene.hand.palm.polygon.clear();
  EXPECT_EQ(norm(palm_force()), 0);
}

}  // namespace
}  // namespace lumbrical
