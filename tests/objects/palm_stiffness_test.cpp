// How stiff palms are on what lies on them, held against differences of the exact field; and light things
// come to rest on a palm.
#include "objects/palm_stiffness.h"

#include <gtest/gtest.h>

#include <cmath>
#include <optional>
#include <string>

#include "largest.h"
#include "lumbrical/shared_objects.h"
#include "model/swept_polygon.h"
#include "pads.h"

namespace lumbrical {
namespace {

using test::largest;
using test::palm_alone_at;
using test::Session;

/// Where the palm is while the wrist is at the origin.
struct OpenPalm {
  Vec3 middle, normal;
  double radius = 0;
};
OpenPalm open_palm(const Hand& hand) {
  std::array<Pose, kJointCount> joint;
  forward_kinematics(hand, {}, std::array<double, kAngleCount>{}, joint);
  const SweptPolygon palm = place_palm(hand.palm, joint[kPalm]);
  OpenPalm open{{}, palm.normal, palm.radius};
  for (std::size_t k = 0; k < palm.corner_count; ++k)
    open.middle += (1.0 / palm.corner_count) * palm.corner[k];
  return open;
}
// Its skin's middle at `place`, looking up.
Pose upward(const OpenPalm& palm, Vec3 place, Quat tilt = {}) {
  const Vec3 axis = cross(palm.normal, {0, 0, 1});
  const Quat turn = tilt * normalized({1 + palm.normal.z, axis.x, axis.y, axis.z});
  return {place - rotate(turn, palm.middle + palm.radius * palm.normal), turn};
}

Scene palm_scene(double precision) {
  Scene scene = test::pad_scene();
  scene.hand = default_hand(Side::right);
  scene.settings.precision.fill(precision);
  return scene;
}

struct Touched {
  std::string name;
  Mesh mesh;
  Quat tilt{};
};
std::vector<Touched> things() {
  return {{"plate", make_box({0.05, 0.05, 0.005}, 2)},
          {"small plate", make_box({0.01, 0.01, 0.005}, 2)},
          {"large plate", make_box({0.3, 0.3, 0.01}, 4)},
          {"large plate, tilted", make_box({0.3, 0.3, 0.01}, 4), normalized({1, 0.05, 0.02, 0})},
          {"edge", make_box({0.05, 0.05, 0.005}, 2), normalized({1, 0.25, 0, 0})},
          {"corner", make_box({0.05, 0.05, 0.005}, 2), normalized({1, 0.25, 0.25, 0})},
          {"rod", make_box({0.1, 0.006, 0.006}, 2)},
          {"wall", make_box({0.1, 0.002, 0.05}, 2)},
          {"standing mug", make_mug({})},
          {"rim of a mug", make_mug({}), normalized({1, 0.15, 0, 0})},
          {"lying mug", make_mug({}), normalized({1, 1, 0, 0})},
          {"ball", make_sphere(0.03, 20)}};
}

/// A palm beneath a thing of the world, which it touches from some depth on.
class Pressing {
 public:
  Pressing(const Touched& thing, double precision, const Pad& pad) : tilt_(thing.tilt) {
    Scene scene = palm_scene(0);
    scene.settings.pad = pad;
    open_ = open_palm(scene.hand);
    scene.objects.push_back({thing.name, thing.mesh});
    exact_.emplace(scene);
    scene.settings.precision.fill(precision);
    felt_.emplace(scene);
    scene.settings.pad = {};
    field_.emplace(scene);
    hand_ = scene.hand;
  }
  bool find(Vec3 beneath) {
    place_ = beneath;
    double low = -0.2, high = low;
    while (!(norm(force({0, 0, high})) > 0)) {
      low = high;
      high += 0.0005;
      if (high > 0.1) return false;
    }
    for (int i = 0; i < 50; ++i) {
      const double middle = 0.5 * (low + high);
      (norm(force({0, 0, middle})) > 0 ? high : low) = middle;
    }
    place_.z += high;
    return true;
  }
  Vec3 force(Vec3 by) { return exact_->feel(frame(by)).segment[kPalmSegment].force; }
  double difference(double depth) {
    const Vec3 normal = unit_or(force({0, 0, depth}), {0, 0, 1});
    const double step = 1e-2 * depth;
    const auto pushed = [&](double by) { return dot(force(Vec3{0, 0, depth} - by * normal), normal); };
    return (pushed(step) - pushed(-step)) / (2 * step);
  }
  PalmStiffness stiffness(double depth) {
    const Vec3 felt = felt_->feel(frame({0, 0, depth})).segment[kPalmSegment].force,
               field = field_->feel(frame({0, 0, depth})).segment[kPalmSegment].force;
    std::uint64_t evaluations = 0;
    return palm_stiffness(felt_->model, field, felt, unit_or(felt, {}), felt_->scratch, evaluations);
  }

