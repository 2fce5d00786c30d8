#include "scenes.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "lumbrical/shapes.h"
#include "random.h"

namespace lumbrical::bench {
namespace {

using test::Random;

// Uneven grid lines from 0 to exactly `size`.
std::vector<double> graded_lines(double size, double edge, Random& random) {
  std::vector<double> line{0};
  while (line.back() < size) line.push_back(line.back() + edge * std::exp(random.between(-0.6, 0.6)));
  const double scale = size / line.back();
  for (double& x : line) x *= scale;
  line.back() = size;
  return line;
}

// A line moved by up to 30 % of the narrower cell beside it; the first and the last stay.
double jittered(const std::vector<double>& line, std::size_t i, Random& random) {
  if (i == 0 || i + 1 == line.size()) return line[i];
  return line[i] + random.between(-0.3, 0.3) * std::min(line[i] - line[i - 1], line[i + 1] - line[i]);
}

void add_square(std::uint32_t a, std::uint32_t b, std::uint32_t c, std::uint32_t d, bool other, Mesh& mesh) {
  if (other) {
    mesh.triangles.push_back({a, b, d});
    mesh.triangles.push_back({b, c, d});
  } else {
    mesh.triangles.push_back({a, b, c});
    mesh.triangles.push_back({a, c, d});
  }
}

void append(const Mesh& part, Mesh& mesh) {
  const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), part.vertices.begin(), part.vertices.end());
  for (const Triangle& t : part.triangles)
    mesh.triangles.push_back({first + t[0], first + t[1], first + t[2]});
}

Mesh square(double extent) {
  const double half = 0.5 * extent;
  return {{{-half, -half, 0}, {half, -half, 0}, {half, half, 0}, {-half, half, 0}}, {{0, 1, 2}, {0, 2, 3}}};
}

Mesh strips(double extent, std::size_t count, Random& random) {
  const std::size_t strip_count = std::max<std::size_t>(1, count / 2);
  std::vector<double> line{0};
  for (std::size_t i = 0; i < strip_count; ++i) line.push_back(line.back() + random.between(0.1, 1));
  Mesh mesh;
  for (const double at : line) {
    const double y = extent * (at / line.back() - 0.5);
    mesh.vertices.push_back({-0.5 * extent, y, 0});
    mesh.vertices.push_back({0.5 * extent, y, 0});
  }
  for (std::uint32_t i = 0; i < strip_count; ++i) {
    add_square(2 * i, 2 * i + 1, 2 * i + 3, 2 * i + 2, random.bits() % 2 == 0, mesh);
  }
  return mesh;
}

// Splits a random triangle at a random inner point, until there are `count`.
Mesh shards(double extent, std::size_t count, Random& random) {
  Mesh mesh = square(extent);
  while (mesh.triangles.size() < count) {
    Triangle& triangle = mesh.triangles[random.below(mesh.triangles.size())];
    const auto [a, b, c] = triangle;
    const double u = random.between(0.1, 1), v = random.between(0.1, 1), w = random.between(0.1, 1);
    const auto inner = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back((u * mesh.vertices[a] + v * mesh.vertices[b] + w * mesh.vertices[c]) /
                            (u + v + w));
    triangle = {a, b, inner};
    mesh.triangles.push_back({b, c, inner});
    mesh.triangles.push_back({c, a, inner});
  }
  return mesh;
}

// Splits a random triangle from a point of its longest edge to the corner opposite, until there are `count`.
Mesh t_junctions(double extent, std::size_t count, Random& random) {
  Mesh mesh = square(extent);
  while (mesh.triangles.size() < count) {
    Triangle& triangle = mesh.triangles[random.below(mesh.triangles.size())];
    std::size_t longest = 0;
    double length = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double edge = norm(mesh.vertices[triangle[(i + 1) % 3]] - mesh.vertices[triangle[i]]);
      if (edge > length) {
        length = edge;
        longest = i;
      }
    }
    const std::uint32_t a = triangle[longest], b = triangle[(longest + 1) % 3],
                        c = triangle[(longest + 2) % 3];
    const double share = random.between(0.2, 0.8);
    const auto middle = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.push_back((1 - share) * mesh.vertices[a] + share * mesh.vertices[b]);
    triangle = {a, middle, c};
    mesh.triangles.push_back({middle, b, c});
  }
  return mesh;
}

