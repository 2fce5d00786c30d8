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

// Sums of what is felt once and, where two levels are mixed, by the lattices of either.
enum Part : std::size_t { kOnce, kCoarser, kFiner };

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
BodySums empty_sums(const Primitives& hand) {
  double largest = hand.palm.radius;
  for (std::size_t i = 0; i < kPhalanxCount; ++i) {
    if (hand.present[i]) largest = max(largest, max(hand.capsule[i].radius1, hand.capsule[i].radius2));
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  BodySums sums;
  sums.force_quantum = std::ldexp(1.0, 3 * exponent - 38);
  sums.moment_quantum = std::ldexp(1.0, 4 * exponent - 38);
  return sums;
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
  [[nodiscard]] BodySums* sums(Part part) const { return memory.sums[part].data(); }
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

// Patches of kinds `first` to `last`, shared by as many tiles, of which at least one of those is wanted.
PatchList wanted_of(SampleWork& work, std::uint32_t first, std::uint32_t last, std::size_t patch_class,
                    std::uint64_t wanted) {
  std::uint64_t innermost = 0;
  for (std::uint32_t k = 0; k < sharers_of(first); ++k) innermost |= wanted >> k;
  const auto is_wanted = [innermost](const ListedPatch& patch) {
    return (innermost >> patch.tile % ListedPatch::kFarEnd & 1u) != 0;
  };
  const std::uint64_t listed_for = work.near.tiles_of_kinds(first, last, patch_class);
  if ((listed_for & innermost) == 0) return {};
  const std::span<const ListedPatch> all = work.of_kinds(first, last, patch_class);
  PatchList list = work.list(all);
  if ((listed_for & ~innermost) == 0) return list;
  list.patches = work.memory.chosen.data();
  list.count =
      static_cast<std::size_t>(std::copy_if(all.begin(), all.end(), work.memory.chosen.begin(), is_wanted) -
                               work.memory.chosen.begin());
  return list;
}

// Each tile's share goes by its own lattice, so that it does not change where a neighbour comes near or goes:
// what tiles of different lattices share is done once for each.
void run_fingers(SampleWork& work, std::size_t patch_class, std::size_t steps, const TileSums& sums) {
  const auto run = [&](std::uint32_t first, std::uint32_t last, const auto& kernel) {
    const PatchList list = wanted_of(work, first, last, patch_class, sums.wanted);
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

// Lattices of a level over the patches of a class.
void run_lattices(SampleWork& work, std::size_t patch_class, std::size_t level, Part part) {
  BodySums* const sums = work.sums(part);
  const auto tiles = tiles_by_steps(work.bodies, level, patch_class);
  for (std::size_t steps = 1; steps <= kMostSteps; ++steps) {
    if (tiles[steps] != 0) run_fingers(work, patch_class, steps, {sums, tiles[steps]});
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
  const TileSums sums{work.sums(kOnce), ~std::uint64_t{0}};
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
        work.kernels.tile_blocks(list, tile_at(work.fingers(), tile), work.sums(kOnce)[tile]);
  }
  if (!palm.empty()) {
    const BlockList list{samples, palm.data(), palm.size(), work.bodies.origin[work.bodies.finger_count]};
    work.memory.touched +=
        work.kernels.palm_blocks(list, work.bodies.palm, work.sums(kOnce)[palm_number(work.bodies)]);
  }
}

// ---- Reduction ----

/// Twice the integral, as kernels leave it, and its moment.
using SumOfLanes = std::array<double, 6>;

SumOfLanes total_of(const SampleMemory& memory, std::size_t threads, Part part, std::size_t number) {
  SumOfLanes total{};
  for (std::size_t t = 0; t < threads; ++t) {
    for (std::size_t k = 0; k < 6; ++k) total[k] += sum_of(memory.thread[t].sums[part][number].lane[k]);
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

  [[nodiscard]] SegmentWrenches wrenches(Part part) const {
    SegmentWrenches wrenches{};
    for_numbers(memory.near.tiles, [&](std::size_t number) {
      const std::size_t i = segment_of(memory.bodies, number);
      wrenches[i] =
          wrench_of(memory.bodies, total_of(memory, threads, part, number), number, hand.base_joint[i]);
    });
    return wrenches;
  }
  [[nodiscard]] std::uint32_t touched() const {
    std::uint32_t touched = 0;
    for (std::size_t t = 0; t < threads; ++t) touched += memory.thread[t].touched;
    return touched;
  }
};

// Calls stage(work) for each of as many threads as that many evaluations are worth; sums of `parts` are begun
// anew.
template <class Stage>
void share_out(SampleTeam& team, std::uint64_t evaluations, std::initializer_list<Part> parts,
               const Stage& stage) {
  team.threads = evaluations < kSerialEvaluations ? 1 : team.memory.thread.size();
  parallel_chunks(team.threads, 1, team.threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t number = first; number < last; ++number) {
      SampleThread& own = team.memory.thread[number];
      for (const Part part : parts)
        for_numbers(team.memory.near.tiles, [&](std::size_t k) { own.sums[part][k] = team.zero; });
      own.touched = 0;
      SampleWork work{sample_kernels(team.model.execution.isa),
                      *team.model.patches,
                      team.memory.bodies,
                      team.memory.near,
                      own,
                      number,
                      team.threads};
      run_blocks(work);
      for (std::size_t k = 0; k < kPatchClasses; ++k) {
        if (!work.near.has(k)) continue;
        run_smooth(work, k);
        stage(work, k);
      }
    }
  });
}

void feel_on_one_level(SampleTeam& team, std::size_t level, SampledForces& forces) {
  share_out(team, forces.evaluations, {kOnce}, [level](SampleWork& work, std::size_t patch_class) {
    run_lattices(work, patch_class, level, kOnce);
  });
  forces.segment = team.wrenches(kOnce);
}

// On a level and the next finer one. Patches whose lattices are the same on all levels are felt once.
void feel_on_two_levels(SampleTeam& team, std::size_t coarser, SampledForces& forces) {
  const auto& has_levels = team.model.patches->has_levels;
  share_out(team, forces.evaluations, {kOnce, kCoarser, kFiner},
            [&](SampleWork& work, std::size_t patch_class) {
              if (!has_levels[patch_class]) return run_lattices(work, patch_class, coarser, kOnce);
              const std::uint32_t touched = work.memory.touched;
              run_lattices(work, patch_class, coarser + 1, kFiner);
              work.memory.touched = touched;
              run_lattices(work, patch_class, coarser, kCoarser);
            });
  forces.segment = team.wrenches(kOnce);
  for (const Part part : {kCoarser, kFiner}) {
    const SegmentWrenches wrenches = team.wrenches(part);
    for (std::size_t i = 0; i < kSegmentCount; ++i)
      add(wrenches[i], forces.level[part == kFiner ? coarser + 1 : coarser], forces.segment[i]);
  }
}

// Looks for what is near as a level wants it: blocks that the skin goes through are taken as ones or opened.
bool find_for(SampleTeam& team, std::size_t level) {
  take_blocks_on_skin(team.model.patches->block_on_skin[level], team.memory.bodies);
  return find_patches(team.model, team.hand, team.memory.bodies, team.memory.search, team.memory.near);
}

std::size_t coarsest_of(const LevelWeights& weights) {
  std::size_t level = 0;
  while (!(weights[level] > 0)) ++level;
  return level;
}

void feel_in_one_cell(SampleTeam& team, const Effort& effort, double force, SampledForces& forces) {
  forces.level = {1};
  forces.evaluations = effort.one_cell;
  forces.coarsened = true;
  forces.error_factor = one_cell_error_factor(*team.model.patches, team.memory.near, force);
  feel_on_one_level(team, kOneCell, forces);
}

LevelWeights only(std::size_t level) {
  LevelWeights weights{};
  weights[level] = 1;
  return weights;
}

// On a level and, as far as the effort allows, the next finer one, which takes other blocks as ones.
bool feel_apart(SampleTeam& team, std::size_t coarser, const Effort& effort, double force,
                SampledForces& forces) {
  forces.evaluations = evaluations_of(effort, only(coarser));
  feel_on_one_level(team, coarser, forces);
  if (!find_for(team, coarser + 1)) return false;
  SampledForces finer;
  finer.evaluations = evaluations_of(effort_of(*team.model.patches, team.memory.near), only(coarser + 1));
  const std::uint64_t most = team.model.settings.effort;
  if (most > 0 && forces.evaluations + finer.evaluations > most) {
    forces.level = only(coarser);
    forces.coarsened = true;
    forces.error_factor = error_factor_of(forces.level, force);
    return true;
  }
  feel_on_one_level(team, coarser + 1, finer);
  forces.evaluations += finer.evaluations;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    Wrench mixed;
    add(forces.segment[i], forces.level[coarser], mixed);
    add(finer.segment[i], forces.level[coarser + 1], mixed);
    forces.segment[i] = mixed;
  }
  return true;
}

// On the levels that the force at centroids calls for, or `levels`, as far as Settings::effort allows. What
// is near has been found for the coarsest one, which asks for the least.
bool feel(SampleTeam& team, const LevelWeights* levels, SampledForces& forces) {
  const Patches& patches = *team.model.patches;
  const auto same_blocks = [&](std::size_t a, std::size_t b) {
    return patches.block_on_skin[a] == patches.block_on_skin[b];
  };
  const double force = force_at_centroids(team.memory.search) / patches.radius3;
  const std::uint64_t most = team.model.settings.effort;
  forces.level = levels != nullptr ? *levels : level_weights(force);
  if (same_blocks(0, 1)) {  // they have the same lattices
    forces.level[1] += forces.level[0];
    forces.level[0] = 0;
  }
  std::size_t coarsest = coarsest_of(forces.level);
  if (!same_blocks(coarsest, 0) && !find_for(team, coarsest)) return false;
  Effort effort = effort_of(patches, team.memory.near);
  if (most > 0 && !same_blocks(coarsest, 0) && evaluations_of(effort, forces.level) > most) {
    if (!find_for(team, 0)) return false;
    effort = effort_of(patches, team.memory.near);
  }
  if (most > 0 && effort.always + effort.level[0] > most) {
    feel_in_one_cell(team, effort, force, forces);
    return true;
  }
  forces.coarsened = keep_effort(effort, most, forces.level);
  forces.evaluations = evaluations_of(effort, forces.level);
  forces.error_factor = forces.coarsened ? error_factor_of(forces.level, force) : 1;
  coarsest = coarsest_of(forces.level);
  if (!(forces.level[coarsest] < 1)) {
    feel_on_one_level(team, coarsest, forces);
  } else if (same_blocks(coarsest, coarsest + 1)) {
    feel_on_two_levels(team, coarsest, forces);
  } else {
    return feel_apart(team, coarsest, effort, force, forces);
  }
  return true;
}

}  // namespace

void size_samples(const Model& model, SampleMemory& memory) {
  if (!model.patches) return;
  size_search(model, memory.search, memory.near);
  at_least(model.execution.threads, memory.thread);
  for (SampleThread& thread : memory.thread) {
    at_least(memory.near.listed.size(), thread.chosen);
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
  set_bodies(hand, segments, *model.patches, memory.bodies);
  SampleTeam team{model, hand, memory, empty_sums(hand)};
  if (!find_for(team, 0)) return false;
  forces.patch_count = static_cast<std::uint32_t>(memory.near.count());
  if (forces.patch_count == 0) return true;
  if (!feel(team, levels, forces)) return false;
  forces.contact_count = team.touched();
  return true;
}

}  // namespace lumbrical
