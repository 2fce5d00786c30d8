#include "objects/contact_patch.h"

#include <array>
#include <cmath>

namespace lumbrical {
namespace {

// Gauss and Legendre's rules on 0 .. 1.
constexpr std::array<double, 5> kNodeAlong = {0.04691007703066802, 0.23076534494715845, 0.5,
                                              0.76923465505284155, 0.95308992296933198};
constexpr std::array<double, 5> kWeightAlong = {0.11846344252809454, 0.23931433524968324, 0.28444444444444444,
                                                0.23931433524968324, 0.11846344252809454};
constexpr std::array<double, 4> kNodeAcross = {0.06943184420297371, 0.33000947820757187, 0.66999052179242813,
                                               0.93056815579702629};
constexpr std::array<double, 4> kWeightAcross = {0.17392742256872693, 0.32607257743127307,
                                                 0.32607257743127307, 0.17392742256872693};

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

struct Interval {
  double low = 1e300, high = -1e300;
  void add(double u) {
    low = min(low, u);
    high = max(high, u);
  }
};

// Where the circle at an end, or the straight side from (a, at height p) to (b, q), crosses the plane.
void add_circle(double u, double height, double radius, Interval& inside) {
  const double square = radius * radius - height * height;
  if (!(square > 0)) return;
  inside.add(u - std::sqrt(square));
  inside.add(u + std::sqrt(square));
}
void add_side(double a, double p, double b, double q, Interval& inside) {
  if ((p < 0) == (q < 0)) return;
  inside.add(a + (b - a) * (p / (p - q)));
}

Interval inside_of(const Outline& o) {
  Interval inside;
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

/// Integrals of phi over the plane: of itself, and times u.
struct PlaneSums {
  double volume = 0, first = 0;
};

// Adds what lies across the axis at u: `add(part of the volume, v)` for each node on one side of it.
template <class Add>
void visit_line(const Outline& o, double u, double weight, const Add& add) {
  const double t = clamp(o.share_at(u), 0, 1);
  const double x = u - t * o.length, y = o.height1 + t * (o.height2 - o.height1);
  const double square = x * x + y * y, radius = o.radius1 + t * (o.radius2 - o.radius1);
  if (!(radius * radius > square)) return;
  const double half = std::sqrt(radius * radius - square);
  for (std::size_t j = 0; j < kNodeAcross.size(); ++j) {
    const double v = half * kNodeAcross[j], phi = radius - std::sqrt(square + v * v);
    add(2 * half * weight * kWeightAcross[j] * phi, v);
  }
}

// Calls visit(from, to) for the pieces of the axis' shadow between which phi has kinks.
template <class Visit>
void visit_pieces(const Outline& o, const Visit& visit) {
  Interval inside = inside_of(o);
  std::array<double, 4> mark = {inside.low, inside.low, inside.high, inside.high};
  const bool lies = o.length * o.length > 1e-6 * o.axis_square;
  if (lies) {
    const double shift = o.height1 * (o.height2 - o.height1);
    mark[1] = clamp(shift / o.length, inside.low, inside.high);
    mark[2] = clamp((o.axis_square + shift) / o.length, inside.low, inside.high);
  }
  if (!lies) {  // a sphere: phi has its kink above the centre
    const double middle = 0.5 * (inside.low + inside.high);
    if (middle > inside.low) visit(inside.low, middle);
    if (inside.high > middle) visit(middle, inside.high);
    return;
  }
  for (std::size_t piece = 0; piece < 3; ++piece) {
    if ((piece == 0 && !o.open1) || (piece == 2 && !o.open2)) continue;
    if (mark[piece + 1] > mark[piece]) visit(mark[piece], mark[piece + 1]);
  }
}

PlaneSums sums_over(const Outline& o) {
  PlaneSums sums;
  visit_pieces(o, [&](double from, double to) {
    for (std::size_t i = 0; i < kNodeAlong.size(); ++i) {
      const double u = from + (to - from) * kNodeAlong[i];
      visit_line(o, u, (to - from) * kWeightAlong[i], [&](double part, double) {
        sums.volume += part;
        sums.first += part * u;
      });
    }
  });
  return sums;
}

// The integral of phi times the distance from the point `about`, where that has a kink.
double moment_about(const Outline& o, double about) {
  double sum = 0;
  const auto add_piece = [&](double from, double to) {
    for (std::size_t i = 0; to > from && i < kNodeAlong.size(); ++i) {
      const double u = from + (to - from) * kNodeAlong[i], along = u - about;
      visit_line(o, u, (to - from) * kWeightAlong[i],
                 [&](double part, double v) { sum += part * std::sqrt(along * along + v * v); });
    }
  };
  visit_pieces(o, [&](double from, double to) {
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

// How far above `touching`, where the outline just meets the plane, it is pushed `volume` [m^3] hard; no
// farther than `deepest`. The root of the volume is nearly a straight line, so false position does.
double depth_of_plane(const Outline& touching, double deepest, double volume) {
  const double wanted = std::sqrt(volume);
  const auto miss = [&](double depth) {
    return std::sqrt(sums_over(lowered(touching, depth)).volume) - wanted;
  };
  double low = 0, high = deepest, below = -wanted, above = miss(deepest);
  if (!(above > 0)) return deepest;
  for (int step = 0; step < 12; ++step) {
    const double depth = low + (high - low) * (below / (below - above)), here = miss(depth);
    if (std::fabs(here) < 1e-5 * wanted) return depth;
    if (here < 0) {
      low = depth;
      below = here;
      above *= 0.5;  // Illinois: the other end must move, too
    } else {
      high = depth;
      above = here;
      below *= 0.5;
    }
  }
  return 0.5 * (low + high);
}

// What a pad presses with, over its field's stiffness [m^3].
double pressed_volume(const Outline& pressed, const Pad& pad) {
  double volume = sums_over(pressed).volume;
  for (const PadLayer& layer : pad.layer) {
    if (layer.stiffness == 0) continue;
    Outline inner = pressed;
    inner.radius1 *= 1 - layer.from;
    inner.radius2 *= 1 - layer.from;
    volume += layer.stiffness * sums_over(inner).volume;
  }
  return volume;
}

// The point of the line of action nearest the base joint.
Vec3 on_line_of_action(Vec3 joint, const Wrench& wrench, double square) {
  return joint + cross(wrench.force, wrench.torque) / square;
}

void take_palm(const SweptPolygon& palm, double stiffness, const Pad& pad, ContactPatch& patch) {
  const double across = dot(patch.normal, palm.normal);
  if (std::fabs(across) > 0.3) {
    const double side = across < 0 ? 1.0 : -1.0;  // the palm is pushed on the side that looks at the object
    const Vec3 skin = palm.corner[0] + (side * palm.radius) * palm.normal;
    patch.centre += (dot(palm.normal, skin - patch.centre) / across) * patch.normal;
  }
  patch.radius = 8.0 / 15 * palm.radius;
  double hardness = 1;
  for (const PadLayer& layer : pad.layer)
    hardness += max(0, layer.stiffness) * (1 - layer.from) * (1 - layer.from);
  patch.stiffness = hardness * (3.141592653589793 * stiffness * palm.radius * palm.radius);
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
  const double deepest = min(height1, height2) - touch, volume = patch.force / stiffness;
  if (!(sums_over(lowered(outline, deepest)).volume > 0)) outline.open1 = outline.open2 = true;
  const double depth = depth_of_plane(outline, deepest, volume), step = 1e-3 * deepest;
  const Outline pressed = lowered(outline, depth);
  const PlaneSums sums = sums_over(pressed);
  const double ahead = pressed_volume(lowered(outline, depth + step), pad),
               behind = pressed_volume(lowered(outline, depth - step), pad);
  patch.centre += (touch + depth - dot(patch.normal, patch.centre)) * patch.normal;
  patch.radius = sums.volume > 0 ? moment_about(pressed, sums.first / sums.volume) / sums.volume : 0;
  patch.stiffness = max(0, stiffness * (ahead - behind) / (2 * step));
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
    take_palm(hand.palm, stiffness, pad, patch);
  } else {
    take_phalanx(hand, segment, stiffness, pad, patch);
  }
  return patch;
}

}  // namespace lumbrical
