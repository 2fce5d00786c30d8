#include "proxy/core_gaps.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/at_least.h"
#include "base/share_along.h"
#include "index/triangle_distance.h"
#include "model/corners.h"
#include "stages/broadphase.h"
#include "stages/hand_pose.h"

namespace lumbrical {
namespace {

// Gaps of a segment that are no farther apart and whose normals' cosine is no less push as one.
constexpr double kSamePlace = 0.002, kSameWay = 0.995;  // [m]

// Where nothing tells which way is out: nearer than this [m] an axis lies in the triangle.
constexpr double kTouching = 1e-12;

// Height [m] over a nearer surface's plane that tells nothing: coordinates of single precision are as rough,
// and gaps give way by more.
constexpr double kFlat = 1e-6;

// What of a primitive is looked at: places along its axis, at each so many of the nearest corners and edges,
// for each so many gaps.
constexpr std::size_t kMostPlaces = 32, kMostPassingsAtAPlace = 8, kMostGapsAtAPoint = 8, kMostHeld = 64;

/// One primitive of the hand, a core thickened by `reach`, and what is collected for it; everything in the
/// model's frame.
struct Core {
  const Primitive& primitive;
  const Surroundings& around;
  double reach;
  GapMemory& memory;
  CoreGaps& gaps;
};

/// Where the axis passes a corner or an edge between its own ends.
struct Passing {
  double distance = 0;
  double t = 0;  ///< along the axis
  Vec3 from;     ///< from the surface
};

/// The nearest passings at one place, ascending.
struct Place {
  std::size_t count = 0;
  std::array<Passing, kMostPassingsAtAPlace> passing;
};

/// The passings of one primitive.
struct Passings {
  std::size_t places = 0;  ///< in use
  std::array<Place, kMostPlaces> place;
};

/// What holds the axis off.
struct Held {
  Vec3 point, surface;  ///< of the axis, and nearest to it
  Vec3 normal;          ///< unit
};
using HeldList = FixedList<Held, kMostHeld>;

Held held_at(Vec3 point, Vec3 gap) { return {point, point - gap, gap / norm(gap)}; }
bool is_above(const Held& held, Vec3 place) { return dot(place - held.surface, held.normal) > kFlat; }

Vec3 axis_of(const Primitive& primitive) { return primitive.end2 - primitive.end1; }
Vec3 point_at(const Primitive& primitive, double t) { return primitive.end1 + t * axis_of(primitive); }

// Of the axis' point nearest to another one.
double nearest_share(const Primitive& primitive, Vec3 point) {
  return share_along(axis_of(primitive), point - primitive.end1);
}

double radius_at(const Primitive& primitive, double t) {
  return primitive.radius1 + t * (primitive.radius2 - primitive.radius1);
}

bool is_told(const CoreGaps& gaps) { return gaps.asks_only_that && gaps.closed; }

std::size_t widest(const CoreGaps& gaps, std::size_t segment) {
  std::size_t found = gaps.gap.size();
  for (std::size_t i = 0; i < gaps.gap.size(); ++i) {
    const Gap& gap = gaps.gap.begin()[i];
    if (gap.segment == segment && (found == gaps.gap.size() || gap.width > gaps.gap.begin()[found].width))
      found = i;
  }
  return found;
}

void keep(const Gap& gap, CoreGaps& gaps) {
  for (Gap& other : gaps.gap) {
    if (other.segment != gap.segment || other.object != gap.object) continue;
    const Vec3 apart = other.point - gap.point;
    if (dot(apart, apart) > kSamePlace * kSamePlace || dot(other.normal, gap.normal) < kSameWay) continue;
    if (gap.width < other.width) other = gap;
    return;
  }
  if (gaps.count[gap.segment] < kMostGapsPerSegment) {
    ++gaps.count[gap.segment];
    gaps.gap.push_back(gap);
    return;
  }
  Gap& worst = gaps.gap.begin()[widest(gaps, gap.segment)];
  if (gap.width < worst.width) worst = gap;
}

void clear(const Core& core, double distance) {
  const bool touches = !(distance > kTouching);
  double& clearance = core.gaps.clearance[core.primitive.segment];
  clearance = min(clearance, touches ? 0 : distance);
  core.gaps.closed = core.gaps.closed || touches;
}

// A point of the core at which it is so thick, with its reach, and the way to it from the triangle's nearest
// point.
void measure(const Core& core, Vec3 point, double radius, Vec3 from_triangle) {
  const double distance = norm(from_triangle), width = distance - (radius - core.reach);
  clear(core, distance);
  core.gaps.closed = core.gaps.closed || width < 0;
  if (!(width < core.reach) || !(distance > kTouching)) return;
  const Pose& X_WM = core.around.X_WM;
  keep({core.primitive.segment, core.around.object, transform(X_WM, point),
        rotate(X_WM.orientation, from_triangle / distance), width, 0, 0},
       core.gaps);
}

// A total order that only places tell: no order of triangles shows.
bool is_before(Vec3 a, Vec3 b) {
  if (a.x != b.x) return a.x < b.x;
  return a.y != b.y ? a.y < b.y : a.z < b.z;
}
bool is_nearer(const Passing& a, const Passing& b) {
  if (a.distance != b.distance) return a.distance < b.distance;
  return a.t != b.t ? a.t < b.t : is_before(a.from, b.from);
}

// Neighbours share corners and edges: the same one counts once.
void add_to(Place& place, const Passing& passing) {
  std::size_t i = place.count;
  while (i > 0 && is_nearer(passing, place.passing[i - 1])) --i;
  if (i > 0 && !is_nearer(place.passing[i - 1], passing)) return;
  if (i == place.passing.size()) return;
  place.count = std::min(place.count + 1, place.passing.size());
  for (std::size_t k = place.count - 1; k > i; --k) place.passing[k] = place.passing[k - 1];
  place.passing[i] = passing;
}

void add_passing(const Core& core, double t, Vec3 surface, Passings& passings) {
  const Primitive& p = core.primitive;
  const Vec3 from = point_at(p, t) - surface;
  const double square = dot(from, from), radius = radius_at(p, t);
  if (!(square < radius * radius)) return;
  const double distance = std::sqrt(square);
  clear(core, distance);
  core.gaps.closed = core.gaps.closed || distance < radius - core.reach;
  const auto place = static_cast<std::size_t>(t * static_cast<double>(passings.places));
  add_to(passings.place[std::min(place, passings.places - 1)], {distance, t, from});
}

void pass_corner(const Core& core, Vec3 corner, Passings& passings) {
  const Vec3 axis = axis_of(core.primitive);
  const double along = dot(corner - core.primitive.end1, axis), square = dot(axis, axis);
  if (along > 0 && along < square) add_passing(core, along / square, corner, passings);
}

void pass_edge(const Core& core, Vec3 from, Vec3 to, Passings& passings) {
  if (is_before(to, from)) std::swap(from, to);
  const Vec3 axis = axis_of(core.primitive), edge = to - from, start = core.primitive.end1 - from;
  const double aa = dot(axis, axis), ee = dot(edge, edge), ae = dot(axis, edge);
  const double spread = aa * ee - ae * ae;
  if (!(spread > 1e-9 * aa * ee)) return;  // side by side: ends and corners tell
  const double t = (ae * dot(edge, start) - ee * dot(axis, start)) / spread;
  const double u = (aa * dot(edge, start) - ae * dot(axis, start)) / spread;
  if (t > 0 && t < 1 && u > 0 && u < 1) add_passing(core, t, from + u * edge, passings);
}

// Does the axis lead through the triangle?
bool pierces(const Primitive& p, const Corners& at) {
  const Vec3 axis = axis_of(p), normal = cross(at.b - at.a, at.c - at.a);
  const auto volume = [&](Vec3 a, Vec3 b) { return dot(axis, cross(a - p.end1, b - p.end1)); };
  const double u = volume(at.a, at.b), v = volume(at.b, at.c), w = volume(at.c, at.a);
  const bool beside = (u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0);
  return !beside && (dot(normal, p.end1 - at.a) > 0) != (dot(normal, p.end2 - at.a) > 0);
}

NearTriangle near_triangle(std::uint32_t triangle, const Corners& at) {
  const Vec3 middle = (1.0 / 3) * (at.a + at.b + at.c);
  const auto square = [&](Vec3 corner) { return dot(corner - middle, corner - middle); };
  return {middle, std::sqrt(max(square(at.a), max(square(at.b), square(at.c)))), triangle};
}

// Bounds: no nearer is the triangle to a point, and to the axis.
double least_distance(Vec3 point, const NearTriangle& triangle) {
  return norm(triangle.middle - point) - triangle.radius;
}
double least_distance(const Primitive& p, const NearTriangle& triangle) {
  return least_distance(point_at(p, nearest_share(p, triangle.middle)), triangle);
}

// Does a gap stand upright on its triangle? 1 in front of it, -1 behind it.
int upright_side(Vec3 gap, const Corners& at) {
  const Vec3 normal = cross(at.b - at.a, at.c - at.a);
  const double height = dot(gap, normal), square = dot(normal, normal);
  if (!(square > 0 && height * height >= (1 - 1e-9) * dot(gap, gap) * square)) return 0;
  return height > 0 ? 1 : -1;
}

// Is no other point of the axis nearer to `surface`?
bool is_nearest(const Primitive& p, Vec3 point, Vec3 surface) {
  const Vec3 apart = point - point_at(p, nearest_share(p, surface));
  return dot(apart, apart) <= kFlat * kFlat;
}

bool is_less_far(const NearPoint& a, const NearPoint& b) {
  if (a.square != b.square) return a.square < b.square;
  return a.pushes != b.pushes ? a.pushes : is_before(a.gap, b.gap);
}

// Of a triangle, to a point of the axis; what is farther than the root of `most` is not looked at closely.
NearPoint near_point(const Core& core, Vec3 point, double most, std::uint32_t triangle, const Corners& at) {
  const auto [gap, square, corner] = nearest_point(point, at.a, at.b, at.c);
  if (square > most) return {gap, square, triangle, false};
  const bool pushes = upright_side(gap, at) != 0 || is_nearest(core.primitive, point, point - gap);
  return {gap, square, triangle, pushes};
}

// Of all triangles, as far as one is nearer than a distance.
NearPoint nearest_of(std::span<const NearTriangle> near, const Core& core, Vec3 point, double distance) {
  NearPoint nearest{{}, distance * distance, 0, false};
  for (const NearTriangle& triangle : near) {
    if (least_distance(point, triangle) > distance + kFlat) continue;
    const Corners at = corners_of(core.around.model.triangles, triangle.number);
    const NearPoint other = near_point(core, point, nearest.square, triangle.number, at);
    if (!is_less_far(other, nearest)) continue;
    nearest = other;
    distance = std::sqrt(nearest.square);
  }
  return nearest;
}

// Is a point of the axis inside a solid: just behind the triangle nearest to it, and in front of none as
// near? Two sides of a sheet may be at one place.
bool is_inside(std::span<const NearTriangle> near, const Core& core, Vec3 point, const NearPoint& nearest) {
  const Model& model = core.around.model;
  if (upright_side(nearest.gap, corners_of(model.triangles, nearest.triangle)) >= 0 ||
      !model.objects[object_of(model, nearest.triangle)].solid)
    return false;
  const double most = std::sqrt(nearest.square) + kFlat;
  return std::none_of(near.begin(), near.end(), [&](const NearTriangle& triangle) {
    if (least_distance(point, triangle) > most) return false;
    const Corners at = corners_of(model.triangles, triangle.number);
    const auto [gap, square, corner] = nearest_point(point, at.a, at.b, at.c);
    return square <= most * most && upright_side(gap, at) > 0;
  });
}

// Of the triangles that reach above the nearest one's plane.
std::span<NearPoint> points_above(const Held& nearest, std::span<const NearTriangle> near, const Core& core,
                                  double radius) {
  std::size_t count = 0;
  for (const NearTriangle& triangle : near) {
    if (!(least_distance(nearest.point, triangle) < radius)) continue;
    const Corners at = corners_of(core.around.model.triangles, triangle.number);
    if (!is_above(nearest, at.a) && !is_above(nearest, at.b) && !is_above(nearest, at.c)) continue;
    const NearPoint other = near_point(core, nearest.point, radius * radius, triangle.number, at);
    if (other.square < radius * radius && is_above(nearest, nearest.point - other.gap))
      core.memory.points[count++] = other;
  }
  return {core.memory.points.data(), count};
}

std::span<NearPoint> above(const Held& nearest, std::span<NearPoint> points) {
  const auto is_kept_away = [&](const NearPoint& other) {
    return !is_above(nearest, nearest.point - other.gap);
  };
  const auto end = std::remove_if(points.begin(), points.end(), is_kept_away);
  return points.first(static_cast<std::size_t>(end - points.begin()));
}

// Gaps at one point of the axis, the nearest first; something is known to be no farther than a distance. What
// lies on or below the plane of a nearer one that plane keeps away: so corners and edges within what is flat
// or hollow push nowhere.
void hold_off(const Core& core, double t, double known, std::span<const NearTriangle> near, HeldList& held) {
  const Vec3 point = point_at(core.primitive, t);
  const double radius = radius_at(core.primitive, t);
  NearPoint nearest = nearest_of(near, core, point, min(radius, known + kFlat));
  if (!(nearest.square < radius * radius)) return;
  clear(core, std::sqrt(nearest.square));
  if (!(nearest.square > kTouching * kTouching)) return;
  if (is_inside(near, core, point, nearest)) clear(core, 0);
  Held plane = held_at(point, nearest.gap);
  std::span<NearPoint> left = points_above(plane, near, core, radius);
  for (std::size_t i = 1; held.size() < kMostHeld; ++i) {
    if (nearest.pushes) {
      measure(core, point, radius, nearest.gap);
      held.push_back(plane);
    }
    if (left.empty() || i == kMostGapsAtAPoint) return;
    nearest = *std::min_element(left.begin(), left.end(), is_less_far);
    plane = held_at(point, nearest.gap);
    left = above(plane, left);
  }
}

// Is it on or below a plane that holds the axis off nearby, and as near? Where a finger is bent the axis may
// be nearer to an edge.
bool is_held_off(const Primitive& primitive, const Passing& passing, const HeldList& held) {
  const Vec3 point = point_at(primitive, passing.t), surface = point - passing.from;
  for (const Held& other : held) {
    const Vec3 apart = other.point - point;
    const bool as_near = norm(other.point - other.surface) <= passing.distance + kFlat;
    if (as_near && dot(apart, apart) <= kSamePlace * kSamePlace && !is_above(other, surface)) return true;
  }
  return false;
}

// The triangles near one primitive, and where its axis passes them.
std::span<const NearTriangle> look_round(const Core& core, std::span<const std::uint64_t> pairs,
                                         Passings& passings) {
  const Primitive& p = core.primitive;
  const double radius = max(p.radius1, p.radius2);
  std::size_t count = 0;
  for (const std::uint64_t pair : pairs) {
    ++core.gaps.pairs;
    const auto number = static_cast<std::uint32_t>(pair);
    const Corners at = corners_of(core.around.model.triangles, number);
    const NearTriangle triangle = near_triangle(number, at);
    if (!(least_distance(p, triangle) < radius)) continue;
    core.memory.near[count++] = triangle;
    if (pierces(p, at)) clear(core, 0);
    for (const Vec3 corner : {at.a, at.b, at.c}) pass_corner(core, corner, passings);
    pass_edge(core, at.a, at.b, passings);
    pass_edge(core, at.b, at.c, passings);
    pass_edge(core, at.c, at.a, passings);
    if (is_told(core.gaps)) break;
  }
  return {core.memory.near.data(), count};
}

void measure_round(const Core& core, std::span<const std::uint64_t> pairs) {
  const Primitive& p = core.primitive;
  const double length = norm(axis_of(p));
  Passings passings;
  passings.places = 1 + static_cast<std::size_t>(min(length / kSamePlace, kMostPlaces - 1));
  const std::span<const NearTriangle> near = look_round(core, pairs, passings);
  constexpr double kNothing = 1e300;
  HeldList held;
  if (is_told(core.gaps)) return;
  hold_off(core, 0, kNothing, near, held);
  if (length > 0) hold_off(core, 1, kNothing, near, held);
  for (const Place& place : passings.place) {
    for (const Passing& passing : std::span{place.passing}.first(place.count)) {
      if (is_told(core.gaps)) return;
      if (!is_held_off(p, passing, held)) hold_off(core, passing.t, passing.distance, near, held);
    }
  }
}

// Of a point in the polygon's plane, or over it.
bool is_inside(const SweptPolygon& palm, Vec3 point) {
  bool inside = true;
  for (std::size_t k = 0; inside && k < palm.corner_count; ++k)
    inside = dot(palm.outward[k], point - palm.corner[k]) < 0;
  return inside;
}

// Does an edge lead through the polygon?
bool pierces(Vec3 from, Vec3 to, const SweptPolygon& palm) {
  const double before = dot(palm.normal, from - palm.corner[0]),
               after = dot(palm.normal, to - palm.corner[0]);
  return (before > 0) != (after > 0) && is_inside(palm, from + before / (before - after) * (to - from));
}

// The inside of the palm's polygon; its rim are round primitives.
void measure_palm(const Core& core, const SweptPolygon& palm, const Corners& at) {
  for (const Vec3 corner : {at.a, at.b, at.c}) {
    if (!is_inside(palm, corner)) continue;
    const Vec3 below = dot(palm.normal, palm.corner[0] - corner) * palm.normal;
    measure(core, corner + below, palm.radius, below);
  }
  if (pierces(at.a, at.b, palm) || pierces(at.b, at.c, palm) || pierces(at.c, at.a, palm)) clear(core, 0);
}

// What no core is nearer to than `reach` is not asked for.
void keep_cores(double reach, Primitives& hand) {
  const auto thin = [reach](double& radius) { radius = kCoreShare * radius + reach; };
  thin(hand.palm.radius);
  for (std::size_t i = 0; i < hand.count; ++i) {
    Primitive& primitive = hand.primitive[i];
    if (primitive.shape == Shape::slab) continue;  // round its sphere
    thin(primitive.radius1);
    thin(primitive.radius2);
  }
}

// Of one primitive, out of all pairs in their order.
std::span<const std::uint64_t> pairs_of(std::uint64_t primitive, std::span<const std::uint64_t> all) {
  const auto first = std::lower_bound(all.begin(), all.end(), primitive << 32);
  return {first, std::lower_bound(first, all.end(), (primitive + 1) << 32)};
}

void measure_all(const Core& core, const SweptPolygon& palm, std::span<const std::uint64_t> pairs) {
  if (core.primitive.shape != Shape::slab) return measure_round(core, pairs);
  for (const std::uint64_t pair : pairs) {
    ++core.gaps.pairs;
    measure_palm(core, palm, corners_of(core.around.model.triangles, static_cast<std::uint32_t>(pair)));
    if (is_told(core.gaps)) break;
  }
}

}  // namespace

void size_gap_memory(const Model& model, GapMemory& memory) {
  const auto most = std::min<std::size_t>(model.settings.max_candidates, model.triangles.size());
  at_least(most, memory.near);
  at_least(most, memory.points);
}

bool add_gaps(const Surroundings& around, const Joints& hand, double reach, Scratch& scratch,
              GapMemory& memory, CoreGaps& gaps) {
  if (is_told(gaps)) return true;
  const Model& model = around.model;
  Primitives& placed = *scratch.primitives;
  if (!tile_hand_in(model, hand, inverse(around.X_WM), placed)) return true;
  keep_cores(reach, placed);
  if (!find_candidates(model, placed, scratch)) return false;
  const std::span<const std::uint64_t> all{scratch.candidates.data(), scratch.candidate_count};
  const std::size_t count = placed.count;
  // A hand that stays is closed by what closed it last.
  const std::size_t first = gaps.asks_only_that ? memory.closed : 0;
  for (std::size_t i = 0; i < count && !is_told(gaps); ++i) {
    const std::size_t of = (first + i) % count;
    const std::span<const std::uint64_t> pairs = pairs_of(of, all);
    if (pairs.empty()) continue;
    measure_all({placed.primitive[of], around, reach, memory, gaps}, placed.palm, pairs);
    if (is_told(gaps)) memory.closed = of;
  }
  return true;
}

}  // namespace lumbrical
