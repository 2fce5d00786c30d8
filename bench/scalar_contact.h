// The exact contacted area, its centroid and the depth there, of one triangle and one phalanx of one radius,
// in plain scalar code: what someone who takes only a triangle query from a library has to add. Green's
// theorem over the triangle's edges, clamped to the section |y| <= eta(x) (docs/mechanics.md); shares no code
// with the engine.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "model/primitive.h"

namespace lumbrical::bench {

struct ScalarContact {
  double area = 0, depth = 0;
};

/// The section of a capsule in the triangle's plane: x along the projected axis, from the foot of the lower
/// end.
class ScalarSection {
 public:
  ScalarSection(double radius, double length, double height, double sine, double cosine)
      : r2_(radius * radius), length_(length), h1_(height), s_(sine), c_(cosine) {
    border1_ = s_ > 1e-12 ? c_ * h1_ / s_ : c_ * h1_ > 0 ? 1e30 : -1e30;
    border2_ = s_ > 1e-12 ? (length_ + c_ * h1_) / s_ : 1e30;
  }
  // Adds the integrals of clamp(y), x clamp(y) and clamp(y)^2 / 2 along the edge.
  void add_edge(double x0, double y0, double x1, double y1, double (&sum)[3]) const {
    if (x0 == x1) return;
    const double sign = x0 < x1 ? 1 : -1;
    if (x0 > x1) std::swap(x0, x1), std::swap(y0, y1);
    const double m = (y1 - y0) / (x1 - x0), b = y0 - m * x0;
    std::array<double, 20> at{x0, x1};
    std::size_t count = 2;
    const auto add = [&](double x, int zone) {
      if (x > x0 && x < x1 && (zone < 0 || zone_of(x) == zone)) at[count++] = x;
    };
    add(border1_, -1);
    add(border2_, -1);
    for (int zone = 0; zone < 3; ++zone) {
      double q2, q1, q0;
      quadratic(zone, q2, q1, q0);
      roots(q2 - m * m, 0.5 * q1 - m * b, q0 - b * b, zone, add);
      roots(q2, 0.5 * q1, q0, zone, add);
    }
    std::sort(at.begin(), at.begin() + static_cast<std::ptrdiff_t>(count));
    for (std::size_t i = 0; i + 1 < count; ++i) add_piece(at[i], at[i + 1], m, b, sign, sum);
  }

 private:
  [[nodiscard]] int zone_of(double x) const { return x <= border1_ ? 0 : x >= border2_ ? 2 : 1; }
  // eta^2 = q2 x^2 + q1 x + q0
  void quadratic(int zone, double& q2, double& q1, double& q0) const {
    if (zone == 1) {
      q2 = -c_ * c_, q1 = -2 * c_ * s_ * h1_, q0 = r2_ - s_ * s_ * h1_ * h1_;
    } else {
      const double foot = zone == 0 ? 0 : s_ * length_, h = zone == 0 ? h1_ : h1_ + c_ * length_;
      q2 = -1, q1 = 2 * foot, q0 = r2_ - foot * foot - h * h;
    }
  }
  template <class Add>
  static void roots(double a, double half_b, double c, int zone, const Add& add) {
    const double square = half_b * half_b - a * c;
    if (square < 0) return;
    const double q = -(half_b + (half_b < 0 ? -std::sqrt(square) : std::sqrt(square)));
    if (a != 0) add(q / a, zone);
    if (q != 0) add(c / q, zone);
  }
  void add_piece(double x0, double x1, double m, double b, double sign, double (&sum)[3]) const {
    const double x = 0.5 * (x0 + x1), y = m * x + b, w = x1 - x0;
    double q2, q1, q0;
    quadratic(zone_of(x), q2, q1, q0);
    const double eta2 = (q2 * x + q1) * x + q0;
    if (!(eta2 > 0)) return;
    if (y * y <= eta2) {
      sum[0] += sign * w * y;
      sum[1] += sign * w * (x * y + m * w * w / 12);
      sum[2] += sign * w * 0.5 * (y * y + m * m * w * w / 12);
      return;
    }
    const double side = y > 0 ? sign : -sign;
    // The integral of eta: by t = (x - middle) / half of its zero distance where eta is a circle or ellipse.
    const double scale = -q2;
    const double middle = scale > 1e-8 ? 0.5 * q1 / scale : 0, top = q0 + scale * middle * middle;
    if (scale > 1e-8) {
      const double a = x0 - middle, z = x1 - middle;
      const double ea = std::sqrt(std::max(top - scale * a * a, 0.0)),
                   ez = std::sqrt(std::max(top - scale * z * z, 0.0)), root = std::sqrt(scale);
      const double turn = std::atan2(root * z, ez) - std::atan2(root * a, ea);
      const double plain = 0.5 * (z * ez - a * ea + top / root * turn);
      const double moment = -(ez * ez * ez - ea * ea * ea) / (3 * scale);
      sum[0] += side * plain;
      sum[1] += side * (moment + middle * plain);
    } else {
      const double eta = std::sqrt(eta2);
      sum[0] += side * w * eta;
      sum[1] += side * w * x * eta;
    }
    sum[2] += sign * 0.5 * w * (eta2 + q2 * w * w / 12);
  }

