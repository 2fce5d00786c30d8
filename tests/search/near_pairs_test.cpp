// Lists of pairs that outlive a tick: the candidates are those of a fresh search, whatever the hand does, and
// the lists do spare searches.
#include "search/near_pairs.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "box_palm.h"
#include "exact/exact_kernels.h"
#include "pose_hand.h"
#include "pressed_hand.h"
#include "random.h"
#include "session.h"
#include "stages/broadphase.h"

namespace lumbrical::test {
namespace {

using Candidates = std::vector<std::uint64_t>;

Candidates candidates_of(const Model& model, const Primitives& hand, Scratch& scratch) {
  EXPECT_TRUE(find_candidates(model, hand, scratch));
  return {scratch.candidates.begin(), scratch.candidates.begin() + scratch.candidate_count};
}

int samples(int usual) {
  const char* const more = std::getenv("LUMBRICAL_NEAR_PAIRS");
  return more == nullptr ? usual : usual * std::atoi(more);
}

// Turned about a random axis through `about` by an angle that moves nothing within `reach` by more than
// `way`.
Pose small_motion(Random& random, Vec3 about, double reach, double way) {
  const double angle = min(way / reach, 3) * random.between(0, 1);
  const Vec3 axis = std::sin(0.5 * angle) * random.direction();
  const Quat turn{std::cos(0.5 * angle), axis.x, axis.y, axis.z};
  return {about - rotate(turn, about) + way * random.between(0, 1) * random.direction(), turn};
}

void move(const Pose& motion, Primitive& primitive) {
  primitive.end1 = transform(motion, primitive.end1);
  primitive.end2 = transform(motion, primitive.end2);
  for (HalfSpace& cut : primitive.cut) {
    cut.normal = rotate(motion.orientation, cut.normal);
    cut.point = transform(motion, cut.point);
  }
}

Primitive random_primitive(Random& random, Vec3 centre, double scale) {
  Primitive primitive;
  primitive.end1 = centre + random.in_box(scale);
  primitive.end2 = primitive.end1 + std::pow(10.0, random.between(-3, 0)) * random.in_box(scale);
  primitive.radius1 = random.between(0.05, 0.2) * scale;
  primitive.radius2 = random.between(0.5, 1) * primitive.radius1;
  for (; primitive.cut_count < 2 && random.between(0, 1) < 0.5; ++primitive.cut_count) {
    primitive.cut[primitive.cut_count] = {random.direction(),
                                          primitive.end1 + random.in_box(primitive.radius1)};
    primitive.overhang[primitive.cut_count] = random.between(0, 0.2) * primitive.radius1;
  }
  return primitive;
}

// The palmar slab of a rectangular palm about `centre`, a primitive with all its planes.
void set_palm(Random& random, Vec3 centre, double scale, Primitives& hand) {
  const Quat turn = random.rotation();
  hand.palm = box_palm(random.between(0.1, 0.4) * scale, random.between(0.1, 0.4) * scale, 0, 0.1 * scale,
                       {centre, turn});
  hand.primitive[hand.count++] = hand_of(hand.palm).primitive[0];
}

void move(const Pose& motion, SweptPolygon& palm) {
  palm.normal = rotate(motion.orientation, palm.normal);
  for (std::size_t i = 0; i < palm.corner_count; ++i) {
    palm.corner[i] = transform(motion, palm.corner[i]);
    palm.outward[i] = rotate(motion.orientation, palm.outward[i]);
  }
}

Primitives random_hand(Random& random, Vec3 centre, double scale) {
  Primitives hand;
  while (hand.count < 8) hand.primitive[hand.count++] = random_primitive(random, centre, scale);
  set_palm(random, centre + random.in_box(0.5 * scale), scale, hand);
  return hand;
}

// Every primitive goes its own way, by no more than `way`; the planes of some turn about themselves.
void walk(Random& random, double way, Primitives& hand) {
  for (std::size_t i = 0; i < hand.count; ++i) {
    Primitive& primitive = hand.primitive[i];
    const Vec3 middle = 0.5 * (primitive.end1 + primitive.end2);
    const double size = norm(primitive.end2 - primitive.end1) + primitive.radius1;
    const Pose motion = small_motion(random, middle, size, way);
    move(motion, primitive);
    if (primitive.shape == Shape::slab) move(motion, hand.palm);
    for (double& overhang : primitive.overhang) {
      if (overhang > 0) overhang += random.between(-0.3, 0.3) * way;
    }
  }
}

Mesh soup(Random& random, Vec3 centre, double scale, int count) {
  Mesh mesh;
  for (int i = 0; i < count; ++i) {
    const Vec3 p = centre + random.in_box(0.8 * scale);
    const double size = scale * std::pow(10.0, random.between(-3, i % 50 == 0 ? 1 : -0.7));
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    const Vec3 q = p + random.in_box(size), r = i % 15 == 0 ? q : p + random.in_box(size);
    mesh.vertices.insert(mesh.vertices.end(), {p, q, r});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

std::vector<Execution> executions(double scale) {
  std::vector<Execution> all(1);
  Execution grid;
  grid.broadphase = Broadphase::grid;
  grid.cell_size = clamp(0.3 * scale, 1e-3, 1e6);
  grid.isa = Isa::scalar;
  all.push_back(grid);
  Execution voxel;
  voxel.broadphase = Broadphase::voxel;
  if (available(Broadphase::voxel)) all.push_back(voxel);
  return all;
}

TEST(NearPairs, GiveTheCandidatesOfBruteForceOnWalksRestsAndJumps) {
  Random random(11);
  std::size_t candidates = 0, searches = 0, ticks = 0;
  for (int scene_number = 0; scene_number < samples(8); ++scene_number) {
    SCOPED_TRACE(scene_number);
    const double scale = std::pow(10.0, random.between(-2, 2));
    // Some worlds are so far from the origin that there can be no lists.
    const double away = scene_number % 4 == 0 ? 1e8 : scale * std::pow(10.0, random.between(-1, 4));
    const Vec3 centre = random.in_box(away);
    Scene scene;
    scene.settings.precision.fill(0);
    scene.hand = default_hand(Side::right);
    scene.objects.push_back({"soup", soup(random, centre, scale, 3000)});
    Execution brute;
    brute.broadphase = Broadphase::brute;
    const Model plain = model_of(scene, brute);
    std::vector<Model> models;
    std::vector<Scratch> scratches;
    for (const Execution& execution : executions(scale)) {
      models.push_back(model_of(scene, execution));
      scratches.push_back(make_scratch(models.back()));
    }
    Scratch fresh = make_scratch(plain);
    Primitives hand = random_hand(random, centre, scale);
    double speed = 0;
    for (int tick_number = 0; tick_number < 60; ++tick_number, ++ticks) {
      if (tick_number % 15 == 0) speed = scale * std::pow(10.0, random.between(-6, -1.3));
      if (tick_number % 20 < 17) walk(random, speed, hand);
      if (tick_number == 31) hand = random_hand(random, centre, scale);
      if (tick_number == 40) std::swap(hand.primitive[1], hand.primitive[2]);
      if (tick_number == 45) --hand.count;
      if (tick_number == 48) hand.primitive[0].radius1 *= 1.01;
      if (tick_number == 50) hand.primitive[3].cut_count = 0;
      const Candidates expected = candidates_of(plain, hand, fresh);
      candidates += expected.size();
      for (std::size_t i = 0; i < models.size(); ++i) {
        ASSERT_EQ(candidates_of(models[i], hand, scratches[i]), expected)
            << broadphase_name(models[i].execution.broadphase) << ", tick " << tick_number;
        if (scene_number % 4 != 0 && i == 0) searches += scratches[i].near->searches;
      }
    }
  }
  EXPECT_GT(candidates, ticks * 100);
  EXPECT_LT(searches, ticks * 9 * 2 / 3);  // three quarters of the scenes, nine primitives
}

// One primitive, a list made of it, and the farthest the list allows it to move: what was left out misses,
// what was called sure does not.
TEST(NearPairs, NoMotionWithinTheSkinTurnsAMissIntoAHitOrASureHitIntoAMiss) {
  Random random(12);
  const ExactKernels& kernels = exact_kernels(widest_isa());
  std::size_t left_out = 0, sure = 0, most_used = 0;
  for (int i = 0; i < samples(20000); ++i) {
    const double scale = std::pow(10.0, random.between(-3, 2));
    const Vec3 centre = random.in_box(random.between(0, 1) < 0.5 ? scale : 1e4 * scale);
    Primitives hand;
    hand.count = 1;
    hand.primitive[0] = random_primitive(random, centre, scale);
    const SkinLimits limits = skin_limits(hand);
    ASSERT_GT(limits.least, 0);
    const double skin = random.between(limits.least, limits.most);
    Hull from, to;
    set_hull(hand.primitive[0], hand.palm, from);
    // As far as is allowed, to a hundredth.
    double way = skin;
    for (int step = 0; step < 60; ++step, way *= 0.9) {
      Primitive moved = hand.primitive[0];
      move(small_motion(random, centre, scale, way), moved);
      set_hull(moved, hand.palm, to);
      if (distance_moved(from, to) <= kUse * skin) break;
    }
    ASSERT_LE(distance_moved(from, to), kUse * skin);
    most_used += distance_moved(from, to) > 0.5 * kUse * skin;
    MissTerms terms;
    terms.count = 16;
    const Primitive& primitive = hand.primitive[0];
    for (std::size_t k = 0; k < terms.count; ++k) {
      // About the hull's surface, where it matters.
      const Vec3 p = primitive.end1 + random.between(0, 1) * (primitive.end2 - primitive.end1) +
                     random.between(0.5, 1.5) * primitive.radius1 * random.direction();
      const double size = primitive.radius1 * std::pow(10.0, random.between(-2, 0.5));
      const Vec3 corner[3] = {p, p + random.in_box(size), p + random.in_box(size)};
      for (std::size_t axis = 0; axis < 3; ++axis) {
        const auto number = [axis](Vec3 v) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; };
        terms.a[axis][k] = number(corner[0]);
        terms.b[axis][k] = number(corner[1]);
        terms.c[axis][k] = number(corner[2]);
      }
    }
    const auto misses = [&](const Hull& hull, double by) {
      set_terms(hull, by, terms);
      kernels.certain_misses(terms);
      return std::vector<double>(terms.miss, terms.miss + terms.count);
    };
    const auto wide = misses(from, skin), narrow = misses(from, -skin), now = misses(to, 0);
    for (std::size_t k = 0; k < terms.count; ++k) {
      left_out += wide[k] != 0;
      sure += narrow[k] == 0;
      EXPECT_FALSE(wide[k] != 0 && now[k] == 0) << "left out, sample " << i;
      EXPECT_FALSE(narrow[k] == 0 && now[k] != 0) << "sure, sample " << i;
    }
  }
  EXPECT_GT(left_out, 10000u);
  EXPECT_GT(sure, 10000u);
  EXPECT_GT(most_used, 5000u);
}

TEST(NearPairs, GiveTheSameTicksOnAGraspWithLostAndBrokenFrames) {
  for (const Law law : {Law::point, Law::max_depth}) {
    const Scene scene = mug_scene(law);
    auto frames = grasp_frames(scene.hand, 2500);
    frames.erase(frames.begin(), frames.begin() + 800);
    frames.resize(120);
    for (std::size_t i = 40; i < 45; ++i) frames[i].flags |= kTrackingLost;
    for (std::size_t i = 60; i < 63; ++i) frames[i].angle[3] = NAN;
    frames[90].base.position.x += 0.05;
    for (const Broadphase broadphase : {Broadphase::tree, Broadphase::grid, Broadphase::voxel}) {
      if (!available(broadphase)) continue;
      Execution execution;
      execution.broadphase = broadphase;
      const Model model = model_of(scene, execution);
      State state, afresh_state;
      Scratch scratch = make_scratch(model), afresh = make_scratch(model);
      afresh.keep_near = false;
      std::size_t searches = 0, all_searches = 0;
      for (std::size_t i = 0; i < frames.size(); ++i) {
        tick(model, state, scratch, frames[i]);
        tick(model, afresh_state, afresh, frames[i]);
        ASSERT_EQ(scratch.stage_hash, afresh.stage_hash) << "frame " << i;
        searches += scratch.near->searches;
        all_searches += afresh.near->searches;
      }
      EXPECT_LT(2 * searches, all_searches) << broadphase_name(broadphase);
      // From the middle, as a replay begins.
      Scratch late = make_scratch(model);
      tick(model, state, late, frames.back());
      tick(model, afresh_state, scratch, frames.back());
      EXPECT_EQ(late.stage_hash, scratch.stage_hash);
    }
  }
}

Primitives pressed(const Model& model, double time) {
  Primitives hand;
  pose_hand(model.hand, model.settings, pressed_frame(model.hand, 0.002, time), hand);
  return hand;
}

TEST(NearPairs, SpareSearchesWhereTheHandMovesLittle) {
  const Model model = model_of(pressed_scene(kWidthA, 69));
  Scratch scratch = make_scratch(model);
  const auto searched = [&](double time) {
    candidates_of(model, pressed(model, time), scratch);
    return scratch.near->searches;
  };
  const auto all_of_it = static_cast<std::uint32_t>(pressed(model, 0).count);
  EXPECT_GT(all_of_it, 20u);
  EXPECT_EQ(searched(0), all_of_it);  // the first tick knows nothing of the hand's speed
  // Those that follow make a few lists each.
  for (std::uint32_t expected = all_of_it; expected > 6; expected -= 6) EXPECT_EQ(searched(0), expected);
  searched(0);
  EXPECT_GT(scratch.near->size, scratch.candidate_count);
  for (int i = 0; i < 100; ++i) EXPECT_EQ(searched(0), 0u);
  // 0.02 mm a tick: less than an eighth of the searches, and never many at once.
  std::size_t all = 0;
  for (int i = 0; i < 500; ++i) {
    const auto count = searched(i * 0.02e-3 / 0.0628);
    all += count;
    // At first it gathers speed.
    EXPECT_LE(count, i < 50 ? all_of_it : 6u) << i;
  }
  EXPECT_LT(8 * all, 500 * all_of_it);
  EXPECT_GT(all, 100u);
  // 4 mm a tick: no lists are made, and what is asked about is nothing.
  for (int i = 0; i < 20; ++i) searched(i / 16.0);
  EXPECT_EQ(searched(0.5), all_of_it);
  EXPECT_EQ(scratch.near->asked, 0u);
  scratch.keep_near = false;
  for (int i = 0; i < 3; ++i) EXPECT_EQ(searched(0.5), all_of_it);
}

TEST(NearPairs, AreOfOneWorldOnly) {
  Scene scene = pressed_scene(kWidthA, 40);
  const Model first = model_of(scene);
  for (Vec3& p : scene.objects[0].mesh.vertices) p.z += 0.001;
  const Model second = model_of(scene), copy = first;
  const Primitives hand = pressed(first, 0);
  Scratch scratch = make_scratch(first), fresh = make_scratch(second);
  for (int i = 0; i < 10; ++i) candidates_of(first, hand, scratch);
  EXPECT_EQ(scratch.near->searches, 0u);
  candidates_of(copy, hand, scratch);
  EXPECT_EQ(scratch.near->searches, 0u);
  EXPECT_EQ(candidates_of(second, hand, scratch), candidates_of(second, hand, fresh));
  EXPECT_EQ(scratch.near->searches, hand.count);
  EXPECT_EQ(candidates_of(first, hand, scratch), candidates_of(first, hand, fresh));
}

TEST(NearPairs, GiveWayWhereOnlyTheCandidatesFit) {
  Scene scene = pressed_scene(kWidthA, 69);
  Model model = model_of(scene);
  Scratch scratch = make_scratch(model);
  const Candidates expected = candidates_of(model, pressed(model, 0), scratch);
  scene.settings.max_candidates = static_cast<std::uint32_t>(expected.size() + 5);
  model = model_of(scene);
  scratch = make_scratch(model);
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(candidates_of(model, pressed(model, 0), scratch), expected);
    EXPECT_EQ(scratch.near->searches, static_cast<std::uint32_t>(pressed(model, 0).count));
  }
  EXPECT_GT(scratch.near->rest, 0u);
  scene.settings.max_candidates = static_cast<std::uint32_t>(expected.size() - 1);
  model = model_of(scene);
  scratch = make_scratch(model);
  for (int i = 0; i < 3; ++i) {
    EXPECT_FALSE(find_candidates(model, pressed(model, 0), scratch));
    EXPECT_EQ(scratch.candidate_count, 0u);
  }
}

}  // namespace
}  // namespace lumbrical::test
