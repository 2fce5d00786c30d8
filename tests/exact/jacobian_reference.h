// The wrench of the field law from its definition, in any precision, and its central differences: what the
// closed Jacobian is held against. Shares no formula with the engine.
//
// The contacted region is convex. It is swept by rays from a point inside it: each ray ends where phi is zero
// or where an edge or a cut is crossed, and along it phi = max over t of R(t) - |p - c(t)| is integrated by
// Gauss's rule between the points where the best t reaches an end or the axis comes close. The angles at
// which this structure changes are found by bisection.
#pragma once

#include <algorithm>
#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <vector>

#include "model/primitive.h"
#include "reference/vector.h"

namespace lumbrical::test {

using reference::Vector;

template <class Real>
Vector<Real> wide(Vec3 a) {
  return {Real(a.x), Real(a.y), Real(a.z)};
}

/// Everything that moves with the segment.
template <class Real>
struct Body {
  Vector<Real> end1, end2, joint;
  Real radius1, radius2;
  int cut_count = 0;
  std::array<Vector<Real>, 2> cut_normal, cut_point;
};

template <class Real>
Body<Real> body_of(const Primitive& primitive, Vec3 joint) {
  Body<Real> body{wide<Real>(primitive.end1),
                  wide<Real>(primitive.end2),
                  wide<Real>(joint),
                  Real(primitive.radius1),
                  Real(primitive.radius2),
                  primitive.cut_count,
                  {},
                  {}};
  for (std::size_t i = 0; i < primitive.cut_count; ++i) {
    body.cut_normal[i] = unit(wide<Real>(primitive.cut[i].normal));
    body.cut_point[i] = wide<Real>(primitive.cut[i].point);
  }
  return body;
}

/// The body moved by `step` along or about (after the third) axis number `column`, about its joint.
template <class Real>
Body<Real> moved(Body<Real> body, std::size_t column, const Real& step) {
  const std::size_t i = column % 3;
  const Vector<Real> axis{Real(i == 0 ? 1 : 0), Real(i == 1 ? 1 : 0), Real(i == 2 ? 1 : 0)};
  // Exactly a rotation, by 2 atan(step / 2).
  const auto turned = [&](const Vector<Real>& a) {
    const Vector<Real> b = cross(axis, a), c = cross(axis, b);
    const Real k = 1 / (1 + step * step / 4);
    return a + Real(k * step) * b + Real(k * step * step / 2) * c;
  };
  const auto point = [&](const Vector<Real>& a) {
    return column < 3 ? a + step * axis : body.joint + turned(a - body.joint);
  };
  Body<Real> result = body;
  result.end1 = point(body.end1);
  result.end2 = point(body.end2);
  result.joint = point(body.joint);
  for (std::size_t k = 0; k < static_cast<std::size_t>(body.cut_count); ++k) {
    result.cut_point[k] = point(body.cut_point[k]);
    if (column >= 3) result.cut_normal[k] = turned(body.cut_normal[k]);
  }
  return result;
}

/// phi, its derivative along a direction, and which sphere is the nearest: of an end or between.
template <class Real>
struct FieldAt {
  Real value, slope;
  int part;
};

template <class Real>
class FieldWrench {
 public:
  FieldWrench(const Body<Real>& body, const std::array<Vec3, 3>& corner, int nodes)
      : body_(body), nodes_(nodes) {
    using std::sqrt;
    for (std::size_t i = 0; i < 3; ++i) corner_[i] = wide<Real>(corner[i]);
    n_ = unit(cross(corner_[1] - corner_[0], corner_[2] - corner_[0]));
    e1_ = unit(corner_[1] - corner_[0]);
    e2_ = cross(n_, e1_);
    axis_ = body.end2 - body.end1;
    length_ = sqrt(dot(axis_, axis_));
    if (length_ > 0) axis_ = Real(1 / length_) * axis_;
    slope_ = length_ > 0 ? Real((body.radius2 - body.radius1) / length_) : Real(0);
    tan_ = slope_ / sqrt((1 - slope_) * (1 + slope_));
    for (std::size_t i = 0; i < 3; ++i)
      walls_.push_back({cross(corner_[(i + 1) % 3] - corner_[i], n_), corner_[i]});
    for (std::size_t i = 0; i < static_cast<std::size_t>(body.cut_count); ++i)
      walls_.push_back({body.cut_normal[i], body.cut_point[i]});
  }

  /// The point to sweep from: 1 where the axis pierces the plane, 2 and 3 the foot of an end, if that is well
  /// inside, otherwise 0, the centroid. A moved body must be swept from the same one.
  [[nodiscard]] int choose_centre() const {
    const Real h1 = dot(n_, body_.end1 - corner_[0]), h2 = dot(n_, body_.end2 - corner_[0]);
    for (const int which : {1, 2, 3}) {
      if (which == 1 && !(h1 * h2 < 0)) continue;
      const Vector<Real> p = centre(which, {});
      bool inside = field(p, n_).value > body_.radius1 / 20;
      for (const Wall& wall : walls_) {
        inside = inside && dot(unit(wall.normal), p - wall.point) < -body_.radius1 / 20;
      }
      if (inside) return which;
    }
    return 0;
  }

