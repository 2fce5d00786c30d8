// Patches that friction and motion rest on, held against closed forms and plain sums.
#include "objects/contact_patch.h"

#include <gtest/gtest.h>

#include <cmath>

#include "../exact/posed_finger.h"
#include "model/swept_polygon.h"
#include "pads.h"
#include "random.h"

namespace lumbrical {
namespace {

constexpr double kPi = 3.141592653589793, kStiffness = 2e7, kTurningStep = 1e-3;

// Of the field law over a plane, by sums over a fine grid.
struct PlainPatch {
  double force = 0, radius = 0, stiffness = 0;
  Vec3 centre;
};

double depth_below_skin(Vec3 p, const test::Pad& pad) {
  const Vec3 base = pad.tip + pad.length * pad.away;
  const Vec3 axis = pad.tip - base;
  const double t = clamp(dot(p - base, axis) / dot(axis, axis), 0, 1);
  return test::kPadRadius - norm(p - (base + t * axis));
}

PlainPatch plain_patch(const test::Pad& pad) {
  const double cell = 5e-5;
  const int reach = 800;
  double sum = 0, touched = 0, around = 0;
  Vec3 first;
  const auto visit = [&](const auto& take) {
    for (int i = -reach; i < reach; ++i) {
      for (int j = -reach; j < reach; ++j) {
        const Vec3 p{(i + 0.5) * cell, (j + 0.5) * cell, 0};
        if (const double phi = depth_below_skin(p, pad); phi > 0) take(p, phi);
      }
    }
  };
  visit([&](Vec3 p, double phi) {
    sum += phi;
    first += phi * p;
    touched += depth_below_skin(p + Vec3{0, 0, 1e-6}, pad) - depth_below_skin(p - Vec3{0, 0, 1e-6}, pad);
  });
  const Vec3 centre = first / sum;
  visit([&](Vec3 p, double phi) { around += phi * norm(p - centre); });
  const double area = cell * cell;
  return {kStiffness * sum * area, around / sum, kStiffness * touched * area / 2e-6, centre};
}

ContactPatch patch_on_plane(const test::Pad& pad) {
  Scene scene = test::pad_scene();
  scene.objects.push_back({"plane", make_plane(0.2, 3)});
  const Model model = test::model_of(scene);
  Scratch scratch = make_scratch(model);
  State state;
  const ActuatorFrame output = tick(model, state, scratch, test::frame_of({pad}));
  return contact_patch(*scratch.primitives, 2, output.segment[2], kStiffness, {});
}

TEST(ContactPatch, OfASphereOnAPlaneIsThatOfTheClosedForm) {
  const double radius = test::kPadRadius;
  for (const double pressed : {0.0005, 0.001, 0.002, 0.004, 0.006}) {
    const double h = radius - pressed, rho = std::sqrt(radius * radius - h * h);
    const ContactPatch patch = patch_on_plane({{0.003, -0.002, h}, {0, 0, 1}});
    const double force =
        kStiffness * kPi * (radius * radius * radius / 3 - radius * h * h + 2 * h * h * h / 3);
    const double twist = 2 * kPi * kStiffness *
                         (radius * rho * rho * rho / 3 - rho * (2 * rho * rho + h * h) * radius / 8 +
                          h * h * h * h / 8 * std::log((rho + radius) / h));
    EXPECT_NEAR(patch.force, force, 1e-6 * force);
    EXPECT_NEAR(patch.radius, twist / force, 0.005 * rho) << pressed;
    EXPECT_NEAR(patch.stiffness, 2 * kPi * kStiffness * h * (radius - h), 0.02 * patch.stiffness) << pressed;
    EXPECT_LT(norm(patch.centre - Vec3{0.003, -0.002, 0}), 2e-5) << pressed;
    EXPECT_LT(norm(patch.normal - Vec3{0, 0, 1}), 1e-9);
  }
}

TEST(ContactPatch, OfALeaningOrLyingCapsuleIsThatOfPlainSums) {
  test::Random random(7);
  for (int i = 0; i < 12; ++i) {
    const double lean = i == 0 ? 0 : random.between(-0.2, 1.3), turn = random.between(0, 6.28);
    test::Pad pad;
    pad.away = {std::cos(lean) * std::cos(turn), std::cos(lean) * std::sin(turn), std::sin(lean)};
    const double lowest = min(0, pad.length * pad.away.z);
    pad.tip = {0, 0, test::kPadRadius - lowest - random.between(0.0005, 0.004)};
    const PlainPatch plain = plain_patch(pad);
    const ContactPatch patch = patch_on_plane(pad);
    EXPECT_NEAR(patch.force, plain.force, 0.005 * plain.force) << lean;
    EXPECT_NEAR(patch.radius, plain.radius, 0.01 * plain.radius) << lean;
    EXPECT_NEAR(patch.stiffness, plain.stiffness, 0.03 * plain.stiffness) << lean;
    EXPECT_LT(norm(patch.centre - plain.centre), 1e-4) << lean;
  }
}

TEST(ContactPatch, OfAPhalanxBetweenItsNeighboursIsAsStiffAsItsForceGrows) {
  Scene scene = test::pad_scene();
  scene.objects.push_back({"plane", make_plane(0.4, 3)});
  test::Session session(scene);
  const auto feel_leaning = [&](double lean, double pressed) {
    const Vec3 tip{0, 0, test::kPadRadius - pressed}, bone{0.025 * std::cos(lean), 0, 0.025 * std::sin(lean)};
    return session.feel(test::finger_frame({tip + 3.0 * bone, tip + 2.0 * bone, tip + bone, tip}));
  };
  const double step = 2e-5;
  std::size_t compared = 0;
  for (const double lean : {0.0, 0.05, 0.1, 0.2, 0.3}) {
    for (const double pressed : {0.002, 0.006}) {
      const ActuatorFrame above = feel_leaning(lean, pressed - step),
                          below = feel_leaning(lean, pressed + step), here = feel_leaning(lean, pressed);
      for (std::size_t i = 3; i < 6; ++i) {
        const double growth = (below.segment[i].force.z - above.segment[i].force.z) / (2 * step);
        if (!(here.segment[i].force.z > 0.1)) continue;
        const ContactPatch patch =
            contact_patch(*session.scratch.primitives, i, here.segment[i], kStiffness, {});
        EXPECT_NEAR(patch.stiffness, growth, 0.02 * growth) << segment_name(static_cast<int>(i)) << lean;
        ++compared;
      }
    }
  }
  EXPECT_GT(compared, 16u);
}

TEST(ContactPatch, OfThePalmMovesAsTheLineOfActionTurnsAndNeverJumps) {
  Primitives hand;
  hand.palm = place_palm(default_hand(Side::right).palm, {});
  const Vec3 point{0.01, 0.02, -0.05}, across = hand.palm.normal, along = unit_or(cross(across, point), {});
  const auto centre_at = [&](double angle) {
    const Vec3 force = 10 * (std::cos(angle) * across + std::sin(angle) * along);
    return contact_patch(hand, kPalmSegment, {force, cross(point, force)}, kStiffness, {}).centre;
  };
  const double step = 1e-4;
  double way = 0;
  for (double angle = 0; angle < kPi; angle += step) {
    const double moved = norm(centre_at(angle + step) - centre_at(angle));
    EXPECT_LT(moved, 10 * step) << angle;
    way += moved;
  }
  EXPECT_GT(way, 0.01);  // [m]
}

// A finger that is straight, or bent by a right angle half way, at a plane.
test::Session felt_finger(Vec3 distal, Vec3 tip) {
  Scene scene = test::pad_scene();
  scene.objects.push_back({"plane", make_plane(0.2, 3)});
  test::Session session(scene);
  DeviceFrame frame = test::finger_frame({Vec3{}, Vec3{0.03125, 0, 0}, distal, tip});
  frame.base.position = {0, 0, test::kPadRadius - 0.002};
  session.feel(frame);
  return session;
}

// Calls visit(angle, patch) for patches of a line of action that turns by half a turn about a point.
template <class Visit>
void visit_turning_patches(const Primitives& hand, std::size_t segment, double force, const Visit& visit) {
  const Primitive& capsule = hand.capsule[segment];
  const Vec3 point = 0.5 * (capsule.end1 + capsule.end2) - hand.base_joint[segment] - Vec3{0, 0, 0.004};
  for (double angle = 0; angle < kPi; angle += kTurningStep) {
    const Vec3 push = force * Vec3{std::cos(angle), 0, std::sin(angle)};
    visit(angle, contact_patch(hand, segment, {push, cross(point, push)}, kStiffness, {}));
  }
}

TEST(ContactPatch, OfAPhalanxNeverJumpsAsTheLineOfActionTurns) {
  const test::Session straight = felt_finger({0.0546875, 0, 0}, {0.078125, 0, 0}),
                      bent = felt_finger({0.046875, 0, -0.015625}, {0.046875, 0, -0.03125});
  for (const test::Session* session : {&straight, &bent}) {
    for (const std::size_t segment : {3u, 4u, 5u}) {
      for (const double force : {1.0, 5.0}) {
        ContactPatch last;
        visit_turning_patches(
            *session->scratch.primitives, segment, force, [&](double angle, const ContactPatch& patch) {
              if (angle > 0) {
                EXPECT_LT(norm(patch.centre - last.centre), 0.05 * kTurningStep) << segment << " " << angle;
                EXPECT_NEAR(patch.radius, last.radius, 2e-4) << segment << " " << angle;
                EXPECT_NEAR(patch.stiffness, last.stiffness, 1000) << segment << " " << angle;
              }
              last = patch;
            });
      }
    }
  }
}

TEST(ContactPatch, OfAPhalanxThatAFacePassesThroughIsNotStifferForItsCuts) {
  for (const double turn : {0.0, 9.9e-4, 1.01e-3, 5e-3, 0.03}) {
    Scene scene = test::pad_scene();
    Mesh box = make_box({0.1, 0.2, 0.2}, 4);
    place_mesh({{0.05, 0, 0}, {}}, box);
    scene.objects.push_back({"face at x = 0", box});
    test::Session session(scene);
    DeviceFrame frame = test::finger_frame(
        {Vec3{-0.046875, 0, 0}, Vec3{-0.015625, 0, 0}, Vec3{0.015625, 0, 0}, Vec3{0.0390625, 0, 0}});
    frame.base.orientation = {std::cos(0.5 * turn), 0, std::sin(0.5 * turn), 0};
    const Wrench wrench = session.feel(frame).segment[4];
    const ContactPatch patch = contact_patch(*session.scratch.primitives, 4, wrench, kStiffness, {});
    EXPECT_GT(patch.force, 5);
    EXPECT_LT(patch.stiffness, 500) << turn;  // [N/m]; its force does not grow at all
  }
}

}  // namespace
}  // namespace lumbrical
