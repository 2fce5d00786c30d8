#include "samples/sampled_forces.h"

#include <cmath>

#include "base/at_least.h"
#include "base/parallel.h"
#include "base/wrench.h"
#include "model/primitive.h"
#include "samples/effort.h"

namespace lumbrical {
namespace {

// What is added to sums is rounded to: 4e-12 to 3e-11 of R^3, so that a thousand addends are not off by a
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

// ---- Reduction ----

/// Twice the integral, as kernels leave it, and its moment.
using SumOfLanes = std::array<double, 6>;

SumOfLanes total_of(const SampleMemory& memory, std::size_t threads, Mix mix, std::size_t number) {
  SumOfLanes total{};
  for (std::size_t t = 0; t < threads; ++t) {
    for (std::size_t k = 0; k < 6; ++k) total[k] += sum_of(memory.thread[t].sums_of(mix)[number].lane[k]);
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
  const Vec3 origin =
      bodies.finger[body_of(number)].origin + Vec3{tile.origin[0], tile.origin[1], tile.origin[2]};
  return wrench_of(sums, tile.axis, origin, joint);
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

  [[nodiscard]] SegmentWrenches wrenches(Mix mix) const {
    SegmentWrenches wrenches{};
    for_numbers(memory.near.tiles, [&](std::size_t number) {
      const std::size_t i = segment_of(memory.bodies, number);
      wrenches[i] =
          wrench_of(memory.bodies, total_of(memory, threads, mix, number), number, hand.base_joint[i]);
    });
    return wrenches;
  }
  [[nodiscard]] std::uint32_t touched() const {
    std::uint32_t touched = 0;
    for (std::size_t t = 0; t < threads; ++t) touched += memory.thread[t].touched;
    return touched;
  }
};

// Calls stage(work) for each of as many threads as that many evaluations are worth; sums of `mixes` are begun
// anew.
template <class Stage>
void share_out(SampleTeam& team, std::uint64_t evaluations, std::initializer_list<Mix> mixes,
               const Stage& stage) {
  team.threads = evaluations < kSerialEvaluations ? 1 : team.memory.thread.size();
  parallel_chunks(team.threads, 1, team.threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t number = first; number < last; ++number) {
      SampleThread& own = team.memory.thread[number];
      for (const Mix mix : mixes)
        for_numbers(team.memory.near.tiles, [&](std::size_t k) { own.sums_of(mix)[k] = team.zero; });
      own.touched = 0;
      SampleWork work{sample_kernels(team.model.execution.isa),
                      *team.model.patches,
                      team.memory.search.cuts,
                      team.memory.bodies,
                      team.memory.near,
                      own,
                      number,
                      team.threads};
      for (const std::size_t block_class : {kWithinSkin, kAcrossSkin}) run_blocks(work, block_class);
      for (std::size_t k = 0; k < kPatchClasses; ++k) {
        if (!work.near.has(k)) continue;
        run_smooth(work, k);
        stage(work, k);
      }
    }
  });
}

void feel_on_one_level(SampleTeam& team, std::size_t level, SampledForces& forces) {
  share_out(team, forces.evaluations, {Mix::once}, [level](SampleWork& work, std::size_t patch_class) {
    run_lattices(work, patch_class, level, Mix::once);
  });
  forces.segment = team.wrenches(Mix::once);
}

// On a level and the next finer one. Patches whose lattices are the same on all levels are felt once.
void feel_on_two_levels(SampleTeam& team, std::size_t coarser, SampledForces& forces) {
  const auto& has_levels = team.model.patches->rules.has_levels;
  share_out(team, forces.evaluations, {Mix::once, Mix::coarser, Mix::finer},
            [&](SampleWork& work, std::size_t patch_class) {
              if (!has_levels[patch_class]) return run_lattices(work, patch_class, coarser, Mix::once);
              const std::uint32_t touched = work.memory.touched;
              run_lattices(work, patch_class, coarser + 1, Mix::finer);
              work.memory.touched = touched;
              run_lattices(work, patch_class, coarser, Mix::coarser);
            });
  forces.segment = team.wrenches(Mix::once);
  for (const Mix mix : {Mix::coarser, Mix::finer}) {
    const SegmentWrenches wrenches = team.wrenches(mix);
    for (std::size_t i = 0; i < kSegmentCount; ++i)
      forces.segment[i] += forces.fineness.level[mix == Mix::finer ? coarser + 1 : coarser] * wrenches[i];
  }
}

// Looks for what is near as a level wants it: blocks that the skin goes through are taken as ones or opened.
bool find_for(SampleTeam& team, std::size_t level) {
  take_blocks_on_skin(team.model.patches->rules.block_on_skin[level], team.memory.bodies);
  return find_patches(team.model, team.hand, team.memory.bodies, team.memory.search);
}

// The same from what was found for a coarser level.
bool open_for(SampleTeam& team, std::size_t level) {
  take_blocks_on_skin(team.model.patches->rules.block_on_skin[level], team.memory.bodies);
  return open_patches(team.model, team.hand, team.memory.bodies, team.memory.search);
}

bool list(SampleTeam& team) {
  SampleMemory& memory = team.memory;
  return list_patches(team.model, memory.bodies, memory.search, memory.near);
}

std::size_t coarsest_of(const LevelWeights& weights) {
  std::size_t level = 0;
  while (!(weights[level] > 0)) ++level;
  return level;
}

SegmentWrenches mix(const SegmentWrenches& one, double of_one, const SegmentWrenches& other,
                    double of_other) {
  SegmentWrenches mixed{};
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    mixed[i] += of_one * one[i];
    mixed[i] += of_other * other[i];
  }
  return mixed;
}

