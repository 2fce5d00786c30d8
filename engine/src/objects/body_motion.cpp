#include "objects/body_motion.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "base/elementary.h"
#include "base/small_turn.h"
#include "base/vector6.h"
#include "base/wrench.h"

namespace lumbrical {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr std::array<Vec3, 3> kAxis = {Vec3{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

// The speed of a body's point along a direction, as a row.
Vector6 along(Vec3 direction, Vec3 arm) { return vector_of(direction, cross(arm, direction)); }

std::array<Vec3, 3> axes_with(Vec3 normal) {
  const Vec3 other = std::fabs(normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 first = unit_or(cross(normal, other), {1, 0, 0});
  return {normal, first, cross(normal, first)};
}

Vec3 turned_inertia(const std::array<double, 6>& inertia, Quat orientation, Vec3 spin) {
  const auto& [xx, yy, zz, xy, yz, zx] = inertia;
  const Vec3 w = rotate(conjugate(orientation), spin);
  return rotate(orientation, {xx * w.x + xy * w.y + zx * w.z, xy * w.x + yy * w.y + yz * w.z,
                              zx * w.x + yz * w.y + zz * w.z});
}

void add_mass(const MassProperties& body, Quat orientation, Matrix6& to) {
  for (std::size_t k = 0; k < 3; ++k) {
    to[k][k] += body.mass;
    const Vec3 column = turned_inertia(body.inertia, orientation, kAxis[k]);
    to[3][3 + k] += column.x;
    to[4][3 + k] += column.y;
    to[5][3 + k] += column.z;
  }
}

// Solves `size` equations by elimination with the largest pivot; a row without one gives 0.
void solve(std::size_t size, Matrix6& a, Vector6& b) {
  for (std::size_t k = 0; k < size; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < size; ++i) {
      if (std::fabs(a[i][k]) > std::fabs(a[pivot][k])) pivot = i;
    }
    std::swap(a[k], a[pivot]);
    std::swap(b[k], b[pivot]);
    if (!(std::fabs(a[k][k]) > 0)) continue;
    for (std::size_t i = k + 1; i < size; ++i) {
      const double factor = a[i][k] / a[k][k];
      for (std::size_t j = k; j < size; ++j) a[i][j] -= factor * a[k][j];
      b[i] -= factor * b[k];
    }
  }
  for (std::size_t k = size; k-- > 0;) {
    for (std::size_t j = k + 1; j < size; ++j) b[k] -= a[k][j] * b[j];
    b[k] = std::fabs(a[k][k]) > 0 ? b[k] / a[k][k] : 0;
  }
}

/// The speeds a joint leaves a body.
struct Freedom {
  std::size_t size = 6;
  std::array<Vector6, 6> speed{};
};

Freedom freedom_of(const Mechanism& mechanism, Vec3 centre) {
  Freedom freedom;
  const Vec3 arm = centre - mechanism.pivot;
  const auto turning = [&](Vec3 about) { return vector_of(cross(about, arm), about); };
  if (mechanism.mobility == Mobility::hinge) {
    freedom = {1, {turning(mechanism.axis)}};
  } else if (mechanism.mobility == Mobility::slider) {
    freedom = {1, {vector_of(mechanism.axis, {})}};
  } else if (mechanism.mobility == Mobility::ball) {
    freedom.size = 3;
    for (std::size_t k = 0; k < 3; ++k) freedom.speed[k] = turning(kAxis[k]);
  } else {
    for (std::size_t k = 0; k < 6; ++k) freedom.speed[k][k] = 1;
  }
  return freedom;
}

// ---- One coordinate ----

// The spring, damper and detents of a hinge or slider: their force at q and speed, and how stiff they are to
// a step. Detents are at least half as stiff as where they are stiffest: then no step gains energy, also
// where their slope pushes on.
struct CoordinateForce {
  double force = 0, stiffness = 0, damping = 0;
};

CoordinateForce coordinate_force(const Mechanism& mechanism, double q) {
  const double turn = 2 * kPi / mechanism.detent_pitch, clicks = q / mechanism.detent_pitch;
  const SinCos detent = sin_cos(2 * kPi * (clicks - std::floor(clicks + 0.5)));
  return {mechanism.spring * (mechanism.rest - q) - mechanism.detent_force * detent.sin,
          mechanism.spring + mechanism.detent_force * turn * max(0.5, detent.cos), mechanism.damping};
}

// Dry friction takes up to so much speed away.
double slowed(double speed, double most) {
  return speed > most ? speed - most : speed < -most ? speed + most : 0;
}

Pose pose_at(const Mechanism& mechanism, const Pose& start, double q) {
  if (mechanism.mobility == Mobility::slider) return {start.position + q * mechanism.axis, start.orientation};
  const SinCos half = sin_cos(0.5 * q);
  const Vec3 v = half.sin * mechanism.axis;
  const Quat turn{half.cos, v.x, v.y, v.z};
  return {mechanism.pivot + rotate(turn, start.position - mechanism.pivot), turn * start.orientation};
}

// Of what turns about a pivot that it keeps.
Vec3 position_about(Vec3 pivot, const Pose& start, Quat orientation) {
  const Vec3 arm = rotate(conjugate(start.orientation), start.position - pivot);
  return pivot + rotate(orientation, arm);
}

Quat turned(Quat orientation, Vec3 by) { return normalized(small_rotation(by) * orientation); }

Vec3 arm_from_pivot(const Mechanism& mechanism, const Pose& pose) {
  return transform(pose, mechanism.body.centre) - mechanism.pivot;
}

// What turns about a pivot takes its centre of mass along: that has no speed of its own, and what the centre
// moved at a tick ago points elsewhere now.
void turn_about_pivot(const Mechanism& mechanism, ObjectState& state) {
  if (mechanism.mobility != Mobility::hinge && mechanism.mobility != Mobility::ball) return;
  state.velocity = cross(state.angular_velocity, arm_from_pivot(mechanism, state.pose));
}

// Of a spin: about the centre of mass, or about the pivot of a ball, round which that centre goes.
Vec3 angular_momentum(const Mechanism& mechanism, const Pose& pose, Vec3 spin) {
  const Vec3 own = turned_inertia(mechanism.body.inertia, pose.orientation, spin);
  if (mechanism.mobility != Mobility::ball) return own;
  const Vec3 arm = arm_from_pivot(mechanism, pose);
  return own + mechanism.body.mass * cross(arm, cross(spin, arm));
}

/// A body's equation of motion for one step: matrix * change of speed = impulse.
struct Equation {
  Matrix6 matrix{};
  Vector6 impulse{};
};

// How much of the slope of spin x momentum by the momentum a step may take. With all of it a step gains
// dt spin . (dspin x inertia dspin), and loses half dspin . inertia dspin: that is more as long as
// dt |spin| < sqrt(least / greatest moment of inertia), which is at least the square root below, for no
// moment is above half the trace. Beyond that a body which spins fast would spin ever faster.
double share_of_slope(const std::array<Vec3, 3>& inertia, Vec3 spin, double dt) {
  const double half_trace = 0.5 * (inertia[0].x + inertia[1].y + inertia[2].z);
  const double determinant = dot(inertia[0], cross(inertia[1], inertia[2]));
  const double safe = std::sqrt(max(0, determinant) / (half_trace * half_trace * half_trace));
  const double turn = dt * norm(spin);
  return turn > safe ? safe / turn : 1;
}

// The gyroscopic torque, as implicit as the rest: explicit, a spinning body would gain energy. A ball's holds
// what leads the centre of mass round the pivot.
void add_gyroscopic_torque(const Mechanism& mechanism, const Pose& pose, Vec3 spin, double dt, Equation& e) {
  std::array<Vec3, 3> inertia;
  for (std::size_t k = 0; k < 3; ++k) inertia[k] = angular_momentum(mechanism, pose, kAxis[k]);
  const Vec3 momentum = angular_momentum(mechanism, pose, spin);
  const double share = share_of_slope(inertia, spin, dt);
  add_scaled(-dt, vector_of({}, cross(spin, momentum)), e.impulse);
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 column = share * cross(spin, inertia[k]) + cross(kAxis[k], momentum);
    e.matrix[3][3 + k] += dt * column.x;
    e.matrix[4][3 + k] += dt * column.y;
    e.matrix[5][3 + k] += dt * column.z;
  }
}

Equation equation_of(const Mechanism& mechanism, const Pose& pose, std::span<const Spring> springs,
                     const Wrench& wrench, const Twist& speed, double dt) {
  Equation e;
  e.impulse = vector_of(dt * wrench);
  for (const Spring& spring : springs) {
    add_scaled(dt, vector_of(about(spring.arm, change_of(spring, speed, dt))), e.impulse);
    add_spring(spring, dt * dt, e.matrix);
  }
  if (mechanism.mobility == Mobility::free || mechanism.mobility == Mobility::ball) {
    add_scaled(-dt * mechanism.damping, vector_of({}, speed.angular_velocity), e.impulse);
    for (std::size_t k = 3; k < 6; ++k) e.matrix[k][k] += dt * mechanism.damping;
  }
  add_mass(mechanism.body, pose.orientation, e.matrix);
  add_gyroscopic_torque(mechanism, pose, speed.angular_velocity, dt, e);
  return e;
}

// The change of the coordinates that a joint leaves.
Vector6 change_of_speed(const Equation& equation, const Freedom& freedom) {
  Matrix6 matrix{};
  Vector6 change{};
  for (std::size_t j = 0; j < freedom.size; ++j) {
    const Vector6 column = times(equation.matrix, freedom.speed[j]);
    for (std::size_t i = 0; i < freedom.size; ++i) matrix[i][j] = dot6(freedom.speed[i], column);
    change[j] = dot6(freedom.speed[j], equation.impulse);
  }
  solve(freedom.size, matrix, change);
  return change;
}

// A hinge or slider: one coordinate, with what acts on it alone.
double coordinate_speed(const Mechanism& mechanism, const Equation& equation, const Vector6& direction,
                        double q, double speed, double dt) {
  const CoordinateForce own = coordinate_force(mechanism, q);
  const double resistance = dt * (own.damping + dt * own.stiffness);
  const double mass = dot6(direction, times(equation.matrix, direction)) + resistance;
  const double impulse = dot6(direction, equation.impulse) + dt * own.force - resistance * speed;
  return slowed(speed + impulse / mass, dt * mechanism.dry_friction / mass);
}

// These return the speed at which springs give way (`advance_body`); the state gets that of the new pose.
Twist move_coordinate(const Mechanism& mechanism, const Pose& start, const Vector6& direction, double speed,
                      double dt, ObjectState& state) {
  const double q = clamp(state.coordinate + dt * speed, mechanism.lower, mechanism.upper);
  speed = (q - state.coordinate) / dt;  // less where it stopped
  state.coordinate = q;
  state.pose = pose_at(mechanism, start, q);
  state.velocity = speed * Vec3{direction[0], direction[1], direction[2]};
  state.angular_velocity = speed * Vec3{direction[3], direction[4], direction[5]};
  const Twist reached{state.velocity, state.angular_velocity};
  turn_about_pivot(mechanism, state);
  return reached;
}

Twist move_freely(const Mechanism& mechanism, const Pose& start, Vec3 centre, double dt, ObjectState& state) {
  const Twist reached{state.velocity, state.angular_velocity};
  state.pose.orientation = turned(state.pose.orientation, dt * state.angular_velocity);
  if (mechanism.mobility == Mobility::ball) {
    state.pose.position = position_about(mechanism.pivot, start, state.pose.orientation);
    turn_about_pivot(mechanism, state);
  } else {
    const Vec3 moved = centre + dt * state.velocity;
    state.pose.position = moved - rotate(state.pose.orientation, mechanism.body.centre);
  }
  return reached;
}

}  // namespace

Wrench change_of(const Spring& spring, const Twist& speed, double dt) {
  const Twist& anchor = spring.anchor;
  const Vec3 point = speed.velocity + cross(speed.angular_velocity, spring.arm) - anchor.velocity;
  const Vec3 turning = speed.angular_velocity - anchor.angular_velocity;
  const double normal = dot(spring.normal, point), spin = dot(spring.normal, turning);
  return {(-dt * spring.across) * point - (dt * (spring.along - spring.across) * normal) * spring.normal,
          (-dt * spring.tilt) * turning - (dt * (spring.about - spring.tilt) * spin) * spring.normal};
}

void add_spring(const Spring& spring, double scale, Matrix6& to) {
  const auto [normal, first, second] = axes_with(spring.normal);
  add_square(scale * spring.along, along(normal, spring.arm), to);
  add_square(scale * spring.across, along(first, spring.arm), to);
  add_square(scale * spring.across, along(second, spring.arm), to);
  add_square(scale * spring.about, vector_of({}, normal), to);
  add_square(scale * spring.tilt, vector_of({}, first), to);
  add_square(scale * spring.tilt, vector_of({}, second), to);
}

Twist advance_body(const Mechanism& mechanism, const Pose& start, std::span<const Spring> springs,
                   const Wrench& wrench, double dt, ObjectState& state) {
  turn_about_pivot(mechanism, state);
  const Vec3 centre = transform(state.pose, mechanism.body.centre);
  const Twist speed{state.velocity, state.angular_velocity};
  const Equation equation = equation_of(mechanism, state.pose, springs, wrench, speed, dt);
  const Freedom freedom = freedom_of(mechanism, centre);
  if (freedom.size == 1) {
    const Vector6& direction = freedom.speed[0];
    const double before = dot6(direction, vector_of(speed)) / dot6(direction, direction);
    const double after = coordinate_speed(mechanism, equation, direction, state.coordinate, before, dt);
    return move_coordinate(mechanism, start, direction, after, dt, state);
  }
  const Vector6 change = change_of_speed(equation, freedom);
  Vector6 gained{};
  for (std::size_t j = 0; j < freedom.size; ++j) add_scaled(change[j], freedom.speed[j], gained);
  state.velocity += {gained[0], gained[1], gained[2]};
  state.angular_velocity += {gained[3], gained[4], gained[5]};
  return move_freely(mechanism, start, centre, dt, state);
}

namespace {

// Of places [m] for each metre they lie from the origin, of turns [rad].
constexpr double kRounding = 1e-8;

// The nearest that its mobility allows.
Pose held_pose(const Mechanism& mechanism, const Pose& start, const ObjectState& state) {
  const Pose& pose = state.pose;
  if (has_coordinate(mechanism)) return pose_at(mechanism, start, state.coordinate);
  if (mechanism.mobility == Mobility::ball)
    return {position_about(mechanism.pivot, start, pose.orientation), pose.orientation};
  return mechanism.mobility == Mobility::free || state.told > 0 ? pose : start;
}

bool may_have_coordinate(const Mechanism& mechanism, double q) {
  return has_coordinate(mechanism) ? q >= mechanism.lower && q <= mechanism.upper : q == 0;
}

}  // namespace

bool may_be_at(const Mechanism& mechanism, const Pose& start, const ObjectState& state) {
  const bool is_told = state.told > 0;
  if (is_told && mechanism.mobility != Mobility::given) return false;
  if (!may_have_coordinate(mechanism, state.coordinate)) return false;
  const auto& [position, orientation] = state.pose;
  const Pose held = held_pose(mechanism, start, state);
  const Quat off = conjugate(held.orientation) * orientation;
  const double room = kRounding * (1 + norm(start.position) + norm(mechanism.pivot));
  return std::fabs(dot(orientation, orientation) - 1) <= kRounding &&
         norm(Vec3{off.x, off.y, off.z}) <= kRounding && norm(position - held.position) <= room;
}

}  // namespace lumbrical