 private:
  DeviceFrame frame(Vec3 by) { return palm_alone_at(hand_, upward(open_, place_ + by, tilt_)); }

  Quat tilt_;
  Hand hand_;
  OpenPalm open_;
  Vec3 place_;
  std::optional<Session> exact_, felt_, field_;
};

TEST(PalmStiffness, IsHowTheFieldGrowsOnFlatAndRoundThingsRimsAndCorners) {
  Pad layered;
  layered.layer[0] = {0.02, 3};
  for (const Pad& pad : {Pad{}, layered}) {
    for (const double precision : {0.0, 1e-4}) {
      int compared = 0;
      for (const Touched& thing : things()) {
        Pressing pressing(thing, precision, pad);
        for (const Vec3 beneath : {Vec3{}, {0.01, 0.013, 0}, {0.035, 0.03, 0}}) {
          if (!pressing.find(beneath)) continue;
          for (const double depth : {1e-6, 1e-5, 1e-4, 5e-4, 2e-3}) {
            if (!(norm(pressing.force({0, 0, depth})) > 2e-3)) continue;
            const double ratio = pressing.stiffness(depth).along / pressing.difference(depth);
            EXPECT_GT(ratio, 0.9) << thing.name << " " << precision << " " << depth;
            EXPECT_LT(ratio, 1.35) << thing.name << " " << precision << " " << depth;
            ++compared;
          }
        }
      }
      EXPECT_GT(compared, 70);
    }
  }
}

TEST(PalmStiffness, IsThatOfTheWholeAreaWhereAPlateLiesFlat) {
  constexpr double kSide = 0.02;
  Pressing pressing({"plate", make_box({kSide, kSide, 0.005}, 2)}, 0, {});
  ASSERT_TRUE(pressing.find({}));
  for (const double depth : {1e-6, 1e-4}) {
    const PalmStiffness stiffness = pressing.stiffness(depth);
    EXPECT_NEAR(stiffness.along, 2e7 * kSide * kSide, 40) << depth;
    EXPECT_NEAR(stiffness.tilt, 2e7 * kSide * kSide * kSide * kSide / 12, 0.002) << depth;
    EXPECT_NEAR(stiffness.reach, kSide / 2, 5e-5);
  }
}

TEST(PalmStiffness, IsThatOfAFlatPalmWhereThereIsNoRoomToFeelItDeeper) {
  Scene scene = palm_scene(0);
  const OpenPalm palm = open_palm(scene.hand);
  scene.objects.push_back({"ball", make_sphere(0.03, 120)});
  const DeviceFrame frame = palm_alone_at(scene.hand, upward(palm, {0, 0, -0.03 + 1e-3}));
  const auto pressed = [&](Session& run) {
    const Vec3 force = run.feel(frame).segment[kPalmSegment].force;
    EXPECT_EQ(run.output.flags & kCandidateOverflow, 0u);
    std::uint64_t evaluations = 0;
    return palm_stiffness(run.model, force, force, unit_or(force, {}), run.scratch, evaluations).along;
  };
  Session roomy(scene);
  roomy.feel(frame);
  scene.settings.max_candidates = roomy.scratch.candidate_count;
  Session narrow(scene);
  const double round = pressed(roomy), flat = pressed(narrow);
  EXPECT_GT(roomy.scratch.candidate_count, scene.settings.max_candidates) << "it asks for no more";
  EXPECT_GT(round, 100);
  EXPECT_GT(flat, 10 * round);
}

// The largest step of the palm's force [N] after a second.
double roughness(const Mesh& mesh, double mass, double rate, double precision) {
  Scene scene = palm_scene(precision);
  scene.settings.rate = rate;
  const OpenPalm palm = open_palm(scene.hand);
  scene.objects.push_back(test::body_of("thing", mesh, mass, {{0, 0, 1e-4}, {}}, {0.5, 0.4, 0, 1000}));
  Session run(scene);
  const DeviceFrame frame = palm_alone_at(scene.hand, upward(palm, {}));
  double last = 0, most = 0;
  for (int i = 0; i < 2 * rate; ++i) {
    run.step(frame);
    const double force = run.output.segment[kPalmSegment].force.z;
    if (i > rate) most = largest(most, std::fabs(force - last));
    last = force;
  }
  EXPECT_NEAR(-last, mass * 9.81, 0.01 * mass * 9.81) << mass << " " << rate;
  return most;
}

Mesh raised(Mesh mesh, double by) {
  place_mesh({{0, 0, by}, {}}, mesh);
  return mesh;
}

TEST(PalmStiffness, BringsLightPlatesAndRodsToRest) {
  for (const double rate : {1000.0, 500.0}) {
    for (const double precision : {0.0, 1e-4}) {
      for (const double mass : {0.002, 0.005, 0.02}) {
        for (const Mesh& mesh : {make_box({0.05, 0.05, 0.004}, 2), make_box({0.15, 0.15, 0.004}, 2),
                                 make_box({0.02, 0.02, 0.004}, 2)}) {
          EXPECT_LT(roughness(raised(mesh, 0.002), mass, rate, precision), 0.01 * mass * 9.81)
              << rate << " " << precision << " " << mass;
        }
        EXPECT_LT(roughness(raised(make_box({0.1, 0.006, 0.006}, 2), 0.003), mass, rate, precision),
                  0.01 * mass * 9.81)
            << "a rod, " << rate << " " << precision << " " << mass;
      }
    }
    EXPECT_LT(roughness(make_mug({}), 0.005, rate, 1e-4), 0.01 * 0.005 * 9.81) << "a light mug, " << rate;
  }
}

// The largest step of either palm's force [N] after a second, of a plate that lies on one, or is held between
// both, each 0.8 mm deep.
double roughness_in_two_hands(bool between, double mass, double rate) {
  constexpr double kThick = 0.004;
  Scene scene = palm_scene(1e-4);
  scene.settings.rate = rate;
  const Hand other = mirrored_hand(scene.hand);
  scene.objects.push_back(test::body_of("plate", make_box({0.05, 0.05, kThick}, 2), mass,
                                        {{0, 0, kThick / 2 + 1e-4}, {}}, {0.5, 0.4, 0, 1000}));
  SharedObjects shared;
  EXPECT_TRUE(share_objects(scene, {}, shared).ok());
  Session below(given_objects(scene)), above(given_objects(scene));
  EXPECT_TRUE(share_world(below.model, other, above.model).ok());
  above.scratch = make_scratch(above.model);
  std::vector<ObjectFrame> given = start_frames(below.model);
  const OpenPalm open = open_palm(scene.hand), facing = open_palm(other);
  const Quat over{0, 1, 0, 0};  // looking down
  double most = 0;
  for (int i = 0; i < 1.2 * rate; ++i) {
    const Vec3 before[] = {test::hand_force(below.output), test::hand_force(above.output)};
    const double deep = between ? 8e-4 * min(1, 4 * i / rate) : 0;
    below.step(palm_alone_at(scene.hand, upward(open, {0, 0, deep})), given);
    push_objects(shared, below.model, below.scratch);
    if (between) {
      const Pose up = upward(facing, {});
      const Pose down{rotate(over, up.position) + Vec3{0, 0, kThick + 3e-4 - deep}, over * up.orientation};
      above.step(palm_alone_at(other, down), given);
      push_objects(shared, above.model, above.scratch);
    }
    move_objects(shared, given);
    if (i < rate) continue;
    most = largest(most, norm(test::hand_force(below.output) - before[0]));
    most = largest(most, norm(test::hand_force(above.output) - before[1]));
  }
  EXPECT_GT(norm(test::hand_force(below.output)), 0.9 * mass * 9.81) << "it is lost";
  return most;
}

TEST(PalmStiffness, OfTwoHandsBringsALightPlateToRestOnOneAndBetweenBoth) {
  for (const double rate : {500.0, 1000.0}) {
    for (const double mass : {0.002, 0.01}) {
      for (const bool between : {false, true})
        EXPECT_LT(roughness_in_two_hands(between, mass, rate), 0.01) << rate << " " << mass << " " << between;
    }
  }
}

}  // namespace
}  // namespace lumbrical
