#include "accuracy_pairs.h"

#include <algorithm>
#include <cmath>

#include "contact_pairs.h"

namespace lumbrical::bench {
namespace {

using test::kPi;
using test::power_of_ten;

Vec3 draw_axis(Angle angle, test::Random& random) {
  if (angle == Angle::any) return random.direction();
  const double turn = random.between(0, 2 * kPi), sign = random.bits() % 2 == 0 ? 1 : -1;
  const double small = random.bits() % 4 == 0 ? 0 : power_of_ten(random, -15, -2);
  const double large = std::sqrt((1 - small) * (1 + small));
  const double across = angle == Angle::lying ? large : small, along = angle == Angle::lying ? small : large;
  return {across * std::cos(turn), across * std::sin(turn), sign * along};
}

void draw_shape(Form form, Angle angle, test::Random& random, Pair& pair) {
  Primitive& primitive = pair.primitive;
  const double radius = random.between(0.004, 0.012);
  const double length = form == Form::sphere ? 0 : radius * power_of_ten(random, -1, 1);
  primitive.shape = form == Form::cylinder ? Shape::flat : Shape::round;
  primitive.radius1 = primitive.radius2 = pair.radius = radius;
  primitive.end2 = length * draw_axis(angle, random);
  if (form != Form::cone) return;
  const double most = 0.99 * std::min(length, radius);
  primitive.radius2 -= most * (random.bits() % 4 == 0 ? power_of_ten(random, -12, 0) : random.between(0, 1));
  if (random.bits() % 2 == 0) std::swap(primitive.end1, primitive.end2);
}

/// How far the primitive reaches down from an end's centre.
double down_from(const Primitive& primitive, double radius) {
  if (primitive.shape == Shape::round) return radius;
  const Vec3 axis = primitive.end2 - primitive.end1;
  return radius * std::hypot(axis.x, axis.y) / norm(axis);
}

/// Moves the primitive so that its lowest point is somewhere below the plane z = 0; says how far.
double draw_depth(test::Random& random, Pair& pair) {
  Primitive& primitive = pair.primitive;
  const double down1 = down_from(primitive, primitive.radius1),
               down2 = down_from(primitive, primitive.radius2);
  const double lowest = std::min(primitive.end1.z - down1, primitive.end2.z - down2);
  const double highest = std::max(primitive.end1.z + down1, primitive.end2.z + down2);
  const double depth = std::min(2 * pair.radius * power_of_ten(random, -6.3, 0), 0.98 * (highest - lowest));
  const Vec3 shift{0, 0, -depth - lowest};
  primitive.end1 += shift;
  primitive.end2 += shift;
  return depth;
}

bool holds(const Primitive& primitive, Vec3 p) {
  const Vec3 axis = primitive.end2 - primitive.end1, from = p - primitive.end1;
  const double length = norm(axis);
  if (length == 0) return norm(from) < primitive.radius1;
  const double q = dot(from, axis) / length, off = norm(cross(from, axis)) / length;
  if (primitive.shape == Shape::flat) return q > 0 && q < length && off < primitive.radius1;
  const double sine = (primitive.radius2 - primitive.radius1) / length;
  const double t = std::clamp(q + off * sine / std::sqrt(1 - sine * sine), 0.0, length);
  return primitive.radius1 + sine * t > std::hypot(off, q - t);
}

/// A point of the section: some tries round the axis and round the lowest end, then what lies above the
/// lowest point.
Vec3 draw_inside(const Primitive& primitive, double reach, test::Random& random) {
  const double down1 = down_from(primitive, primitive.radius1),
               down2 = down_from(primitive, primitive.radius2);
  const bool first = primitive.end1.z - down1 <= primitive.end2.z - down2;
  const Vec3 low = first ? primitive.end1 : primitive.end2, high = first ? primitive.end2 : primitive.end1;
  Vec3 lowest = low;
  if (primitive.shape == Shape::flat) {
    const Vec3 axis = unit_or(high - low, {0, 0, 1});
    lowest += primitive.radius1 * unit_or(axis.z * axis - Vec3{0, 0, 1}, {});
  }
  for (int i = 0; i < 40; ++i) {
    const Vec3 near = i % 2 == 0 ? low + random.between(-0.3, 1.3) * (high - low) : lowest;
    const Vec3 p{near.x + random.between(-reach, reach), near.y + random.between(-reach, reach), 0};
    if (holds(primitive, p)) return p;
  }
  return {lowest.x, lowest.y, 0};
}

/// A triangle of the plane z = 0 that has `inside` within it, or next to one of its edges or corners.
void draw_triangle(Vec3 inside, double reach, test::Random& random, Pair& pair) {
  const double size = pair.radius * power_of_ten(random, -3, 3);
  const double first = random.between(0, 2 * kPi);
  const double angles[] = {first, first + random.between(0.2, 2.9), first + random.between(3.3, 6.0)};
  const double thin = random.bits() % 4 == 0 ? power_of_ten(random, -3, 0) : 1;
  const double turn = random.between(0, 2 * kPi), c = std::cos(turn), s = std::sin(turn);
  std::array<Vec3, 3> local;
  for (int i = 0; i < 3; ++i) {
    const double far = size * random.between(0.4, 1);
    const double x = far * std::cos(angles[i]), y = far * thin * std::sin(angles[i]);
    local[i] = {c * x - s * y, s * x + c * y, 0};
  }
  double weight[3] = {random.between(0, 1), random.between(0, 1), random.between(0, 1)};
  const std::uint64_t where = random.bits() % 3;  // anywhere, at an edge, at a corner
  if (where > 0) weight[0] = 0;
  if (where > 1) weight[1] = 0;
  const double sum = weight[0] + weight[1] + weight[2];
  Vec3 anchor = (1 / sum) * (weight[0] * local[0] + weight[1] * local[1] + weight[2] * local[2]);
  const double beside = 0.8 * std::min(reach, size);
  if (where > 0) anchor += Vec3{random.between(-beside, beside), random.between(-beside, beside), 0};
  for (int i = 0; i < 3; ++i) pair.corners[i] = local[i] - anchor + inside;
}

}  // namespace

Pair draw_pair(Form form, Angle angle, test::Random& random) {
  Pair pair;
  draw_shape(form, angle, random, pair);
  const double depth = std::min(draw_depth(random, pair), pair.radius);
  const double reach = std::sqrt(depth * (2 * pair.radius - depth));
  draw_triangle(draw_inside(pair.primitive, reach, random), reach, random, pair);
  if (random.bits() % 2 == 0) return pair;
  const Pose anywhere = random.pose(0.5);
  pair.primitive.end1 = transform(anywhere, pair.primitive.end1);
  pair.primitive.end2 = transform(anywhere, pair.primitive.end2);
  for (Vec3& corner : pair.corners) corner = transform(anywhere, corner);
  return pair;
}

reference::Solid to_reference(const Primitive& primitive) {
  reference::Solid solid;
  solid.flat = primitive.shape == Shape::flat;
  solid.end1 = test::to_reference(primitive.end1), solid.end2 = test::to_reference(primitive.end2);
  solid.radius1 = primitive.radius1, solid.radius2 = primitive.radius2;
  return solid;
}

reference::Triangle to_reference(const std::array<Vec3, 3>& corners) { return test::to_reference(corners); }

std::string describe(const Pair& pair) {
  return test::describe(to_reference(pair.primitive), test::to_reference(pair.corners));
}

}  // namespace lumbrical::bench
