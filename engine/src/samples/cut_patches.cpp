#include "samples/cut_patches.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/at_least.h"
#include "base/fixed_list.h"
#include "base/parallel.h"
#include "model/primitive.h"
#include "search/tree_search.h"

namespace lumbrical {
namespace {

// Blocks there is room for, of each so many candidates.
constexpr std::size_t kCandidatesPerBlock = 16;

// [m] What is cut reaches so much farther than the hand: it moves that far until it asks again.
constexpr double kSpareReach = 0.005;

// By this share of their size, and by that of where they are, things are nearer than they seem.
constexpr double kSlack = 1e-6, kRounding = 1e-15;

constexpr double kFarAway = 1e300;  // [m]

std::size_t room_for_blocks(const Model& model) {
  return std::max<std::size_t>(16, model.settings.max_candidates / kCandidatesPerBlock);
}

// ---- What is near ----

HandPlace place_of(const Primitives& hand) {
  HandPlace place;
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    if (!hand.present[i]) continue;
    const Primitive& capsule = hand.capsule[i];
    place.phalanx[place.phalanx_count++] = {capsule.end1, capsule.end2,
                                            max(capsule.radius1, capsule.radius2)};
  }
  place.palm = hand.palm;
  return place;
}

// Is no part of it farther than so much [m] from where it was?
bool is_within(double reach, const HandPlace& was, const HandPlace& hand) {
  if (hand.phalanx_count != was.phalanx_count || hand.palm.corner_count != was.palm.corner_count)
    return false;
  const auto is_near = [reach](Vec3 a, Vec3 b) { return dot(a - b, a - b) <= reach * reach; };
  bool within = true;
  for (std::size_t i = 0; i < hand.phalanx_count; ++i) {
    const auto &a = hand.phalanx[i], &b = was.phalanx[i];
    within = within && a.radius == b.radius && is_near(a.end1, b.end1) && is_near(a.end2, b.end2);
  }
  for (std::size_t k = 0; k < static_cast<std::size_t>(hand.palm.corner_count); ++k)
    within = within && is_near(hand.palm.corner[k], was.palm.corner[k]);
  return within;
}

/// A hand that may be farther by `spare` [m]: thick segments and a palm, a bit each.
class Limbs {
 public:
  Limbs(const HandPlace& hand, double spare) : count_(hand.phalanx_count), palm_(hand.palm) {
    Box box;
    for (std::size_t i = 0; i < count_; ++i) {
      const auto& [end1, end2, radius] = hand.phalanx[i];
      const Vec3 axis = end2 - end1;
      const double square = dot(axis, axis), reach = radius + spare;
      segment_[i] = {end1, axis, square > 0 ? 1 / square : 0, (1 + kSlack) * reach};
      box.add(end1, reach);
      box.add(end2, reach);
    }
    for (std::size_t k = 0; k < static_cast<std::size_t>(palm_.corner_count); ++k)
      box.add(palm_.corner[k], palm_.radius + spare);
    palm_reach_ = (1 + kSlack) * (palm_.radius + spare);
    ball_.end1 = ball_.end2 = box.middle();
    ball_.radius1 = ball_.radius2 = norm(box.upper - ball_.end1);
  }
  /// Round all of them.
  [[nodiscard]] const Primitive& ball() const { return ball_; }
  /// Those that are near a triangle's plane.
  [[nodiscard]] std::uint32_t near_plane(const Corners& at) const {
    const Vec3 across = cross(at.b - at.a, at.c - at.a), normal = across / norm(across);
    const double slack = kRounding * (largest_of(at.a) + largest_of(ball_.end1));
    const auto height = [&](Vec3 p) { return dot(normal, p - at.a); };
    std::uint32_t near = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      const double at_end = height(segment_[i].end), beyond = at_end + dot(normal, segment_[i].axis),
                   reach = segment_[i].reach + slack;
      near |= std::uint32_t{min(at_end, beyond) <= reach && max(at_end, beyond) >= -reach} << i;
    }
    double lowest = kFarAway, highest = -kFarAway;
    for (std::size_t k = 0; k < static_cast<std::size_t>(palm_.corner_count); ++k) {
      const double at_corner = height(palm_.corner[k]);
      lowest = min(lowest, at_corner);
      highest = max(highest, at_corner);
    }
    const double reach = palm_reach_ + slack;
    return near | std::uint32_t{lowest <= reach && highest >= -reach} << count_;
  }
  /// Those of some that are near a sphere.
  [[nodiscard]] std::uint32_t near(const Sphere& sphere, std::uint32_t limbs) const {
    const double within = (1 + kSlack) * sphere.radius + kRounding * largest_of(sphere.centre);
    const Vec3 gap = sphere.centre - ball_.end1;
    const double reach = ball_.radius1 + within;
    if (dot(gap, gap) > reach * reach) return 0;
    if (sphere.radius > ball_.radius1) return limbs;
    std::uint32_t near = 0;
    for (std::uint32_t left = limbs; left != 0; left &= left - 1) {
      const auto i = static_cast<std::size_t>(__builtin_ctz(left));
      const bool meets =
          i < count_ ? meets_segment(segment_[i], sphere.centre, within) : meets_palm(sphere.centre, within);
      near |= std::uint32_t{meets} << i;
    }
    return near;
  }

