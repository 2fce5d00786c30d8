// See golden_sessions.h.
#include "golden_sessions.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <string_view>
#include <utility>

#include "borders/pair_contact.h"
#include "fists.h"
#include "golden_hashes.h"
#include "lumbrical/jacobian.h"
#include "pressed_hand.h"
#include "random.h"

namespace lumbrical::test {
namespace {

GoldenSession grasp(const std::string& name, Law law, std::size_t count) {
  GoldenSession session{name, mug_scene(law), {}};
  session.frames = grasp_frames(session.scene.hand, count);
  return session;
}

/// A flat hand that comes down on the scene and wanders over it, so that ticks differ.
GoldenSession press(const std::string& name, Scene scene, double depth, std::size_t count) {
  GoldenSession session{name, std::move(scene), {}};
  const DeviceFrame pressed = pressed_frame(session.scene.hand, depth, 0);
  for (std::size_t i = 0; i < count; ++i) {
    const double share = static_cast<double>(i) / static_cast<double>(count);
    DeviceFrame frame = pressed;
    frame.base.position = pressed.base.position + Vec3{0.007 * share, -0.011 * share, 0.002 * (1 - share)};
    session.frames.push_back(frame);
  }
  return session;
}

GoldenSession crowd() { return press("crowd", pressed_scene(0.3, 130), 0.006, 6); }

/// Two sides of a sheet 0.1 mm thick, through which fingers pass.
GoldenSession thin_sheets(Law law) {
  Scene scene = pressed_scene(0.3, 1);
  scene.settings.law.fill(law);
  const Mesh upper = make_plane(0.3, 50, 0.7, 3);
  Mesh lower = upper;
  for (Vec3& vertex : lower.vertices) vertex.z -= 1e-4;
  for (auto& triangle : lower.triangles) std::swap(triangle[1], triangle[2]);
  scene.objects = {{"upper", upper}, {"lower", lower}};
  return press("thin." + std::string(law_name(law)), scene, 0.003, 8);
}

/// The same from 6 cm above, by 1 cm a tick, turned to the little finger and drawn over an edge: a proxy
/// holds the hand on top, by a joint too.
GoldenSession proxy() {
  GoldenSession session = thin_sheets(Law::field);
  session.name = "proxy";
  session.scene.settings.proxy_stiffness = 3000;
  for (std::size_t i = 0; i < session.frames.size(); ++i) {
    Pose& base = session.frames[i].base;
    base.position = base.position + Vec3{0, 0.11, 0.06 - 0.01 * static_cast<double>(i)};
    base.orientation = normalized(Quat{0.97, 0, 0.24, 0}) * base.orientation;
  }
  return session;
}

std::array<float, 3> narrowed(Vec3 v) {
  return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
}

/// The same hand told by the poses of its joints.
DeviceFrame as_joint_poses(const Hand& hand, const DeviceFrame& frame) {
  std::array<double, kAngleCount> angles;
  std::copy(frame.angle.begin(), frame.angle.end(), angles.begin());
  std::array<Pose, kJointCount> poses;
  forward_kinematics(hand, Pose{}, angles, poses);
  DeviceFrame result;
  result.base = frame.base;
  for (std::size_t j = 0; j < kJointCount; ++j) {
    const auto& [p, q] = poses[j];
    result.joint[j] = {
        narrowed(p),
        {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z), static_cast<float>(q.w)}};
  }
  return result;
}

/// Tracking comes and goes, as a whole and joint by joint.
GoldenSession lost_tracking() {
  GoldenSession session = grasp("lost", Law::field, 90);
  for (std::size_t i = 0; i < session.frames.size(); ++i) {
    DeviceFrame& frame = session.frames[i];
    if (i % 2 == 0) frame = as_joint_poses(session.scene.hand, frame);
    if (i % 30 >= 18 && i % 30 < 23) frame.flags |= kTrackingLost;
    if (i % 7 == 0) frame.flags |= kExtrapolated;
    if (i % 5 == 0) frame.valid &= ~(1u << (i % kJointCount));
  }
  return session;
}

GoldenSession not_finite() {
  GoldenSession session = grasp("not_finite", Law::field, 90);
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < session.frames.size(); ++i) {
    DeviceFrame& frame = session.frames[i];
    switch (i % 30) {
      case 14:
        frame.angle[i % kAngleCount] = kNan;
        break;
      case 15:
        frame.base.position.y = -kInfinity;
        break;
      case 16:
        frame.base.orientation = {-0.0, 0.0, -0.0, 0.0};
        break;
      case 17:
        frame.base.position.z = std::numeric_limits<double>::denorm_min();
        break;
      case 18:
        frame.angle[3] = -0.0f;
        break;
      case 19:
        frame.base.orientation.x = std::numeric_limits<double>::quiet_NaN();
        break;
      default:
        break;
    }
  }
  return session;
}

