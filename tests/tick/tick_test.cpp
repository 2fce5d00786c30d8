// The whole tick: the same bits every way it can be run, no allocation, and forces that never step.
#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <cstddef>
#include <limits>
#include <set>

#include "largest.h"
#include "lumbrical/jacobian.h"
#include "model/primitive.h"
#include "own_allocator.h"
#include "pads.h"
#include "pose_hand.h"
#include "pressed_hand.h"
#include "random.h"
#include "session.h"
#include "stages/broadphase.h"
#include "stages/narrowphase.h"
#include "tick/tick_trace.h"

namespace lumbrical {
namespace {

TEST(Tick, TreeGridAndBruteForceGiveTheSameBits) {
  const Scene scene = test::mug_scene(Law::field);
  const auto frames = test::grasp_frames(scene.hand, 20);
  Execution brute;
  brute.broadphase = Broadphase::brute;
  const std::uint64_t expected = test::hash_run(test::model_of(scene, brute), frames);
  for (const std::uint32_t levels : {0u, 1u, 2u, 3u, 5u}) {
    for (const std::uint32_t leaf_size : {1u, 3u, 8u, 64u}) {
      Execution tree;
      tree.tree_levels = levels;
      tree.leaf_size = leaf_size;
      EXPECT_EQ(test::hash_run(test::model_of(scene, tree), frames), expected)
          << levels << " levels of " << leaf_size;
    }
  }
  for (const double cell_size : {0.001, 0.01, 0.1, 1.0}) {
    Execution grid;
    grid.broadphase = Broadphase::grid;
    grid.cell_size = cell_size;
    EXPECT_EQ(test::hash_run(test::model_of(scene, grid), frames), expected) << "cells of " << cell_size;
  }
}

TEST(Tick, AnyNumberOfThreadsGivesTheSameBits) {
  const Scene scene = test::mug_scene(Law::field);
  const auto frames = test::grasp_frames(scene.hand, 40);
  const std::uint64_t expected = test::hash_run(test::model_of(scene), frames);
  for (const std::uint32_t threads : {2u, 4u, 8u}) {
    Execution execution;
    execution.threads = threads;
    EXPECT_EQ(test::hash_run(test::model_of(scene, execution), frames), expected) << threads;
  }
}

// [m] How far outside a round primitive, about.
double distance_outside(const Primitive& primitive, Vec3 p) {
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i <= 500; ++i) {
    const double t = i / 500.0;
    const double radius = (1 - t) * primitive.radius1 + t * primitive.radius2;
    least = min(least, norm(p - (1 - t) * primitive.end1 - t * primitive.end2) - radius);
  }
  return least;
}

// Triangles that a segment all but misses have areas of nothing but rounding.
TEST(Tick, RecordsOfContactsLieInTheirSegments) {
  Scene scene = test::mug_scene(Law::field);
  scene.objects = {{"ball", make_sphere(0.037, 60)}};
  const Model model = test::model_of(scene);
  Scratch scratch = make_scratch(model);
  test::Random random(10);
  std::size_t count = 0;
  for (DeviceFrame frame : test::grasp_frames(scene.hand, 20)) {
    for (float& angle : frame.angle) angle += static_cast<float>(random.between(-0.4, 0.4));
    frame.base.position += random.in_box(0.02);
    State state = make_state(model);
    tick(model, state, scratch, frame);
    for (const Contact& contact : find_contacts(model, scratch)) {
      const Primitive& primitive = scratch.primitives->primitive[contact.primitive];
      if (primitive.shape != Shape::round) continue;
      ++count;
      EXPECT_LT(distance_outside(primitive, contact.centroid), 1e-6) << contact.area << " m^2";
    }
  }
  EXPECT_GT(count, 1000u);
}

std::atomic<int> allocations{0};

// In ticks along a grasp, and Jacobians after them.
int allocations_of(const Scene& scene, Broadphase broadphase) {
  Execution execution;
  execution.broadphase = broadphase;
  const Model model = test::model_of(scene, execution);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  const auto frames = test::grasp_frames(scene.hand, 50);
  std::array<SegmentJacobian, kSegmentCount> jacobians;
  std::uint32_t contacts = 0;
  allocations = 0;
  test::may_allocate = [] {
    ++allocations;
    return true;
  };
  for (const DeviceFrame& frame : frames) {
    contacts += tick(model, state, scratch, frame).contact_count;
    segment_jacobians(model, scratch, jacobians);
  }
  test::may_allocate = nullptr;
  EXPECT_GT(contacts, 100u);
  return allocations;
}

TEST(Tick, AllocatesNothing) {
  for (const Law law : {Law::field, Law::column, Law::max_depth, Law::centroid, Law::point}) {
    for (const double precision : {0.0, 1e-4}) {
      if (precision > 0 && law != Law::field) continue;
      Scene scene = test::mug_scene(law);
      scene.objects.push_back(
          {"floor", make_plane(40, 1)});  // by samples it is cut where the hand comes near
      scene.settings.precision.fill(precision);
      scene.settings.felt_once = law == Law::field ? FeltOnce::always : FeltOnce::never;
      for (const Broadphase broadphase : {Broadphase::tree, Broadphase::grid, Broadphase::voxel}) {
        if (!available(broadphase)) continue;
        EXPECT_EQ(allocations_of(scene, broadphase), 0)
            << law_name(law) << ", " << precision << ", " << broadphase_name(broadphase);
      }
    }
  }
}

TEST(Tick, OfABodyWithPadsAndAProxyAllocatesNothing) {
  for (const double precision : {0.0, 1e-4}) {
    Scene scene = test::mug_scene(Law::field);
    scene.objects = {test::body_of("mug", make_mug({}), 0.2, {}, {0.8, 0.5, 0.2, 1500}),
                     {"floor", make_plane(1, 10)}};
    scene.ground.emplace();
    scene.settings.precision.fill(precision);
    scene.settings.proxy_stiffness = 3000;
    scene.settings.pad = {{{{0.2, 3}, {0.5, -2}}}, 5};
    EXPECT_EQ(allocations_of(scene, Broadphase::tree), 0) << precision;
  }
}

TEST(Tick, DoesNotCareAboutTheCallersRoundingMode) {
  const Scene scene = test::mug_scene(Law::field);
  const Model model = test::model_of(scene);
  const auto frames = test::grasp_frames(scene.hand, 20);
  const std::uint64_t expected = test::hash_run(model, frames);
#if defined(__SSE2__)
  const unsigned before = __builtin_ia32_stmxcsr();
  const unsigned odd = before | 0x8040u | 0x6000u;  // flush to zero, denormals are zero, round towards zero
  State state;
  Scratch scratch = make_scratch(model);
  Hasher hasher;
  for (const DeviceFrame& frame : frames) {
    __builtin_ia32_ldmxcsr(odd);
    tick(model, state, scratch, frame);
    EXPECT_EQ(__builtin_ia32_stmxcsr() & ~0x3fu, odd & ~0x3fu);  // the caller's modes are back
    __builtin_ia32_ldmxcsr(before);
    for (const std::uint64_t hash : scratch.stage_hash) hasher.value(hash);
    hasher.value(hash_state(state));
  }
  EXPECT_EQ(hasher.digest(), expected);
#endif
}

double largest_step(const ActuatorFrame& a, const ActuatorFrame& b) {
  double step = 0;
  for (std::size_t i = 0; i < kSegmentCount; ++i)
    step = test::largest(step, norm(a.segment[i].force - b.segment[i].force));
  return step;
}

double largest_force(const ActuatorFrame& a) { return largest_step(a, ActuatorFrame{}); }

TEST(Tick, BadInputFadesForcesToZeroAndBackWithoutAStep) {
  const Scene scene = test::mug_scene(Law::field);
  const Model model = test::model_of(scene);
  const DeviceFrame held = test::grasp_frames(scene.hand, 100)[50];  // amid the grasp
  struct Fault {
    const char* name;
    std::uint32_t flag;
    void (*spoil)(DeviceFrame&);
  };
  const Fault faults[] = {
      {"NaN angle", kInputNotFinite, [](DeviceFrame& f) { f.angle[7] = NAN; }},
      {"infinite position", kInputNotFinite, [](DeviceFrame& f) { f.base.position.x = INFINITY; }},
      {"zero quaternion", kInputImplausible,
       [](DeviceFrame& f) {
         f.base.orientation = {0, 0, 0, 0};
       }},
      {"lost tracking", kInputLost, [](DeviceFrame& f) { f.flags |= kTrackingLost; }},
  };
  for (const Fault& fault : faults) {
    SCOPED_TRACE(fault.name);
    State state;
    Scratch scratch = make_scratch(model);
    const std::uint32_t fade = static_cast<std::uint32_t>(scene.settings.fade_time * scene.settings.rate);
    ActuatorFrame last, settled;
    double worst = 0;
    std::uint32_t flags = 0;
    const auto run = [&](const DeviceFrame& frame, std::uint32_t ticks) {
      for (std::uint32_t i = 0; i < ticks; ++i) {
        const ActuatorFrame output = tick(model, state, scratch, frame);
        worst = test::largest(worst, largest_step(output, last));
        flags |= output.flags;
        last = output;
      }
    };
    DeviceFrame spoilt = held;
    fault.spoil(spoilt);
    run(held, fade + 5);
    settled = last;
    ASSERT_GT(largest_force(settled), 0.1);
    flags = 0;
    run(spoilt, fade / 2);
    EXPECT_NE(flags & fault.flag, 0u);
    run(held, fade / 4);  // back and lost again in the middle of fading
    run(spoilt, fade + 5);
    EXPECT_EQ(largest_force(last), 0);
    run(held, fade + 5);
    EXPECT_EQ(largest_step(last, settled), 0);  // exactly the force of before
    EXPECT_LE(worst, 2.001 * largest_force(settled) / fade);
  }
}

TEST(Tick, OverflowOfCandidatesIsFlaggedAndFades) {
  Scene scene = test::mug_scene(Law::field);
  scene.settings.max_candidates = 10;
  const Model model = test::model_of(scene);
  State state;
  Scratch scratch = make_scratch(model);
  ActuatorFrame output;
  for (int i = 0; i < 30; ++i) output = tick(model, state, scratch, test::grasp_frames(scene.hand, 100)[50]);
  EXPECT_NE(output.flags & kCandidateOverflow, 0u);
  EXPECT_EQ(largest_force(output), 0);
}

// A hand that can't meet the world is not shaped at all.
TEST(Tick, AHandThatIsLeftUnshapedWouldHaveTouchedNothing) {
  Scene scene = test::pressed_scene(0.3, 20);
  int touching = 0, unshaped = 0;
  for (const Law law : {Law::field, Law::max_depth}) {
    scene.settings.law.fill(law);
    const Model model = test::model_of(scene);
    test::Random random(11);
    for (int i = 0; i < 400; ++i) {
      DeviceFrame frame = test::pressed_frame(scene.hand, 0.002, random.between(0, 1));
      frame.base.position += random.between(0, 0.3) * random.direction();
      frame.base.orientation = random.rotation() * frame.base.orientation;
      State state;
      Scratch scratch = make_scratch(model);
      touching += tick(model, state, scratch, frame).contact_count > 0 ? 1 : 0;
      Primitives& hand = *scratch.primitives;
      if (!hand.out_of_reach) continue;
      ++unshaped;
      EXPECT_EQ(hand.count, 0u);
      test::pose_hand(model.hand, model.settings, frame, hand);
      EXPECT_GT(hand.count, 0u);
      ASSERT_TRUE(find_candidates(model, hand, scratch));
      ASSERT_EQ(
          collide_pairs(model, hand, {scratch.candidates.data(), scratch.candidate_count}, scratch.contacts),
          0u)
          << i;
    }
  }
  EXPECT_GT(touching, 200);
  EXPECT_GT(unshaped, 100);
}

// The paper's parts are a cylinder and spheres cut at its ends, which without an axis would all be whole.
// Not by the point law, which counts parts.
TEST(Tick, APhalanxOfNoLengthIsFeltOnce) {
  for (const Law law : {Law::field, Law::column, Law::max_depth, Law::centroid}) {
    Scene scene;
    scene.hand = default_hand(Side::right);
    scene.settings.law.fill(law);
    scene.settings.precision.fill(0);
    scene.settings.fade_time = 0;
    scene.settings.max_force = 1e6;
    scene.objects.push_back({"plane", make_plane(0.1, 1)});
    const Model model = test::model_of(scene);
    const auto force_at = [&](double length, bool joined) {
      DeviceFrame frame;
      frame.kind = InputKind::joint_poses;
      frame.valid = 1u << kIndexDistal | 1u << kIndexTip | (joined ? 1u << kIndexIntermediate : 0u);
      const auto put = [&frame](Joint joint, double x) {
        frame.joint[joint].position = {static_cast<float>(x), 0.001f, 0.004f};
        frame.joint[joint].orientation = {0, 0, 0, 1};
      };
      put(kIndexIntermediate, -0.02);
      put(kIndexDistal, 0.001);
      put(kIndexTip, 0.001 + length);
      State state;
      Scratch scratch = make_scratch(model);
      Vec3 force;
      for (const Wrench& segment : tick(model, state, scratch, frame).segment) force += segment.force;
      return norm(force);
    };
    for (const bool joined : {false, true}) {
      const double force = force_at(0, joined), nearly = force_at(1e-5, joined);
      EXPECT_GT(nearly, 0.1) << static_cast<int>(law);
      EXPECT_NEAR(force / nearly, 1, 0.02) << static_cast<int>(law) << ", joined " << joined;
    }
  }
}

// What is left to tell of such a hand is where its phalanges and its palm are.
TEST(Tick, TheHashOfAHandOutOfReachTellsEveryPhalanx) {
  const Scene scene = test::mug_scene(Law::field);
  const Model model = test::model_of(scene);
  State state;
  Scratch scratch = make_scratch(model);
  DeviceFrame frame = test::grasp_frames(scene.hand, 2)[1];
  frame.base.position = {3, 4, 5};
  const auto pose_hash = [&] {
    tick(model, state, scratch, frame);
    EXPECT_TRUE(scratch.primitives->out_of_reach);
    return scratch.stage_hash[static_cast<std::size_t>(Stage::hand_pose)];
  };
  std::set<std::uint64_t> seen = {pose_hash()};
  EXPECT_FALSE(seen.insert(pose_hash()).second) << "the same frame has another hash";
  for (float& angle : frame.angle) {
    angle += 1e-5f;
    EXPECT_TRUE(seen.insert(pose_hash()).second) << "angle " << &angle - frame.angle.data();
  }
  frame.base.position.z = std::nextafter(frame.base.position.z, 6);
  EXPECT_TRUE(seen.insert(pose_hash()).second);
  // The trace, which names what differs, has those numbers too.
  const std::vector<TraceValue> values = trace_stage(scratch, frame, {}, {}, Stage::hand_pose);
  EXPECT_EQ(values.size(), std::size_t{3} + 1 + kJointCount * 7);
  frame.base.position = {};
  tick(model, state, scratch, frame);
  EXPECT_FALSE(scratch.primitives->out_of_reach);
}

TEST(Tick, AHandFeltBySamplesHasNoPrimitivesUntilItsContactsAreAskedFor) {
  Scene scene = test::mug_scene(Law::field);
  const Model exact = test::model_of(scene);
  scene.settings.precision.fill(1e-4);
  const Model sampled = test::model_of(scene);
  std::size_t found = 0;
  for (const DeviceFrame& frame : test::grasp_frames(scene.hand, 5)) {
    State exact_state, state;
    Scratch exact_scratch = make_scratch(exact), scratch = make_scratch(sampled);
    tick(exact, exact_state, exact_scratch, frame);
    tick(sampled, state, scratch, frame);
    EXPECT_EQ(scratch.primitives->count, 0u);
    const auto wanted = find_contacts(exact, exact_scratch), contacts = find_contacts(sampled, scratch);
    ASSERT_EQ(contacts.size(), wanted.size());
    for (std::size_t i = 0; i < wanted.size(); ++i) {
      EXPECT_EQ(contacts[i].triangle, wanted[i].triangle);
      EXPECT_EQ(contacts[i].area, wanted[i].area);
      EXPECT_EQ(contact_segment(scratch, contacts[i]), contact_segment(exact_scratch, wanted[i]));
    }
    found += wanted.size();
  }
  EXPECT_GT(found, 20u);
}

// What a bent finger's tile has beyond its joint's border, the primitive that a plane cuts has not.
TEST(Tick, NoContactIsShallowerThanItsFieldOnAverage) {
  Scene scene = test::mug_scene(Law::field);
  scene.settings.precision.fill(0);
  const Model model = test::model_of(scene);
  std::size_t found = 0;
  for (const DeviceFrame& frame : test::grasp_frames(scene.hand, 40)) {
    State state;
    Scratch scratch = make_scratch(model);
    tick(model, state, scratch, frame);
    for (const Contact& contact : find_contacts(model, scratch)) {
      EXPECT_GE(contact.depth, contact.volume / contact.area * (1 - 1e-9)) << contact.triangle;
      ++found;
    }
  }
  EXPECT_GT(found, 500u);
}

Scene plane_scene() {
  Scene scene = test::mug_scene(Law::max_depth);
  scene.objects = {{"plane", make_plane(0.6, 40, 1)}};
  return scene;
}
// Palm down, a little into the plane, joint by joint.
DeviceFrame palm_down(const Hand& hand) {
  std::array<Pose, kJointCount> pose;
  const std::array<double, kAngleCount> flat{};
  forward_kinematics(hand, {{0, 0, 0.005}, {std::sqrt(0.5), std::sqrt(0.5), 0, 0}}, flat, pose);
  DeviceFrame frame;
  for (std::size_t i = 0; i < kJointCount; ++i) {
    const Vec3 p = pose[i].position;
    const Quat q = pose[i].orientation;
    frame.joint[i].position = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    frame.joint[i].orientation = {static_cast<float>(q.x), static_cast<float>(q.y), static_cast<float>(q.z),
                                  static_cast<float>(q.w)};
  }
  return frame;
}
constexpr std::uint32_t kAllJoints = (1u << kJointCount) - 1;

TEST(Tick, MissingJointsSilenceOnlyTheirSegments) {
  const Scene scene = plane_scene();
  const Model model = test::model_of(scene);
  DeviceFrame frame = palm_down(scene.hand);
  const auto settle = [&](std::uint32_t valid) {
    frame.valid = valid;
    State state;
    Scratch scratch = make_scratch(model);
    ActuatorFrame output;
    for (int i = 0; i < 40; ++i) output = tick(model, state, scratch, frame);
    return output;
  };
  const ActuatorFrame whole = settle(kAllJoints), without = settle(kAllJoints & ~(1u << kIndexTip));
  EXPECT_GT(norm(whole.segment[5].force), 0);
  EXPECT_EQ(norm(without.segment[5].force), 0);
  EXPECT_NE(without.flags & kSegmentMissing, 0u);
  EXPECT_EQ(without.segment[8].force, whole.segment[8].force);
}

TEST(Tick, ASegmentThatTrackingLosesOrFindsFadesOutAndIn) {
  const Scene scene = plane_scene();
  const Model model = test::model_of(scene);
  DeviceFrame frame = palm_down(scene.hand);
  State state;
  Scratch scratch = make_scratch(model);
  const double most_step = 1.001 / (model.settings.fade_time * model.settings.rate);
  double whole = 0, last = 0;
  for (int i = 0; i < 300; ++i) {
    frame.valid = i / 60 % 2 == 0 ? kAllJoints : i < 120 ? kAllJoints & ~(1u << kIndexTip) : 0;
    const ActuatorFrame output = tick(model, state, scratch, frame);
    const double force = norm(output.segment[5].force);
    if (i == 59) whole = force;
    if (i >= 60) {
      EXPECT_LE(std::fabs(force - last), most_step * whole) << i;
    }
    if (i % 60 == 59) {
      EXPECT_DOUBLE_EQ(force, i / 60 % 2 == 0 ? whole : 0) << i;
    }
    last = force;
  }
  EXPECT_GT(whole, 1);
}

TEST(Tick, AHandThatJumpsFeelsItsNewPlaceWithinTheFadeTime) {
  const Scene scene = plane_scene();
  const Model model = test::model_of(scene);
  State state;
  Scratch scratch = make_scratch(model);
  const double most_step = 1.001 / (model.settings.fade_time * model.settings.rate);
  Vec3 last, whole;
  for (int i = 0; i < 200; ++i) {
    DeviceFrame frame = palm_down(scene.hand);
    if (i >= 40 && i < 80) frame.base.position.z += 0.3;
    if (i >= 120) frame.base.position.x += 0.2;
    const ActuatorFrame output = tick(model, state, scratch, frame);
    const Vec3 force = output.segment[5].force;
    if (i == 39) whole = force;
    EXPECT_EQ((output.flags & kHandJumped) != 0, i == 40 || i == 80 || i == 120) << i;
    if (i >= 40) {
      EXPECT_LE(norm(force - last), most_step * norm(whole)) << i;
    }
    if (i == 79) {
      EXPECT_EQ(norm(force), 0);
    }
    last = force;
  }
  EXPECT_GT(norm(whole), 1);
  EXPECT_NEAR(norm(last), norm(whole), 1e-3 * norm(whole)) << "the plane is the same everywhere";
}

TEST(Tick, WhatATrackerHoldsForSomeTicksOrLosesIsNoJump) {
  const Scene scene = plane_scene();
  const Model model = test::model_of(scene);
  State state;
  Scratch scratch = make_scratch(model);
  DeviceFrame frame = palm_down(scene.hand);
  for (int i = 0; i < 200; ++i) {
    if (i % 16 == 0) frame.base.position.x += 0.08;  // 60 Hz, 5 m/s
    EXPECT_EQ(tick(model, state, scratch, frame).flags & kHandJumped, 0u) << i;
  }
  frame.flags = kTrackingLost;
  tick(model, state, scratch, frame);
  frame.flags = 0;
  frame.base.position.x += 2;
  EXPECT_EQ(tick(model, state, scratch, frame).flags & kHandJumped, 0u) << "where it was no one knows";
  frame.valid &= ~(1u << kWrist);
  frame.joint[kWrist].position = {0.5f, 0, 0};
  EXPECT_EQ(tick(model, state, scratch, frame).flags & kHandJumped, 0u) << "of what is not tracked";
}

TEST(Tick, AHandThatJumpsFromWhereTooMuchWasNearHasJumped) {
  Scene scene = plane_scene();
  scene.objects[0].mesh = make_plane(1, 100);
  scene.settings.max_candidates = 10;
  scene.settings.precision.fill(0);
  const Model model = test::model_of(scene);
  State state;
  Scratch scratch = make_scratch(model);
  DeviceFrame frame = palm_down(scene.hand);
  EXPECT_NE(tick(model, state, scratch, frame).flags & kCandidateOverflow, 0u);
  frame.base.position.z += 0.3;
  EXPECT_NE(tick(model, state, scratch, frame).flags & kHandJumped, 0u);
}

TEST(Tick, WhatStandsInAJointThatIsNotTrackedIsNotRead) {
  const Scene scene = plane_scene();
  const Model model = test::model_of(scene);
  const auto settle = [&](float in_index_proximal) {
    DeviceFrame frame = palm_down(scene.hand);
    frame.valid = kAllJoints & ~(1u << kIndexProximal);
    frame.joint[kIndexProximal].position.fill(in_index_proximal);
    frame.joint[kIndexProximal].orientation.fill(in_index_proximal);
    State state;
    Scratch scratch = make_scratch(model);
    ActuatorFrame output;
    for (int i = 0; i < 40; ++i) output = tick(model, state, scratch, frame);
    return output;
  };
  const ActuatorFrame finite = settle(0), broken = settle(std::numeric_limits<float>::quiet_NaN()),
                      far = settle(0.5f);
  EXPECT_GT(norm(finite.segment[8].force), 0);
  EXPECT_EQ(broken.flags, finite.flags);
  EXPECT_EQ(broken.flags & kFading, 0u);
  for (std::size_t i = 0; i < kSegmentCount; ++i) EXPECT_EQ(broken.segment[i].force, finite.segment[i].force);
  EXPECT_EQ(broken.flexion_torque, finite.flexion_torque);
  EXPECT_EQ(far.flexion_torque, finite.flexion_torque);
  EXPECT_EQ(far.joint_torque, finite.joint_torque);
  EXPECT_EQ(far.flexion_torque[3], 0) << "of the joint that is not tracked";
}

// Two hands in one scene: each its own model, state and outputs, of one world.
TEST(Tick, TwoHandsShareAWorldAndFeelWhatEachWouldAlone) {
  for (const bool exact : {false, true}) {
    Scene scene;
    scene.hand = default_hand(Side::right);
    scene.objects.push_back({"mug", make_mug({})});
    if (exact) scene.settings.precision.fill(0);
    Model right, left, alone;
    ASSERT_TRUE(build_model(scene, {}, right).ok());
    ASSERT_TRUE(share_world(right, default_hand(Side::left, 0.21), left).ok());
    scene.hand = default_hand(Side::left, 0.21);
    ASSERT_TRUE(build_model(scene, {}, alone).ok());
    EXPECT_EQ(left.triangles.x.data(), right.triangles.x.data());
    EXPECT_EQ(left.tree.lines.data(), right.tree.lines.data());
    const Motion motion = make_grasp(left.hand, 0.037, 0.095, 2),
                 other = make_grasp(right.hand, 0.037, 0.095, 2);
    State a, b, c;
    Scratch of_left = make_scratch(left), of_right = make_scratch(right), of_alone = make_scratch(alone);
    std::uint32_t contacts = 0;
    for (int i = 0; i < 40; ++i) {
      const DeviceFrame frame = resample(motion, 0.05 * i);
      const ActuatorFrame felt = tick(left, a, of_left, frame);
      static_cast<void>(tick(right, b, of_right, resample(other, 0.05 * i)));
      static_cast<void>(tick(alone, c, of_alone, frame));
      ASSERT_EQ(of_left.stage_hash, of_alone.stage_hash) << i;
      contacts = std::max(contacts, felt.contact_count);
    }
    EXPECT_EQ(hash_state(a), hash_state(c));
    EXPECT_GT(contacts, 0u);
  }
  Model unbuilt;
  Hand broken = default_hand(Side::left);
  broken.radius[kIndexTip] = -1;
  EXPECT_FALSE(share_world(test::model_of(test::mug_scene(Law::field)), broken, unbuilt).ok());
}

}  // namespace
}  // namespace lumbrical