 private:
  struct Segment {
    Vec3 end, axis;
    double inverse, reach;  // [1/m^2] 1 / |axis|^2, [m]
  };
  static bool meets_segment(const Segment& segment, Vec3 centre, double within) {
    const Vec3 from = centre - segment.end;
    const Vec3 gap = from - clamp(dot(from, segment.axis) * segment.inverse, 0, 1) * segment.axis;
    const double reach = segment.reach + within;
    return dot(gap, gap) <= reach * reach;
  }
  [[nodiscard]] bool meets_palm(Vec3 centre, double within) const {
    const double reach = palm_reach_ + within;
    bool meets = palm_.corner_count > 0 && std::fabs(dot(palm_.normal, centre - palm_.corner[0])) <= reach;
    for (std::size_t k = 0; meets && k < static_cast<std::size_t>(palm_.corner_count); ++k)
      meets = dot(palm_.outward[k], centre - palm_.corner[k]) <= reach;
    return meets;
  }

  std::size_t count_;
  std::array<Segment, kPhalanxCount> segment_;
  const SweptPolygon& palm_;
  double palm_reach_ = 0;
  Primitive ball_;
};

// Calls take(triangle) for the large triangles that a ball may meet, in the order of the tree; with brute
// force for all.
template <class Take>
void for_large(const Model& model, const Primitive& ball, CutPatches& cuts, const Take& take) {
  const Patches& patches = *model.patches;
  const SphereTree& tree = patches.large_tree;
  const TreeLayout layout = layout_of(tree.head);
  const SphereBlock* const spheres = blocks_of(tree.lines.data()) + layout.upper;
  const std::uint32_t* const numbers = numbers_of(tree.lines.data(), layout);
  if (model.execution.broadphase == Broadphase::brute) {
    for (std::size_t i = 0; i < layout.lowest * SphereBlock::kWidth; ++i) {
      if (spheres[i / SphereBlock::kWidth].r[i % SphereBlock::kWidth] >= 0) take(numbers[i]);
    }
    return;
  }
  const FieldKernels& kernels = field_kernels(model.execution.isa);
  const SphereQuery query = query_of(tree.head, ball);
  const auto leaves = search_leaves(tree.head, layout, tree.lines.data(), query, kernels, cuts.frontier);
  for (const std::uint32_t leaf : leaves) {
    std::uint32_t places[SphereBlock::kWidth];
    const std::size_t count = kernels.sphere_hits(spheres, query, &leaf, 1, places);
    for (std::size_t i = 0; i < count; ++i) take(numbers[places[i]]);
  }
}

// ---- Cells ----

std::size_t hash_of(const CutCell& cell) {
  std::uint64_t hash = cell.build;
  for (const std::uint64_t part : {std::uint64_t{cell.triangle} << 32 | cell.path.part, cell.path.halves}) {
    hash = (hash ^ part) * 0x9e3779b97f4a7c15u;
    hash ^= hash >> 29;
  }
  return static_cast<std::size_t>(hash);
}

bool is_same(const CutCell& a, const CutCell& b) {
  return a.build == b.build && a.triangle == b.triangle && a.path.part == b.path.part &&
         a.path.halves == b.path.halves;
}

// Where a cell is, or where there is a place for it. There are more places than blocks.
CutCell& find_cell(const CutCell& cell, CutPatches& cuts) {
  std::size_t place = hash_of(cell) % cuts.cells.size();
  while (cuts.cells[place].build != 0 && !is_same(cuts.cells[place], cell))
    place = (place + 1) % cuts.cells.size();
  return cuts.cells[place];
}