  double r2_, length_, h1_, s_, c_, border1_ = 0, border2_ = 0;
};

/// [m] how deep p is under the phalanx' surface; negative outside.
inline double depth_in(const Primitive& phalanx, Vec3 p) {
  const Vec3 axis = phalanx.end2 - phalanx.end1, from = p - phalanx.end1;
  const double square = dot(axis, axis);
  return phalanx.radius1 - norm(from - (square > 0 ? clamp(dot(from, axis) / square, 0, 1) : 0) * axis);
}

inline bool is_cut(const Primitive& phalanx, Vec3 a, Vec3 b, Vec3 c) {
  for (int k = 0; k < phalanx.cut_count; ++k) {
    const HalfSpace& cut = phalanx.cut[static_cast<std::size_t>(k)];
    for (const Vec3 p : {a, b, c}) {
      if (dot(cut.normal, p - cut.point) > 0) return true;
    }
  }
  return false;
}

/// False where they have no area in common. The cut planes bound the phalanx' share of the finger.
inline bool scalar_contact(const Primitive& phalanx, Vec3 a, Vec3 b, Vec3 c, ScalarContact& contact) {
  const Vec3 middle = (a + b + c) / 3.0;
  const double depth = depth_in(phalanx, middle);
  const Vec3 to_a = a - middle, to_b = b - middle, to_c = c - middle;
  const double square = max(dot(to_a, to_a), max(dot(to_b, to_b), dot(to_c, to_c)));
  if (depth < 0 && depth * depth > square) return false;
  const Vec3 raw = cross(b - a, c - a);
  const double doubled = norm(raw);
  if (!(doubled > 0)) return false;
  if (depth > 0 && depth * depth >= square && !is_cut(phalanx, a, b, c)) {
    contact = {0.5 * doubled, depth};
    return true;
  }
  const Vec3 n = raw / doubled;
  const double radius = phalanx.radius1, length = norm(phalanx.end2 - phalanx.end1);
  Vec3 end = phalanx.end1, axis = length > 0 ? (phalanx.end2 - phalanx.end1) / length : Vec3{};
  if (dot(axis, n) < 0) end = phalanx.end2, axis = -axis;
  const double h1 = dot(n, end - a), cosine = dot(axis, n);
  if (h1 > radius || h1 + cosine * length < -radius) return false;
  std::array<Vec3, 5> corner{a - end, b - end, c - end};
  int count = 3;
  for (int k = 0; k < phalanx.cut_count; ++k) {
    const HalfSpace& cut = phalanx.cut[static_cast<std::size_t>(k)];
    std::array<Vec3, 5> kept{};
    int kept_count = 0;
    const double offset = dot(cut.normal, cut.point - end);
    for (int i = 0; i < count; ++i) {
      const Vec3 p = corner[static_cast<std::size_t>(i)],
                 q = corner[static_cast<std::size_t>((i + 1) % count)];
      const double dp = dot(cut.normal, p) - offset, dq = dot(cut.normal, q) - offset;
      if (dp <= 0) kept[static_cast<std::size_t>(kept_count++)] = p;
      if ((dp < 0 && dq > 0) || (dp > 0 && dq < 0))
        kept[static_cast<std::size_t>(kept_count++)] = p + dp / (dp - dq) * (q - p);
    }
    corner = kept;
    count = kept_count;
    if (count < 3) return false;
  }
  const Vec3 sideways = cross(n, axis);
  const double sine = norm(sideways);
  const Vec3 v = sine > 1e-12 ? sideways / sine : unit_or(b - a, {1, 0, 0}), u = cross(v, n);
  const ScalarSection section(radius, length, h1, sine, cosine);
  double sum[3] = {0, 0, 0};
  for (int i = 0; i < count; ++i) {
    const Vec3 p = corner[static_cast<std::size_t>(i)], q = corner[static_cast<std::size_t>((i + 1) % count)];
    section.add_edge(dot(p, u), dot(p, v), dot(q, u), dot(q, v), sum);
  }
  contact.area = -sum[0];
  if (!(contact.area > 1e-12 * radius * radius)) return false;
  const double x = sum[1] / sum[0], y = sum[2] / sum[0];
  contact.depth = depth_in(phalanx, end + x * u + y * v - h1 * n);
  return true;
}

}  // namespace lumbrical::bench
