// Work of the contact force round closed paths: a law that is the gradient of a potential does none.
#include <algorithm>
#include <cmath>
#include <numbers>

#include "base/gauss.h"
#include "experiments.h"
#include "lumbrical/shapes.h"

namespace lumbrical::bench {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;
constexpr std::size_t kIndexSegment = 3;  // of the index finger's first phalanx

Quat turned_by(Vec3 turn) {
  const double angle = norm(turn);
  if (angle == 0) return {};
  const Vec3 axis = std::sin(0.5 * angle) / angle * turn;
  return {std::cos(0.5 * angle), axis.x, axis.y, axis.z};
}

struct Motion6 {
  Vec3 velocity;  // [m] per unit of t, of F's origin
  Vec3 spin;      // [rad] per unit of t
};

Motion6 motion_at(const ClosedPath& path, double t) {
  const double a = 2 * kPi * t;
  return {2 * kPi * (std::cos(a) * path.sine - std::sin(a) * path.cosine) +
              4 * kPi * std::cos(2 * a) * path.wobble,
          2 * kPi * std::cos(a) * path.turn};
}

class Integrator {
 public:
  Integrator(Rig& rig, const ClosedPath& path, LoopWork& result) : rig_(rig), path_(path), result_(result) {}

  void add(double lower, double upper, double tolerance, int levels) {
    const double rough = integral(kGauss8, lower, upper), fine = integral(kGauss16, lower, upper);
    const double allowed = tolerance * (upper - lower) * result_.largest_force * result_.length;
    if (std::fabs(fine - rough) <= allowed || levels == 0) {
      result_.work += fine;
      result_.error += std::fabs(fine - rough);
      return;
    }
    const double middle = 0.5 * (lower + upper);
    add(lower, middle, tolerance, levels - 1);
    add(middle, upper, tolerance, levels - 1);
  }

 private:
  template <std::size_t N>
  double integral(const GaussNode (&rule)[N], double lower, double upper) {
    double sum = 0;
    for (const GaussNode& node : rule) {
      const double t = lower + (upper - lower) * node.at;
      const Felt felt = feel(rig_, pose_at(path_, t));
      const Motion6 motion = motion_at(path_, t);
      result_.largest_force = std::max(result_.largest_force, norm(felt.force));
      sum +=
          (upper - lower) * node.weight * (dot(felt.force, motion.velocity) + dot(felt.torque, motion.spin));
      ++result_.nodes;
    }
    return sum;
  }

  Rig& rig_;
  const ClosedPath& path_;
  LoopWork& result_;
};

// The longest way a joint of the finger goes.
double path_length(const Rig& rig, const ClosedPath& path) {
  constexpr int kChords = 2000;
  double longest = 0;
  for (std::size_t i = 0; i < kJointCount; ++i) {
    if ((rig.frame.valid >> i & 1u) == 0) continue;
    const auto& p = rig.frame.joint[i].position;
    double length = 0;
    Vec3 before = transform(pose_at(path, 0), {p[0], p[1], p[2]});
    for (int k = 1; k <= kChords; ++k) {
      const Vec3 here = transform(pose_at(path, static_cast<double>(k) / kChords), {p[0], p[1], p[2]});
      length += norm(here - before);
      before = here;
    }
    longest = std::max(longest, length);
  }
  return longest;
}

// A fingertip's loop through a corner or edge at the origin: in and out along `inward`, to and fro across.
ClosedPath loop_through(Vec3 centre, Vec3 across, Vec3 inward, Vec3 wobble, Quat orientation) {
  return {{centre, orientation}, across, inward, wobble, {}};
}

}  // namespace

Pose pose_at(const ClosedPath& path, double t) {
  const double a = 2 * kPi * t;
  const Vec3 shift = std::cos(a) * path.cosine + std::sin(a) * path.sine + std::sin(2 * a) * path.wobble;
  return {path.start.position + shift, turned_by(std::sin(a) * path.turn) * path.start.orientation};
}

LoopWork work_round(Rig& rig, const ClosedPath& path, double tolerance, int levels) {
  LoopWork result;
  result.length = path_length(rig, path);
  for (int i = 0; i < 64; ++i)  // a first idea of F_max, which the tolerance is a share of
    result.largest_force = std::max(result.largest_force, norm(feel(rig, pose_at(path, i / 64.0)).force));
  Integrator integrator(rig, path, result);
  constexpr int kIntervals = 16;
  for (int i = 0; i < kIntervals; ++i) {
    integrator.add(static_cast<double>(i) / kIntervals, static_cast<double>(i + 1) / kIntervals, tolerance,
                   levels);
  }
  return result;
}

