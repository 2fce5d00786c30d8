#include "samples/sampled_forces.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "base/at_least.h"
#include "base/parallel.h"
#include "model/primitive.h"
#include "samples/effort.h"

namespace lumbrical {
namespace {

constexpr std::size_t kEveryLevel = kLevels;  // sums of what is the same on all of them

// ---- Numbers of tiles, and of the palm behind the last finger's ----

std::size_t palm_number(const Bodies& bodies) { return bodies.finger_count * Bodies::kTilesApart; }

std::size_t segment_of(const Bodies& bodies, std::size_t number) {
  if (number == palm_number(bodies)) return kPalmSegment;
  return bodies.finger[number / Bodies::kTilesApart].segment[number % Bodies::kTilesApart];
}

// Calls take(number) for every tile whose bit is set.
template <class Take>
void for_numbers(std::uint64_t tiles, const Take& take) {
  for (; tiles != 0; tiles &= tiles - 1) take(static_cast<std::size_t>(__builtin_ctzll(tiles)));
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

/// A hand's patches, and who computes them: one of `threads`, each of which takes its part of every list.
struct SampleWork {
  const SampleKernels& kernels;
  const Patches& patches;
  const Bodies& bodies;
  NearPatches& near;
  SampleThread& memory;
  std::size_t number, threads;
  std::size_t lists = 0;  ///< so far

  [[nodiscard]] const FingerBody* fingers() const { return bodies.finger.data(); }
  [[nodiscard]] BodySums* sums(std::size_t level) const { return memory.sums[level].data(); }
  [[nodiscard]] PatchList list(std::span<const ListedPatch> listed) const {
    return {patches.shape.data(), listed.data(), listed.size(), bodies.origin.data()};
  }
  /// Whole rows of sixteen; where there are too few for all, list by list others go without.
  [[nodiscard]] std::span<const ListedPatch> own_part(std::span<const ListedPatch> all) {
    if (threads == 1) return all;
    const std::size_t rows = piece_count(all.size(), PatchBlock::kWidth), turn = lists++ % threads;
    const auto begin = [&](std::size_t thread) {
      return std::min(all.size(), (rows * thread + turn) / threads * PatchBlock::kWidth);
    };
    return all.subspan(begin(number), begin(number + 1) - begin(number));
  }
  [[nodiscard]] std::span<const ListedPatch> of_kinds(std::uint32_t first, std::uint32_t last,
                                                      std::size_t patch_class) {
    return own_part(near.of_kinds(first, last, patch_class));
  }
};

// Of every number of steps the tiles whose lattices have so many in patches of a class, a bit each.
std::array<std::uint64_t, kMostSteps + 1> tiles_by_steps(const Bodies& bodies, std::size_t level,
                                                         std::size_t patch_class) {
  std::array<std::uint64_t, kMostSteps + 1> tiles{};
  for (std::size_t i = 0; i < bodies.finger_count; ++i) {
    for (std::size_t k = 0; k < bodies.finger[i].tile_count; ++k)
      tiles[bodies.finger[i].steps[k][patch_class][level]] |= std::uint64_t{1}
                                                              << (i * Bodies::kTilesApart + k);
  }
  return tiles;
}

// Patches of kinds `first` to `last`, shared by as many tiles, of which at least one of those is wanted;
// `mark`: which of them are outside is to be said.
PatchList wanted_of(SampleWork& work, std::uint32_t first, std::uint32_t last, std::size_t patch_class,
                    bool mark, std::uint64_t wanted) {
  std::uint64_t innermost = 0;
  for (std::uint32_t k = 0; k < sharers_of(first); ++k) innermost |= wanted >> k;
  const auto is_wanted = [innermost](const ListedPatch& patch) {
    return (innermost >> patch.tile % ListedPatch::kFarEnd & 1u) != 0;
  };
  const std::uint64_t listed_for = work.near.tiles_of_kinds(first, last, patch_class);
  if ((listed_for & innermost) == 0) return {};
  const std::span<const ListedPatch> all = work.of_kinds(first, last, patch_class);
  PatchList list = work.list(all);
  if (mark) list.outside = work.near.outside.data() + (all.data() - work.near.listed.data());
  if ((listed_for & ~innermost) == 0) return list;
  SampleThread& memory = work.memory;
  list.patches = memory.chosen.data();
  list.numbers = memory.numbers.data();
  list.count = 0;
  for (std::size_t i = 0; i < all.size(); ++i) {
    memory.chosen[list.count] = all[i];
    memory.numbers[list.count] = static_cast<std::uint32_t>(i);
    list.count += is_wanted(all[i]) ? 1 : 0;
  }
  return list;
}

// Each tile's share goes by its own lattice, so that it does not change where a neighbour comes near or goes:
// what tiles of different lattices share is done once for each.
void run_fingers(SampleWork& work, std::size_t patch_class, std::size_t steps, bool mark,
                 const TileSums& sums) {
  const auto run = [&](std::uint32_t first, std::uint32_t last, const auto& kernel) {
    const PatchList list = wanted_of(work, first, last, patch_class, mark, sums.wanted);
    if (list.count > 0) work.memory.touched += kernel(list);
  };
  const auto run_part = [&](std::uint32_t first, std::uint32_t last, TilePart part) {
    run(first, last, [&](const PatchList& list) {
      return work.kernels.tile_lattice(list, work.fingers(), part, steps, sums);
    });
  };
  run_part(kind::kTile, kind::kTile + 2, TilePart::whole);
  run_part(kind::kSide, kind::kSide + 2, TilePart::side);
  run_part(kind::kNearEnd, kind::kFarEnd + 2, TilePart::end);
  run(kind::kInnerJoint, kind::kOuterJoint,
      [&](const PatchList& list) { return work.kernels.joint_lattice(list, work.fingers(), steps, sums); });
  run(kind::kFinger, kind::kFinger,
      [&](const PatchList& list) { return work.kernels.finger_lattice(list, work.fingers(), steps, sums); });
}

// Lattices of a level over the patches of a class. The coarsest ones tell which patches finer ones needn't
// see.
void run_lattices(SampleWork& work, std::size_t patch_class, std::size_t level) {
  const bool has_levels = level != kOneCell && work.patches.has_levels[patch_class];
  BodySums* const sums = work.sums(has_levels ? level : kEveryLevel);
  const auto tiles = tiles_by_steps(work.bodies, level, patch_class);
  for (std::size_t steps = 1; steps <= kMostSteps; ++steps) {
    if (tiles[steps] != 0)
      run_fingers(work, patch_class, steps, has_levels && level == 0, {sums, tiles[steps]});
  }
  const auto run_palm = [&](std::uint32_t kind, const auto& kernel) {
    const PatchList list = work.list(work.of_kinds(kind, kind, patch_class));
    if (list.count == 0) return;
    const PalmBody& palm = work.bodies.palm;
    work.memory.touched += kernel(list, palm, palm.steps[patch_class][level], sums[palm_number(work.bodies)]);
  };
  run_palm(kind::kPalmEdge, work.kernels.palm_edge_lattice);
  run_palm(kind::kPalm, work.kernels.palm_lattice);
}

// By the patch's size in steps.
std::size_t rule_for(std::size_t size) { return size < 1 ? 0 : size < 2 ? 1 : size < 5 ? 2 : 3; }

// What lies inside, where fields are smooth, or linear.
void run_smooth(SampleWork& work, std::size_t patch_class) {
  const TileSums sums{work.sums(kEveryLevel), ~std::uint64_t{0}};
  const PatchList inside = work.list(work.of_kinds(kind::kInside, kind::kInside + 2, patch_class)),
                  side = work.list(work.of_kinds(kind::kPalmSide, kind::kPalmSide, patch_class)),
                  through = work.list(work.of_kinds(kind::kPalmThrough, kind::kPalmThrough, patch_class));
  std::uint32_t& touched = work.memory.touched;
  if (inside.count > 0)
    touched += work.kernels.tile_rule(inside, work.fingers(), rule_for(patch_class), sums);
  BodySums& palm_sums = sums.of[palm_number(work.bodies)];
  if (side.count > 0) touched += work.kernels.palm_side(side, work.bodies.palm, palm_sums);
  if (through.count > 0) touched += work.kernels.palm_through(through, work.bodies.palm, palm_sums);
}

void run_blocks(SampleWork& work) {
  const BlockSamples* const samples = work.patches.samples.data();
  const auto fingers = work.of_kinds(kind::kBlockInside, kind::kBlockInside + 2, 0),
             palm = work.of_kinds(kind::kPalmBlock, kind::kPalmBlockBeside, 0);
  for (std::size_t i = 0, end = 0; i < fingers.size(); i = end) {
    const std::uint32_t tile = fingers[i].tile;
    while (end < fingers.size() && fingers[end].tile == tile) ++end;
    const BlockList list{samples, fingers.data() + i, end - i,
                         work.bodies.origin[tile / Bodies::kTilesApart]};
    work.memory.touched +=
        work.kernels.tile_blocks(list, tile_at(work.fingers(), tile), work.sums(kEveryLevel)[tile]);
  }
  if (!palm.empty()) {
    const BlockList list{samples, palm.data(), palm.size(), work.bodies.origin[work.bodies.finger_count]};
    work.memory.touched +=
        work.kernels.palm_blocks(list, work.bodies.palm, work.sums(kEveryLevel)[palm_number(work.bodies)]);
  }
}

// ---- Reduction ----

/// Twice the integral, as kernels leave it, and its moment.
using SumOfLanes = std::array<double, 6>;

// Exact in any order: half onto half is quickest.
double sum_of(const double (&lanes)[PatchBlock::kWidth]) {
  double half[PatchBlock::kWidth];
  std::copy_n(lanes, PatchBlock::kWidth, half);
  for (std::size_t width = PatchBlock::kWidth / 2; width > 0; width /= 2) {
    for (std::size_t i = 0; i < width; ++i) half[i] += half[i + width];
  }
  return half[0];
}

SumOfLanes sum_of(const SampleMemory& memory, std::size_t threads, std::size_t level, std::size_t number) {
  SumOfLanes total{};
  for (std::size_t t = 0; t < threads; ++t) {
    for (std::size_t k = 0; k < 6; ++k) total[k] += sum_of(memory.thread[t].sums[level][number].lane[k]);
  }
  return total;
}

// From the frame of a tile to W, about the segment's joint.
Wrench wrench_of(const SumOfLanes& total, const float (&axis)[3][3], Vec3 origin, Vec3 joint) {
  const auto to_world = [&](const double* v) {
    const auto row = [&](std::size_t i) { return v[0] * axis[0][i] + v[1] * axis[1][i] + v[2] * axis[2][i]; };
    return 0.5 * Vec3{row(0), row(1), row(2)};
  };
  const Vec3 force = to_world(total.data());
  return {force, to_world(total.data() + 3) + cross(origin - joint, force)};
}

Wrench wrench_of(const Bodies& bodies, const SumOfLanes& sums, std::size_t number, Vec3 joint) {
  if (number == palm_number(bodies)) return wrench_of(sums, bodies.palm.axis, bodies.palm.origin, joint);
  const TileFrame& tile = tile_at(bodies.finger.data(), number);
  const Vec3 origin = bodies.finger[number / Bodies::kTilesApart].origin +
                      Vec3{tile.origin[0], tile.origin[1], tile.origin[2]};
  return wrench_of(sums, tile.axis, origin, joint);
}

void add(const Wrench& more, double weight, Wrench& to) {
  to.force += weight * more.force;
  to.torque += weight * more.torque;
}

using SegmentWrenches = std::array<Wrench, kSegmentCount>;

// What all segments feel together, on the coarsest lattices, in units of R^3.
double force_of(const SegmentWrenches& coarsest, const SegmentWrenches& every_level, double radius3) {
  double force = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i) force += norm(coarsest[i].force + every_level[i].force);
  return force / radius3;
}

// Is a patch near of which levels have lattices of their own?
bool has_levels(const Patches& patches, const NearPatches& near) {
  for (std::size_t k = 0; k < kPatchClasses; ++k) {
    if (near.has(k) && patches.has_levels[k]) return true;
  }
  return false;
}

// The lattices of a level; beyond the coarsest those that differ from it.
void run_level(SampleWork& work, std::size_t level) {
  for (std::size_t k = 0; k < kPatchClasses; ++k) {
    if (work.near.has(k) && (level == 0 || level == kOneCell || work.patches.has_levels[k]))
      run_lattices(work, k, level);
  }
}

// ---- On threads ----

// Evaluations below which threads cost more than they bring.
constexpr std::uint64_t kSerialEvaluations = 20000;

/// A hand near patches, and all who compute.
struct SampleTeam {
  const Model& model;
  const Primitives& hand;
  SampleMemory& memory;
  BodySums zero;
  std::size_t threads = 1;

