// What felt once means, computed otherwise: the field of the deepest body at each point, by the centroids of
// small pieces, or, where that must be right to many digits, along rays.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <vector>

#include "base/gauss.h"
#include "exact/finger_reference.h"
#include "largest.h"
#include "lumbrical/model.h"
#include "lumbrical/tick.h"
#include "model/corners.h"
#include "model/primitive.h"

namespace lumbrical::test {

inline constexpr std::size_t kBodies = kFingerCount + 1, kPalmBody = kFingerCount;
using BodyForces = std::array<Vec3, kBodies>;

inline double palm_reference(const SweptPolygon& palm, Vec3 p) {
  const double height = dot(p - palm.corner[0], palm.normal);
  const Vec3 foot = p - height * palm.normal;
  bool outside = false;
  double aside = 1e300;
  for (std::size_t k = 0; k < palm.corner_count; ++k) {
    const Vec3 a = palm.corner[k], b = palm.corner[(k + 1) % palm.corner_count];
    outside = outside || dot(foot - a, palm.outward[k]) > 0;
    const double t = std::clamp(dot(foot - a, b - a) / dot(b - a, b - a), 0.0, 1.0);
    aside = std::min(aside, norm(foot - (a + t * (b - a))));
  }
  return palm.radius - std::hypot(height, outside ? aside : 0);
}

// The fields of fingers and palm at a point.
using FieldOfBodies = std::array<double, kBodies>;
inline std::size_t deepest_of(const FieldOfBodies& field) {
  return static_cast<std::size_t>(std::max_element(field.begin(), field.end()) - field.begin());
}
class BodyFields {
 public:
  explicit BodyFields(const Primitives& hand) : palm_(hand.palm) {
    for (std::size_t i = 0; i < kPhalanxCount; ++i) {
      const Primitive& phalanx = hand.capsule[i];
      if (hand.present[i])
        finger_[i / 3].push_back({phalanx.end1, phalanx.end2, phalanx.radius1, phalanx.radius2});
    }
  }
  [[nodiscard]] FieldOfBodies at(Vec3 p) const {
    FieldOfBodies field;
    for (std::size_t i = 0; i < kFingerCount; ++i)
      field[i] = finger_[i].empty() ? -1 : finger_field(finger_[i], p);
    field[kPalmBody] = palm_.corner_count > 0 ? palm_reference(palm_, p) : -1;
    return field;
  }

 private:
  std::array<std::vector<ReferenceCapsule>, kFingerCount> finger_;
  const SweptPolygon& palm_;
};

// By the centroids of pieces of 0.15 mm, of a stiffness of 1: each piece to the deepest body, or to all.
struct Reference {
  BodyForces once{}, by_all{};
};
inline Reference reference_of(const Model& model, const Primitives& hand) {
  const BodyFields fields(hand);
  Reference reference;
  for (std::uint32_t i = 0; i < model.triangles.size(); ++i) {
    const auto [at_a, at_b, at_c] = corners_of(model.triangles, i);
    const Vec3 a = at_a, b = at_b, c = at_c;
    const Vec3 middle = (a + b + c) / 3.0;
    const double size = std::max({norm(a - middle), norm(b - middle), norm(c - middle)});
    const auto there = fields.at(middle);
    if (*std::max_element(there.begin(), there.end()) < -size) continue;
    const int cuts = static_cast<int>(std::ceil(size / 1.5e-4));
    const Vec3 piece = 0.5 / (cuts * cuts) * cross(b - a, c - a);
    const auto add = [&](double u, double v) {
      const auto field = fields.at(a + u / cuts * (b - a) + v / cuts * (c - a));
      const std::size_t deepest = deepest_of(field);
      for (std::size_t k = 0; k < kBodies; ++k) {
        const Vec3 force = std::max(0.0, field[k]) * piece;
        reference.by_all[k] += force;
        if (k == deepest) reference.once[k] += force;
      }
    };
    for (int u = 0; u < cuts; ++u) {
      for (int v = 0; u + v < cuts; ++v) {
        add(u + 1.0 / 3, v + 1.0 / 3);
        if (u + v + 1 < cuts) add(u + 2.0 / 3, v + 2.0 / 3);
      }
    }
  }
  return reference;
}

// The fields of the deepest bodies on a ray from a triangle's corner, by Simpson's rule on parts that are
// halved until they are right, or next to nothing: where another body begins to be the deepest one.
class OnRay {
 public:
  OnRay(const BodyFields& fields, Vec3 from, Vec3 to) : fields_(fields), from_(from), to_(to) {}