  /// (force, torque about the joint) / K_s.
  std::array<Real, 6> integrate(int which_centre, Vec3 centroid) {
    centre_ = centre(which_centre, centroid);
    std::array<Real, 6> sum{};
    const std::vector<Real> breaks = angle_breaks();
    for (std::size_t i = 0; i + 1 < breaks.size(); ++i) {
      gauss(breaks[i], breaks[i + 1], [&](const Real& angle, const Real& weight) {
        const Ray ray = ray_at(angle);
        for (std::size_t k = 0; k + 1 < ray.split.size(); ++k) {
          gauss(ray.split[k], ray.split[k + 1],
                [&](const Real& s, const Real& w) { add(ray, s, weight * w, sum); });
        }
      });
    }
    return sum;
  }

 private:
  struct Wall {
    Vector<Real> normal, point;
  };
  struct Ray {
    Vector<Real> direction;
    std::vector<Real> split;  // from 0 to its end
    std::vector<int> structure;
  };

  template <class F>
  void gauss(const Real& from, const Real& to, F&& f) const {
    if (nodes_ <= 15) return rule<15>(from, to, f);
    return rule<25>(from, to, f);
  }
  template <unsigned N, class F>
  static void rule(const Real& from, const Real& to, F&& f) {
    using Gauss = boost::math::quadrature::gauss<Real, N>;
    const Real middle = (from + to) / 2, half = (to - from) / 2;
    for (std::size_t i = 0; i < Gauss::abscissa().size(); ++i) {
      const Real at = Gauss::abscissa()[i], weight = half * Gauss::weights()[i];
      f(Real(middle + half * at), weight);
      if (at != 0) f(Real(middle - half * at), weight);
    }
  }

  FieldAt<Real> field(const Vector<Real>& p, const Vector<Real>& direction) const {
    using std::sqrt;
    const Vector<Real> from = p - body_.end1;
    Real best = 0;
    int part = 0;
    if (length_ > 0) {
      const Vector<Real> off = cross(from, axis_);
      best = dot(from, axis_) + tan_ * sqrt(dot(off, off));
      part = best <= 0 ? 0 : best >= length_ ? 2 : 1;
      best = part == 0 ? Real(0) : part == 2 ? length_ : best;
    }
    const Vector<Real> away = from - best * axis_;
    const Real distance = sqrt(dot(away, away));
    return {body_.radius1 + slope_ * best - distance, -dot(away, direction) / distance, part};
  }

  [[nodiscard]] Vector<Real> centre(int which, Vec3 centroid) const {
    const Real h1 = dot(n_, body_.end1 - corner_[0]), rate = dot(n_, axis_);
    if (which == 1) return body_.end1 - Real(h1 / rate) * axis_;
    if (which == 2) return body_.end1 - h1 * n_;
    if (which == 3) return body_.end2 - dot(n_, body_.end2 - corner_[0]) * n_;
    return wide<Real>(centroid);
  }

  // Newton's method from outside: phi is concave, so it comes down on its root from above.
  Real exit_of_solid(const Vector<Real>& direction) const {
    using std::abs;
    Real s = body_.radius1 + body_.radius2 + length_;
    for (int i = 0; i < 60; ++i) {
      const FieldAt<Real> at = field(centre_ + s * direction, direction);
      const Real step = at.value / at.slope;
      s -= step;
      if (abs(step) < 4 * std::numeric_limits<Real>::epsilon() * s) break;
    }
    return s;
  }

  Ray ray_at(const Real& angle) const {
    using std::cos;
    using std::sin;
    Ray ray{Real(cos(angle)) * e1_ + Real(sin(angle)) * e2_, {Real(0)}, {}};
    Real end = exit_of_solid(ray.direction);
    int by = -1;
    for (std::size_t i = 0; i < walls_.size(); ++i) {
      const Real rate = dot(walls_[i].normal, ray.direction);
      if (!(rate > 0)) continue;
      const Real s = dot(walls_[i].normal, walls_[i].point - centre_) / rate;
      if (s < end) end = s, by = static_cast<int>(i);
    }
    ray.structure.push_back(by);
    std::vector<Real> changes;
    split(ray.direction, end, changes, ray.split);
    std::sort(changes.begin(), changes.end());
    changes.insert(changes.begin(), Real(0));
    changes.push_back(end);
    for (std::size_t i = 0; i + 1 < changes.size(); ++i) {
      const int part = field(centre_ + Real((changes[i] + changes[i + 1]) / 2) * ray.direction, n_).part;
      if (ray.structure.size() < 2 || ray.structure.back() != part) ray.structure.push_back(part);
    }
    ray.split.insert(ray.split.end(), changes.begin() + 1, changes.end());
    std::sort(ray.split.begin(), ray.split.end());
    return ray;
  }

