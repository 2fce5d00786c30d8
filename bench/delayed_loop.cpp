// See delayed_loop.h.
#include "delayed_loop.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "loop/running_time.h"
#include "lumbrical/tick.h"
#include "modbus/exchange_words.h"

namespace lumbrical::bench {
namespace {

constexpr std::int64_t kStep = 100'000;  // [ns] of the device
constexpr double kBefore = 0.5;          // [s] of exchanges without forces
constexpr double kPatience = 0.004;      // [s] for a reply that does not come
constexpr double kStallPause = 0.5;      // [s] from one exchange that stalls to the next
constexpr double kHalfClosed = 0.25;     // of the motion, where joints without a hand are left

double seconds(std::int64_t ns) { return static_cast<double>(ns) * 1e-9; }
std::int64_t ns(double seconds) { return static_cast<std::int64_t>(seconds * 1e9); }

JointArray closing(const DeviceFrame& frame) {
  JointArray target;
  for (std::size_t j = 0; j < kPhalanxCount; ++j)
    target[j] = static_cast<double>(frame.angle[flexion_angle(j)]);
  return target;
}

// What the arm gives to the touch while it moves the wrist, by the torques that act at the moment: they are a
// share of what some tick wanted, and its forces, by as much, are what the arm would have felt.
class Arm {
 public:
  explicit Arm(const Hand& hand) : hand_(hand) {}

  void keep(const ActuatorFrame& output) {
    Wanted& wanted = past_[output.tick % past_.size()];
    wanted.tick = output.tick;
    wanted.forces = output;
  }
  // The wrist moves to where `frame` has it while commands of tick `acting` act with `torque` [N m].
  std::array<double, kFingerCount> move(const DeviceFrame& frame, std::uint64_t acting,
                                        const JointArray& torque) {
    std::array<double, kAngleCount> angles;
    std::copy(frame.angle.begin(), frame.angle.end(), angles.begin());
    forward_kinematics(hand_, frame.base, angles, X_WJ_);
    const Pose before = std::exchange(base_, frame.base);
    const Wanted& wanted = past_[acting % past_.size()];
    if (!std::exchange(moved_, true) || wanted.tick != acting) return {};
    std::array<double, kFingerCount> work = arm_work(before, frame.base, X_WJ_, wanted.forces);
    for (std::size_t f = 0; f < kFingerCount; ++f) {
      double acts = 0, asked = 0;
      for (std::size_t j = 3 * f; j < 3 * f + 3; ++j) {
        acts += torque[j] * wanted.forces.flexion_torque[j];
        asked += wanted.forces.flexion_torque[j] * wanted.forces.flexion_torque[j];
      }
      work[f] *= asked > 0 ? acts / asked : 0;
    }
    return work;
  }

 private:
  struct Wanted {
    std::uint64_t tick = 0;
    HandForces forces;
  };
  const Hand& hand_;
  std::vector<Wanted> past_ = std::vector<Wanted>(1024);
  std::array<Pose, kJointCount> X_WJ_{};
  Pose base_;
  bool moved_ = false;
};

// What is between the ticks and the device, in the time that pass() was last told.
class SimulatedLink final : public DeviceLink {
 public:
  SimulatedLink(const DeviceProfile& profile, const Bus& bus, double length, SimulatedDevice& device)
      : profile_(profile),
        bus_(bus),
        length_(length),
        device_(device),
        words_(profile),
        safety_(start_safety(profile)),
        running_{1 / bus.rate} {}

  [[nodiscard]] std::int64_t now() const noexcept override { return now_; }
  void publish(const DeviceCommand& command) noexcept override {
    newest_ = command;
    published_ = now_;
  }
  bool feedback(DeviceFeedback& feedback) noexcept override {
    if (reply_) feedback = *reply_;
    return std::exchange(reply_, std::nullopt).has_value();
  }
  bool sent(SentCommand& command) noexcept override {
    if (told_) command = *told_;
    return std::exchange(told_, std::nullopt).has_value();
  }
  bool arm = false;
  double sensing = 0;
  double largest_step = 0;
  std::uint64_t acting_tick = 0;  // of the command that acts

  // Sends, delivers, answers: whatever is due.
  void pass(std::int64_t now) {
    now_ = now;
    if (waiting_ && now >= arrives_ && !delivered_ && !lost_) deliver();
    if (waiting_ && now >= answered_) take_reply();
    if (!waiting_ && now >= due()) send(now);
  }