  [[nodiscard]] SegmentWrenches wrenches(std::size_t level) const {
    SegmentWrenches wrenches{};
    for_numbers(memory.near.tiles, [&](std::size_t number) {
      const std::size_t i = segment_of(memory.bodies, number);
      wrenches[i] =
          wrench_of(memory.bodies, sum_of(memory, threads, level, number), number, hand.base_joint[i]);
    });
    return wrenches;
  }
  [[nodiscard]] std::uint32_t touched() const {
    std::uint32_t touched = 0;
    for (std::size_t t = 0; t < threads; ++t) touched += memory.thread[t].touched;
    return touched;
  }
};

// Calls stage(work) for each of as many threads as that many evaluations are worth; sums of `levels` are
// begun anew.
template <class Stage>
void share_out(SampleTeam& team, std::uint64_t evaluations, std::initializer_list<std::size_t> levels,
               const Stage& stage) {
  team.threads = evaluations < kSerialEvaluations ? 1 : team.memory.thread.size();
  parallel_chunks(team.threads, 1, team.threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t number = first; number < last; ++number) {
      SampleThread& own = team.memory.thread[number];
      for (const std::size_t level : levels)
        for_numbers(team.memory.near.tiles, [&](std::size_t k) { own.sums[level][k] = team.zero; });
      own.touched = 0;
      SampleWork work{sample_kernels(team.model.execution.isa),
                      *team.model.patches,
                      team.memory.bodies,
                      team.memory.near,
                      own,
                      number,
                      team.threads};
      stage(work);
    }
  });
}

