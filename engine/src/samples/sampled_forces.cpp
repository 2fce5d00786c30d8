#include "samples/sampled_forces.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <span>

#include "index/sphere_tree.h"
#include "lanes/tree_search.h"
#include "model/primitive.h"

namespace lumbrical {
namespace {

constexpr std::size_t kWidth = PatchBlock::kWidth;

// Blocks that are classified at a time: the list of patches has room for all they may hold.
constexpr std::size_t kBlocksAtATime = 64;
constexpr std::size_t kSpare = kBlocksAtATime * kWidth;

// ---- Search ----

// Goes down the levels; `hits(spheres, blocks, count, is_last, to)` asks the spheres of one.
template <class Hits>
std::span<std::uint32_t> search_levels(const SphereTree& tree, SampleMemory& memory, const Hits& hits) {
  if (tree.head.level_count == 0) return {};
  const TreeLayout layout = layout_of(tree.head);
  std::size_t level = tree.head.level_count, count = layout.blocks[level - 1];
  std::uint32_t* from = memory.frontier[0].data();
  std::uint32_t* to = memory.frontier[1].data();
  std::iota(from, from + count, 0u);
  for (const SphereBlock* spheres = blocks_of(tree.lines.data()); level-- > 0;
       spheres += layout.blocks[level]) {
    count = hits(spheres, from, count, level == 0, to);
    std::swap(from, to);
  }
  return {from, count};
}

std::span<std::uint32_t> search_for_finger(const Model& model, const Primitives& hand,
                                           const FingerBody& finger, SampleMemory& memory) {
  const SphereTree& tree = model.patches->tree;
  const SampleKernels& kernels = sample_kernels(model.execution.isa);
  if (model.execution.broadphase == Broadphase::brute) {
    const auto all = static_cast<std::uint32_t>(model.patches->block.size());
    for (std::uint32_t i = 0; i < all; ++i) memory.frontier[0][i] = i << 3 | finger.tiles();
    return {memory.frontier[0].data(), all};
  }
  SphereQuery queries[FingerBody::kMostTiles];
  for (std::size_t k = 0; k < finger.tile_count; ++k)
    queries[k] = query_of(tree.head, hand.capsule[finger.segment[k]]);
  return search_levels(tree, memory,
                       [&](const SphereBlock* spheres, const std::uint32_t* blocks, std::size_t count,
                           bool is_last, std::uint32_t* to) {
                         return kernels.finger_hits(spheres, queries, finger.tile_count, blocks, count,
                                                    is_last, to);
                       });
}

void set_plane(Vec3 normal, double offset, float (&plane)[4]) {
  plane[0] = static_cast<float>(normal.x);
  plane[1] = static_cast<float>(normal.y);
  plane[2] = static_cast<float>(normal.z);
  plane[3] = static_cast<float>(offset);
}

PalmQuery query_of_palm(const TreeHead& tree, const SweptPolygon& palm) {
  constexpr double kFloatSlack = 1.6e-6;
  PalmQuery query;
  double size = tree.radius + norm(tree.centre);
  const auto add = [&](Vec3 normal, Vec3 point) {
    const Vec3 from = point - tree.origin;
    size = max(size, norm(from));
    set_plane(normal, -dot(normal, from) - palm.radius, query.plane[query.plane_count++]);
  };
  add(palm.normal, palm.corner[0]);
  add(-palm.normal, palm.corner[0]);
  for (int k = 0; k < palm.corner_count; ++k)
    add(palm.outward[static_cast<std::size_t>(k)], palm.corner[static_cast<std::size_t>(k)]);
  query.slack = static_cast<float>(kFloatSlack * (size + palm.radius));
  return query;
}

std::span<std::uint32_t> search_for_palm(const Model& model, const Primitives& hand, SampleMemory& memory) {
  const SphereTree& tree = model.patches->tree;
  if (model.execution.broadphase == Broadphase::brute) {
    std::iota(memory.frontier[0].begin(), memory.frontier[0].end(), 0u);
    return {memory.frontier[0].data(), model.patches->block.size()};
  }
  const SampleKernels& kernels = sample_kernels(model.execution.isa);
  const PalmQuery query = query_of_palm(tree.head, hand.palm);
  return search_levels(
      tree, memory,
      [&](const SphereBlock* spheres, const std::uint32_t* blocks, std::size_t count, bool,
          std::uint32_t* to) { return kernels.palm_hits(spheres, query, blocks, count, to); });
}

// ---- Classification ----

// Appends the patches of the blocks found; `sort` takes out, sixteen blocks at a time, what is nothing or a
// whole block, `classify` looks at the patches of the rest. False where there is no room.
template <class Sort, class Classify>
bool append_patches(std::span<std::uint32_t> blocks, SampleMemory& memory, std::size_t& count,
                    const Sort& sort, const Classify& classify) {
  std::size_t open = 0;
  for (std::size_t i = 0; i < blocks.size(); i += kWidth) {
    if (count + kWidth > memory.found.size()) return false;
    const auto sorted =
        sort(blocks.data() + i, std::min(kWidth, blocks.size() - i), memory.found.data() + count);
    count += sorted.whole_count;
    std::copy_n(blocks.data() + i, sorted.open_count, blocks.data() + open);
    open += sorted.open_count;
  }
  for (std::size_t i = 0; i < open; i += kBlocksAtATime) {
    if (count + kSpare > memory.found.size()) return false;
    count += classify(blocks.data() + i, std::min(kBlocksAtATime, open - i), memory.found.data() + count);
  }
  return count + kSpare <= memory.found.size();  // whatever else was looked at
}

/// Where a body's patches are in the order of their keys: those of key k from begin[k] to begin[k + 1].
struct KeyOrder {
  std::array<std::uint32_t, kKeyCount + 1> begin{};
};

void order_by_key(std::span<const FoundPatch> found, std::uint32_t* places, KeyOrder& order) {
  order.begin.fill(0);
  for (const FoundPatch& patch : found) ++order.begin[patch.key + 1];
  std::partial_sum(order.begin.begin(), order.begin.end(), order.begin.begin());
  std::array<std::uint32_t, kKeyCount> next;
  std::copy_n(order.begin.begin(), kKeyCount, next.begin());
  for (const FoundPatch& patch : found) places[next[patch.key]++] = patch.place;
}

// ---- Kernels ----

// What is added to sums is rounded to: 4e-12 of R^3 or less, so that a thousand addends are not off by a
// share of 1e-9 that a hand feels, and 4000 R^3 fit in, forty times what a whole hand laid flat and deep
// comes to.
void set_quanta(const Primitives& hand, BodySums& sums) {
  double largest = hand.palm.radius;
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    if (hand.present[i]) largest = max(largest, max(hand.capsule[i].radius1, hand.capsule[i].radius2));
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  sums.force_quantum = std::ldexp(1.0, 3 * exponent - 38);
  sums.moment_quantum = std::ldexp(1.0, 4 * exponent - 38);
}

// By the patch's size in the tile's radius: what is inside is smooth.
std::size_t inner_rule(std::size_t steps) { return steps <= 1 ? 0 : steps <= 2 ? 1 : steps <= 5 ? 2 : 3; }

/// One body's patches in order of their keys, and who computes them.
struct BodyWork {
  const SampleKernels& kernels;
  const Patches& patches;
  const std::uint32_t* places;
  const KeyOrder& order;
  Vec3 origin;
  std::uint32_t touched = 0;

