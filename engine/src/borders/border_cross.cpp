// A near border is a convex cone (JointBorder), and g = sqrt(x^2 + y^2) - side z is a convex function,
// negative inside. So a triangle with all corners inside is inside, one whose corners are above zero on a
// tangent plane of g is outside, or whose edges are while the cone's axis does not pierce it, and an edge
// from inside to outside crosses the border once, at the root of a quadratic. Whatever is not as plain as
// that is left to `collide_shared`.
#include "borders/border_cross.h"

#include <cmath>

namespace lumbrical {
namespace {

// A way across a triangle shorter than this share of a border's reach is not looked at.
constexpr double kShortest = 1e-10;

// A point in the border's coordinates. All points here are relative to the joint: far from the origin nothing
// is lost.
struct ConePoint {
  double x, y, z;  // z along the cone
};

ConePoint seen(const JointBorder& border, Vec3 d) {
  return {dot(border.x, d), dot(border.y, d), border.side * dot(border.normal, d)};
}
double gap_of(const ConePoint& p) { return std::sqrt(p.x * p.x + p.y * p.y) - p.z; }

// Is g positive on the whole straight or triangle round `middle` because its tangent plane there is?
bool is_above(const ConePoint& middle, const ConePoint* corner, int count) {
  const double length = std::sqrt(middle.x * middle.x + middle.y * middle.y);
  if (!(length > 0)) return false;
  const double gx = middle.x / length, gy = middle.y / length;
  for (int i = 0; i < count; ++i) {
    if (!(gx * corner[i].x + gy * corner[i].y - corner[i].z > 0)) return false;
  }
  return true;
}

// Do two points outside have nothing inside between them?
bool stays_out(const ConePoint& p, const ConePoint& q) {
  const ConePoint ends[2] = {p, q};
  if (is_above({0.5 * (p.x + q.x), 0.5 * (p.y + q.y), 0.5 * (p.z + q.z)}, ends, 2)) return true;
  const ConePoint d{q.x - p.x, q.y - p.y, q.z - p.z};
  const double a = d.x * d.x + d.y * d.y - d.z * d.z, b = p.x * d.x + p.y * d.y - p.z * d.z;
  const double c = p.x * p.x + p.y * p.y - p.z * p.z;
  // Outside the cone and its mirror image at both ends, and a quadratic in between.
  if (!(c > 0) || !(a + 2 * b + c > 0)) return false;
  return a <= 0 || b >= 0 || a + b <= 0 || b * b < a * c;
}

// Is the axis of the cone clear of a triangle?
bool axis_misses(const ConePoint (&at)[3]) {
  double side[3];
  for (int i = 0; i < 3; ++i) {
    const ConePoint &p = at[i], &q = at[(i + 1) % 3];
    side[i] = p.x * q.y - p.y * q.x;
  }
  return min(side[0], min(side[1], side[2])) < 0 && max(side[0], max(side[1], side[2])) > 0;
}

// Where the way from a point inside the cone to one outside leaves it, as a share of the way.
double way_out(const ConePoint& inside, const ConePoint& outside) {
  const ConePoint d{outside.x - inside.x, outside.y - inside.y, outside.z - inside.z};
  const double a = d.x * d.x + d.y * d.y - d.z * d.z;
  const double b = inside.x * d.x + inside.y * d.y - inside.z * d.z;
  const double c = inside.x * inside.x + inside.y * inside.y - inside.z * inside.z;
  const double root = std::sqrt(max(0, b * b - a * c));
  const double t = b >= 0 ? (b + root > 0 ? -c / (b + root) : 0) : (a != 0 ? (root - b) / a : 1);
  return clamp(t, 0, 1);
}

enum class Verdict : std::uint8_t { mine, others, crossed, unclear };

struct Crossed {
  Verdict verdict = Verdict::unclear;
  Vec3 from, to;  // [m] W, from the joint: where the border crosses edges; its kin's part lies to the right
                  // of the way
};

Crossed cross_border(const JointBorder& border, bool is_outer_tile, const Vec3 (&corner)[3]) {
  ConePoint at[3];
  bool inside[3];
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    at[i] = seen(border, corner[i]);
    inside[i] = gap_of(at[i]) < 0;
    count += inside[i] ? 1 : 0;
  }
  const bool mine_inside = (border.side > 0) == is_outer_tile;
  if (count == 3) return {mine_inside ? Verdict::mine : Verdict::others, {}, {}};
  if (count == 0) {
    const ConePoint centre{(at[0].x + at[1].x + at[2].x) / 3, (at[0].y + at[1].y + at[2].y) / 3, 0};
    const bool edges_out = stays_out(at[0], at[1]) && stays_out(at[1], at[2]) && stays_out(at[2], at[0]);
    if (!is_above(centre, at, 3) && !(edges_out && axis_misses(at))) return {};
    return {mine_inside ? Verdict::others : Verdict::mine, {}, {}};
  }
  int lone = 0;  // the corner on its own side
  while (inside[lone] != (count == 1)) ++lone;
  const int next = (lone + 1) % 3, last = (lone + 2) % 3;
  if (count == 1 && !stays_out(at[next], at[last])) return {};
  const auto crossing = [&](int i) {
    const int in = count == 1 ? lone : i, out = count == 1 ? i : lone;
    return corner[in] + way_out(at[in], at[out]) * (corner[out] - corner[in]);
  };
  // Counter-clockwise the lone corner lies between the crossings with its last and its next edge.
  const Vec3 before = crossing(last), after = crossing(next);
  const bool lone_is_mine = (count == 1) == mine_inside;
  // A chord so short has no direction: at a joint in the triangle's corner rounding makes one.
  if (!(norm(after - before) > kShortest * border.reach)) return {};
  return lone_is_mine ? Crossed{Verdict::crossed, after, before} : Crossed{Verdict::crossed, before, after};
}

}  // namespace

TriangleCuts cross_borders(const Primitives& hand, const Primitive& tile, const TileBorders& near,
                           const Corners& at) {
  const auto [inner, outer, folded] = near;
  const auto is_far = [&](bool at_outer) { return !hand.border[joint_of(tile, at_outer)].near; };
  TriangleCuts cuts;
  if (folded || (inner && is_far(false)) || (outer && is_far(true))) {
    cuts.kind = CutKind::unclear;
    return cuts;
  }
  if (!inner && !outer) return cuts;
  cuts.cut = {tile.cut[0], tile.cut[1]};
  cuts.kind = CutKind::other;
  bool gone = false;
  for (const bool at_outer : {false, true}) {
    if (!(at_outer ? outer : inner)) continue;
    const JointBorder& border = hand.border[joint_of(tile, at_outer)];
    const Crossed here =
        cross_border(border, !at_outer, {at.a - border.centre, at.b - border.centre, at.c - border.centre});
    if (here.verdict == Verdict::unclear) cuts.kind = CutKind::unclear;
    if (here.verdict == Verdict::mine) cuts.cut[own_cut(tile, at_outer)].normal = {};
    if (here.verdict == Verdict::crossed) cuts.crossing[at_outer] = {true, here.from, here.to};
    gone = gone || here.verdict == Verdict::others;
  }
  if (gone) cuts.kind = CutKind::gone;
  return cuts;
}

}  // namespace lumbrical