  /// [m] Integrals of field r dr, r from 0 to 1.
  [[nodiscard]] FieldOfBodies integral() const {
    constexpr int kParts = 256;
    FieldOfBodies sum{};
    for (int i = 0; i < kParts; ++i) {
      const double begin = i / double(kParts), width = 1 / double(kParts);
      add_to(sum, begin, width, {felt(begin), felt(begin + width / 2), felt(begin + width)}, 1e-14);
    }
    return sum;
  }

 private:
  [[nodiscard]] FieldOfBodies felt(double t) const {
    const FieldOfBodies all = fields_.at(from_ + t * (to_ - from_));
    const std::size_t deepest = deepest_of(all);
    FieldOfBodies one{};
    one[deepest] = t * std::max(0.0, all[deepest]);
    return one;
  }
  void add_to(FieldOfBodies& sum, double begin, double width, const std::array<FieldOfBodies, 3>& at,
              double most) const {
    const FieldOfBodies first = felt(begin + width / 4), second = felt(begin + 3 * width / 4);
    FieldOfBodies value;
    double change = 0;
    for (std::size_t k = 0; k < kBodies; ++k) {
      value[k] = width / 12 * (at[0][k] + 4 * first[k] + 2 * at[1][k] + 4 * second[k] + at[2][k]);
      change = std::max(change, std::fabs(value[k] - width / 6 * (at[0][k] + 4 * at[1][k] + at[2][k])));
    }
    if (change > most && width > 1e-12) {
      add_to(sum, begin, width / 2, {at[0], first, at[1]}, most);
      add_to(sum, begin + width / 2, width / 2, {at[1], second, at[2]}, most);
    } else {
      for (std::size_t k = 0; k < kBodies; ++k) sum[k] += value[k];
    }
  }

  const BodyFields& fields_;
  Vec3 from_, to_;
};

// By rays to each triangle's shortest edge, of a stiffness of 1.
inline BodyForces reference_by_rays(const Model& model, const Primitives& hand) {
  const BodyFields fields(hand);
  BodyForces sum{};
  for (std::uint32_t i = 0; i < model.triangles.size(); ++i) {
    auto [a, b, c] = corners_of(model.triangles, i);
    while (norm(c - b) > std::min(norm(b - a), norm(a - c))) std::tie(a, b, c) = std::tuple(b, c, a);
    for (const auto [at, weight] : kGauss12) {
      const auto field = OnRay(fields, a, b + at * (c - b)).integral();
      for (std::size_t k = 0; k < kBodies; ++k) sum[k] += weight * field[k] * cross(b - a, c - a);
    }
  }
  return sum;
}

inline BodyForces by_bodies(const HandForces& forces, double stiffness) {
  BodyForces sum{};
  for (std::size_t i = 0; i < kSegmentCount; ++i) sum[i / 3] += forces.segment[i].force / stiffness;
  return sum;
}

// Of the hand's force, and of the worst body's, as a share of what bodies feel together.
struct Difference {
  double hand = 0, body = 0;
};
inline Difference body_difference(const BodyForces& one, const BodyForces& other) {
  Vec3 sum;
  double size = 0;
  Difference difference;
  for (std::size_t k = 0; k < kBodies; ++k) {
    sum += one[k] - other[k];
    size += norm(other[k]);
    difference.body = largest(difference.body, norm(one[k] - other[k]));
  }
  return {norm(sum) / size, difference.body / size};
}

}  // namespace lumbrical::test