// The half plane x > 0 of the given cells, falling by `angle`; turned by half a turn for the other side.
Mesh slope(double angle, double reach, double edge, bool left, std::uint64_t seed) {
  Mesh half = graded_rectangle(reach, 2 * reach, edge, seed);
  const double fall = std::sin(angle), run = std::cos(angle);
  for (Vec3& p : half.vertices) {
    p = {p.x * run, p.y - reach, -p.x * fall};
    if (left) p = {-p.x, -p.y, p.z};
  }
  return half;
}

}  // namespace

Mesh graded_rectangle(double size_x, double size_y, double edge, std::uint64_t seed) {
  Random random{seed};
  const std::vector<double> xs = graded_lines(size_x, edge, random), ys = graded_lines(size_y, edge, random);
  const auto row = static_cast<std::uint32_t>(xs.size());
  Mesh mesh;
  for (std::size_t j = 0; j < ys.size(); ++j) {
    for (std::size_t i = 0; i < xs.size(); ++i) {
      const double x = jittered(xs, i, random), y = jittered(ys, j, random);
      mesh.vertices.push_back({x, y, 0});
    }
  }
  for (std::uint32_t j = 0; j + 1 < ys.size(); ++j) {
    for (std::uint32_t i = 0; i + 1 < row; ++i) {
      const std::uint32_t a = j * row + i;
      add_square(a, a + 1, a + row + 1, a + row, random.bits() % 2 == 0, mesh);
    }
  }
  return mesh;
}

Mesh graded_plane(double size_x, double size_y, double edge, std::uint64_t seed) {
  Mesh mesh = graded_rectangle(size_x, size_y, edge, seed);
  for (Vec3& p : mesh.vertices) p -= Vec3{0.5 * size_x, 0.5 * size_y, 0};
  return mesh;
}

Mesh cut_plane(double extent, std::size_t count, Cut cut, std::uint64_t seed) {
  Random random{seed};
  const double cells = std::max(1.0, std::round(std::sqrt(0.5 * static_cast<double>(count))));
  switch (cut) {
    case Cut::whole:
      return {{{-extent, -extent, 0}, {3 * extent, -extent, 0}, {-extent, 3 * extent, 0}}, {{0, 1, 2}}};
    case Cut::grid:
      return make_plane(extent, static_cast<std::uint32_t>(cells));
    case Cut::graded:
      return graded_plane(extent, extent, extent / cells / 1.06, seed);  // 1.06: mean of e^(-0.6 .. 0.6)
    case Cut::slivers:
      return strips(extent, count, random);
    case Cut::shards:
      return shards(extent, count, random);
    case Cut::t_junctions:
      return t_junctions(extent, count, random);
  }
  return {};
}

Mesh bent_plane(double angle, double reach, double edge_left, double edge_right, std::uint64_t seed) {
  Mesh mesh = slope(0, reach, edge_left, true, seed);
  append(slope(angle, reach, edge_right, false, seed + 1), mesh);
  return mesh;
}

Mesh ridge(double angle, double reach, double edge_left, double edge_right, std::uint64_t seed) {
  Mesh mesh = slope(angle, reach, edge_left, true, seed);
  append(slope(angle, reach, edge_right, false, seed + 1), mesh);
  return mesh;
}

Mesh tetrahedron(double edge) {
  const double height = edge * std::sqrt(2.0 / 3), around = edge / std::sqrt(3.0);
  Mesh mesh;
  mesh.vertices.push_back({0, 0, 0});
  mesh.vertices.push_back({around, 0, -height});
  mesh.vertices.push_back({-0.5 * around, 0.5 * edge, -height});
  mesh.vertices.push_back({-0.5 * around, -0.5 * edge, -height});
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 1}, {1, 3, 2}};
  return mesh;
}

