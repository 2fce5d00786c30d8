// What holds a proxy back: springs and gaps balance, whatever the gaps.
#include "proxy/hand_pull.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "largest.h"
#include "lumbrical/motion.h"
#include "random.h"

namespace lumbrical {
namespace {

using test::largest;
using test::Random;

constexpr double kGapCompliance = 2e-6;  // [m/N]

Joints flat_hand() {
  Joints joints;
  joints.valid = (1u << kJointCount) - 1;
  const std::array<double, kAngleCount> angles{};
  forward_kinematics(default_hand(Side::right), {{0.1, 0.2, 0.3}, {0.5, 0.5, -0.5, 0.5}}, angles,
                     joints.pose);
  return joints;
}

/// By how much a joint turned by `turn` in W takes a point along a normal.
double carried(const Joints& hand, int joint, Vec3 turn, const Gap& gap) {
  return dot(cross(turn, gap.point - hand.position(joint)), gap.normal);
}

std::vector<int> bends_before(const Gap& gap) {
  std::vector<int> bends;
  if (gap.segment == kPalmSegment) return bends;
  for (int i = gap.segment - gap.segment % 3; i <= gap.segment; ++i) bends.push_back(i);
  return bends;
}

double widened(const Joints& hand, const HandMove& move, const Gap& gap) {
  double sum = dot(move.shift, gap.normal) + carried(hand, kWrist, move.turn, gap);
  for (const int i : bends_before(gap)) {
    const auto at = static_cast<std::size_t>(i);
    const int joint = kPhalanxJoints[at].base;
    const Quat frame = hand.pose[static_cast<std::size_t>(joint)].orientation;
    sum += carried(hand, joint, rotate(frame, move.bend[at]), gap);
  }
  return sum;
}

/// The move to which the springs give way under the gaps' pushes.
HandMove given_way(const Joints& hand, const HandMove& wanted, double stiffness, double balanced,
                   const std::vector<Gap>& gaps) {
  HandMove move = wanted;
  for (const Gap& gap : gaps) {
    const Vec3 force = gap.push * gap.normal;
    const double wrist = (1 - balanced) / (stiffness * (1 + 20 * balanced)), lever = kHandLever * kHandLever;
    move.shift += wrist * force;
    move.turn += wrist / lever * cross(gap.point - hand.position(kWrist), force);
    for (const int i : bends_before(gap)) {
      const auto at = static_cast<std::size_t>(i);
      const Pose& joint = hand.pose[static_cast<std::size_t>(kPhalanxJoints[at].base)];
      const Vec3 torque = rotate(conjugate(joint.orientation), cross(gap.point - joint.position, force));
      const double bend = 1 / (stiffness * kFingerLever * kFingerLever);
      move.bend[at] += bend * Vec3{torque.x, i % 3 == 0 ? torque.y : torque.y / 20, torque.z / 20};
    }
  }
  return move;
}

double distance(const HandMove& a, const HandMove& b) {
  double most = largest(norm(a.shift - b.shift), norm(a.turn - b.turn));
  for (std::size_t i = 0; i < kPhalanxCount; ++i) most = largest(most, norm(a.bend[i] - b.bend[i]));
  return most;
}

/// Fingers round something and on it: most gaps of a segment look the same way, many are doubled.
std::vector<Gap> random_gaps(Random& random, const Joints& hand, int count) {
  std::vector<Gap> gaps;
  for (int i = 0; i < count; ++i) {
    if (i % 3 == 2) {
      gaps.push_back(gaps[random.below(gaps.size())]);
      continue;
    }
    Gap gap;
    gap.segment = static_cast<std::uint8_t>(random.below(kSegmentCount));
    const int joint = gap.segment == kPalmSegment ? int{kPalm} : int{kPhalanxJoints[gap.segment].tip};
    gap.point = hand.position(joint) + 0.01 * random.direction();
    const Vec3 tilted = Vec3{0, 1, 0} + 0.5 * random.direction();
    gap.normal = tilted / norm(tilted);
    gap.width = random.between(-0.002, 0.002);
    gaps.push_back(gap);
  }
  return gaps;
}

TEST(HandPull, BalancesSpringsAndGapsHoweverManyPush) {
  const Joints hand = flat_hand();
  Random random(7);
  int pushing = 0;
  for (int trial = 0; trial < 400; ++trial) {
    std::vector<Gap> gaps = random_gaps(random, hand, 1 + trial % 250);
    const double stiffness = std::pow(10, random.between(1, 5));
    const double balanced = trial % 4 == 0 ? 0 : trial % 4 == 1 ? 1 : random.between(0, 1);
    HandMove wanted{0.01 * random.direction(), 0.05 * random.direction(), {}};
    for (Vec3& bend : wanted.bend) bend = 0.2 * random.direction();
    const HandMove move = pull(hand, wanted, stiffness, balanced, gaps);
    double most = 0;
    for (const Gap& gap : gaps) most = largest(most, gap.push);
    const double rounding = 1e-10 * kGapCompliance * most + 1e-16;  // [m]
    EXPECT_LT(distance(move, given_way(hand, wanted, stiffness, balanced, gaps)), 1e-10) << trial;
    for (const Gap& gap : gaps) {
      const double left = gap.width + widened(hand, move, gap);
      EXPECT_GE(gap.push, 0) << trial;
      if (gap.push > 0)
        EXPECT_NEAR(left, -kGapCompliance * gap.push, rounding) << trial;
      else
        EXPECT_GE(left, -rounding) << trial;
      pushing += gap.push > 0 ? 1 : 0;
    }
  }
  EXPECT_GT(pushing, 2000);
}

}  // namespace
}  // namespace lumbrical