const char* obstacle_name(Obstacle obstacle) {
  constexpr const char* names[] = {"30 degree edge",          "90 degree edge",
                                   "90 degree edge, turning", "hook round a 90 degree edge",
                                   "corner of a cube",        "vertex of a tetrahedron"};
  return names[static_cast<std::size_t>(obstacle)];
}

LoopWork work_over(Obstacle obstacle, const PosedFinger& finger, Law law, double tolerance, int levels) {
  const double out =
      kRadius - 0.5 * kDepth;  // from a corner to the middle of the path, which goes 3 mm both ways
  const Quat oblique = leaning(50 * kDegree, 0.6);
  Mesh mesh;
  ClosedPath path;
  switch (obstacle) {
    case Obstacle::edge_30: {
      mesh = bent_plane(30 * kDegree, 0.1, 0.006, 0.006, 61);
      const Vec3 normal{std::sin(15 * kDegree), 0, std::cos(15 * kDegree)};
      path = loop_through(out * normal, {0.006, 0, -0.001}, 0.002 * normal, {0, 0.001, 0}, oblique);
      break;
    }
    case Obstacle::edge_90:
    case Obstacle::edge_90_turning: {
      mesh = bent_plane(90 * kDegree, 0.1, 0.006, 0.006, 61);
      const Vec3 normal{std::sqrt(0.5), 0, std::sqrt(0.5)};
      path = loop_through(out * normal, {0.006, 0, -0.002}, {0.0005, 0, 0.004}, {0.001, 0.001, 0}, oblique);
      if (obstacle == Obstacle::edge_90_turning) path.turn = {0.2, 0.3, -0.15};
      break;
    }
    case Obstacle::hook_90:
      mesh = bent_plane(90 * kDegree, 0.1, 0.006, 0.006, 61);
      path = loop_through({out + 0.0005, 0, kRadius - 0.006}, {0.0025, 0, 0}, {0, 0, 0.008}, {}, {});
      break;
    case Obstacle::cube_corner: {
      mesh = make_box({0.1, 0.1, 0.1}, 10);
      for (Vec3& p : mesh.vertices) p -= Vec3{0.05, 0.05, 0.05};
      const Vec3 normal = Vec3{1, 1, 1} / std::sqrt(3.0);
      path =
          loop_through(out * normal, {0.004, -0.004, 0}, 0.003 * normal, {0.0015, 0.0015, -0.003}, oblique);
      path.turn = {0.1, -0.2, 0.15};
      break;
    }
    case Obstacle::tetrahedron_vertex:
      mesh = tetrahedron(0.12);
      path = loop_through({0, 0, out}, {0.004, 0.002, 0}, {0, 0, 0.003}, {-0.001, 0.002, 0}, oblique);
      path.turn = {0.1, -0.2, 0.15};
      break;
  }
  Rig rig = make_rig(mesh, finger, law);
  return work_round(rig, path, tolerance, levels);
}

LoopWork work_of_bending(double first, double second, bool tapered, Law law, int ticks) {
  PosedFinger finger = bent_finger(first, second);
  if (tapered) finger.radius = {0.0105, 0.0085, 0.0076, 0.0066};
  Rig rig = make_rig(bent_plane(90 * kDegree, 0.2, 0.006, 0.006, 61), finger, law);
  const Vec3 start = Vec3{0, 0, 0.0055} - finger.joints[1];
  LoopWork result;
  result.nodes = ticks;
  // The trapezoidal rule, which for periodic motion is all one needs.
  const double step = 2 * kPi / ticks;
  for (int i = 0; i < ticks; ++i) {
    const double t = step * i;
    const double first_rate = -30 * kDegree * std::sin(t), second_rate = 25 * kDegree * std::cos(t);
    const PosedFinger posed =
        bent_finger(first + 30 * kDegree * std::cos(t), second + 25 * kDegree * std::sin(t));
    set_joints(posed, rig);
    feel(rig, {start + Vec3{0.004 * std::cos(t + 1), 0, 0.0025 * std::sin(t)}, {}});
    const double rate[3] = {0, first_rate, first_rate + second_rate};
    Vec3 velocity{-0.004 * std::sin(t + 1), 0, 0.0025 * std::cos(t)}, force;
    for (std::size_t k = 0; k < 3; ++k) {
      const Wrench& wrench = rig.output.segment[kIndexSegment + k];
      const Vec3 spin{0, rate[k], 0};
      result.work += step * (dot(wrench.force, velocity) + dot(wrench.torque, spin));
      force += wrench.force;
      velocity += cross(spin, posed.joints[k + 1] - posed.joints[k]);
    }
    result.length += step * norm(velocity);
    result.largest_force = std::max(result.largest_force, norm(force));
  }
  return result;
}

}  // namespace lumbrical::bench