PosedFinger one_phalanx(double radius, double length) {
  return {{Vec3{0, 0, length}, Vec3{0, 0, 0}}, {radius, radius}};
}

PosedFinger bent_finger(double first, double second, double radius) {
  constexpr double kLength[3] = {0.040, 0.025, 0.020};
  const double angle[3] = {0, first, first + second};
  PosedFinger finger{{Vec3{}}, std::vector<double>(4, radius)};
  for (std::size_t i = 0; i < 3; ++i) {
    finger.joints.push_back(finger.joints.back() +
                            kLength[i] * Vec3{std::cos(angle[i]), 0, -std::sin(angle[i])});
  }
  return finger;
}

Quat leaning(double tilt, double heading) {
  const double lean = 0.5 * (0.5 * std::numbers::pi - tilt), turn = 0.5 * heading;
  return Quat{std::cos(turn), 0, 0, std::sin(turn)} * Quat{std::cos(lean), 0, std::sin(lean), 0};
}

Rig make_rig(const Mesh& mesh, const PosedFinger& finger, Law law) {
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  scene.hand.palm.polygon.clear();
  const std::size_t first = kIndexTip + std::size_t{1} - finger.joints.size();
  for (std::size_t i = 0; i < finger.joints.size(); ++i) scene.hand.radius[first + i] = finger.radius[i];
  scene.settings.law.fill(law);
  scene.settings.fade_time = 0;
  scene.settings.max_force = 1e6;
  // Needles as long as the scene are all candidates of every phalanx.
  scene.settings.max_candidates =
      static_cast<std::uint32_t>(std::clamp<std::size_t>(4 * mesh.triangles.size(), 1u << 12, 1u << 24));
  scene.objects.push_back({"mesh", mesh});
  Rig rig;
  if (Status status = build_model(scene, {}, rig.model); !status.ok())
    throw std::runtime_error(status.message());
  rig.scratch = make_scratch(rig.model);
  rig.scratch.hash_stages = false;
  rig.frame.valid = 0;
  set_joints(finger, rig);
  return rig;
}

void set_joints(const PosedFinger& finger, Rig& rig) {
  const std::size_t first = kIndexTip + std::size_t{1} - finger.joints.size();
  for (std::size_t i = 0; i < finger.joints.size(); ++i) {
    const Vec3 p = finger.joints[i];
    rig.frame.joint[first + i].position = {static_cast<float>(p.x), static_cast<float>(p.y),
                                           static_cast<float>(p.z)};
    rig.frame.valid |= 1u << (first + i);
  }
}

Felt feel(Rig& rig, const Pose& X_WF) {
  rig.frame.base = X_WF;
  State state;
  const ActuatorFrame& output = rig.output = tick(rig.model, state, rig.scratch, rig.frame);
  Felt felt;
  felt.contacts = output.contact_count;
  felt.flags = output.flags;
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    const Wrench& wrench = output.segment[i];
    const auto& p = rig.frame.joint[kPhalanxJoints[i].base].position;
    const Vec3 joint = rotate(normalized(X_WF.orientation), {p[0], p[1], p[2]});
    felt.force += wrench.force;
    felt.torque += wrench.torque + cross(joint, wrench.force);
  }
  std::vector<std::uint32_t> touched;
  for (std::size_t i = 0; i < output.contact_count; ++i) {
    felt.area += rig.scratch.contacts[i].area;
    touched.push_back(rig.scratch.contacts[i].triangle);
  }
  std::sort(touched.begin(), touched.end());
  felt.triangles = static_cast<std::uint32_t>(std::unique(touched.begin(), touched.end()) - touched.begin());
  return felt;
}

}  // namespace lumbrical::bench