GoldenSession overflow() {
  GoldenSession session = grasp("overflow", Law::field, 80);
  session.scene.settings.max_candidates = 250;  // of the exact rung
  session.scene.settings.precision.fill(0);
  return session;
}

/// Triangles larger than phalanges, under capsules.
GoldenSession large_triangles() {
  Scene scene = pressed_scene(0.3, 1);
  scene.hand.radius.fill(0.008);
  scene.objects = {{"plane", make_plane(0.4, 16, 0.8, 5)}};
  return press("large", scene, 0.004, 20);
}

/// So large that samples cut them where they are touched, and a needle and another mesh among them.
GoldenSession hall() {
  Scene scene = pressed_scene(0.1, 20);
  Mesh needle;
  needle.vertices = {{-20, 0.01, 0.001}, {30, 0.012, 0.001}, {10, 0.03, 0.002}};
  needle.triangles = {{0, 1, 2}};
  scene.objects.push_back({"floor", make_plane(40, 3, 0.8, 5)});
  scene.objects.push_back({"needle", needle});
  return press("hall", scene, 0.004, 12);
}

/// Where tiles border on one another, on the rung of `precision`: the mug grasped, then fingers of uneven
/// radii, `plump` times as thick, bent at random, some folded.
GoldenSession bent(const std::string& name, double precision, double plump) {
  GoldenSession session = grasp(name, Law::field, 60);
  Scene& scene = session.scene;
  scene.settings.precision.fill(precision);
  Random random(23);
  for (double& radius : scene.hand.radius) radius *= plump * random.between(0.8, 1.2);
  scene.objects.push_back({"field", make_height_field(0.3, 60, 0.002, 0.04)});
  const DeviceFrame pressed = pressed_frame(scene.hand, 0.004, 0);
  for (int i = 0; i < 12; ++i) {
    DeviceFrame& frame = session.frames.emplace_back(pressed);
    for (std::size_t finger = 1; finger < kFingerCount; ++finger) {
      for (std::size_t k = 1; k <= 3; ++k)
        frame.angle[4 * finger + k] = static_cast<float>(random.between(-0.2, 1.9));
    }
    frame.base.position.z += random.between(-0.01, 0.06);
    frame.base.orientation = random.rotation();
  }
  return session;
}

/// Fists about a ball of triangles so fine that parts take blocks as ones.
GoldenSession fists() {
  GoldenSession session{"fists", pressed_scene(0.1, 1), {}};
  session.scene.hand = loosened(session.scene.hand);
  session.scene.settings.precision.fill(1e-4);
  session.scene.objects = {{"ball", make_sphere(0.02, 60)}};
  Random random(7);
  for (int i = 0; i < 40; ++i) session.frames.push_back(fist_frame(session.scene.hand, random, 0.02));
  return session;
}

GoldenSession far_away() {
  GoldenSession session = grasp("far", Law::field, 40);
  const Vec3 away{1234.5, -987.25, 33.125};
  for (SceneObject& object : session.scene.objects) {
    for (Vec3& vertex : object.mesh.vertices) vertex = vertex + away;
  }
  for (DeviceFrame& frame : session.frames) frame.base.position = frame.base.position + away;
  return session;
}

/// Samples of every precision: the mug grasped, so that fingers bend and fold, told by angles and by poses
/// with joints that are lost, then a flat hand on a mesh fine enough for blocks.
GoldenSession sampled(const std::string& name, double precision) {
  GoldenSession session = grasp(name, Law::field, 40);
  session.scene.settings.precision.fill(precision);
  session.scene.objects.push_back({"plane", make_plane(0.3, 130, 0.8, 11)});
  const DeviceFrame pressed = pressed_frame(session.scene.hand, 0.004, 0);
  for (std::size_t i = 0; i < 12; ++i) {
    DeviceFrame frame = pressed;
    frame.base.position.y -= 0.003 * static_cast<double>(i);
    if (i % 2 != 0) frame = as_joint_poses(session.scene.hand, frame);
    if (i % 4 == 3) frame.valid &= ~(1u << (kThumbProximal + i));
    session.frames.push_back(frame);
  }
  return session;
}

