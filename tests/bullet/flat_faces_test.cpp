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

// Rings about the middle of a convex polygon in z = 0, cut finely.
Mesh rings_in(const std::vector<Vec3>& corners, std::uint32_t rings) {
  Mesh mesh;
  const auto sides = static_cast<std::uint32_t>(corners.size());
  for (std::uint32_t ring = 0; ring <= rings; ++ring) {
    for (std::uint32_t k = 0; k < sides; ++k) {
      mesh.vertices.push_back((static_cast<double>(ring) / rings) * corners[k]);
      const std::uint32_t next = (k + 1) % sides, own = ring * sides;
      if (ring == rings) continue;
      mesh.triangles.push_back({own + k, own + sides + k, own + sides + next});
      if (ring > 0) mesh.triangles.push_back({own + k, own + sides + next, own + next});
    }
  }
  return mesh;
}

std::vector<Vec3> circle(double radius, std::uint32_t sides) {
  std::vector<Vec3> corners;
  for (std::uint32_t k = 0; k < sides; ++k) {
    const double angle = 2 * std::numbers::pi * k / sides;
    corners.push_back({radius * std::cos(angle), radius * std::sin(angle), 0});
  }
  return corners;
}

// A square plate with corners rounded by sixteen short sides each, its straight sides cut every 10 mm.
std::vector<Vec3> rounded_plate() {
  std::vector<Vec3> corners;
  for (std::uint32_t k = 0; k < 4; ++k) {
    const double turn = 0.5 * std::numbers::pi * k;
    const auto put = [&](double x, double y) {
      corners.push_back(
          {std::cos(turn) * x - std::sin(turn) * y, std::sin(turn) * x + std::cos(turn) * y, 0});
    };
    for (int i = -49; i < 50; ++i) put(0.5, 0.01 * i);
    for (int i = 0; i <= 16; ++i) {
      const double angle = std::numbers::pi * i / 32;
      put(0.49 + 0.01 * std::cos(angle), 0.49 + 0.01 * std::sin(angle));
    }
  }
  return corners;
}

TEST(FlatFaces, AreCutAsCoarselyAsTheirCornersAllow) {
  test::Random random(5);
  for (int i = 0; i < 4; ++i) {
    const Pose place{{random.between(-3, 3), random.between(-3, 3), random.between(-3, 3)},
                     random.rotation()};
    for (const auto& [mesh, count] :
         {std::pair{make_plane(0.3, 32), 2u}, std::pair{make_box({0.1, 0.2, 0.3}, 7), 12u},
          std::pair{test::finely_cut_tray(), 14u}, std::pair{rings_in(circle(0.12, 12), 6), 10u},
          std::pair{rings_in(circle(0.05, 400), 2), 398u},
          std::pair{rings_in(rounded_plate(), 2), 4 * 17 - 2u}}) {
      Mesh placed = mesh;
      if (i > 0) place_mesh(place, placed);
      const Mesh whole = with_whole_faces(placed);
      EXPECT_EQ(whole.triangles.size(), count);
      EXPECT_LT(norm(area_of(whole) - area_of(placed)), 2e-6);
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
  Mesh notched = make_plane(20, 20);  // 10 mm into its rim
  for (Vec3& p : notched.vertices)
    if (p.x > 9.9 && std::fabs(p.y) < 0.5) p = {9.99, p.y, 0};
  EXPECT_EQ(with_whole_faces(notched).triangles.size(), notched.triangles.size());
  const Mesh ball = make_sphere(0.04, 12);
  EXPECT_EQ(with_whole_faces(corner).triangles.size(), corner.triangles.size());
  EXPECT_EQ(with_whole_faces(ball).triangles.size(), ball.triangles.size());
}

}  // namespace
}  // namespace lumbrical
