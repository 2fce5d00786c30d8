// How the polygons of mesh files become triangles.
#include <gtest/gtest.h>

#include <sstream>
#include <string>
#include <vector>

#include "mesh_samples.h"

namespace lumbrical {
namespace {

using Polygon = std::vector<std::size_t>;

// A prism over a U, 6 by 4 with a notch of 2 by 3, and 2 high: 88 of area, 36 of volume.
const std::vector<Vec3> kPrismCorners = {{0, 0, 0}, {6, 0, 0}, {6, 4, 0}, {4, 4, 0}, {4, 1, 0}, {2, 1, 0},
                                         {2, 4, 0}, {0, 4, 0}, {0, 0, 2}, {6, 0, 2}, {6, 4, 2}, {4, 4, 2},
                                         {4, 1, 2}, {2, 1, 2}, {2, 4, 2}, {0, 4, 2}};
const std::vector<Polygon> kPrismFaces = {{8, 9, 10, 11, 12, 13, 14, 15},
                                          {7, 6, 5, 4, 3, 2, 1, 0},
                                          {0, 1, 9, 8},
                                          {1, 2, 10, 9},
                                          {2, 3, 11, 10},
                                          {3, 4, 12, 11},
                                          {4, 5, 13, 12},
                                          {5, 6, 14, 13},
                                          {6, 7, 15, 14},
                                          {7, 0, 8, 15}};

std::string point_rows(const std::vector<Vec3>& points, const std::string& start) {
  std::ostringstream text;
  text.precision(17);
  for (const Vec3& p : points) text << start << p.x << " " << p.y << " " << p.z << "\n";
  return text.str();
}

std::string face_rows(const std::vector<Polygon>& faces, const std::string& start, std::size_t first) {
  std::string text;
  for (const Polygon& face : faces) {
    text += start.empty() ? std::to_string(face.size()) : start;
    for (const std::size_t corner : face) text += " " + std::to_string(corner + first);
    text += "\n";
  }
  return text;
}

std::string obj_of(const std::vector<Vec3>& points, const std::vector<Polygon>& faces) {
  return point_rows(points, "v ") + face_rows(faces, "f", 1);
}

// A face of all the points in their order.
Mesh cut_polygon(const std::vector<Vec3>& points) {
  Polygon corners;
  for (std::size_t i = 0; i < points.size(); ++i) corners.push_back(i);
  return parsed(obj_of(points, {corners}), "a.obj");
}

TEST(MeshPolygons, ConcaveOnesOfEveryFormatAreCutWithoutFolds) {
  const std::string points = point_rows(kPrismCorners, ""), faces = face_rows(kPrismFaces, "", 0);
  const std::string vertex = "element vertex 16\nproperty double x\nproperty double y\nproperty double z\n";
  const std::string face = "element face 10\nproperty list uchar int vertex_indices\n";
  const std::string ply = "ply\nformat ascii 1.0\n", end = "end_header\n";
  const struct {
    std::string name, text;
  } files[] = {
      {"a.obj", obj_of(kPrismCorners, kPrismFaces)},
      {"faces_first.obj", face_rows(kPrismFaces, "f", 1) + point_rows(kPrismCorners, "v ")},
      {"a.off", "OFF\n16 10 0\n" + points + faces},
      {"a.ply", ply + vertex + face + end + points + faces},
      {"faces_first.ply", ply + face + vertex + end + faces + points},
  };
  for (const auto& [name, text] : files) {
    SCOPED_TRACE(name);
    const MeshReport report = inspect_mesh(parsed(text, name));
    EXPECT_EQ(report.triangles, 28u);
    EXPECT_TRUE(report.watertight);
    EXPECT_NEAR(report.area, 88, 1e-12);
    EXPECT_NEAR(report.volume, 36, 1e-12);
  }
}

TEST(MeshPolygons, ThoseThatNoFanFoldsOverKeepTheirFan) {
  const std::vector<Triangle> fan = {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}};
  EXPECT_EQ(cut_polygon({{0, 0, 0}, {1, 0, 0}, {2, 1, 0}, {1, 2, 0}, {0, 1, 0}}).triangles, fan);
  EXPECT_EQ(cut_polygon({{0.1, 0.1, 0}, {2, -2, 0}, {2, 0, 0}, {2, 2, 0}, {-1, 1, 0}}).triangles, fan)
      << "concave at the first corner";
  EXPECT_EQ(cut_polygon({{0, 0, 0}, {1, 0, 0}, {2, 1e-9, 0}, {3, 0, 0}, {1, 1, 0}}).triangles, fan)
      << "concave by rounding";
  EXPECT_EQ(cut_polygon({{0, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 0, 0}}).triangles,
            (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}))
      << "crosses itself";
}