  // Where along a ray the nearest sphere becomes that of an end, and where the axis or an end is close.
  void split(const Vector<Real>& direction, const Real& end, std::vector<Real>& changes,
             std::vector<Real>& splits) const {
    using std::sqrt;
    const auto keep = [&](const Real& s, std::vector<Real>& list) {
      if (s > end / 1000000 && s < end - end / 1000000) list.push_back(s);
    };
    const auto close = [&](const Real& a, const Real& b, const Real& c) {
      if (!(a > end / 1000000000)) return;
      const Real at = -b / a, square = c / a - at * at;
      const Real off = square > 0 ? Real(sqrt(square)) : Real(0);
      keep(at, splits);
      for (Real d = std::max(off, Real(end / 100000)); d < end && off > end / 1000000000; d *= 5) {
        keep(at + d, splits);
        keep(at - d, splits);
      }
    };
    const Vector<Real> from = centre_ - body_.end1;
    close(Real(1), dot(from, direction), dot(from, from));
    if (!(length_ > 0)) return;
    const Vector<Real> from2 = centre_ - body_.end2;
    close(Real(1), dot(from2, direction), dot(from2, from2));
    const Vector<Real> turn = cross(direction, axis_), arm = cross(from, axis_);
    close(dot(turn, turn), dot(turn, arm), dot(arm, arm));
    // at + off tan = end, squared.
    const Real rate = dot(direction, axis_);
    for (const int which : {0, 1}) {
      const Real gap = which * length_ - dot(from, axis_), tt = tan_ * tan_;
      const Real a = tt * dot(turn, turn) - rate * rate, b = tt * dot(turn, arm) + rate * gap,
                 c = tt * dot(arm, arm) - gap * gap;
      if (tt == 0) {
        if (rate != 0) keep(gap / rate, changes);
        continue;
      }
      const Real square = b * b - a * c;
      if (!(square > 0) || a == 0) continue;
      keep((-b - sqrt(square)) / a, changes);
      keep((-b + sqrt(square)) / a, changes);
    }
  }

  // Angles between which the structure of rays stays the same, no more than an eighth of a turn apart.
  std::vector<Real> angle_breaks() const {
    constexpr int kSamples = 120;
    const Real turn = 2 * boost::math::constants::pi<Real>();
    const Real fine = turn / 1e15L;  // what is misplaced by so little counts squared
    std::vector<Real> breaks{Real(0)};
    std::vector<int> before = ray_at(Real(0)).structure;
    for (int i = 1; i <= kSamples; ++i) {
      Real low = turn * (i - 1) / kSamples;
      const Real end = turn * i / kSamples;
      const std::vector<int> after = ray_at(end).structure;
      while (before != after) {  // possibly several changes between two samples
        Real high = end;
        while (high - low > fine) {
          const Real middle = (low + high) / 2;
          (ray_at(middle).structure == before ? low : high) = middle;
        }
        breaks.push_back((low + high) / 2);
        before = ray_at(high).structure;
        low = high;
      }
      if (i % (kSamples / 8) == 0) breaks.push_back(end);
    }
    std::sort(breaks.begin(), breaks.end());
    return breaks;
  }

  void add(const Ray& ray, const Real& s, const Real& weight, std::array<Real, 6>& sum) const {
    const Vector<Real> p = centre_ + s * ray.direction;
    const Real share = weight * s * field(p, n_).value;
    const Vector<Real> moment = cross(p - body_.joint, n_);
    sum[0] += share * n_.x;
    sum[1] += share * n_.y;
    sum[2] += share * n_.z;
    sum[3] += share * moment.x;
    sum[4] += share * moment.y;
    sum[5] += share * moment.z;
  }

  Body<Real> body_;
  int nodes_;
  std::array<Vector<Real>, 3> corner_;
  Vector<Real> n_, e1_, e2_, axis_, centre_;
  Real length_, slope_, tan_;
  std::vector<Wall> walls_;
};

/// The Jacobian over K_s by central differences with a step of `step` radii and radians. `centroid` [m] is
/// any point well inside the contacted area; `nodes` is 15 or 25, per interval.
template <class Real>
Matrix6 reference_jacobian(const Primitive& primitive, Vec3 joint, const std::array<Vec3, 3>& corner,
                           Vec3 centroid, const Real& step, int nodes) {
  const Body<Real> body = body_of<Real>(primitive, joint);
  const int centre = FieldWrench<Real>(body, corner, nodes).choose_centre();
  Matrix6 result;
  for (std::size_t k = 0; k < 6; ++k) {
    const Real h = k < 3 ? Real(step * body.radius1) : step;
    const auto wrench = [&](const Real& by) {
      return FieldWrench<Real>(moved(body, k, by), corner, nodes).integrate(centre, centroid);
    };
    const std::array<Real, 6> ahead = wrench(h), behind = wrench(-h);
    for (std::size_t i = 0; i < 6; ++i) {
      result[i][k] = static_cast<double>(Real((ahead[i] - behind[i]) / (2 * h)));
    }
  }
  return result;
}

}  // namespace lumbrical::test