/// What several fingers, or fingers and palm, hold together, felt otherwise than by default.
GoldenSession held_together(const std::string& name, double precision, FeltOnce felt_once) {
  GoldenSession session = sampled(name, precision);
  session.scene.settings.felt_once = felt_once;
  return session;
}

GoldenSession mixed_laws() {
  GoldenSession session = grasp("mixed", Law::field, 50);
  for (std::size_t s = 0; s < kSegmentCount; ++s) session.scene.settings.law[s] = static_cast<Law>(s % 5);
  return session;
}

/// Sphere, capsule or rounded cone.
Primitive random_primitive(Random& random, std::uint64_t shape) {
  constexpr double kRadius = 0.008;
  Primitive primitive;
  primitive.law = Law::field;
  primitive.radius1 = kRadius;
  primitive.radius2 = shape == 2 ? random.between(0.7, 1.0) * kRadius : kRadius;
  primitive.end1 = random.in_box(0.1);
  // One number per statement: compilers are free in the order of operands.
  const double length = shape == 0 ? 0.0 : random.between(0.5, 4) * kRadius;
  const Vec3 axis = random.direction();
  primitive.end2 = primitive.end1 + length * axis;
  return primitive;
}

/// Pads with both layers and damping: on the world, and on a box that gives way.
GoldenSession pads() {
  GoldenSession session = press("pads", pressed_scene(0.3, 60), 0.004, 8);
  Settings& settings = session.scene.settings;
  settings.pad = {{{{0.2, 3}, {0.5, -2}}}, 5};
  settings.precision.fill(1e-4);
  settings.precision[2] = settings.precision[kPalmSegment] = 0;
  SceneObject block{
      "block", make_box({0.04, 0.04, 0.02}, 4), Winding::as_is, {{0, 0, 0.006}, {}}, {0.8, 0.5, 0.2, 1500},
      {}};
  block.mechanism.mobility = Mobility::free;
  block.mechanism.body = {0.1, {}, {2e-5, 2e-5, 3e-5, 0, 0, 0}};
  session.scene.objects.push_back(block);
  return session;
}

SceneObject body(const char* name, Mesh mesh, Mobility mobility, Vec3 position) {
  SceneObject object{name, std::move(mesh), Winding::as_is, {position, {}}, {0.8, 0.5, 0.2, 1500}, {}};
  object.mechanism.mobility = mobility;
  object.mechanism.body = {0.2, {0.002, 0, 0.04}, {3e-4, 3e-4, 2e-4, 1e-6, 0, 0}};
  object.mechanism.pivot = position;
  return object;
}

/// Every kind of object apart: the mug is grasped, lifted, tilted and put down again beside others on joints
/// and one that rubs only, on the ground.
GoldenSession objects() {
  GoldenSession session{"objects", mug_scene(Law::field), {}};
  Scene& scene = session.scene;
  scene.settings.precision.fill(1e-4);
  scene.settings.precision[2] = 0;
  scene.settings.rate = 250;
  scene.ground.emplace();
  scene.objects = {body("mug", make_mug({}), Mobility::free, {0, 0, 0}),
                   body("mat", make_plane(0.3, 20, 0.5, 3), Mobility::fixed, {0, 0, 0.0005}),
                   body("lever", make_box({0.02, 0.06, 0.02}, 3), Mobility::hinge, {0.02, -0.05, 0.05}),
                   body("knob", make_sphere(0.015, 6), Mobility::ball, {-0.02, 0.055, 0.06}),
                   body("key", make_box({0.02, 0.02, 0.02}, 3), Mobility::slider, {0.03, 0.03, 0.02}),
                   body("told", make_sphere(0.01, 4), Mobility::given, {-0.1, 0, 0.07})};
  Mechanism& lever = scene.objects[2].mechanism;
  lever.lower = -0.3;
  lever.upper = 0.6;
  lever.detent_force = 0.05;
  lever.dry_friction = 0.01;
  scene.objects[3].mechanism.damping = 0.002;
  scene.objects[4].mechanism.spring = 100;
  const Motion motion = make_grasp(scene.hand, 0.037, 0.095, 2, 0.05);
  for (int i = 0; i < 500; ++i) session.frames.push_back(resample(motion, i / scene.settings.rate));
  return session;
}