// Whatever the hand's levels.
SampledForces in_one_cell(SampleTeam& team, const Effort& effort, double force) {
  SampledForces forces;
  forces.evaluations = effort.one_cell;
  forces.error_factor = one_cell_error_factor(team.model.patches->rules, team.memory.near, force);
  feel_on_one_level(team, kOneCell, forces);
  return forces;
}

void mix_in(const SampledForces& rough, double share, SampledForces& forces) {
  forces.segment = mix(forces.segment, 1 - share, rough.segment, share);
  forces.evaluations += rough.evaluations;
  forces.error_factor = (1 - share) * forces.error_factor + share * rough.error_factor;
  forces.coarsened = true;
}

Effort effort_of(const SampleTeam& team) { return effort_of(team.model.patches->rules, team.memory.near); }

// Of Settings::effort; 0: as much as it takes.
std::uint64_t effort_left(const SampleTeam& team) {
  const std::uint64_t most = team.model.settings.effort, spent = team.memory.spent;
  if (most == 0) return 0;
  return spent < most ? most - spent : 1;
}

bool same_blocks(const SampleTeam& team, std::size_t a, std::size_t b) {
  const auto& block = team.model.patches->rules.block_on_skin;
  return block[a] == block[b];
}

LevelWeights only(std::size_t level) {
  LevelWeights weights{};
  weights[level] = 1;
  return weights;
}

// On a level and, as far as `most` allows (0: all), the next finer one, which takes other blocks as ones.
bool feel_by_level(SampleTeam& team, std::size_t coarser, const Effort& effort, std::uint64_t most,
                   double force, SampledForces& forces) {
  LevelWeights& level = forces.fineness.level;
  forces.evaluations = evaluations_of(effort, only(coarser));
  feel_on_one_level(team, coarser, forces);
  if (!open_for(team, coarser + 1) || !list(team)) return false;
  SampledForces finer;
  finer.evaluations = evaluations_of(effort_of(team), only(coarser + 1));
  if (most > 0 && forces.evaluations + finer.evaluations > most) {
    level = only(coarser);
    forces.coarsened = true;
    forces.error_factor = error_factor_of(level, force);
    return true;
  }
  feel_on_one_level(team, coarser + 1, finer);
  forces.evaluations += finer.evaluations;
  forces.segment = mix(forces.segment, level[coarser], finer.segment, level[coarser + 1]);
  return true;
}

