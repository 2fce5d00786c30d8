// Clusters: their moments, how far a contact of a whole cluster may be off against triangle by triangle, and
// that they are the same with every broadphase, instruction set and number of threads.
#include "index/cluster_tree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "lumbrical/jacobian.h"
#include "model/corners.h"
#include "pressed_hand.h"
#include "random.h"
#include "session.h"
#include "stages/broadphase.h"
#include "stages/narrowphase.h"

namespace lumbrical::test {
namespace {

constexpr double kRadius = 0.008, kPatch = 0.04;  // [m]

// A square patch of cells x cells squares, the heights a function of x and y.
Mesh patch(std::uint32_t cells, const std::function<double(double, double)>& height) {
  Mesh mesh;
  for (std::uint32_t j = 0; j <= cells; ++j) {
    for (std::uint32_t i = 0; i <= cells; ++i) {
      const double x = kPatch * (i / double{1.0 * cells} - 0.5), y = kPatch * (j / double{1.0 * cells} - 0.5);
      mesh.vertices.push_back({x, y, height(x, y)});
    }
  }
  for (std::uint32_t j = 0; j < cells; ++j) {
    for (std::uint32_t i = 0; i < cells; ++i) {
      const std::uint32_t a = j * (cells + 1) + i, b = a + 1, c = a + cells + 1, d = c + 1;
      mesh.triangles.push_back({a, b, d});
      mesh.triangles.push_back({a, d, c});
    }
  }
  return mesh;
}

Mesh soup(Random& random, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 near{random.between(-0.5, 0.5) * kPatch, random.between(-0.5, 0.5) * kPatch,
                    random.between(-1e-3, 1e-3)};
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    for (int k = 0; k < 3; ++k) mesh.vertices.push_back(near + random.between(0, 1e-3) * random.direction());
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

constexpr int kSurfaceCount = 6;
Mesh surface(int kind, Random& random) {
  const auto bumpy = [](double x, double y) { return 5e-4 * std::sin(400 * x) * std::cos(300 * y); };
  switch (kind) {
    case 0:
      return patch(80, bumpy);
    case 1:  // creases
      return patch(80, [](double x, double) { return std::fabs(std::remainder(x, 0.007)); });
    case 2: {  // both sides of a sheet without thickness
      Mesh mesh = patch(60, bumpy);
      for (std::size_t i = 0, count = mesh.triangles.size(); i < count; ++i) {
        const Triangle t = mesh.triangles[i];
        mesh.triangles.push_back({t[0], t[2], t[1]});
      }
      return mesh;
    }
    case 3: {  // needles
      Mesh mesh = patch(80, bumpy);
      for (Vec3& p : mesh.vertices) p.y = 0.02 * p.y + 0.3 * p.x;
      return mesh;
    }
    case 4:
      return soup(random, 20000);
    default:  // flat, steps between
      return patch(90, [](double x, double y) { return 5e-4 * (std::fabs(x) < 0.004 ? 1 : 0) + 0 * y; });
  }
}

// A sphere, capsule or cone pressed into the patch, cut by a plane every other time.
Primitive pressed_primitive(Random& random, int shape) {
  Primitive p;
  p.law = Law::field;
  p.segment = 1;  // a phalanx that nothing is folded upon
  p.radius1 = kRadius;
  p.radius2 = shape == 2 ? random.between(0.7, 1) * kRadius : kRadius;
  const double length = shape == 0 ? 0 : random.between(0.5, 3) * kRadius, heading = random.between(0, 6);
  const double low = random.between(0.5, 0.9) * kRadius;
  const Vec3 axis{std::cos(heading), std::sin(heading), random.between(-0.1, 0.3)};
  p.end1 = Vec3{0, 0, low} - 0.4 * length * axis;
  p.end2 = p.end1 + length * axis;
  if (random.between(0, 1) < 0.5) {
    p.cut_count = 1;
    p.cut[0] = {unit_or(axis + 0.3 * random.direction(), {1, 0, 0}), {0.002, 0, 0}};
  }
  return p;
}

struct Place {
  Pose pose;
  double scale = 1;
  [[nodiscard]] Vec3 point(Vec3 p) const { return transform(pose, scale * p); }
};

Primitive moved(Primitive p, const Place& place) {
  p.end1 = place.point(p.end1);
  p.end2 = place.point(p.end2);
  p.radius1 *= place.scale;
  p.radius2 *= place.scale;
  for (HalfSpace& cut : p.cut) cut = {rotate(place.pose.orientation, cut.normal), place.point(cut.point)};
  return p;
}

Model model_at(Mesh mesh, const Place& place, double tolerance, const Execution& execution = {}) {
  for (Vec3& p : mesh.vertices) p = place.point(p);
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  scene.settings.tolerance = tolerance;
  scene.settings.max_candidates = 1u << 16;
  scene.objects.push_back({"patch", std::move(mesh)});
  return model_of(scene, execution);
}

// What one primitive feels, over K_s, with bounds of its error.
struct Felt {
  Vec3 force, torque;
  double force_bound = 0, torque_bound = 0, area = 0;
  int contacts = 0, clusters = 0;
};

Felt feel(const Model& model, const Primitive& primitive, Vec3 about) {
  Primitives hand;
  hand.count = 1;
  hand.primitive[0] = primitive;
  Scratch scratch = make_scratch(model);
  EXPECT_TRUE(find_candidates(model, hand, scratch));
  const std::uint32_t count =
      find_contacts(model, hand, {scratch.candidates.data(), scratch.candidate_count}, scratch.contacts);
  Felt felt;
  const double size = max(primitive.radius1, primitive.radius2);
  for (std::uint32_t i = 0; i < count; ++i) {
    const Contact& contact = scratch.contacts[i];
    const Vec3 force = contact.volume * contact.normal, lever = contact.centre - about;
    EXPECT_NEAR(norm(contact.normal), 1, 1e-6);
    felt.force += force;
    felt.torque += cross(lever, force);
    felt.force_bound += contact.error;
    felt.torque_bound += contact.error * (norm(lever) + 4 * size);
    felt.area += contact.area;
    ++felt.contacts;
    felt.clusters += (contact.triangle & kClusterBit) != 0 ? 1 : 0;
  }
  return felt;
}

TEST(Clusters, AreBuiltOnlyWhereThePrecisionAsksForThem) {
  Scene scene = pressed_scene(0.1, 40);
  EXPECT_EQ(byte_count(model_of(scene).clusters), 0u);
  scene.settings.tolerance = 1e-3;
  const double bytes = static_cast<double>(byte_count(model_of(scene).clusters));
  EXPECT_GT(bytes, 0);
  EXPECT_LT(bytes / (2 * 40 * 40), 76);
  scene.settings.law.fill(Law::column);
  EXPECT_EQ(byte_count(model_of(scene).clusters), 0u);
}

TEST(Clusters, HaveTheMomentsOfTheirTriangles) {
  Random random(3);
  for (int kind = 0; kind < kSurfaceCount; ++kind) {
    const Model model = model_at(surface(kind, random), {random.pose(1), 1}, 1e-3);
    const ClusterTree& tree = model.clusters;
    std::uint32_t seen = 0;
    for (std::size_t level = 0; level + 1 < tree.level.size(); ++level) {
      for (std::uint32_t c = tree.level[level]; c < tree.level[level + 1]; ++c) {
        const ClusterBlock& block = tree.block[c / 4];
        const double radius = block.r[c % 4];
        if (radius < 0) continue;
        const Vec3 centre = tree.origin + Vec3{block.x[c % 4], block.y[c % 4], block.z[c % 4]},
                   mean{block.nx[c % 4], block.ny[c % 4], block.nz[c % 4]};
        double area = 0;
        Vec3 normal, first_z, second_xy;
        for (const std::uint32_t t : triangles_of(tree, c)) {
          const Corners at = corners_of(model.triangles, t);
          const Vec3 p[] = {at.a - centre, at.b - centre, at.c - centre};
          const Vec3 n = 0.5 * cross(p[1] - p[0], p[2] - p[0]);
          area += norm(n);
          normal += n;
          // Midpoints of the edges integrate a square exactly.
          for (int i = 0; i < 3; ++i) {
            const Vec3 m = 0.5 * (p[i] + p[(i + 1) % 3]);
            first_z += (m.z / 3) * n;
            second_xy += (m.x * m.y / 3) * n;
            EXPECT_LE(norm(p[i]), radius * (1 + 1e-6) + 1e-9);
            EXPECT_LE(std::fabs(dot(p[i], mean)), block.thickness[c % 4] * (1 + 1e-5) + 1e-9);
            EXPECT_LE(std::fabs(p[i].x), block.bx[c % 4] * (1 + 1e-6) + 1e-9);
            EXPECT_LE(std::fabs(p[i].y), block.by[c % 4] * (1 + 1e-6) + 1e-9);
            EXPECT_LE(std::fabs(p[i].z), block.bz[c % 4] * (1 + 1e-6) + 1e-9);
            EXPECT_LE(norm(p[(i + 1) % 3] - p[i]), block.edge[c % 4] * (1 + 1e-6) + 1e-9);
          }
          if (level == 0) ++seen;
        }
        const ClusterMoments& m = tree.moments[c];
        const double slack = 1e-5 * area;
        EXPECT_NEAR(m.area, area, slack);
        EXPECT_NEAR(m.normal[1], normal.y, slack);
        EXPECT_NEAR(m.first[2][0], first_z.x, slack * radius + 1e-16);
        EXPECT_NEAR(m.second[1][2], second_xy.z, slack * radius * radius + 1e-20);
      }
    }
    EXPECT_EQ(seen, model.triangles.size());
  }
}

TEST(Clusters, StayWithinTheBoundsTheyStateOnAnySurfaceInAnyPlace) {
  Random random(5);
  int clusters = 0;
  double used = 0;
  for (int kind = 0; kind < kSurfaceCount; ++kind) {
    for (const double scale : {1.0, 1e-3, 1e3}) {
      const Mesh mesh = surface(kind, random);
      const Place place{{scale * random.in_box(0.5), random.rotation()}, scale};
      const Model exact = model_at(mesh, place, 0);
      for (const double tolerance : {1e-4, 1e-2, 0.1}) {
        const Model coarse = model_at(mesh, place, tolerance);
        for (int shape = 0; shape < 3; ++shape) {
          const Primitive primitive = moved(pressed_primitive(random, shape), place);
          const Vec3 about = place.point(random.in_box(0.05));
          const Felt wanted = feel(exact, primitive, about), got = feel(coarse, primitive, about);
          const double force = norm(got.force - wanted.force), torque = norm(got.torque - wanted.torque);
          const double force_bound = got.force_bound + wanted.force_bound,
                       torque_bound = got.torque_bound + wanted.torque_bound;
          EXPECT_LE(force, force_bound) << "surface " << kind << " scale " << scale << " at " << tolerance;
          EXPECT_LE(torque, torque_bound) << "surface " << kind << " scale " << scale << " at " << tolerance;
          EXPECT_NEAR(got.area, wanted.area, 0.1 * wanted.area);
          clusters += got.clusters;
          used = std::max(used, force / force_bound);
        }
      }
    }
  }
  EXPECT_GT(clusters, 5000);
  EXPECT_GT(used, 1e-3);  // the bounds say something
}

TEST(Clusters, AreOffByLessWhereThePrecisionAsksForMore) {
  Random random(7);
  const Mesh mesh = surface(0, random);
  const Model exact = model_at(mesh, {}, 0);
  const Primitive primitive = pressed_primitive(random, 1);
  const Felt wanted = feel(exact, primitive, {});
  double last_bound = 1;
  int last_contacts = 0;
  for (const double tolerance : {1e-1, 1e-2, 1e-3, 1e-4}) {
    const Felt got = feel(model_at(mesh, {}, tolerance), primitive, {});
    const double error = norm(got.force - wanted.force) / norm(wanted.force);
    const double bound = got.force_bound / norm(wanted.force);
    EXPECT_LE(error, 0.2 * tolerance);
    EXPECT_LT(bound, last_bound);
    EXPECT_GT(got.contacts, last_contacts);
    last_bound = bound;
    last_contacts = got.contacts;
  }
  EXPECT_LE(last_contacts, wanted.contacts);
}

// A hand pressed into a dense field: fingers with shared borders, and the palm.
Scene dense_scene(double tolerance) {
  Scene scene = pressed_scene(kWidthA, 150);
  scene.settings.tolerance = tolerance;
  scene.settings.max_force = 1e6;
  scene.settings.fade_time = 0;
  return scene;
}

TEST(Clusters, LeaveTheForcesOfAHandWithinWhatTheTickStates) {
  const Scene scene = dense_scene(3e-2);
  const Model exact = model_of(dense_scene(0)), coarse = model_of(scene);
  Scratch exact_scratch = make_scratch(exact), coarse_scratch = make_scratch(coarse);
  State exact_state, coarse_state;
  for (const double depth : {0.001, 0.003}) {
    const DeviceFrame frame = pressed_frame(scene.hand, depth, depth * 100);
    const ActuatorFrame wanted = tick(exact, exact_state, exact_scratch, frame);
    const ActuatorFrame got = tick(coarse, coarse_state, coarse_scratch, frame);
    EXPECT_LT(got.contact_count, wanted.contact_count);
    double off = 0, all = 0;
    for (std::size_t i = 0; i < kSegmentCount; ++i) {
      off += norm(got.segment[i].force - wanted.segment[i].force);
      all += norm(wanted.segment[i].force);
    }
    EXPECT_LE(off, got.force_error + wanted.force_error);
    EXPECT_LE(off, 2e-3 * all);
  }
}

TEST(Clusters, AreTheSameWithEveryBroadphaseInstructionSetAndNumberOfThreads) {
  const Scene scene = dense_scene(1e-2);
  const std::vector<DeviceFrame> frames{pressed_frame(scene.hand, 0.002, 0.2),
                                        pressed_frame(scene.hand, 0.003, 0.7)};
  std::uint32_t contacts = 0;
  const std::uint64_t expected = hash_run(model_of(scene), frames, &contacts);
  EXPECT_GT(contacts, 1000u);
  const auto hash_of = [&](auto change) {
    Execution execution;
    change(execution);
    return hash_run(model_of(scene, execution), frames);
  };
  for (const Broadphase broadphase : {Broadphase::grid, Broadphase::voxel, Broadphase::brute}) {
    if (!available(broadphase)) continue;
    EXPECT_EQ(hash_of([&](Execution& e) { e.broadphase = broadphase; }), expected)
        << broadphase_name(broadphase);
  }
  for (const Isa isa : {Isa::scalar, Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon}) {
    if (!available(isa)) continue;
    EXPECT_EQ(hash_of([&](Execution& e) { e.isa = isa; }), expected) << isa_name(isa);
  }
  EXPECT_EQ(hash_of([&](Execution& e) { e.threads = 4; }), expected);
  EXPECT_EQ(hash_of([&](Execution& e) { e.leaf_size = 5; }), expected);
}

TEST(Clusters, HaveTheSlopeOfTheirTriangles) {
  const Scene scene = dense_scene(1e-2);
  const Model exact = model_of(dense_scene(0)), coarse = model_of(scene);
  Scratch exact_scratch = make_scratch(exact), coarse_scratch = make_scratch(coarse);
  State exact_state, coarse_state;
  const DeviceFrame frame = pressed_frame(scene.hand, 0.002, 0);
  tick(exact, exact_state, exact_scratch, frame);
  tick(coarse, coarse_state, coarse_scratch, frame);
  std::array<SegmentJacobian, kSegmentCount> wanted, got;
  segment_jacobians(exact, exact_scratch, wanted, 1u << 6 | 1u << kPalmSegment);
  segment_jacobians(coarse, coarse_scratch, got, 1u << 6 | 1u << kPalmSegment);
  for (const std::size_t segment : {std::size_t{6}, static_cast<std::size_t>(kPalmSegment)}) {
    double largest = 0, off = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      for (std::size_t k = 0; k < 3; ++k) {
        largest = std::max(largest, std::fabs(wanted[segment].value[i][k]));
        off = std::max(off, std::fabs(wanted[segment].value[i][k] - got[segment].value[i][k]));
      }
    }
    EXPECT_GT(largest, 0);
    EXPECT_LE(off, 1e-3 * largest) << "segment " << segment;
  }
}

}  // namespace
}  // namespace lumbrical::test