 private:
  double exchange_time(std::int64_t now) {
    random_ = random_ * 6364136223846793005u + 1442695040888963407u;
    const double chance = static_cast<double>(random_ >> 40) / 16777216.0;
    const double run = clamp((seconds(now) - kBefore) / length_, 0, 1);
    switch (bus_.kind) {
      case Delays::constant:
        return bus_.delay;
      case Delays::jittering:
        return bus_.delay * (0.5 + chance);
      case Delays::growing:
        return bus_.delay * run;
      case Delays::stepping:
        return run < 0.4 ? 0 : bus_.delay;
      case Delays::stalling:
        if (now < stall_) return 0;
        stall_ = now + ns(kStallPause);
        return bus_.delay;
    }
    return 0;
  }
  std::int64_t due() const {
    const double exchange = seconds(answered_ - sent_at_);
    return std::max(next_, answered_) + ns(wait_for_tick(newest_, sent_at_, exchange, profile_.safety));
  }
  void send(std::int64_t now) {
    SafetyInputs inputs;
    const double elapsed = seconds(now - sent_at_);
    inputs.dt = running_.advance(elapsed);
    inputs.gap = elapsed - inputs.dt;
    inputs.connected = true;
    inputs.arm = arm && safety_.state == SafetyState::idle;
    inputs.tick_age = seconds(now - published_);
    inputs.wanted = newest_.wanted;
    const SafetyOutput output = step_safety(profile_, inputs, safety_);
    for (std::size_t i = 0; i < profile_.actuators.size(); ++i) {
      for (std::size_t j = 0; j < kPhalanxCount; ++j)
        largest_step =
            max(largest_step, std::fabs(profile_.actuators[i].arm[j] * (output.command[i] - commanded_[i])));
    }
    commanded_ = output.command;
    words_.write(profile_, {++cycle_, output, newest_});
    sending_ = {cycle_, newest_.tick, now, 0, 0, safety_.state, output.flags, 0, {}};
    asked_for_ = newest_.feedback_time;
    sent_at_ = now;
    lost_ = cycle_ % static_cast<std::uint64_t>(bus_.arriving) != 0;
    const std::int64_t time = lost_ ? ns(kPatience) : ns(exchange_time(now)) + kStep;
    arrives_ = now + time / 2;
    answered_ = now + time;
    next_ = now + ns(1 / bus_.rate);
    waiting_ = true;
    delivered_ = false;
  }
  void deliver() {
    const RegisterBlock& writes = words_.plan.writes[0];
    const RegisterBlock& reads = words_.plan.reads[0];
    device_.write(writes.unit, writes.address, std::span(words_.written.data(), writes.count));
    if (seconds(now_ - sensed_at_) >= sensing || sensed_at_ == 0) {
      device_.read_inputs(reads.unit, reads.address, std::span(words_.read.data(), reads.count));
      sensed_at_ = now_;
    }
    delivered_ = true;
    acting_tick = sending_.tick;
  }
  void take_reply() {
    waiting_ = false;
    if (lost_) {
      told_ = sending_;
      return;
    }
    DeviceFeedback feedback;
    feedback.asked = sending_.sent;
    feedback.time = answered_;
    feedback.acted = std::exchange(acting_, commanded_);
    words_.angles(profile_, feedback.angle, feedback.valid);
    reply_ = feedback;
    sending_.acknowledged = answered_;
    sending_.loop_delay = asked_for_ != 0 ? answered_ - asked_for_ : 0;
    told_ = sending_;
  }

  const DeviceProfile& profile_;
  Bus bus_;
  double length_;
  SimulatedDevice& device_;
  ExchangeWords words_;
  SafetyMemory safety_;
  RunningTime running_;
  DeviceCommand newest_;
  ActuatorArray commanded_{}, acting_{};
  std::optional<DeviceFeedback> reply_;
  std::optional<SentCommand> told_;
  SentCommand sending_;
  std::uint64_t cycle_ = 0, random_ = 1;
  std::int64_t now_ = 0, published_ = 0, stall_ = 0, sent_at_ = 0, next_ = 0, arrives_ = 0, answered_ = 0,
               asked_for_ = 0, sensed_at_ = 0;
  bool waiting_ = false, delivered_ = false, lost_ = false;
};

}  // namespace

LoopFelt run_delayed(const Model& model, const Motion& motion, const DeviceProfile& profile,
                     const DelayedLoop& wanted) {
  DeviceProfile truth = profile;
  for (JointDynamics& joint : truth.dynamics) joint.friction *= wanted.friction;
  const double length = duration(motion);
  SimulationOptions simulation;
  simulation.human = wanted.human;
  simulation.watchdog = 1;
  simulation.intention = [&](double time, JointArray& target) {
    const bool held = wanted.human.stiffness > 0;
    target = closing(resample(motion, held ? clamp(time, 0, length) : kHalfClosed * length));
  };
  SimulatedDevice device(truth, simulation);
  HapticLoop loop = start_loop(profile, wanted.options);
  SimulatedLink link(profile, wanted.bus, length, device);
  link.sensing = wanted.sensing;
  Arm arm(model.hand);
  State state;
  Scratch scratch = make_scratch(model);
  scratch.hash_stages = false;
  WornDevice worn;
  LoopFelt felt;
  const std::int64_t period = ns(1 / model.settings.rate), begin = ns(kBefore), end = begin + ns(length);
  std::int64_t next_tick = kStep;
  for (std::int64_t now = kStep; now < end; now += kStep) {
    device.advance(seconds(kStep));
    look(device, worn);
    link.pass(now);
    if (now < next_tick) continue;
    next_tick += period;
    if (now >= begin && !loop.certified) {
      certify_loop(loop);
      link.arm = true;
    }
    const auto feel = [&](LoopStep& step) {
      step.output = tick(model, state, scratch, step.frame);
      const std::array<double, kFingerCount> work = arm.move(step.frame, link.acting_tick, device.torque());
      for (std::size_t f = 0; f < kFingerCount; ++f) worn.balance[f] += work[f];
      arm.keep(step.output);
      return true;
    };
    LoopStep step;
    step.frame = resample(motion, max(0, seconds(now - begin)));
    step_loop(model, scratch, feel, link, loop, step);
    for (const double torque : device.torque()) felt.torque += std::fabs(torque);
  }
  felt.torque *= static_cast<double>(period) / static_cast<double>(end - begin);
  felt.shakes = shakes_of(worn);
  felt.given = worn.given;
  felt.taken = worn.taken;
  felt.step = link.largest_step;
  return felt;
}

}  // namespace lumbrical::bench
