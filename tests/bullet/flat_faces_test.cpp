// Faces that are cut anew for Bullet: as few triangles, the same polygon; what is no convex polygon stays.
#include "bullet/flat_faces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "finely_cut.h"
#include "random.h"
#include "session.h"

namespace lumbrical {
namespace {

// Twice the areas, summed along their normals.
Vec3 area_of(const Mesh& mesh) {
  Vec3 sum;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += cross(mesh.vertices[b] - mesh.vertices[a], mesh.vertices[c] - mesh.vertices[a]);
  return sum;
}

Mesh with_whole_faces(const Mesh& mesh) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"mesh", mesh});
  const Model model = test::model_of(scene);
  std::vector<std::uint32_t> all(model.triangles.size());
  std::iota(all.begin(), all.end(), 0u);
  return with_whole_faces(model.triangles, all);
}

TEST(FlatFaces, AreCutAsCoarselyAsTheirCornersAllow) {
  Mesh disc;
  constexpr std::uint32_t kSides = 12, kRings = 6;
  for (std::uint32_t ring = 0; ring <= kRings; ++ring) {
    for (std::uint32_t k = 0; k < kSides; ++k) {
      const double angle = 2 * std::numbers::pi * k / kSides, r = 0.02 * ring;
      disc.vertices.push_back({r * std::cos(angle), r * std::sin(angle), 0});
      const std::uint32_t next = (k + 1) % kSides, own = ring * kSides;
      if (ring == kRings) continue;
      disc.triangles.push_back({own + k, own + kSides + k, own + kSides + next});
      if (ring > 0) disc.triangles.push_back({own + k, own + kSides + next, own + next});
    }
  }
  test::Random random(5);
  for (int i = 0; i < 20; ++i) {
    const Pose place{{random.between(-3, 3), random.between(-3, 3), random.between(-3, 3)},
                     random.rotation()};
    for (const auto& [mesh, count] :
         {std::pair{make_plane(0.3, 32), 2u}, std::pair{make_box({0.1, 0.2, 0.3}, 7), 12u},
          std::pair{test::finely_cut_tray(), 14u}, std::pair{disc, kSides - 2}}) {
      Mesh placed = mesh;
      place_mesh(place, placed);
      const Mesh whole = with_whole_faces(placed);
      EXPECT_EQ(whole.triangles.size(), count);
      EXPECT_LT(norm(area_of(whole) - area_of(placed)), 1e-6);
      if (i > 0) continue;
      for (const Triangle& t : whole.triangles) {
        const Vec3 a = whole.vertices[t[0]];
        EXPECT_GT(norm(cross(whole.vertices[t[1]] - a, whole.vertices[t[2]] - a)), 1e-5);
      }
    }
  }
}

TEST(FlatFaces, ThatAreNotConvexThatHaveAHoleAndWhatIsRoundStayAsTheyAre) {
  Mesh corner = make_plane(0.3, 8);  // one quarter is not there
  std::erase_if(corner.triangles, [&](const Triangle& t) {
    const Vec3 middle = (1.0 / 3) * (corner.vertices[t[0]] + corner.vertices[t[1]] + corner.vertices[t[2]]);
    return middle.x > 0 && middle.y > 0;
  });
  Mesh holed = make_plane(10, 20);  // all but closed
  for (Vec3& p : holed.vertices) {
    if (largest_of(p) < 0.6) p = 0.002 * p;
  }
  std::erase_if(holed.triangles, [&](const Triangle& t) {
    return std::all_of(t.begin(), t.end(),
                       [&](std::uint32_t i) { return largest_of(holed.vertices[i]) < 0.01; });
  });
  EXPECT_EQ(holed.triangles.size(), 800u - 8);
  EXPECT_EQ(with_whole_faces(holed).triangles.size(), holed.triangles.size());
  const Mesh ball = make_sphere(0.04, 12);
  EXPECT_EQ(with_whole_faces(corner).triangles.size(), corner.triangles.size());
  EXPECT_EQ(with_whole_faces(ball).triangles.size(), ball.triangles.size());
}

}  // namespace
}  // namespace lumbrical