// What is the same on all levels, and the lattices of one.
void feel_on(SampleTeam& team, std::size_t level, std::uint64_t evaluations, SampledForces& forces) {
  share_out(team, evaluations, {kEveryLevel, 0}, [&](SampleWork& work) {
    run_blocks(work);
    for (std::size_t k = 0; k < kPatchClasses; ++k) {
      if (work.near.has(k)) run_smooth(work, k);
    }
    run_level(work, level);
  });
  forces.contact_count = team.touched();
  forces.segment = team.wrenches(kEveryLevel);
  forces.level = {1};
  forces.evaluations = evaluations;
}

// On lattices of one cell a patch: the coarsest level would cost too much.
void feel_in_one_cell(SampleTeam& team, const Effort& effort, SampledForces& forces) {
  const Patches& patches = *team.model.patches;
  feel_on(team, kOneCell, effort.one_cell, forces);
  forces.coarsened = true;
  forces.error_factor =
      one_cell_error_factor(patches, team.memory.near, force_of({}, forces.segment, patches.radius3));
}

// What finer levels cost over patches that the coarsest one has not found to meet nothing.
void drop_outside(const Patches& patches, NearPatches& near, Effort& effort) {
  drop_outside(near);
  const Effort left = effort_of(patches, near);
  std::copy(left.level.begin() + 1, left.level.end(), effort.level.begin() + 1);
}