/// The same mug standing still, of few facets that are felt round, ridged, and rough in places.
GoldenSession surface() {
  GoldenSession session{"surface", mug_scene(Law::field), {}};
  Scene& scene = session.scene;
  scene.settings.precision.fill(1e-4);
  scene.settings.precision[5] = 0;
  MugShape shape;
  shape.segments = 14;
  SceneObject& mug = scene.objects[0];
  mug.mesh = make_mug(shape);
  mug.material = {0.6, 0.4, 0.1, 1200};
  mug.surface.crease_angle = 0.6;
  for (std::size_t i = 0; i < mug.mesh.triangles.size(); ++i)
    mug.surface.friction_factor.push_back(static_cast<double>(i % 5) / 4);
  mug.surface.grip = {{2, 2, {65535, 30000, 20000, 65535}}, 0.03, 0.2, 1.5};
  mug.surface.bumps = {{3, 2, {0, 30000, 65535, 50000, 10000, 40000}}, 0.01, 0, 0.0005};
  session.frames = grasp_frames(scene.hand, 200);
  return session;
}

}  // namespace

std::vector<GoldenSession> golden_sessions() {
  std::vector<GoldenSession> sessions;
  for (const Law law : {Law::field, Law::column, Law::max_depth, Law::centroid, Law::point})
    sessions.push_back(grasp("mug." + std::string(law_name(law)), law, 100));
  sessions.push_back(crowd());
  sessions.push_back(thin_sheets(Law::field));
  sessions.push_back(thin_sheets(Law::column));
  sessions.push_back(pads());
  sessions.push_back(lost_tracking());
  sessions.push_back(not_finite());
  sessions.push_back(overflow());
  sessions.push_back(large_triangles());
  sessions.push_back(hall());
  sessions.push_back(far_away());
  sessions.push_back(mixed_laws());
  sessions.push_back(sampled("samples.1e-3", 1e-3));
  sessions.push_back(sampled("samples.1e-4", 1e-4));
  sessions.push_back(sampled("samples.1e-5", 1e-5));
  sessions.push_back(held_together("never.1e-4", 1e-4, FeltOnce::never));
  sessions.push_back(held_together("once.exact", 0, FeltOnce::always));
  sessions.push_back(bent("bent", 0, 1));
  sessions.push_back(bent("plump", 1e-4, 1.6));
  sessions.push_back(fists());
  sessions.push_back(objects());
  sessions.push_back(proxy());
  sessions.push_back(surface());
  return sessions;
}

std::uint64_t hash_jacobians(const Execution& execution) {
  Scene scene = mug_scene(Law::field);
  scene.settings.fade_time = 0;
  scene.settings.max_force = 1e6;
  const Model model = model_of(scene, execution);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  std::array<SegmentJacobian, kSegmentCount> jacobians;
  Hasher hasher;
  for (const DeviceFrame& frame : grasp_frames(scene.hand, 20)) {
    tick(model, state, scratch, frame);
    segment_jacobians(model, scratch, jacobians);
    for (const SegmentJacobian& jacobian : jacobians) {
      for (const auto& row : jacobian.value) hasher.array(row);
    }
  }
  return hasher.digest();
}

std::uint64_t hash_pairs(Isa isa) {
  Random random(17);
  Hasher hasher;
  for (std::uint64_t i = 0; i < 900; ++i) {
    const Primitive primitive = random_primitive(random, i % 3);
    double size = 3e-4;  // to 30 R
    for (std::uint64_t k = random.bits() % 4; k > 0; --k) size *= random.between(3, 9);
    const double along = random.between(0, 1), out = random.between(0, 1) * primitive.radius1;
    const Vec3 aside = random.direction();
    const Vec3 near = primitive.end1 + along * (primitive.end2 - primitive.end1) + out * aside;
    const Vec3 a = near + size * random.direction(), b = near + size * random.direction(),
               c = near + size * random.direction();
    Contact contact{};
    const ContactQuery query{1e-4, nullptr, exact_kernels(isa)};
    hasher.value(collide(primitive, query, {a, b, c}, contact));
    hasher.bytes(&contact, sizeof contact);
  }
  return hasher.digest();
}

std::uint64_t golden_hash(const std::string& name) {
  for (const auto& [golden_name, hash] : kGolden) {
    if (name == golden_name) return hash;
  }
  return 0;
}

}  // namespace lumbrical::test
