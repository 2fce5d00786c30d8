// See simulated_loop.h.
#include "simulated_loop.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <memory>
#include <numbers>

#include "lumbrical/local_model.h"
#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"

namespace lumbrical::bench {
namespace {

constexpr double kStep = 5e-5;     // [s]
constexpr double kSweepRate = 2;   // [Hz]
constexpr double kLocalShare = 1;  // as lumbrical run has it
constexpr double kTwoPi = 2 * std::numbers::pi;
constexpr std::size_t kJoint = 3;  // the index' first

struct Pending {
  double due = 0;
  lumbrical_local_model model{};
};

class Host {
 public:
  Host(const SimulatedLoop& loop, const Touch& touch) : loop_(loop), touch_(touch) {
    certificate_.known[kJoint] = true;
    // The device's own loop is what has to be passive where there is one.
    const LoopTiming timing = loop.local_period > 0 ? LoopTiming{loop.local_period, 0, 0}
                                                    : LoopTiming{loop.period, loop.jitter, loop.delay};
    certificate_.joint[kJoint] = stiffness_bound(timing, loop.dynamics);
    profile_.dynamics[kJoint] = loop.dynamics;
  }
  lumbrical_local_model command(double angle, double acted) {
    const Touched touched = touch_(angle);
    HandStiffness stiffness{};
    stiffness[kJoint / 3][0][0] = touched.stiffness;
    JointArray wanted{};
    wanted[kJoint] = touched.torque;
    if (loop_.limiter) limit_stiffness(certificate_, stiffness, wanted, loop_.period, limiter_);
    const double factor = limiter_.factor[kJoint / 3];
    least_factor = std::min(least_factor, factor);
    double torque = factor * touched.torque;
    double share = 1;
    if (loop_.account) {
      EnergyStep step;
      step.dt = loop_.period;
      step.moved[0] = started_ ? angle - angle_ : 0;
      step.acted[0] = acted;
      step.touching = torque != 0 || acted != 0;
      keep_account(certificate_, profile_, kJoint / 3, step, account_);
      share = pay(certificate_, kJoint / 3, {torque, 0, 0}, loop_.period, account_);
    }
    angle_ = angle;
    started_ = true;
    torque *= share;
    const double k = share * factor * touched.stiffness;
    return {torque, angle, k, k > 0 ? kLocalShare * std::fabs(torque) / k : 0};
  }
  [[nodiscard]] double factor() const { return limiter_.factor[kJoint / 3]; }
  double least_factor = 1;