// On the coarsest level, and as far as its force, or `levels`, calls for and `most` evaluations allow on
// finer ones.
void feel_on_levels(SampleTeam& team, Effort effort, std::uint64_t most, const LevelWeights* levels,
                    SampledForces& forces) {
  feel_on(team, 0, evaluations_of(effort, {1}), forces);
  if (!has_levels(*team.model.patches, team.memory.near)) return;
  const SegmentWrenches coarsest = team.wrenches(0);
  const double force = force_of(coarsest, forces.segment, team.model.patches->radius3);
  forces.level = levels != nullptr ? *levels : level_weights(force);
  if (forces.level[0] < 1) drop_outside(*team.model.patches, team.memory.near, effort);
  forces.coarsened = keep_effort(effort, most, forces.level);
  forces.evaluations = evaluations_of(effort, forces.level);
  forces.error_factor = forces.coarsened ? error_factor_of(forces.level, force) : 1;
  for (std::size_t level = 0; level < kLevels; ++level) {
    if (!(forces.level[level] > 0)) continue;
    if (level > 0)
      share_out(team, effort.level[level], {level}, [level](SampleWork& work) { run_level(work, level); });
    const SegmentWrenches wrenches = level > 0 ? team.wrenches(level) : coarsest;
    for (std::size_t i = 0; i < kSegmentCount; ++i) add(wrenches[i], forces.level[level], forces.segment[i]);
  }
}

}  // namespace

void size_samples(const Model& model, SampleMemory& memory) {
  if (!model.patches) return;
  size_search(model, memory.search, memory.near);
  at_least(model.execution.threads, memory.thread);
  for (SampleThread& thread : memory.thread) {
    at_least(memory.near.listed.size(), thread.chosen);
    at_least(memory.near.listed.size(), thread.numbers);
    for (auto& sums : thread.sums) sums.resize((Bodies::kMostFingers + 1) * Bodies::kTilesApart);
  }
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

bool sample_forces(const Model& model, const Primitives& hand, std::uint32_t segments, SampleMemory& memory,
                   SampledForces& forces, const LevelWeights* levels) {
  forces = {};
  const Bodies& bodies = memory.bodies;
  set_bodies(hand, segments, *model.patches, memory.bodies);
  if (!find_patches(model, hand, bodies, memory.search, memory.near)) return false;
  forces.patch_count = static_cast<std::uint32_t>(memory.near.count());
  if (forces.patch_count == 0) return true;
  SampleTeam team{model, hand, memory, {}};
  set_quanta(hand, team.zero);
  const Effort effort = effort_of(*model.patches, memory.near);
  const std::uint64_t most = model.settings.effort;
  if (most > 0 && effort.always + effort.level[0] > most) {
    feel_in_one_cell(team, effort, forces);
  } else {
    feel_on_levels(team, effort, most, levels, forces);
  }
  return true;
}

}  // namespace lumbrical