// On the levels of forces.fineness, as far as `most` allows (0: all).
bool feel_levels(SampleTeam& team, const Effort& effort, std::uint64_t most, double force,
                 SampledForces& forces) {
  const Fineness& fineness = forces.fineness;
  LevelWeights& level = forces.fineness.level;
  forces.coarsened = keep_effort(effort, most, level) || fineness.coarse_blocks;
  forces.evaluations = evaluations_of(effort, level);
  if (forces.coarsened)  // a level's blocks are off as much as its lattices
    forces.error_factor = error_factor_of(fineness.coarse_blocks ? only(0) : level, force);
  const std::size_t coarsest = coarsest_of(level);
  if (!(level[coarsest] < 1)) {
    feel_on_one_level(team, coarsest, forces);
  } else if (fineness.coarse_blocks || same_blocks(team, coarsest, coarsest + 1)) {
    feel_on_two_levels(team, coarsest, forces);
  } else {
    return feel_by_level(team, coarsest, effort, most, force, forces);
  }
  return true;
}

// As finely as the force at centroids calls for and Settings::effort allows, or as `given`. What is near has
// been found for the coarsest level, which asks for the least.
bool feel(SampleTeam& team, const Fineness* given, SampledForces& forces) {
  const double force =
      force_at_centroids(team.memory.bodies, team.memory.search) / team.model.patches->rules.radius3;
  const std::uint64_t most = given != nullptr ? 0 : effort_left(team);
  Fineness& fineness = forces.fineness;
  LevelWeights& level = fineness.level;
  fineness = given != nullptr ? *given : Fineness{level_weights(force)};
  if (same_blocks(team, 0, 1)) {  // they have the same lattices
    level[1] += level[0];
    level[0] = 0;
  }
  const std::size_t wanted = coarsest_of(level);
  const bool own_blocks = !fineness.coarse_blocks && !same_blocks(team, wanted, 0);
  if (own_blocks && !open_for(team, wanted)) return false;
  if (!list(team)) return false;
  Effort effort = effort_of(team);
  if (own_blocks && most > 0 && evaluations_of(effort, only(wanted)) > most) {
    fineness.coarse_blocks = true;
    if (!find_for(team, 0) || !list(team)) return false;
    effort = effort_of(team);
  }
  forces.patch_count =
      static_cast<std::uint32_t>(team.memory.near.count()) + team.memory.near.overlaps.patch_count();
  if (given == nullptr) fineness.one_cell = one_cell_share(effort, most);
  if (!(fineness.one_cell > 0)) return feel_levels(team, effort, most, force, forces);
  const SampledForces rough = in_one_cell(team, effort, force);
  if (fineness.one_cell < 1 &&
      !feel_levels(team, effort, most > 0 ? most - rough.evaluations : 0, force, forces))
    return false;
  mix_in(rough, fineness.one_cell, forces);
  return true;
}

}  // namespace

void size_samples(const Model& model, SampleMemory& memory) {
  if (!model.patches) return;
  size_search(model, memory.search);
  size_near(model, memory.near);
  at_least(model.execution.threads, memory.thread);
  for (SampleThread& thread : memory.thread) {
    at_least(memory.near.listed.size(), thread.chosen);
    for (auto& sums : thread.sums) sums.resize((Bodies::kMostFingers + 1) * Bodies::kTilesApart);
  }
}

std::uint32_t sampled_segments(const Model& model) {
  return model.patches ? model.patches->rules.segments : 0;
}

bool sample_forces(const Model& model, const Primitives& hand, std::uint32_t segments, SampleMemory& memory,
                   SampledForces& forces, const Fineness* given) {
  forces = {};
  // What others are deeper in is theirs, so they have to be there.
  const bool once = model.settings.felt_once != FeltOnce::never;
  set_bodies(hand, once ? sampled_segments(model) : segments, segments, model.patches->rules, memory.bodies);
  SampleTeam team{model, hand, memory, empty_sums(hand)};
  memory.near.forget();
  if (!cut_near(model, hand, memory.search.cuts) || !find_for(team, 0)) return false;
  if (!found_any(memory.search)) return true;
  if (!feel(team, given, forces)) {
    forces.segment = {};  // no level by itself either
    return false;
  }
  forces.contact_count = team.touched();
  return true;
}

}  // namespace lumbrical
