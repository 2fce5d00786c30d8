// Stiffness bounds against the published numbers, joint stiffness against ticks of a moved finger, the
// limiter and the energy accounts against what they promise.
#include "lumbrical/passivity.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "device_fixture.h"
#include "frame_joints.h"
#include "pressed_hand.h"
#include "session.h"

namespace lumbrical {
namespace {

TEST(StiffnessBound, GivesThePublishedNumbers) {
  const JointDynamics joint{0, 0.1, 0.05, 1e-3};  // b = 0.1
  EXPECT_NEAR(stiffness_bound({0.001, 0, 0}, joint).sampled, 200, 1e-9);
  EXPECT_NEAR(stiffness_bound({0.009, 0, 0}, joint).largest, 22.2, 0.03);
  const StiffnessBound delayed = stiffness_bound({0.001, 0, 0.004}, joint);
  EXPECT_NEAR(delayed.delayed, 0.1 / 0.0045, 1e-9);
  EXPECT_EQ(delayed.largest, delayed.delayed);
  EXPECT_NEAR(stiffness_bound({0.0005, 0, 0}, joint).friction, 100, 1e-9);
  EXPECT_EQ(stiffness_bound({0.0005, 0, 0}, joint).largest, 100);
  EXPECT_NEAR(stiffness_bound({0.001, 0.001, 0}, joint).sampled, 100, 1e-9)
      << "jitter makes the period longer";
  EXPECT_EQ(stiffness_bound({0.001, 0, 0}, {0, 0.1, 0, 0}).friction, std::numeric_limits<double>::infinity());
}

HandStiffness stiffness_of(const Model& model, Scratch& scratch, const DeviceFrame& frame,
                           const ActuatorFrame& output) {
  const std::array<Pose, kJointCount> X_WJ = test::posed_joints(model.hand, frame);
  std::array<SegmentJacobian, kSegmentCount> jacobians;
  segment_jacobians(model, scratch, jacobians);
  return joint_stiffness(X_WJ, output, jacobians);
}

// The opening torques' growth when joint `angle` closes, by central differences of ticks.
std::array<double, 3> ticked(const Model& model, const DeviceFrame& frame, std::size_t finger,
                             std::size_t joint) {
  std::array<double, 3> growth{};
  const float step = 1e-4f;
  double width = 0;
  for (const float sign : {1.0f, -1.0f}) {
    DeviceFrame moved = frame;
    float& angle = moved.angle[4 * finger + 1 + joint];
    angle += sign * step;
    width += static_cast<double>(sign) * static_cast<double>(angle);
    State state;
    Scratch scratch = make_scratch(model);
    const ActuatorFrame output = tick(model, state, scratch, moved);
    for (std::size_t i = 0; i < 3; ++i)
      growth[i] += static_cast<double>(sign) * output.flexion_torque[3 * finger + i];
  }
  for (double& value : growth) value /= width;
  return growth;
}

// Pressed hand and world without anything that would come between touch and force.
Model unlimited_model() {
  Scene scene = test::pressed_scene(test::kWidthA, 40);
  scene.settings.fade_time = 1e-6;
  scene.settings.max_force = 1e6;
  for (Finger& finger : scene.hand.finger) finger.limit.fill({-1, 2});
  return test::model_of(scene);
}

TEST(JointStiffness, IsWhatTicksOfABentFingerSay) {
  const Model model = unlimited_model();
  Scratch scratch = make_scratch(model);
  int compared = 0;
  for (const double time : {0.0, 0.37, 0.71}) {
    const DeviceFrame frame = test::pressed_frame(model.hand, 0.002, time);
    State state;
    const ActuatorFrame output = tick(model, state, scratch, frame);
    const HandStiffness stiffness = stiffness_of(model, scratch, frame, output);
    for (std::size_t finger = 1; finger < kFingerCount; ++finger) {
      double scale = 0;
      for (const auto& row : stiffness[finger]) {
        for (const double entry : row) scale = std::max(scale, std::fabs(entry));
      }
      for (std::size_t k = 0; k < 3; ++k) {
        const std::array<double, 3> growth = ticked(model, frame, finger, k);
        for (std::size_t i = 0; i < 3; ++i) {
          // What is left: borders between phalanges that turn, which the Jacobian leaves out, and the steps'
          // width.
          EXPECT_NEAR(stiffness[finger][i][k], growth[i], 0.02 * scale) << finger << " " << i << " " << k;
          ++compared;
        }
      }
      EXPECT_GT(scale, 0.1);
    }
  }
  EXPECT_EQ(compared, 3 * 4 * 9);
}

TEST(JointStiffness, FingerByFingerGivesTheSameBitsAsAllAtOnce) {
  const Model model = test::model_of(test::pressed_scene(test::kWidthA, 40));
  State state;
  Scratch scratch = make_scratch(model);
  tick(model, state, scratch, test::pressed_frame(model.hand, 0.002, 0.2));
  std::array<SegmentJacobian, kSegmentCount> all, turns;
  segment_jacobians(model, scratch, all);
  for (std::uint32_t finger = 0; finger < kFingerCount; ++finger) {
    segment_jacobians(model, scratch, turns, 7u << 3 * finger);
  }
  double size = 0;
  for (std::size_t s = 0; s < kPhalanxCount; ++s) {
    EXPECT_EQ(turns[s].value, all[s].value) << s;
    size += std::fabs(all[s].value[2][2]);
  }
  EXPECT_GT(size, 1);
  EXPECT_FALSE(turns[kPalmSegment].known) << "no one asked";
}

TEST(StiffnessCertificate, CountsOnTheDelaysOfSensorsAndDrivesJointByJoint) {
  DeviceProfile profile = test::shipped_profile("exoskeleton");
  const LoopTiming bus{0.001, 0, 0.001};
  const StiffnessCertificate unsaid = make_certificate(profile, bus);
  EXPECT_FALSE(knows_own_delays(profile));
  for (Sensor& sensor : profile.sensors) sensor.delay = sensed_joint(sensor) == 3 ? 0.02 : 0;
  for (Actuator& actuator : profile.actuators) actuator.delay = actuator.arm[4] != 0 ? 0.005 : 0;
  EXPECT_TRUE(knows_own_delays(profile));
  const StiffnessCertificate said = make_certificate(profile, bus);
  EXPECT_EQ(said.timing.delay, bus.delay) << "the bus's";
  const auto delayed = [&](double delay) {
    return stiffness_bound({0.001, 0, delay}, profile.dynamics[3]).delayed;
  };
  EXPECT_EQ(said.joint[3].delayed, delayed(0.021));
  EXPECT_EQ(said.joint[4].delayed, delayed(0.006));
  EXPECT_EQ(said.joint[5].delayed, unsaid.joint[5].delayed);
}

// An angle that is told anew every 20 ms has moved for 20 ms, and not in the one millisecond since the last
// answer, in which damping would have taken twenty times as much.
TEST(EnergyAccount, DampingIsCountedOnForAllOfTheTimeThatAWayTook) {
  const DeviceProfile profile = test::shipped_profile("exoskeleton");
  const StiffnessCertificate certificate = make_certificate(profile, {0.001, 0, 0.001});
  const auto taken = [&](double before) {
    EnergyAccount account;
    EnergyStep step{0.001, {0.02}, {}, 0, true};
    step.held[0] = before;
    keep_account(certificate, profile, 0, step, account);
    return account.energy;
  };
  EXPECT_GT(taken(0), 0);
  EXPECT_NEAR(taken(0.019), taken(0) / 20, 1e-12);
}

TEST(StiffnessLimiter, HoldsWhatIsTooStiffAndLetsTheRestBe) {
  const DeviceProfile profile = test::shipped_profile("exoskeleton");
  const StiffnessCertificate certificate = make_certificate(profile, {0.001, 0, 0.001});
  const double allowed = certificate.margin * certificate.joint[3].largest;
  HandStiffness stiffness{};
  stiffness[1][0][0] = 4 * allowed;
  stiffness[2][0][0] = 0.9 * allowed;
  StiffnessLimiter limiter;
  limit_stiffness(certificate, stiffness, {}, 0.001, limiter);
  EXPECT_NEAR(limiter.factor[1], 0.25, 1e-12);
  EXPECT_EQ(limiter.factor[2], 1);
  stiffness = {};
  limit_stiffness(certificate, stiffness, {}, 0.001, limiter);
  EXPECT_LT(limiter.factor[1], 0.2512) << "recovers slowly";
  for (int i = 0; i < 10000; ++i) limit_stiffness(certificate, stiffness, {}, 0.001, limiter);
  EXPECT_GT(limiter.factor[1], 0.999);
  stiffness[1][2][0] = std::nan("");
  limit_stiffness(certificate, stiffness, {}, 0.001, limiter);
  EXPECT_EQ(limiter.factor[1], 0);
}

TEST(StiffnessLimiter, ScalesAnyFingerUnderItsBounds) {
  // x' K x <= margin * sum of bound_i x_i^2 for whatever motion x, after scaling by the factor.
  test::Random random(11);
  StiffnessCertificate certificate;
  for (int round = 0; round < 2000; ++round) {
    HandStiffness stiffness{};
    certificate.known.fill(true);
    for (std::size_t j = 0; j < kPhalanxCount; ++j) certificate.joint[j].largest = random.between(0.1, 10);
    for (auto& row : stiffness[0]) {
      for (double& entry : row) entry = random.between(-20, 20);
    }
    StiffnessLimiter limiter;
    limit_stiffness(certificate, stiffness, {}, 0.001, limiter);
    for (int trial = 0; trial < 20; ++trial) {
      const Vec3 v = random.direction();
      const double x[] = {v.x, v.y, v.z};
      double made = 0, allowed = 0;
      for (std::size_t i = 0; i < 3; ++i) {
        allowed += certificate.margin * certificate.joint[i].largest * x[i] * x[i];
        for (std::size_t k = 0; k < 3; ++k) made += limiter.factor[0] * x[i] * stiffness[0][i][k] * x[k];
      }
      ASSERT_LE(made, allowed * (1 + 1e-9));
    }
  }
}

// A finger whose first joint has a bound of `largest` [N m/rad], no damping, and an encoder without steps.
struct OneJoint {
  StiffnessCertificate certificate;
  DeviceProfile profile;
  explicit OneJoint(double largest) {
    certificate.joint[0].largest = largest;
    certificate.known[0] = true;
  }
};

TEST(EnergyAccount, KeepsTheBooksOfAHeldTorqueExactly) {
  OneJoint joint(1);
  EnergyAccount account;
  const auto step = [&](double moved, double acted, double given, bool touching) {
    keep_account(joint.certificate, joint.profile, 0, {0.001, {moved}, {acted}, given, touching}, account);
  };
  step(0.03, 0.2, 0, true);
  EXPECT_NEAR(account.energy, 0.006, 1e-15);
  step(-0.01, 0.5, 0, true);
  EXPECT_NEAR(account.energy, 0.001, 1e-15);
  step(0, 0.5, 0.002, true);  // the arm has pressed
  EXPECT_NEAR(account.energy, 0.003, 1e-15);
  EXPECT_EQ(account.generated, 0);
  step(0, 0, 0, false);
  EXPECT_EQ(account.energy, 0) << "no touch, no account";
  step(-0.01, 0.5, 0, true);
  step(0, 0, 0, false);
  EXPECT_NEAR(account.energy, -0.005, 1e-15) << "what was given too much stays owed";
  EXPECT_NEAR(account.generated, 0.005, 1e-15);
  joint.profile.dynamics[0].damping = 0.01;
  step(0.01, 0, 0, false);  // 10 rad/s
  EXPECT_NEAR(account.energy, -0.005 + joint.certificate.margin * 0.01 * 10 * 0.01, 1e-15);
  step(std::nan(""), 0.5, 0, true);
  EXPECT_TRUE(std::isfinite(account.energy));
}

// Forces that fade and come back within a delay of the bus: all the while something acts.
TEST(EnergyAccount, IsClosedWhereNothingIsWantedAnyMoreThoughAnOldTorqueStillActs) {
  const OneJoint joint(1);
  EnergyAccount account;
  keep_account(joint.certificate, joint.profile, 0, {0.001, {0.1}, {0.5}, 0, true}, account);
  EXPECT_EQ(pay(joint.certificate, 0, {0.05, 0, 0}, 0.001, account), 1);
  EXPECT_GT(account.energy, 0.04);
  pay(joint.certificate, 0, {}, 0.001, account);
  EXPECT_EQ(account.energy, 0);
  EXPECT_LT(pay(joint.certificate, 0, {0.05, 0, 0}, 0.001, account), 1);
}

// A joint that is pressed against any torque and let go again gets back no more than it gave, but for the
// loan and what one step of the way holds: whatever the touch, however its torque jumps.
TEST(EnergyAccount, GivesNoMoreThanItHasTakenWhateverTheTouchWants) {
  test::Random random(12);
  int scaled = 0;
  for (int round = 0; round < 200; ++round) {
    const double bound = random.between(0.05, 10), way = random.between(1e-4, 2e-3);
    const OneJoint joint(bound);
    EnergyAccount account;
    double taken = 0, acted = 0, largest = 0;
    for (int i = 0; i < 2000; ++i) {
      const double moved = way * (random.between(-1, 1) + (i % 400 < 200 ? 0.3 : -0.3));
      taken += acted * moved;
      largest = std::max(largest, -taken);
      keep_account(joint.certificate, joint.profile, 0, {0.001, {moved}, {acted}, 0, true}, account);
      const double torque = random.between(-1, 1) * (random.bits() % 8 == 0 ? 0 : 1);
      const double share = pay(joint.certificate, 0, {torque, 0, 0}, 0.001, account);
      ASSERT_GE(share, 0);
      ASSERT_LE(share, 1);
      scaled += share < 1 ? 1 : 0;
      acted = share * torque;
      const double held = std::max(0.0, account.energy + kMostLent);
      ASSERT_LE(acted * acted / (2 * joint.certificate.margin * bound), held * (1 + 1e-9) + 1e-18);
    }
    const double step = 1.3 * way;
    const double reach =
        std::sqrt(2 * joint.certificate.margin * bound * (kMostLent + 0.5 * bound * step * step));
    EXPECT_LT(largest, kMostLent + reach * step) << round;
  }
  EXPECT_GT(scaled, 1000);
}

// However much was taken before: a stiff touch grows no faster than the spring the certificate allows.
TEST(EnergyAccount, LetsTorquesGrowNoFasterThanTheAllowedSprings) {
  const OneJoint joint(0.5);
  EnergyAccount account;
  account.energy = 1;
  const double allowed = joint.certificate.margin * 0.5;
  double before = 0.3 * pay(joint.certificate, 0, {0.3, 0, 0}, 0, account);
  EXPECT_NEAR(before, allowed * kLentWay, 1e-12);
  for (int i = 0; i < 50; ++i) {
    keep_account(joint.certificate, joint.profile, 0, {0.001, {0.001}, {before}, 0, true}, account);
    const double given = 0.3 * pay(joint.certificate, 0, {0.3, 0, 0}, 0, account);
    EXPECT_NEAR(given, before + allowed * 0.001, 1e-12);
    before = given;
  }
  const double still = 0.3 * pay(joint.certificate, 0, {0.3, 0, 0}, 0.01, account);
  EXPECT_GT(still, before) << "comes back by itself";
  EXPECT_LT(still, 1.01 * before) << "but slowly";
}

// Whoever is pushed back feels what the spring held, not more, whatever the touch asks for and the arm adds.
TEST(EnergyAccount, LetsNoTorqueGrowByTheWayItPushes) {
  const OneJoint joint(0.5);
  for (const double arm : {0.0, 5e-6}) {
    EnergyAccount account;
    account.energy = 1;
    const double before = 0.3 * pay(joint.certificate, 0, {0.3, 0, 0}, 0, account);
    for (int i = 0; i < 50; ++i) {
      keep_account(joint.certificate, joint.profile, 0, {0.001, {-0.01}, {before}, arm, true}, account);
      EXPECT_NEAR(0.3 * pay(joint.certificate, 0, {0.3, 0, 0}, 0, account), before, 1e-12);
    }
  }
}

// What is small comes back slowly: a torque that was let go of must not be back before the hand has settled.
TEST(EnergyAccount, LetsASmallTorqueCreepByAShareOfItself) {
  const OneJoint joint(0.5);
  EnergyAccount account;
  account.energy = 1;
  const double before = 0.3 * pay(joint.certificate, 0, {0.3, 0, 0}, 0, account);
  double after = before;
  for (int i = 0; i < 100; ++i) after = 0.3 * pay(joint.certificate, 0, {0.3, 0, 0}, 0.001, account);
  EXPECT_GT(after, 1.01 * before);
  EXPECT_LT(after, 1.06 * before) << "a tenth of a second";
}

TEST(StiffnessLimiter, HoldsTheTorqueWhileATouchGetsStifferAndFollowsAShrinkingBound) {
  StiffnessCertificate certificate;
  certificate.known.fill(true);
  for (StiffnessBound& bound : certificate.joint) bound.largest = 1;
  StiffnessLimiter limiter;
  HandStiffness stiffness{};
  JointArray torque{};
  torque[0] = 0.1;
  stiffness[0][0][0] = 0.5;
  limit_stiffness(certificate, stiffness, torque, 0.001, limiter);
  EXPECT_EQ(limiter.factor[0], 1);
  stiffness[0][0][0] = 8;  // ten times what is allowed
  torque[0] = 0.125;
  limit_stiffness(certificate, stiffness, torque, 0.001, limiter);
  EXPECT_NEAR(limiter.factor[0] * torque[0], 0.1, 1e-4) << "as before, not a tenth";
  StiffnessLimiter staying = limiter;
  for (int i = 0; i < 200; ++i) limit_stiffness(certificate, stiffness, torque, 0.001, staying);
  EXPECT_NEAR(staying.factor[0] * torque[0], 0.1 * std::exp(-0.1), 1e-4) << "from there on slowly";
  for (int i = 0; i < 6000; ++i) limit_stiffness(certificate, stiffness, torque, 0.001, staying);
  EXPECT_NEAR(staying.factor[0], 0.25, 1e-3) << "but not as far too stiff as it was";
  torque[0] = 5;
  limit_stiffness(certificate, stiffness, torque, 0.001, limiter);
  EXPECT_NEAR(limiter.factor[0], 0.1, 1e-12) << "no less than the bound asks for";
  for (StiffnessBound& bound : certificate.joint) bound.largest = 0.1;
  limit_stiffness(certificate, stiffness, torque, 0.001, limiter);
  EXPECT_NEAR(limiter.factor[0], 0.1 / 8, 1e-5) << "at once to where it is passive";
  for (int i = 0; i < 200; ++i) limit_stiffness(certificate, stiffness, torque, 0.001, limiter);
  EXPECT_GT(limiter.factor[0], 0.0105) << "to the margin without a kick";
  for (int i = 0; i < 5000; ++i) limit_stiffness(certificate, stiffness, torque, 0.001, limiter);
  EXPECT_NEAR(limiter.factor[0], 0.01, 1e-12);
}

// A bus that has become slower makes the same torque a larger part of what may be held: no reason to drop it.
TEST(EnergyAccount, LetsATorqueStandWhenTheBoundShrinks) {
  const OneJoint before(0.5), after(0.05);
  EnergyAccount account;
  account.energy = 1;
  const double torque = before.certificate.margin * 0.5 * kLentWay;
  EXPECT_NEAR(pay(before.certificate, 0, {torque, 0, 0}, 0, account), 1, 1e-12);
  renew_account(before.certificate, after.certificate, 0, account);
  EXPECT_NEAR(pay(after.certificate, 0, {torque, 0, 0}, 0, account), 1, 1e-12);
  EXPECT_LT(pay(after.certificate, 0, {2 * torque, 0, 0}, 0, account), 0.75) << "but it may not grow";
}

TEST(EnergyAccount, NeverTouchesASpringTheCertificateAllows) {
  const OneJoint joint(2);
  EnergyAccount account;
  double acted = 0, angle = 0;
  for (int i = 1; i <= 2000; ++i) {
    const double next = 0.1 * (1 - std::cos(2 * 3.14159265358979323846 * i / 2000));
    // Half of what was held at the ends: as a device without delay would have done.
    const double torque = joint.certificate.margin * 2 * next, mean = 0.5 * (acted + torque);
    keep_account(joint.certificate, joint.profile, 0, {0.001, {next - angle}, {mean}, 0, true}, account);
    ASSERT_EQ(pay(joint.certificate, 0, {torque, 0, 0}, 0.001, account), 1) << i;
    acted = torque;
    angle = next;
  }
}

// Joints and wrist of a finger that touches move to and fro: what joints take and what the arm gives must add
// up to what the touch holds, and that comes back to nothing with the hand.
TEST(EnergyAccount, TheArmsWorkPaysForWhatTheJointsGet) {
  const Model model = unlimited_model();
  State state;
  Scratch scratch = make_scratch(model);
  const DeviceFrame start = test::pressed_frame(model.hand, 0.002, 0);
  const int steps = 400;
  DeviceFrame frame, before = start;
  ActuatorFrame output = tick(model, state, scratch, start), last = output;
  double joints = 0, arm = 0, size = 0;
  for (int i = 1; i <= steps; ++i) {
    const double phase = 2 * 3.14159265358979323846 * i / steps;
    frame = start;
    frame.base.position.z -= 0.001 * std::sin(phase);
    frame.base.orientation =
        normalized(Quat{1, 0.01 * std::sin(phase), 0, 0.01 * (1 - std::cos(phase))} * start.base.orientation);
    for (std::size_t k = 5; k < 8; ++k) frame.angle[k] += static_cast<float>(0.03 * (1 - std::cos(phase)));
    output = tick(model, state, scratch, frame);
    const std::array<Pose, kJointCount> X_WJ = test::posed_joints(model.hand, frame);
    HandForces mean = output;
    for (std::size_t s = 0; s < kSegmentCount; ++s) {
      mean.segment[s].force = 0.5 * (output.segment[s].force + last.segment[s].force);
      mean.segment[s].torque = 0.5 * (output.segment[s].torque + last.segment[s].torque);
    }
    const double given = arm_work(before.base, frame.base, X_WJ, mean)[1];
    arm += given;
    size += std::fabs(given);
    for (std::size_t k = 0; k < 3; ++k) {
      const double moved = static_cast<double>(frame.angle[5 + k]) - static_cast<double>(before.angle[5 + k]);
      joints += 0.5 * (output.flexion_torque[3 + k] + last.flexion_torque[3 + k]) * moved;
    }
    before = frame;
    last = output;
  }
  EXPECT_GT(std::fabs(joints), 0.01 * size) << "the cycle should move energy from arm to joints";
  EXPECT_NEAR(joints + arm, 0, 0.02 * std::fabs(joints) + 0.002 * size);
}

}  // namespace
}  // namespace lumbrical
