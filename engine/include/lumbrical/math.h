// Vectors, quaternions and rigid poses in double precision: the few operations the engine needs.
//
// Only + - * / and sqrt are used, so every function gives the same bits on every machine.
#pragma once

#include <array>
#include <cmath>

namespace lumbrical {

struct Vec3 {
  double x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Vec3&, const Vec3&) = default;
};

constexpr Vec3 operator+(Vec3 a, Vec3 b) { return {a.x + b.x, a.y + b.y, a.z + b.z}; }
constexpr Vec3 operator-(Vec3 a, Vec3 b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
constexpr Vec3 operator-(Vec3 a) { return {-a.x, -a.y, -a.z}; }
constexpr Vec3 operator*(double s, Vec3 a) { return {s * a.x, s * a.y, s * a.z}; }
constexpr Vec3 operator*(Vec3 a, double s) { return s * a; }
constexpr Vec3 operator/(Vec3 a, double s) { return {a.x / s, a.y / s, a.z / s}; }
constexpr Vec3& operator+=(Vec3& a, Vec3 b) { return a = a + b; }
constexpr Vec3& operator-=(Vec3& a, Vec3 b) { return a = a - b; }
constexpr double dot(Vec3 a, Vec3 b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
constexpr Vec3 cross(Vec3 a, Vec3 b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
inline double norm(Vec3 a) { return std::sqrt(dot(a, a)); }

/// a / |a|, or `fallback` where |a| is zero, denormal or not finite.
inline Vec3 unit_or(Vec3 a, Vec3 fallback) {
  const double length = norm(a);
  return length > 1e-150 && length < 1e150 ? a / length : fallback;
}

inline bool is_finite(double a) { return std::isfinite(a); }
inline bool is_finite(Vec3 a) { return std::isfinite(a.x) && std::isfinite(a.y) && std::isfinite(a.z); }

// Own minimum, maximum and clamp: fixed by compare and select, so NaN and -0 behave alike everywhere.
constexpr double min(double a, double b) { return a < b ? a : b; }
constexpr double max(double a, double b) { return a > b ? a : b; }
/// The largest coordinate's amount.
inline double largest_of(Vec3 a) { return max(std::fabs(a.x), max(std::fabs(a.y), std::fabs(a.z))); }
constexpr double clamp(double a, double low, double high) { return min(max(a, low), high); }

/// Unit quaternion w + xi + yj + zk; rotates column vectors.
struct Quat {
  double w = 1, x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Quat&, const Quat&) = default;
};

constexpr Quat operator*(Quat a, Quat b) {
  return {a.w * b.w - a.x * b.x - a.y * b.y - a.z * b.z, a.w * b.x + a.x * b.w + a.y * b.z - a.z * b.y,
          a.w * b.y - a.x * b.z + a.y * b.w + a.z * b.x, a.w * b.z + a.x * b.y - a.y * b.x + a.z * b.w};
}
constexpr Quat conjugate(Quat q) { return {q.w, -q.x, -q.y, -q.z}; }
constexpr double dot(Quat a, Quat b) { return a.w * b.w + a.x * b.x + a.y * b.y + a.z * b.z; }

/// q / |q|, or the identity where q is zero or not finite.
inline Quat normalized(Quat q) {
  const double length = std::sqrt(dot(q, q));
  if (!(length > 1e-150 && length < 1e150)) return {};
  return {q.w / length, q.x / length, q.y / length, q.z / length};
}

constexpr Vec3 rotate(Quat q, Vec3 v) {
  const Vec3 u{q.x, q.y, q.z};
  const Vec3 t = 2.0 * cross(u, v);
  return v + q.w * t + cross(u, t);
}

/// The rotation whose columns are the orthonormal, right-handed axes x, y, z (Shepperd's method).
Quat quat_from_axes(Vec3 x, Vec3 y, Vec3 z);

/// Rigid transform X_AB: the pose of frame B in frame A. Maps coordinates in B to coordinates in A.
struct Pose {
  Vec3 position;     ///< [m] origin of B in A
  Quat orientation;  ///< rotates vectors of B into A
  friend constexpr bool operator==(const Pose&, const Pose&) = default;
};

constexpr Vec3 transform(const Pose& X_AB, Vec3 p_B) { return X_AB.position + rotate(X_AB.orientation, p_B); }
constexpr Pose operator*(const Pose& X_AB, const Pose& X_BC) {
  return {transform(X_AB, X_BC.position), X_AB.orientation * X_BC.orientation};
}
constexpr Pose inverse(const Pose& X_AB) {
  const Quat q = conjugate(X_AB.orientation);
  return {rotate(q, -X_AB.position), q};
}

/// An axis-aligned box round points. Empty as long as none was added.
struct Box {
  Vec3 lower{1e300, 1e300, 1e300}, upper{-1e300, -1e300, -1e300};  ///< [m]
  void add(Vec3 p, double r = 0) {
    lower = {min(lower.x, p.x - r), min(lower.y, p.y - r), min(lower.z, p.z - r)};
    upper = {max(upper.x, p.x + r), max(upper.y, p.y + r), max(upper.z, p.z + r)};
  }
  void add(const Box& other) {
    lower = {min(lower.x, other.lower.x), min(lower.y, other.lower.y), min(lower.z, other.lower.z)};
    upper = {max(upper.x, other.upper.x), max(upper.y, other.upper.y), max(upper.z, other.upper.z)};
  }
  [[nodiscard]] Vec3 middle() const { return 0.5 * lower + 0.5 * upper; }
  [[nodiscard]] bool meets(const Box& other) const {
    return lower.x <= other.upper.x && other.lower.x <= upper.x && lower.y <= other.upper.y &&
           other.lower.y <= upper.y && lower.z <= other.upper.z && other.lower.z <= upper.z;
  }
};

/// [m/s] of a point of a body, and [rad/s].
struct Twist {
  Vec3 velocity, angular_velocity;
};

/// Force and torque of one body part.
struct Wrench {
  Vec3 force;   ///< [N]
  Vec3 torque;  ///< [N m] about the point the owner documents
};

/// Six rows of six: what relates two pairs of vectors, such as the change of a wrench to that of a pose.
using Matrix6 = std::array<std::array<double, 6>, 6>;

}  // namespace lumbrical
