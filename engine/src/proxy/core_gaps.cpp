#include "proxy/core_gaps.h"

#include <cmath>

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

/// One primitive of the hand, a core thickened by `reach`, and what is collected for it; everything in the
/// model's frame.
struct Core {
  const Primitive& primitive;
  const Surroundings& around;
  double reach;
  CoreGaps& gaps;
};

double radius_at(const Primitive& primitive, double t) {
  return primitive.radius1 + t * (primitive.radius2 - primitive.radius1);
}

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

// A point of the core at which it is so thick, with its reach, and the way to it from the triangle's nearest
// point.
void measure(const Core& core, Vec3 point, double radius, Vec3 from_triangle) {
  const double distance = norm(from_triangle), width = distance - (radius - core.reach);
  double& clearance = core.gaps.clearance[core.primitive.segment];
  clearance = min(clearance, distance);
  if (!(width < core.reach) || !(distance > kTouching)) return;
  const Pose& X_WM = core.around.X_WM;
  keep({core.primitive.segment, core.around.object, transform(X_WM, point),
        rotate(X_WM.orientation, from_triangle / distance), width, 0, 0},
       core.gaps);
}

void measure_end(const Core& core, Vec3 end, double radius, const Corners& at) {
  measure(core, end, radius, nearest_point(end, at.a, at.b, at.c).gap);
}

void measure_corner(const Core& core, Vec3 corner) {
  const Primitive& p = core.primitive;
  const Vec3 axis = p.end2 - p.end1;
  const double square = dot(axis, axis);
  const double t = square > 0 ? clamp(dot(corner - p.end1, axis) / square, 0, 1) : 0;
  const Vec3 point = p.end1 + t * axis;
  measure(core, point, radius_at(p, t), point - corner);
}

// Where axis and edge pass each other between their ends.
void measure_edge(const Core& core, Vec3 from, Vec3 to) {
  const Primitive& p = core.primitive;
  const Vec3 axis = p.end2 - p.end1, edge = to - from, start = p.end1 - from;
  const double aa = dot(axis, axis), ee = dot(edge, edge), ae = dot(axis, edge);
  const double spread = aa * ee - ae * ae;
  if (!(spread > 1e-9 * aa * ee)) return;  // side by side: ends and corners tell
  const double t = (ae * dot(edge, start) - ee * dot(axis, start)) / spread;
  const double u = (aa * dot(edge, start) - ae * dot(axis, start)) / spread;
  if (!(t > 0 && t < 1 && u > 0 && u < 1)) return;
  const Vec3 point = p.end1 + t * axis;
  measure(core, point, radius_at(p, t), point - (from + u * edge));
}

// Does the axis lead through the triangle?
bool pierces(const Primitive& p, const Corners& at) {
  const Vec3 axis = p.end2 - p.end1, normal = cross(at.b - at.a, at.c - at.a);
  const auto volume = [&](Vec3 a, Vec3 b) { return dot(axis, cross(a - p.end1, b - p.end1)); };
  const double u = volume(at.a, at.b), v = volume(at.b, at.c), w = volume(at.c, at.a);
  const bool beside = (u < 0 || v < 0 || w < 0) && (u > 0 || v > 0 || w > 0);
  return !beside && (dot(normal, p.end1 - at.a) > 0) != (dot(normal, p.end2 - at.a) > 0);
}

// A bound: no nearer is the triangle to the axis.
double least_distance(const Primitive& p, const Corners& at) {
  const Vec3 middle = (1.0 / 3) * (at.a + at.b + at.c);
  const auto square = [&](Vec3 corner) { return dot(corner - middle, corner - middle); };
  const double radius = std::sqrt(max(square(at.a), max(square(at.b), square(at.c))));
  const Vec3 axis = p.end2 - p.end1, from = middle - p.end1;
  const double length = dot(axis, axis), t = length > 0 ? clamp(dot(from, axis) / length, 0, 1) : 0;
  return norm(from - t * axis) - radius;
}

void measure_round(const Core& core, const Corners& at) {
  const Primitive& p = core.primitive;
  if (pierces(p, at)) core.gaps.clearance[p.segment] = 0;
  measure_end(core, p.end1, p.radius1, at);
  measure_end(core, p.end2, p.radius2, at);
  for (const Vec3 corner : {at.a, at.b, at.c}) measure_corner(core, corner);
  measure_edge(core, at.a, at.b);
  measure_edge(core, at.b, at.c);
  measure_edge(core, at.c, at.a);
}

// The inside of the palm's polygon; its rim are round primitives.
void measure_palm(const Core& core, const SweptPolygon& palm, const Corners& at) {
  for (const Vec3 corner : {at.a, at.b, at.c}) {
    bool inside = true;
    for (std::size_t k = 0; inside && k < static_cast<std::size_t>(palm.corner_count); ++k)
      inside = dot(palm.outward[k], corner - palm.corner[k]) < 0;
    if (!inside) continue;
    const Vec3 below = dot(palm.normal, palm.corner[0] - corner) * palm.normal;
    measure(core, corner + below, palm.radius, below);
  }
}

// What no core is nearer to than `reach` is not asked for.
void keep_cores(double reach, Primitives& hand) {
  const auto thin = [reach](double& radius) { radius = kCoreShare * radius + reach; };
  thin(hand.palm.radius);
  for (std::size_t i = 0; i < static_cast<std::size_t>(hand.count); ++i) {
    Primitive& primitive = hand.primitive[i];
    if (primitive.shape == Shape::slab) continue;  // round its sphere
    thin(primitive.radius1);
    thin(primitive.radius2);
  }
}

}  // namespace

bool add_gaps(const Surroundings& around, const Joints& hand, double reach, Scratch& scratch,
              CoreGaps& gaps) {
  const Model& model = around.model;
  Primitives& placed = *scratch.primitives;
  static_cast<void>(place_hand(model.hand, model.settings, hand, inverse(around.X_WM), placed));
  if (!may_meet(model.hand, placed, model.extent)) return true;
  shape_hand(model.hand, placed);
  tile_hand(model.settings, placed);
  keep_cores(reach, placed);
  if (!find_candidates(model, placed, scratch)) return false;
  gaps.pairs += scratch.candidate_count;
  for (std::uint32_t i = 0; i < scratch.candidate_count; ++i) {
    const std::uint64_t pair = scratch.candidates[i];
    const Primitive& primitive = placed.primitive[pair >> 32];
    const Core core{primitive, around, reach, gaps};
    const Corners at = corners_of(model.triangles, static_cast<std::uint32_t>(pair));
    if (primitive.shape == Shape::slab) {
      measure_palm(core, placed.palm, at);
    } else if (least_distance(primitive, at) < max(primitive.radius1, primitive.radius2)) {
      measure_round(core, at);
    }
  }
  return true;
}

}  // namespace lumbrical
