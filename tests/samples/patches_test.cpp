// Which triangles are cut into patches with their model, and into which.
#include <gtest/gtest.h>

#include "index/patch_cuts.h"
#include "index/patches.h"
#include "lumbrical/shapes.h"
#include "pressed_hand.h"
#include "sampled_hand.h"

namespace lumbrical::test {
namespace {

Mesh strip(double length, double width) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {length, 0, 0}, {0, width, 0}};
  mesh.triangles = {{0, 1, 2}};
  return mesh;
}

bool is_cut(const Mesh& mesh) {
  return model_at(sampled_scene(default_hand(Side::right), {{"mesh", mesh}}), 1e-4).patches->large.empty();
}

TEST(Patches, OfTrianglesUpToSomeMetresAndOfLongSliversAreCutWithTheModel) {
  EXPECT_TRUE(is_cut(make_plane(0.01, 1)));
  EXPECT_TRUE(is_cut(make_plane(0.8, 1))) << "half a table";
  EXPECT_FALSE(is_cut(make_plane(10, 1))) << "half a hall";
  EXPECT_TRUE(is_cut(strip(1.8, 0.5))) << "half a desk";
  EXPECT_TRUE(is_cut(strip(1.8, 0.03))) << "half of its front";
  EXPECT_TRUE(is_cut(strip(0.05, 0.001)));
  EXPECT_TRUE(is_cut(strip(0.5, 0.001)));
  EXPECT_TRUE(is_cut(strip(50, 0.0001)));
  EXPECT_FALSE(is_cut(strip(3000, 0.001))) << "a million patches";
}

// Of a model's patches: their number, longest edge, vector area and its first moment.
struct Cut {
  std::size_t count = 0;
  double longest = 0;
  Vec3 area, moment;
};
Cut cut_of(const Patches& patches) {
  Cut cut;
  for (std::size_t i = 0; i < patches.shape.size(); ++i) {
    if (patches.block[i / PatchBlock::kWidth].radius[i % PatchBlock::kWidth] < 0) continue;
    const PatchShape& shape = patches.shape[i];
    const Vec3 corner = point_of(shape.corner), e1 = vec3_of(shape.edge[0]), e2 = vec3_of(shape.edge[1]);
    const Vec3 area = 0.5 * cross(e1, e2);
    ++cut.count;
    cut.longest = std::max({cut.longest, norm(e1), norm(e2), norm(e2 - e1)});
    cut.area += area;
    cut.moment += norm(area) * (corner + (e1 + e2) / 3.0);
  }
  return cut;
}

TEST(Patches, OfATriangleAreTheWholeOfItAndFaceItsWay) {
  const Hand hand = default_hand(Side::right);
  Random random(77);
  for (int i = 0; i < 300; ++i) {
    const double size = std::exp(random.between(std::log(1e-3), std::log(1.0))),
                 width = size * std::exp(random.between(std::log(1e-4), 0.0));
    Mesh mesh;
    const Vec3 a = random.in_box(0.2), along = size * random.direction();
    const Vec3 side = cross(along, random.direction()), aside = width / norm(side) * side;
    mesh.vertices = {a, a + along, a + random.between(0, 1) * along + aside};
    const auto turn = static_cast<std::uint32_t>(i % 3);
    mesh.triangles = {{turn, (turn + 1) % 3, (turn + 2) % 3}};
    const Model model = model_at(sampled_scene(hand, {{"mesh", mesh}}), 1e-4);
    const Cut cut = cut_of(*model.patches);
    const Vec3 area = 0.5 * cross(along, aside);
    // Their edges are in single precision.
    const double off = 1e-6 * norm(area) + 1e-7 * size * std::min(size, 0.012);
    EXPECT_LT(norm(cut.area - area), off) << i;
    const Vec3 middle = (mesh.vertices[0] + mesh.vertices[1] + mesh.vertices[2]) / 3.0;
    EXPECT_LT(norm(cut.moment - norm(area) * middle), off * (size + 0.4)) << i;
    EXPECT_LT(cut.longest, 0.012) << i;
    // No more than length and area ask for, and about as many as expected.
    const auto count = static_cast<double>(cut.count);
    EXPECT_LT(count, 6 + size / 0.0012 + norm(area) / (0.0025 * 0.0025)) << i;
    const double share = count / expected_patches({mesh.vertices[0], mesh.vertices[1], mesh.vertices[2]},
                                                  model.patches->rules.step);
    EXPECT_GT(share, 0.5) << i;
    EXPECT_LT(share, 5) << i;
  }
}

void expect_its_precision(FeelingHand& samples, FeelingHand& exact) {
  for (int i = 0; i < 40; ++i) {
    const DeviceFrame frame = pressed_frame(exact.model().hand, 0.0005 + 1e-4 * i, 0.2);
    const ActuatorFrame felt = samples(frame), right = exact(frame);
    const double size = force_size(right);
    ASSERT_GT(size, 0.1);
    EXPECT_LT(norm(total_force(felt) - total_force(right)), 1e-4 * size) << i;
  }
}

// A plane of needles, each as long as the table: their exact contacts would take a millisecond.
TEST(Patches, OfNeedlesAreFeltToTheirPrecision) {
  constexpr int kNeedles = 100;
  Mesh mesh;
  for (int i = 0; i <= kNeedles; ++i)
    mesh.vertices.push_back({-0.15 + 0.3 * i / kNeedles, i % 2 == 0 ? -0.15 : 0.15, 0});
  mesh.vertices.push_back({0.15, 0.15, 0});
  mesh.vertices.push_back({-0.15, 0.15, 0});
  for (std::uint32_t i = 0; i + 2 <= kNeedles; ++i)
    mesh.triangles.push_back(i % 2 == 0 ? std::array{i, i + 2, i + 1} : std::array{i, i + 1, i + 2});
  const Scene scene = sampled_scene(default_hand(Side::right), {{"needles", mesh}});
  FeelingHand samples(scene, 1e-4), exact(scene, 0);
  EXPECT_TRUE(samples.model().patches->large.empty());
  expect_its_precision(samples, exact);
}

TEST(Patches, AreNoMoreThanHalfAMillionBesideTheTriangles) {
  EXPECT_TRUE(is_cut(make_plane(2, 4)));
  EXPECT_FALSE(is_cut(make_plane(10, 20))) << "800 triangles as large";
}

}  // namespace
}  // namespace lumbrical::test