TEST(MeshPolygons, WhereverAConcaveOneBeginsAndLiesItHasItsArea) {
  const std::vector<Vec3> u(kPrismCorners.begin(), kPrismCorners.begin() + 8);
  const std::vector<Quat> turns = {{1, 0, 0, 0},
                                   {0, 1, 0, 0},
                                   {0.5, 0.5, 0.5, 0.5},
                                   {0.8, 0, 0, 0.6},
                                   {0.1, 0.3, -0.5, 0.806225774829855}};
  for (const Quat& turn : turns) {
    for (std::size_t start = 0; start < u.size(); ++start) {
      std::vector<Vec3> points;
      for (std::size_t i = 0; i < u.size(); ++i)
        points.push_back(rotate(turn, u[(start + i) % u.size()]) + Vec3{20, -3, 7});
      EXPECT_NEAR(inspect_mesh(cut_polygon(points)).area, 18, 1e-12) << start;
    }
  }
}

TEST(MeshPolygons, AHoleJoinedByACutStaysOpen) {
  const std::vector<Vec3> ring = {{0, 0, 0}, {1, 1, 0}, {1, 2, 0}, {2, 2, 0}, {2, 1, 0},
                                  {1, 1, 0}, {0, 0, 0}, {3, 0, 0}, {3, 3, 0}, {0, 3, 0}};
  const MeshReport report = inspect_mesh(cut_polygon(ring));
  EXPECT_EQ(report.triangles, 8u);
  EXPECT_NEAR(report.area, 8, 1e-12);
}

TEST(MeshPolygons, CornersInARowAndRepeatedOnesHinderNoCut) {
  const std::vector<Vec3> stairs = {{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}, {3, 1, 0}, {3, 1, 0},
                                    {2, 1, 0}, {2, 2, 0}, {2, 2, 0}, {2, 2, 0}, {2, 3, 0}, {1, 3, 0},
                                    {0, 3, 0}, {0, 2, 0}, {1, 2, 0}, {1, 1, 0}, {0, 1, 0}};
  for (std::size_t start = 0; start < stairs.size(); ++start) {
    std::vector<Vec3> points(stairs.begin() + static_cast<std::ptrdiff_t>(start), stairs.end());
    points.insert(points.end(), stairs.begin(), stairs.begin() + static_cast<std::ptrdiff_t>(start));
    EXPECT_NEAR(inspect_mesh(cut_polygon(points)).area, 6, 1e-12) << start;
  }
}

// Teeth that lie across all of each other, whichever way one looks for what is near.
std::vector<Vec3> comb(int teeth) {
  std::vector<Vec3> points;
  for (int i = 0; i < teeth; ++i) {
    points.push_back({0, i + 0.1, 0});
    points.push_back({1000.0 + i % 7, i + 0.5, 0});
    points.push_back({0, i + 0.9, 0});
  }
  points.push_back({-1, static_cast<double>(teeth), 0});
  points.push_back({-1, 0, 0});
  return points;
}

TEST(MeshPolygons, ThousandsOfConcaveCornersAreCutAndMoreThanATimeAllowsRefused) {
  const double tooth = 0.8 * 1003 / 2, gap = 0.2;
  EXPECT_NEAR(inspect_mesh(cut_polygon(comb(350))).area, 350 * (tooth + 1) - gap / 2, 1);
  Polygon corners;
  const std::vector<Vec3> points = comb(5000);
  for (std::size_t i = 0; i < points.size(); ++i) corners.push_back(i);
  expect_refusal(obj_of(points, {{0, 1, 2}, corners}), "a.obj",
                 "a.obj:" + std::to_string(points.size() + 2) + ":1: ", "export the mesh as triangles");
}

}  // namespace
}  // namespace lumbrical