 private:
  const SimulatedLoop& loop_;
  const Touch& touch_;
  StiffnessCertificate certificate_;
  StiffnessLimiter limiter_;
  DeviceProfile profile_;
  EnergyAccount account_;
  double angle_ = 0;
  bool started_ = false;
};

struct Figures {
  double low = 1e9, high = -1e9, energy = 0, generated = 0, error = 0, ideal = 0;
};

}  // namespace

LoopOutcome simulate(const SimulatedLoop& loop, const Touch& touch) {
  Host host(loop, touch);
  JointState joint{loop.start, 0};
  std::deque<Pending> pending;
  const lumbrical_local_limits limits = {1e3, 1e9, 1e3, 1};
  lumbrical_local_model model = host.command(joint.angle, 0);  // the touch is not new
  Figures figures;
  double torque = model.torque, next_command = 0, next_local = 0;
  std::uint64_t random = 1;
  const auto steps = static_cast<int>(loop.seconds / kStep);
  for (int i = 0; i < steps; ++i) {
    const double time = i * kStep;
    if (time >= next_command) {
      random = random * 6364136223846793005u + 1442695040888963407u;
      const double late = loop.jitter * static_cast<double>(random >> 40) / 16777216.0;
      pending.push_back(
          {time + loop.delay + late, host.command(read_encoder(loop.dynamics, joint.angle), torque)});
      next_command += loop.period;
    }
    while (!pending.empty() && time >= pending.front().due - 1e-12) {
      model = pending.front().model;
      pending.pop_front();
      torque = loop.local_period > 0 ? torque : model.torque;
      next_local = std::min(next_local, time);
    }
    if (loop.local_period > 0 && time >= next_local) {
      torque = lumbrical_local_torque(&model, &limits, read_encoder(loop.dynamics, joint.angle), 0);
      next_local = time + loop.local_period;
    }
    const double target = loop.middle + loop.sweep * std::sin(kTwoPi * kSweepRate * time);
    const double before = joint.angle;
    step_joint(loop.dynamics, loop.human, target, torque - loop.push, kStep, joint);
    figures.energy += torque * (joint.angle - before);
    figures.generated = std::max(figures.generated, -figures.energy);
    if (i % 20 == 0) {
      const double ideal = host.factor() * touch(joint.angle).torque;
      figures.error += (torque - ideal) * (torque - ideal);
      figures.ideal += ideal * ideal;
    }
    if (i < steps - steps / 5) continue;
    figures.low = std::min(figures.low, joint.angle);
    figures.high = std::max(figures.high, joint.angle);
  }
  LoopOutcome outcome;
  outcome.swing = figures.high - figures.low;
  outcome.generated = figures.generated;
  outcome.felt_error = figures.ideal > 0 ? std::sqrt(figures.error / figures.ideal) : 0;
  outcome.least_factor = host.least_factor;
  outcome.shakes = !(outcome.swing <= 10 * std::max(loop.dynamics.encoder_step, 1e-4));
  return outcome;
}

double shaking_stiffness(SimulatedLoop loop) {
  double low = 0.1, high = 1e3;
  while (high / low > 1.02) {
    const double middle = std::sqrt(low * high);
    loop.start = 1.2 * loop.push / middle;  // a little off its rest
    (simulate(loop, linear_wall(middle)).shakes ? high : low) = middle;
  }
  return low;
}

Touch linear_wall(double stiffness) {
  return [=](double angle) { return angle > 0 ? Touched{stiffness * angle, stiffness} : Touched{}; };
}

Touch round_wall(double stiffness) {
  return [=](double angle) {
    if (angle <= 0) return Touched{};
    const double root = std::sqrt(angle / 0.1);
    return Touched{stiffness * root * angle / 1.5, stiffness * root};
  };
}

Touch engine_touch(double stiffness_per_volume) {
  struct Engine {
    Model model;
    State state;
    Scratch scratch;
    DeviceFrame frame;
    std::array<double, kAngleCount> angles{};
    std::array<Pose, kJointCount> X_WJ{};
  };
  constexpr double kBent = 0.5;  // [rad] at which the fingertip meets the plane
  constexpr std::size_t kAngle = 5;
  const auto engine = std::make_shared<Engine>();
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.stiffness = stiffness_per_volume;
  scene.settings.max_force = 1e6;
  scene.settings.fade_time = 1e-6;
  scene.objects.push_back({"plane", make_plane(0.4, 16, 0)});
  if (!build_model(scene, {}, engine->model).ok()) return {};
  engine->scratch = make_scratch(engine->model);
  engine->scratch.hash_stages = false;
  DeviceFrame& frame = engine->frame;
  frame.kind = InputKind::joint_angles;
  frame.base.orientation = {std::sqrt(0.5), std::sqrt(0.5), 0, 0};
  engine->angles[kAngle] = kBent;
  forward_kinematics(scene.hand, frame.base, engine->angles, engine->X_WJ);
  frame.base.position = {0, -0.08, scene.hand.radius[kIndexTip] - engine->X_WJ[kIndexTip].position.z};
  return [engine](double angle) {
    Engine& e = *engine;
    e.angles[kAngle] = kBent + angle;
    e.frame.angle[kAngle] = static_cast<float>(e.angles[kAngle]);
    const ActuatorFrame output = tick(e.model, e.state, e.scratch, e.frame);
    if (output.contact_count == 0) return Touched{};
    std::array<SegmentJacobian, kSegmentCount> jacobians;
    segment_jacobians(e.model, e.scratch, jacobians, 7u << 3);
    forward_kinematics(e.model.hand, e.frame.base, e.angles, e.X_WJ);
    return Touched{output.flexion_torque[kJoint], joint_stiffness(e.X_WJ, output, jacobians)[1][0][0]};
  };
}

}  // namespace lumbrical::bench