void forget(CutPatches& cuts) {
  std::fill(cuts.cells.begin(), cuts.cells.end(), CutCell{});
  cuts.near.clear();
  cuts.count = 0;
  cuts.build = 0;
}

/// Patches on their way into blocks.
struct BlockFiller {
  double step;
  std::size_t room;
  CutPatches& cuts;
  FixedList<Corners, PatchBlock::kWidth> members;

  void add(const Corners& patch) {
    if (members.size() == PatchBlock::kWidth) flush();
    members.push_back(patch);
  }
  void flush() {
    if (cuts.count < room) {
      cuts.sphere[cuts.count] = put_block({members.begin(), members.size()}, step, {}, cuts.block[cuts.count],
                                          cuts.shape.data() + cuts.count * PatchBlock::kWidth);
    }
    ++cuts.count;
    members.clear();
  }
};

// The blocks of cells near a hand. False where there is no room for all.
bool find_near(const Model& model, const Limbs& limbs, CutPatches& cuts) {
  const std::size_t room = room_for_blocks(model);
  const double step = model.patches->rules.step;
  bool fits = true;
  cuts.near.clear();
  for_large(model, limbs.ball(), cuts, [&](std::uint32_t triangle) {
    const auto near = [&](const Sphere& sphere, std::uint32_t some) {
      return fits ? limbs.near(sphere, some) : 0;
    };
    const auto take = [&](CellPath path, const auto& for_patches) {
      CutCell cell{model.build, triangle, path};
      CutCell& found = path.halves != 0 ? find_cell(cell, cuts) : cell;
      if (&found == &cell || found.build == 0) {
        cell.first = cuts.count;
        BlockFiller filler{step, room, cuts, {}};
        for_patches([&](const Corners& patch) { filler.add(patch); });
        filler.flush();
        cell.count = cuts.count - cell.first;
        found = cell;
      }
      fits = cuts.count <= room && cuts.near.size() + found.count <= room;
      for (std::uint32_t i = 0; fits && i < found.count; ++i) cuts.near.push_back(found.first + i);
    };
    const Corners at = corners_of(model.triangles, triangle);
    CellWalk{step, near, take}.go(at, limbs.near_plane(at));
  });
  return fits;
}

void put_spheres(Vec3 origin, CutPatches& cuts) {
  constexpr Sphere kNone{{}, -std::numeric_limits<double>::infinity()};
  const std::size_t end = piece_count(cuts.near.size(), SphereBlock::kWidth) * SphereBlock::kWidth;
  for (std::size_t i = 0; i < end; ++i) {
    Sphere sphere = kNone;
    if (i < cuts.near.size()) {
      sphere = cuts.sphere[cuts.near[i]];
      sphere.centre = sphere.centre - origin;
    }
    put_sphere(sphere, i, cuts.round.data());
  }
}

}  // namespace

std::size_t most_blocks(const Model& model) {
  return model.patches->block.size() + (model.patches->large.empty() ? 0 : room_for_blocks(model));
}

void size_cuts(const Model& model, CutPatches& cuts) {
  if (model.patches->large.empty()) return;
  const std::size_t room = room_for_blocks(model);
  at_least(room, cuts.block);
  at_least(room * PatchBlock::kWidth, cuts.shape);
  at_least(room, cuts.sphere);
  at_least(2 * room, cuts.cells);
  at_least(piece_count(room, SphereBlock::kWidth), cuts.round);
  cuts.near.reserve(room);
  for (auto& frontier : cuts.frontier) at_least(frontier_capacity(model.patches->large_tree.head), frontier);
}

bool cut_near(const Model& model, const Primitives& hand, CutPatches& cuts) {
  if (model.patches->large.empty()) return true;
  const HandPlace place = place_of(hand);
  const bool is_again = cuts.build == model.build;
  if (is_again && is_within(cuts.spare, cuts.about, place)) return true;
  cuts.about = place;
  const double at_first = is_again ? cuts.spare : kSpareReach;
  for (const double spare : {at_first, at_first, 0.0}) {
    if (find_near(model, Limbs(cuts.about, spare), cuts)) {
      put_spheres(model.patches->tree.head.origin, cuts);
      cuts.build = model.build;
      cuts.spare = spare;
      return true;
    }
    forget(cuts);
  }
  return false;
}

}  // namespace lumbrical