  [[nodiscard]] bool has(std::size_t size) const {
    return order.begin[size * kind::kCount] < order.begin[(size + 1) * kind::kCount];
  }
  [[nodiscard]] PatchList list_of(std::uint32_t what, std::size_t size) const {
    const std::size_t key = size * kind::kCount + what;
    return {patches.block.data(), places + order.begin[key], order.begin[key + 1] - order.begin[key], origin};
  }
  [[nodiscard]] BlockList blocks_of(std::uint32_t what) const {
    return {patches.samples.data(), places + order.begin[what], order.begin[what + 1] - order.begin[what],
            origin};
  }
};

// Patches that may meet one tile alone. Of those nearest to one part of it whole rows go to that part's
// kernel; what is left over goes with the rest, to the whole tile's, which gives the same bits.
void run_tile(BodyWork& work, const TileFrame& tile, std::uint32_t number, std::size_t steps,
              std::size_t size, BodySums& sums) {
  const PatchList inside = work.list_of(kind::kInside + number, size);
  if (inside.count > 0) work.touched += work.kernels.tile_rule(inside, tile, inner_rule(steps), sums);
  std::array<std::uint32_t, 3 * kWidth> odd;
  std::size_t odd_count = 0;
  for (const auto& [part, what] : {std::pair{TilePart::side, kind::kSide},
                                   {TilePart::near_end, kind::kNearEnd},
                                   {TilePart::far_end, kind::kFarEnd}}) {
    PatchList list = work.list_of(what + number, size);
    const std::size_t whole = list.count / kWidth * kWidth;
    odd_count = static_cast<std::size_t>(
        std::copy(list.places + whole, list.places + list.count, odd.begin() + odd_count) - odd.begin());
    list.count = whole;
    if (whole > 0) work.touched += work.kernels.tile_lattice(list, tile, part, steps, sums);
  }
  PatchList list = work.list_of(kind::kTile + number, size);
  const std::size_t filled = std::min((kWidth - odd_count % kWidth) % kWidth, list.count);
  std::copy_n(list.places, filled, odd.begin() + odd_count);
  PatchList rest = list;
  rest.places = odd.data();
  rest.count = odd_count + filled;
  list.places += filled;
  list.count -= filled;
  for (const PatchList& part : {rest, list}) {
    if (part.count > 0) work.touched += work.kernels.tile_lattice(part, tile, TilePart::whole, steps, sums);
  }
}

// Patches that tiles `first` to `last` share. Each tile's share goes by its own lattice, so that it does not
// change where a neighbour comes near or goes.
void run_shared(BodyWork& work, const FingerBody& finger, std::uint32_t what, std::size_t first,
                std::size_t last, std::size_t size, BodySums* sums) {
  const PatchList list = work.list_of(what, size);
  if (list.count == 0) return;
  std::uint32_t touched = 0;
  for (unsigned done = 0, k = 0; k <= last - first; ++k) {
    if ((done >> k & 1u) != 0) continue;
    const std::uint8_t steps = finger.steps[first + k][size];
    unsigned wanted = 0;
    for (std::size_t i = k; i <= last - first; ++i)
      wanted |= static_cast<unsigned>(finger.steps[first + i][size] == steps) << i;
    done |= wanted;
    const TileFrame* const tiles = finger.tile + first;
    const JointSides* const joints = finger.joint + first;
    touched = std::max(
        touched, last - first == 1
                     ? work.kernels.joint_lattice(list, tiles, joints, steps, wanted, sums + first)
                     : work.kernels.finger_lattice(list, tiles, joints, finger.folded, steps, wanted, sums));
  }
  work.touched += touched;
}

void run_finger(BodyWork& work, const FingerBody& finger, BodySums* sums) {
  for (std::uint32_t k = 0; k < finger.tile_count; ++k) {
    const BlockList list = work.blocks_of(kind::kBlockInside + k);
    if (list.count > 0) work.touched += work.kernels.tile_blocks(list, finger.tile[k], sums[k]);
  }
  for (std::size_t size = 0; size < kPatchSizes; ++size) {
    if (!work.has(size)) continue;
    for (std::uint32_t k = 0; k < finger.tile_count; ++k)
      run_tile(work, finger.tile[k], k, finger.steps[k][size], size, sums[k]);
    if (finger.tile_count > 1) run_shared(work, finger, kind::kInnerJoint, 0, 1, size, sums);
    if (finger.tile_count > 2) run_shared(work, finger, kind::kOuterJoint, 1, 2, size, sums);
    if (finger.tile_count > 2) run_shared(work, finger, kind::kFinger, 0, 2, size, sums);
  }
}

void run_palm(BodyWork& work, const PalmBody& palm, BodySums& sums) {
  const BlockList list = work.blocks_of(kind::kPalmBlock);
  if (list.count > 0) work.touched += work.kernels.palm_blocks(list, palm, sums);
  for (std::size_t size = 0; size < kPatchSizes; ++size) {
    const PatchList side = work.list_of(kind::kPalmSide, size), any = work.list_of(kind::kPalm, size);
    if (side.count > 0) work.touched += work.kernels.palm_side(side, palm, sums);
    if (any.count > 0) work.touched += work.kernels.palm_lattice(any, palm, palm.steps[size], sums);
  }
}

// ---- Reduction ----

// From the frame of a tile to W, about the segment's joint. Kernels leave twice the integral.
Wrench wrench_of(const BodySums& sums, const float (&axis)[3][3], Vec3 origin, Vec3 joint) {
  double total[6] = {};
  for (std::size_t k = 0; k < 6; ++k) {
    for (const double lane : sums.lane[k]) total[k] += lane;
  }
  const auto to_world = [&](const double* v) {
    const auto row = [&](std::size_t i) { return v[0] * axis[0][i] + v[1] * axis[1][i] + v[2] * axis[2][i]; };
    return 0.5 * Vec3{row(0), row(1), row(2)};
  };
  const Vec3 force = to_world(total);
  return {force, to_world(total + 3) + cross(origin - joint, force)};
}

}  // namespace

void size_samples(const Model& model, SampleMemory& memory) {
  if (!model.patches) return;
  const Patches& patches = *model.patches;
  const std::size_t blocks =
      std::max<std::size_t>(patches.block.size(), frontier_capacity(patches.tree.head));
  for (auto& frontier : memory.frontier) frontier.resize(blocks);
  const std::size_t most = (Bodies::kMostFingers + 1) * patches.block.size() * kWidth;
  const std::size_t room = std::min<std::size_t>(model.settings.max_candidates, most);
  memory.found.resize(room + kSpare);
  memory.ordered.resize(room + kSpare);
}

std::uint32_t sampled_segments(const Model& model) {
  std::uint32_t segments = 0;
  if (!model.patches) return segments;
  for (std::size_t i = 0; i < kSegmentCount; ++i)
    segments |= static_cast<std::uint32_t>(is_sampled(model.settings, i)) << i;
  return segments;
}

bool felt_by_samples(const Model& model, std::size_t segment, std::uint32_t triangle) {
  return (sampled_segments(model) >> segment & 1u) != 0 && is_sampled(*model.patches, triangle);
}

namespace {

/// Where the patches of each finger and, last, of the palm begin in SampleMemory::found.
using BodyBegins = std::array<std::size_t, Bodies::kMostFingers + 2>;

// Search and classification of all bodies; false where there is no room.
bool find_patches(const Model& model, const Primitives& hand, SampleMemory& memory, BodyBegins& begin) {
  const Bodies& bodies = memory.bodies;
  const PatchBlock* const blocks = model.patches->block.data();
  const BlockSamples* const samples = model.patches->samples.data();
  const SampleKernels& kernels = sample_kernels(model.execution.isa);
  std::size_t count = 0;
  for (std::size_t i = 0; i < bodies.finger_count; ++i) {
    const FingerBody& finger = bodies.finger[i];
    const auto near = search_for_finger(model, hand, finger, memory);
    const bool fits = append_patches(
        near, memory, count,
        [&](std::uint32_t* from, std::size_t more, FoundPatch* to) {
          return kernels.sort_blocks(samples, finger, from, more, to);
        },
        [&](const std::uint32_t* from, std::size_t more, FoundPatch* to) {
          return kernels.classify_finger(blocks, finger, from, more, to);
        });
    if (!fits) return false;
    begin[i + 1] = count;
  }
  if (bodies.palm.corner_count > 0) {
    const auto near = search_for_palm(model, hand, memory);
    const bool fits = append_patches(
        near, memory, count,
        [&](std::uint32_t* from, std::size_t more, FoundPatch* to) {
          return kernels.sort_palm_blocks(samples, bodies.palm, from, more, to);
        },
        [&](const std::uint32_t* from, std::size_t more, FoundPatch* to) {
          return kernels.classify_palm(blocks, bodies.palm, from, more, to);
        });
    if (!fits) return false;
  }
  begin[bodies.finger_count + 1] = count;
  return true;
}

// The forces of body i, the palm behind the fingers, from its patches.
void add_body_forces(const Model& model, const Primitives& hand, std::size_t i,
                     std::span<const FoundPatch> found, SampleMemory& memory, SampledForces& forces) {
  const Bodies& bodies = memory.bodies;
  KeyOrder order;
  order_by_key(found, memory.ordered.data(), order);
  const bool is_palm = i == bodies.finger_count;
  BodyWork work{sample_kernels(model.execution.isa), *model.patches, memory.ordered.data(), order,
                is_palm ? bodies.palm.origin : bodies.finger[i].origin};
  BodySums sums[FingerBody::kMostTiles];
  for (BodySums& sum : sums) set_quanta(hand, sum);
  if (is_palm) {
    run_palm(work, bodies.palm, sums[0]);
    forces.segment[kPalmSegment] =
        wrench_of(sums[0], bodies.palm.axis, bodies.palm.origin, hand.base_joint[kPalmSegment]);
  } else {
    const FingerBody& finger = bodies.finger[i];
    run_finger(work, finger, sums);
    for (std::size_t k = 0; k < finger.tile_count; ++k) {
      const TileFrame& tile = finger.tile[k];
      const Vec3 origin = finger.origin + Vec3{tile.origin[0], tile.origin[1], tile.origin[2]};
      forces.segment[finger.segment[k]] =
          wrench_of(sums[k], tile.axis, origin, hand.base_joint[finger.segment[k]]);
    }
  }
  forces.contact_count += work.touched;
}

}  // namespace

bool sample_forces(const Model& model, const Primitives& hand, std::uint32_t segments, SampleMemory& memory,
                   SampledForces& forces) {
  forces = {};
  set_bodies(hand, segments, *model.patches, memory.bodies);
  BodyBegins begin{};
  if (!find_patches(model, hand, memory, begin)) return false;
  const std::size_t bodies = memory.bodies.finger_count + 1;
  forces.patch_count = static_cast<std::uint32_t>(begin[bodies]);
  for (std::size_t i = 0; i < bodies; ++i) {
    const std::span found(memory.found.data() + begin[i], begin[i + 1] - begin[i]);
    if (!found.empty()) add_body_forces(model, hand, i, found, memory, forces);
  }
  return true;
}

}  // namespace lumbrical
