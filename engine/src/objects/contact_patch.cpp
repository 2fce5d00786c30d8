#include "objects/contact_patch.h"

#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "base/gauss.h"
#include "base/share_along.h"

namespace lumbrical {
namespace {

/// A phalanx over a plane, seen along it at right angles to the axis: its ends over the plane, `length` apart
/// on it. What lies beyond a joint is the neighbour's.
struct Outline {
  double height1 = 0, height2 = 0, length = 0;  // [m]
  double radius1 = 0, radius2 = 0;
  bool open1 = true, open2 = true;  ///< the sphere at the end is its own
  double axis_square = 0;

  [[nodiscard]] double share_at(double u) const {  // of the axis, unclamped
    if (!(axis_square > 1e-18)) return 0;
    return (u * length - height1 * (height2 - height1)) / axis_square;
  }
};

struct Inside {
  double low = 1e300, high = -1e300;
  void add(double u) {
    low = min(low, u);
    high = max(high, u);
  }
};

// Where the circle at an end, or the straight side from (a, at height p) to (b, q), crosses the plane.
void add_circle(double u, double height, double radius, Inside& inside) {
  const double square = radius * radius - height * height;
  if (!(square > 0)) return;
  inside.add(u - std::sqrt(square));
  inside.add(u + std::sqrt(square));
}
void add_side(double a, double p, double b, double q, Inside& inside) {
  if ((p < 0) == (q < 0)) return;
  inside.add(a + (b - a) * (p / (p - q)));
}

Inside inside_of(const Outline& o) {
  Inside inside;
  add_circle(0, o.height1, o.radius1, inside);
  add_circle(o.length, o.height2, o.radius2, inside);
  if (o.axis_square > 1e-18) {
    const double size = std::sqrt(o.axis_square), x = (o.height1 - o.height2) / size, y = o.length / size;
    for (const double side : {1.0, -1.0}) {
      const double r1 = side * o.radius1, r2 = side * o.radius2;
      add_side(r1 * x, o.height1 + r1 * y, o.length + r2 * x, o.height2 + r2 * y, inside);
    }
  }
  return inside;
}

/// The field across the axis at u: of a point v beside it phi is radius - sqrt(square + v^2), and lowering
/// the outline lets it grow by turning + height / sqrt(square + v^2).
struct Line {
  double radius = 0, square = 0, height = 0, turning = 0;
  double half = 0;  ///< phi is above 0 on both sides up to here [m]
};
Line line_at(const Outline& o, double u) {
  const double share = o.share_at(u), t = clamp(share, 0, 1), rise = o.height2 - o.height1;
  const double x = u - t * o.length, y = o.height1 + t * rise,
               radius = o.radius1 + t * (o.radius2 - o.radius1);
  const double square = x * x + y * y, left = radius * radius - square;
  const double turning =
      t == share && o.axis_square > 1e-18 ? rise / o.axis_square * (o.radius2 - o.radius1) : 0;
  return {radius, square, y, turning, left > 0 ? std::sqrt(left) : 0};
}

/// Integrals of phi over the plane: of itself, times u, and by how much the first grows a metre of depth,
/// where the cuts at joints stay, and because they move.
struct PlaneSums {
  double volume = 0, first = 0, growth = 0, growth_at_cuts = 0;
};
void add_line(const Line& line, double u, double weight, PlaneSums& sums) {
  if (!(line.half > 0)) return;
  double volume = 0, nearness = 0;
  for (const auto [at, share] : kGauss3) {
    const double v = line.half * at, distance = std::sqrt(line.square + v * v);
    volume += share * (line.radius - distance);
    nearness += share / distance;
  }
  const double area = 2 * line.half * weight;
  sums.volume += area * volume;
  sums.first += area * volume * u;
  sums.growth += area * (line.turning + line.height * nearness);
}

// The flattest angle [rad] between the axis and the plane's normal at which cuts are still where the axis'
// ends are: below it they would go from one side of a phalanx to the other within a few um of depth.
constexpr double kSteepestCut = 0.03;

/// The axis' shadow: where phi is above 0, parted where the nearest point of the axis becomes an end. Cuts go
/// along it as the outline is lowered.
struct Shadow {
  std::array<double, 4> mark{};  ///< ascending [m]
  double cut_speed = 0;          ///< per depth
};
Shadow shadow_of(const Outline& o) {
  const Inside inside = inside_of(o);
  const double longest = std::sqrt(o.axis_square), steepest = max(o.length, kSteepestCut * longest);
  const double slope = steepest > 0 ? (o.height2 - o.height1) / steepest : 0;
  return {{inside.low, clamp(slope * o.height1, inside.low, inside.high),
           clamp(o.length + slope * o.height2, inside.low, inside.high), inside.high},
          -slope};
}

// Calls visit(from, to) for the pieces of the shadow that are not a neighbour's, spheres' in two halves: they
// are deepest, and may have a kink, in their middle.
template <class Visit>
void visit_pieces(const Outline& o, const Shadow& shadow, const Visit& visit) {
  const auto visit_halves = [&](double from, double middle, double to) {
    middle = clamp(middle, from, to);
    if (middle > from) visit(from, middle);
    if (to > middle) visit(middle, to);
  };
  const auto& [low, cut1, cut2, high] = shadow.mark;
  if (o.open1) visit_halves(low, 0, cut1);
  if (cut2 > cut1) visit(cut1, cut2);
  if (o.open2) visit_halves(cut2, o.length, high);
}

// What the field gains as the outline is lowered because a cut at an end moves along the axis' shadow.
double growth_at_cuts(const Outline& o, const Shadow& shadow) {
  PlaneSums at1, at2;
  if (!o.open1) add_line(line_at(o, shadow.mark[1]), 0, 1, at1);
  if (!o.open2) add_line(line_at(o, shadow.mark[2]), 0, 1, at2);
  return shadow.cut_speed * (at2.volume - at1.volume);
}

PlaneSums sums_over(const Outline& o) {
  PlaneSums sums;
  const Shadow shadow = shadow_of(o);
  visit_pieces(o, shadow, [&](double from, double to) {
    for (const auto [at, share] : kGauss5) {
      const double u = from + (to - from) * at;
      add_line(line_at(o, u), u, (to - from) * share, sums);
    }
  });
  sums.growth_at_cuts = growth_at_cuts(o, shadow);
  return sums;
}

// The integral of phi times the distance from the point `about`, where that has a kink.
double moment_about(const Outline& o, double about) {
  double sum = 0;
  const auto add_piece = [&](double from, double to) {
    if (!(to > from)) return;
    for (const GaussNode& node : kGauss4) {
      const double u = from + (to - from) * node.at, along = u - about;
      const Line line = line_at(o, u);
      double moment = 0;
      for (const auto [at, share] : kGauss3) {
        const double v = line.half * at, phi = line.radius - std::sqrt(line.square + v * v);
        moment += share * phi * std::sqrt(along * along + v * v);
      }
      sum += 2 * line.half * (to - from) * node.weight * moment;
    }
  };
  visit_pieces(o, shadow_of(o), [&](double from, double to) {
    const double middle = clamp(about, from, to);
    add_piece(from, middle);
    add_piece(middle, to);
  });
  return sum;
}

Outline lowered(const Outline& o, double by) {
  Outline result = o;
  result.height1 -= by;
  result.height2 -= by;
  return result;
}

/// An outline pushed into the plane [m], and its sums there.
struct Pressed {
  double depth = 0;
  PlaneSums sums;
};

// How far below `touching`, where the outline just meets the plane, it is pushed `volume` [m^3] hard; no
// deeper than `deepest`. The root of the volume is nearly a straight line, so few of Newton's steps do.
Pressed press_into(const Outline& touching, const Pressed& deepest, double volume) {
  const double wanted = std::sqrt(volume), share = wanted / std::sqrt(deepest.sums.volume);
  if (!(share < 1)) return deepest;
  Pressed pressed;
  pressed.depth = deepest.depth * share * std::sqrt(1 / (3 - 1.15 * share));  // a sphere's, within 1 %
  double low = 0, high = deepest.depth;
  for (int step = 0; step < 12; ++step) {
    pressed.sums = sums_over(lowered(touching, pressed.depth));
    const double root = std::sqrt(pressed.sums.volume), miss = root - wanted;
    if (std::fabs(miss) < 1e-5 * wanted) break;
    (miss < 0 ? low : high) = pressed.depth;
    const double next = pressed.depth - 2 * root * miss / (pressed.sums.growth + pressed.sums.growth_at_cuts);
    pressed.depth = next > low && next < high ? next : 0.5 * (low + high);
  }
  return pressed;
}

// What a cut takes from a phalanx its neighbour gains, so to the object cuts are no stiffness, but tell whose
// it is. Where the axis is steep they would be a thousand times what there is. So they add no more than all
// of it, and take no more than half: with less, a step that rests on it would not be stable.
double bounded_growth(const PlaneSums& sums) {
  const double all = max(0, sums.growth);
  return sums.growth + clamp(sums.growth_at_cuts, -0.5 * all, all);
}

// How much more a pad presses per metre of depth, over its field's stiffness [m^2].
double growth_of(const Outline& pressed, const PlaneSums& field, const Pad& pad) {
  double growth = bounded_growth(field);
  for (const PadLayer& layer : pad.layer) {
    if (layer.stiffness == 0) continue;
    Outline inner = pressed;
    inner.radius1 *= 1 - layer.from;
    inner.radius2 *= 1 - layer.from;
    growth += layer.stiffness * bounded_growth(sums_over(inner));
  }
  return growth;
}

// The point of the line of action nearest the base joint.
Vec3 on_line_of_action(Vec3 joint, const Wrench& wrench, double square) {
  return joint + cross(wrench.force, wrench.torque) / square;
}

// Where faces push opposite ways the line of action may pass far from what they push: it has to stay within
// a distance of an axis, seen along the line.
Vec3 within(double distance, Vec3 end1, Vec3 end2, Vec3 along, Vec3 point) {
  const auto flat = [&](Vec3 v) { return v - dot(along, v) * along; };
  const Vec3 axis = flat(end2 - end1), offset = flat(point - end1);
  const Vec3 away = offset - share_along(axis, offset) * axis;
  const double beyond = norm(away);
  return beyond > distance ? point + (distance / beyond - 1) * away : point;
}

struct Ball {
  Vec3 middle;
  double radius = 0;
};
Ball ball_around(const SweptPolygon& palm) {
  const std::span corners(palm.corner.data(), palm.corner_count);
  Ball ball;
  for (const Vec3 corner : corners) ball.middle += (1.0 / palm.corner_count) * corner;
  for (const Vec3 corner : corners) ball.radius = max(ball.radius, norm(corner - ball.middle));
  ball.radius += palm.radius;
  return ball;
}

// The least cosine of the angle between a line of action and the palm's normal for the patch to be moved
// along that line onto the palm's skin; below it, the less the flatter the line is.
constexpr double kSteepLine = 0.3;

void take_palm(const SweptPolygon& palm, double stiffness, const Pad& pad, ContactPatch& patch) {
  const double across = dot(patch.normal, palm.normal);
  const double side = across < 0 ? 1.0 : -1.0;  // the palm is pushed on the side that looks at the object
  const Vec3 skin = palm.corner[0] + (side * palm.radius) * palm.normal;
  const double height = dot(palm.normal, skin - patch.centre);
  const double way =
      std::fabs(across) > kSteepLine ? height / across : height * (across / (kSteepLine * kSteepLine));
  patch.centre += way * patch.normal;
  patch.radius = 8.0 / 15 * palm.radius;
  double hardness = 1;
  for (const PadLayer& layer : pad.layer)
    hardness += max(0, layer.stiffness) * (1 - layer.from) * (1 - layer.from);
  patch.stiffness = hardness * (std::numbers::pi * stiffness * palm.radius * palm.radius);
}

bool is_joined(const Primitives& hand, std::size_t phalanx, bool outward) {
  return outward ? phalanx % 3 < 2 && hand.present[phalanx + 1]
                 : phalanx % 3 > 0 && hand.present[phalanx - 1];
}

void take_phalanx(const Primitives& hand, std::size_t segment, double stiffness, const Pad& pad,
                  ContactPatch& patch) {
  const Primitive& capsule = hand.capsule[segment];
  const double height1 = dot(patch.normal, capsule.end1), height2 = dot(patch.normal, capsule.end2);
  const Vec3 axis = capsule.end2 - capsule.end1;
  const double rise = height2 - height1, square = dot(axis, axis);
  const double touch = min(height1 - capsule.radius1, height2 - capsule.radius2);
  Outline outline{height1 - touch,
                  height2 - touch,
                  std::sqrt(max(0, square - rise * rise)),
                  capsule.radius1,
                  capsule.radius2,
                  !is_joined(hand, segment, false),
                  !is_joined(hand, segment, true),
                  square};
  Pressed deepest{min(height1, height2) - touch, {}};
  const auto press_deepest = [&] { deepest.sums = sums_over(lowered(outline, deepest.depth)); };
  press_deepest();
  if (!(deepest.sums.volume > 0)) {
    outline.open1 = outline.open2 = true;
    press_deepest();
  }
  const auto [depth, sums] = press_into(outline, deepest, patch.force / stiffness);
  const Outline pressed = lowered(outline, depth);
  patch.centre += (touch + depth - dot(patch.normal, patch.centre)) * patch.normal;
  patch.radius = sums.volume > 0 ? moment_about(pressed, sums.first / sums.volume) / sums.volume : 0;
  patch.stiffness = max(0, stiffness * growth_of(pressed, sums, pad));
}

}  // namespace

ContactPatch contact_patch(const Primitives& hand, std::size_t segment, const Wrench& wrench,
                           double stiffness, const Pad& pad) {
  ContactPatch patch;
  const double square = dot(wrench.force, wrench.force);
  patch.force = std::sqrt(square);
  if (!(patch.force > 1e-9)) return {};
  patch.normal = wrench.force / patch.force;
  patch.centre = on_line_of_action(hand.base_joint[segment], wrench, square);
  if (segment == kPalmSegment) {
    const auto [middle, reach] = ball_around(hand.palm);
    patch.centre = within(reach, middle, middle, patch.normal, patch.centre);
    take_palm(hand.palm, stiffness, pad, patch);
  } else {
    const Primitive& capsule = hand.capsule[segment];
    patch.centre =
        within(max(capsule.radius1, capsule.radius2), capsule.end1, capsule.end2, patch.normal, patch.centre);
    take_phalanx(hand, segment, stiffness, pad, patch);
  }
  return patch;
}

}  // namespace lumbrical
