// See lumbrical/haptic_loop.h.
#include "lumbrical/haptic_loop.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "base/set_bits.h"
#include "base/steady_clock.h"
#include "lumbrical/math.h"
#include "lumbrical/safety.h"

namespace lumbrical {
namespace {

// A local model is trusted as far as it takes to make the torque nothing, or twice what it is.
constexpr double kLocalShare = 1, kLargestRadius = 0.1;  // [1], [rad]
constexpr double kLocalPeriod = 0.001;                   // [s] of the device's own loop, at least as fast
// A finger's torque falls no faster than with these time constants, for bus and touch and for its account,
// and by no more than that share from one command to the next: what the hand falls into is no kick then.
constexpr double kLetGo = 0.2, kAccountLetGo = 0.015, kMostLetGo = 0.3;  // [s], [s], [1]
// What is left of a touch that counts as let go of: by its time constant alone it never would be.
constexpr double kGone = 0.01;
constexpr double kWorthTelling = 0.1;  // change of a bound, as a share

double total(const LoopTiming& timing) { return timing.period + timing.jitter + timing.delay; }

// What acted on a joint because of a touch: a wire pulls with its preload without one, and a brake opposes
// whichever way the joint went. A step of its encoder may be no way: it would be energy for nothing.
double acted_on(const Actuator& actuator, double command, std::size_t joint, double moved, double step) {
  const double arm = actuator.arm[joint];
  switch (actuator.drive) {
    case Drive::wire:
      return arm * max(0, command - actuator.preload);
    case Drive::brake:
      return std::fabs(arm) * command * (moved > 1.5 * step ? 1 : moved < -1.5 * step ? -1 : 0);
    default:
      return arm * command;
  }
}

// Does anything act on a joint because of a touch, a brake on one that stands still, too?
bool is_acted_on(const HapticLoop& loop, std::size_t joint) {
  for (std::size_t i = 0; i < loop.profile.actuators.size(); ++i)
    if (acted_on(loop.profile.actuators[i], loop.feedback.acted[i], joint, 1, 0) != 0) return true;
  return false;
}

JointArray acted_torque(const HapticLoop& loop) {
  JointArray torque{};
  for (std::size_t i = 0; i < loop.profile.actuators.size(); ++i) {
    for (std::size_t j = 0; j < kPhalanxCount; ++j)
      torque[j] += acted_on(loop.profile.actuators[i], loop.feedback.acted[i], j, loop.moved[j],
                            loop.profile.dynamics[j].encoder_step);
  }
  return torque;
}

// One finger a tick: all of them would take longer than the tick itself.
void update_stiffness(const Model& model, Scratch& scratch, const ActuatorFrame& output, double dt,
                      HapticLoop& loop) {
  const std::size_t turn = loop.turn = (loop.turn + 1) % kFingerCount;
  segment_jacobians(model, scratch, loop.jacobians, 7u << 3 * turn);
  bool known = true;  // a finger folded upon itself may be unknown for a moment: then what it was counts
  for (std::size_t i = 3 * turn; i < 3 * turn + 3; ++i)
    known = known && (loop.jacobians[i].known || model.settings.law[i] != Law::field);
  if (known) loop.stiffness[turn] = joint_stiffness(loop.X_WJ, output, loop.jacobians)[turn];
  if (!loop.certified || !loop.options.limiter) return;
  JointArray torque;
  std::copy_n(output.flexion_torque.begin(), kPhalanxCount, torque.begin());
  limit_stiffness(loop.certificate, loop.stiffness, torque, dt, loop.limiter);
}

void follow_hand(const Model& model, const DeviceFrame& frame, const ActuatorFrame& output,
                 HapticLoop& loop) {
  // Where a frame that is not trusted has the wrist means nothing, nor how far that is from the next one's.
  constexpr std::uint32_t kNowhere = kInputNotFinite | kInputImplausible | kInputLost;
  const bool known_before = std::exchange(loop.base_known, (output.flags & kNowhere) == 0);
  if (!loop.base_known) return;
  std::array<double, kAngleCount> angles;
  std::copy(frame.angle.begin(), frame.angle.end(), angles.begin());
  forward_kinematics(model.hand, frame.base, angles, loop.X_WJ);
  const Pose before = std::exchange(loop.base_before, frame.base);
  if (!known_before) return;
  const std::array<double, kFingerCount> work = arm_work(before, frame.base, loop.X_WJ, output);
  for (std::size_t f = 0; f < kFingerCount; ++f) loop.arm[f] += work[f];
}

void book_energy(const JointArray& wanted, HapticLoop& loop) {
  const JointArray acted = acted_torque(loop);
  for (std::size_t f = 0; f < kFingerCount; ++f) {
    EnergyStep step;
    step.dt = loop.between;
    double squares = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const double moved = step.moved[k] = loop.moved[3 * f + k];
      double& still = loop.still[3 * f + k];
      step.held[k] = still;
      still = moved != 0 ? 0 : still + loop.between;
      step.acted[k] = acted[3 * f + k];
      step.touching = step.touching || wanted[3 * f + k] != 0 || is_acted_on(loop, 3 * f + k);
      squares += step.acted[k] * step.acted[k];
    }
    // As large a share of it as of the touch acted: the safety envelope may have let less through than was
    // asked for.
    const double asked = loop.acting.torque[f],
                 acted_share = asked > 0 ? min(1, std::sqrt(squares) / asked) : 0;
    step.given = loop.acting.level[f] * acted_share * loop.arm[f];
    keep_account(loop.certificate, loop.profile, f, step, loop.account[f]);
    loop.arm[f] = 0;
  }
}

// Of every sensor there is, none of them in doubt.
bool has_all_angles(const HapticLoop& loop) {
  const auto& sensors = loop.profile.sensors;
  return loop.any_feedback && std::all_of(sensors.begin(), sensors.end(), [&loop](const Sensor& sensor) {
           return has_bit(loop.feedback.valid, sensor.angle);
         });
}

// Angles that are older than the bus explains tell nothing about now, nor do those in doubt: forces fade, no
// faster than they may fall, and what is gone comes back by soft start.
void weigh_gap(std::int64_t now, double dt, bool touching, HapticLoop& loop) {
  const SafetyTimes& times = loop.profile.safety;
  const LoopTiming& timing = loop.certificate.timing;
  const double age = loop.any_feedback ? in_seconds(now - loop.feedback.asked) : times.answer_timeout;
  const double usual = loop.certified ? timing.delay + timing.period + timing.jitter : 0;
  const bool stale = age > usual + times.tick_hold;
  if (stale && touching && loop.gain == 1) ++loop.gaps;
  const bool blind = stale || !has_all_angles(loop);
  loop.settling = blind || loop.letting_go ? kSettling : max(0, loop.settling - dt);
  const double soft = times.soft_start > 0 ? dt / times.soft_start : 1;
  const double change = blind ? -dt / times.fade : loop.settling > 0 ? 0 : soft;
  loop.gain = clamp(loop.gain + change, 0, 1);
}

double touch_of(const ActuatorFrame& output, std::size_t finger) {
  const std::size_t j = 3 * finger;
  const double a = output.flexion_torque[j], b = output.flexion_torque[j + 1],
               c = output.flexion_torque[j + 2];
  return std::sqrt(a * a + b * b + c * c);
}

// The least share of its touch that each finger gets, for its torque to fall no faster. Where the touch
// itself lets go, the share need not; where no one answers, nothing acts.
std::array<double, kFingerCount> least_levels(const ActuatorFrame& output, std::int64_t now,
                                              double time_constant, const HapticLoop& loop) {
  const double since = in_seconds(now - loop.answered.sent);
  std::array<double, kFingerCount> least{};
  if (!(since <= loop.profile.safety.answer_timeout)) return least;
  const double kept = 1 - clamp(since / time_constant, 0, kMostLetGo);
  for (std::size_t f = 0; f < kFingerCount; ++f) {
    const double level = loop.given.level[f], touch = touch_of(output, f),
                 torque = kept * loop.given.torque[f];
    least[f] = level * touch > torque ? torque / touch : level;
  }
  return least;
}

std::size_t place_of(std::uint64_t tick, const HapticLoop& loop) {
  return tick / loop.sharing % loop.past.size();
}

void keep_levels(const ActuatorFrame& output, HapticLoop& loop) {
  GivenTouch& given = loop.past[place_of(output.tick, loop)];
  given.tick = output.tick;
  given.level = loop.level;
  for (std::size_t f = 0; f < kFingerCount; ++f) given.torque[f] = loop.level[f] * touch_of(output, f);
}

std::size_t told_actuators(const SentCommand& sent, const DeviceProfile& profile) {
  return std::min<std::size_t>(sent.actuator_count, profile.actuators.size());
}

// What a tick wanted is not what was given while nothing but safe values were sent, before arming say.
bool gives_nothing(const SentCommand& sent, const DeviceProfile& profile) {
  const std::size_t count = told_actuators(sent, profile);
  for (std::size_t i = 0; i < count; ++i)
    if (sent.value[i] != profile.actuators[i].safe) return false;
  return count > 0;
}

void note_told_torque(const SentCommand& sent, HapticLoop& loop) {
  JointArray torque{};
  for (std::size_t i = 0; i < told_actuators(sent, loop.profile); ++i)
    for (std::size_t j = 0; j < kPhalanxCount; ++j)
      torque[j] += acted_on(loop.profile.actuators[i], sent.value[i], j, 1, 0);
  for (std::size_t j = 0; j < kPhalanxCount; ++j)
    loop.largest_told[j] = max(loop.largest_told[j], std::fabs(torque[j]));
}

void renew_certificate(HapticLoop& loop) {
  LoopTiming timing = timing_of(loop.meter);
  if (loop.local_loop) timing = {kLocalPeriod, 0, 0};
  const StiffnessCertificate before = std::exchange(loop.certificate, make_certificate(loop.profile, timing));
  for (std::size_t f = 0; f < kFingerCount; ++f) renew_account(before, loop.certificate, f, loop.account[f]);
  if (is_measured(loop.meter) && total(timing) > total(loop.slowest)) loop.slowest = timing;
}

// Where the device has a sensor that is not believed now, the frame's angle is another one than the device's.
bool is_doubted(const HapticLoop& loop, std::size_t angle) {
  const bool measured =
      std::any_of(loop.profile.sensors.begin(), loop.profile.sensors.end(),
                  [angle](const Sensor& sensor) { return static_cast<std::size_t>(sensor.angle) == angle; });
  return measured && !has_bit(loop.feedback.valid, angle);
}

// [N m] By how much more an actuator could make of the torque it makes about a joint.
double room_of(const Actuator& actuator, double command, std::size_t joint) {
  const double arm = actuator.arm[joint];
  const bool rises = arm * (arm * command) >= 0;
  return std::fabs(arm) * max(0, rises ? actuator.upper - command : command - actuator.lower);
}

// None where the angle is not the device's: round another one the torque may be anything up to twice what it
// is. And none that would go on where a command could not: of a torque that is cut at the end of its actuator
// nobody knows how it changes there.
void put_local_models(const DeviceFrame& frame, const JointArray& wanted, const HapticLoop& loop,
                      DeviceCommand& command) {
  for (std::size_t i = 0; i < loop.profile.actuators.size(); ++i) {
    const Actuator& actuator = loop.profile.actuators[i];
    if (!actuator.local.present) continue;
    const std::size_t j = driven_joint(actuator);
    if (is_doubted(loop, flexion_angle(j))) continue;
    const double k = loop.level[j / 3] * loop.stiffness[j / 3][j % 3][j % 3];
    command.angle[i] = static_cast<double>(frame.angle[flexion_angle(j)]);
    command.stiffness[i] = max(0, k);
    const double change = min(kLocalShare * std::fabs(wanted[j]), room_of(actuator, command.wanted[i], j));
    command.radius[i] = k > 0 ? min(change / k, kLargestRadius) : 0;
  }
}

JointArray wanted_torque(const ActuatorFrame& output, const HapticLoop& loop) {
  JointArray wanted;
  for (std::size_t j = 0; j < kPhalanxCount; ++j) wanted[j] = loop.level[j / 3] * output.flexion_torque[j];
  return wanted;
}

bool books_energy(const HapticLoop& loop) { return loop.certified && keeps_accounts(loop); }

// By how much touches had to be softened. Before a loop is measured nothing is passive, and what a factor
// lacks while it rises from there is the start's.
void note_softening(HapticLoop& loop) {
  if (!std::isfinite(loop.certificate.timing.delay)) return;
  for (std::size_t f = 0; f < kFingerCount; ++f)
    loop.least_factor[f] = min(loop.least_factor[f], max(loop.limiter.factor[f], loop.limiter.passive[f]));
}

// What the accounts of the fingers can't pay is taken off their levels.
void pay_for(const JointArray& wanted, double dt, HapticLoop& loop) {
  if (loop.fresh) book_energy(wanted, loop);
  for (std::size_t f = 0; f < kFingerCount; ++f) {
    const std::array<double, 3> torque = {wanted[3 * f], wanted[3 * f + 1], wanted[3 * f + 2]};
    const double share = pay(loop.certificate, f, torque, dt, loop.account[f]);
    loop.least_share[f] = min(loop.least_share[f], share);
    loop.level[f] *= share;
  }
}

void keep_least_levels(const ActuatorFrame& output, std::int64_t now, HapticLoop& loop) {
  const std::array<double, kFingerCount> least = least_levels(output, now, kAccountLetGo, loop);
  loop.letting_go = false;
  for (std::size_t f = 0; f < kFingerCount; ++f) {
    loop.level[f] = max(loop.level[f], least[f]);
    const bool above = loop.level[f] > loop.gain * loop.limiter.factor[f] + kGone;
    loop.letting_go = loop.letting_go || (above && touch_of(output, f) > 0);
  }
}

/// From one sample to the newest.
struct Way {
  std::array<double, kPhalanxCount> moved{};  // [rad] closing
  double between = 0;                         // [s]; 0: the device had let go meanwhile, nobody knows when
};
Way way_from(const DeviceFeedback& first, const HapticLoop& loop) {
  Way way;
  const DeviceFeedback& last = loop.feedback;
  if (!loop.any_feedback || last.held_since > first.time) return way;  // and it took no energy
  // Between the two moments of reading lies one of these; where they differ, the longer one counts.
  way.between = in_seconds(std::max(last.asked - first.asked, last.time - first.time));
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    const std::size_t a = flexion_angle(j);
    const bool believed = has_bit(last.valid & first.valid, a);
    way.moved[j] = believed ? static_cast<double>(last.angle[a] - first.angle[a]) : 0;
  }
  return way;
}

void keep_newest(const SentCommand& sent, LoopStep& step) {
  if (step.sent_count == kMaxSentPerTick) {
    std::copy(step.sent.begin() + 1, step.sent.end(), step.sent.begin());
    --step.sent_count;
  }
  step.sent[step.sent_count++] = sent;
}

}  // namespace

bool keeps_accounts(const HapticLoop& loop) {
  return loop.options.account && loop.options.feedback && !loop.local_loop;
}

HapticLoop start_loop(const DeviceProfile& profile, const LoopOptions& options) {
  HapticLoop loop;
  loop.profile = profile;
  loop.options = options;
  if (profile.sensors.empty()) loop.options.feedback = false;
  // Where the motion moves the hand instead, its angles are not those that the device has.
  if (!loop.options.feedback && !profile.sensors.empty()) loop.options.local = false;
  // Where angles come over the bus, so do the models made of them, and a touch that is not straight goes by
  // them: the loop is the bus's, however fast the device goes on in between.
  loop.local_loop = loop.options.local && profile.sensors.empty();
  for (const Actuator& actuator : profile.actuators)
    loop.local_loop = loop.local_loop && actuator.local.present;
  return loop;
}

void take_feedback(const DeviceFeedback& feedback, HapticLoop& loop) {
  // While ticks stood still the sink went on, and what acts now is not what acted then.
  const bool acts_otherwise = loop.fresh && feedback.acted != loop.feedback.acted;
  if (acts_otherwise && books_energy(loop)) book_energy(loop.wanted, loop);
  if (!loop.fresh) loop.answered_from = loop.feedback;
  if (acts_otherwise || !loop.fresh) loop.booked = loop.feedback;
  loop.feedback = feedback;
  const Way way = way_from(loop.booked, loop), since_command = way_from(loop.answered_from, loop);
  if (way.between == 0) loop.arm = {};
  loop.moved = way.moved;
  loop.between = way.between;
  for (std::size_t j = 0; j < kPhalanxCount; ++j)
    loop.speed[j] = since_command.between > 0 ? since_command.moved[j] / since_command.between : 0;
  loop.any_feedback = loop.fresh = true;
}

bool put_angles(const HapticLoop& loop, std::int64_t now, DeviceFrame& frame) {
  if (!loop.options.feedback) return true;
  if (frame.kind == InputKind::joint_poses) {  // the wrist is the motion's, the fingers are the device's
    const JointPose& wrist = frame.joint[kWrist];
    const auto [px, py, pz] = wrist.position;
    const auto [qx, qy, qz, qw] = wrist.orientation;
    frame.base = frame.base * Pose{{px, py, pz}, normalized({qw, qx, qy, qz})};
    frame.kind = InputKind::joint_angles;
    frame.angle.fill(0);
    if (!has_bit(frame.valid, kWrist)) frame.flags |= kTrackingLost;
    frame.joint = {};
    frame.valid = (1u << kJointCount) - 1;
  }
  for (std::size_t a = 0; a < kAngleCount; ++a) {
    if (has_bit(loop.feedback.valid, a)) frame.angle[a] = loop.feedback.angle[a];
  }
  const bool known =
      has_all_angles(loop) && in_seconds(now - loop.feedback.asked) <= loop.profile.safety.answer_timeout;
  if (!known) frame.flags |= kTrackingLost | loop.feedback.flags;
  return known;
}

void note_exchange(const SentCommand& sent, HapticLoop& loop) {
  note_told_torque(sent, loop);
  if (sent.acknowledged == 0) return;
  const GivenTouch& given = loop.past[place_of(sent.tick, loop)];
  loop.acting = loop.given;
  if (given.tick / loop.sharing == sent.tick / loop.sharing) loop.given = given;
  if (gives_nothing(sent, loop.profile)) loop.given = {};
  // Commands that were lost in between are time without one, too; a device that was gone is another matter.
  const SentCommand before = std::exchange(loop.answered, sent);
  const double interval = in_seconds(sent.sent - before.sent), delay = in_seconds(sent.loop_delay);
  // A process that slept made its own angles old, those of the next command as well: that is no delay of the
  // bus. No exchange takes as long, but for a reply that waits for who sleeps.
  const double longest = loop.profile.safety.answer_timeout;
  const bool slept = in_seconds(sent.acknowledged - sent.sent) > longest;
  if (slept || interval > longest)
    loop.measured_from = std::max(loop.measured_from, slept ? sent.acknowledged : sent.sent);
  if (before.acknowledged == 0 || interval > longest ||
      sent.acknowledged - sent.loop_delay < loop.measured_from)
    return;
  const bool known = is_measured(loop.meter);
  measure_exchange(interval, delay, loop.meter);
  if (loop.certified && !(known && !loop.options.follow)) renew_certificate(loop);
}

bool news_of_timing(HapticLoop& loop) {
  const double before = total(loop.told), now = total(loop.certificate.timing);
  if (!loop.certified || now == before || std::fabs(now - before) < kWorthTelling * before) return false;
  loop.told = loop.certificate.timing;
  return true;
}

void forget_timing(std::int64_t now, HapticLoop& loop) {
  loop.meter = {};
  loop.measured_from = now;
  if (loop.certified) renew_certificate(loop);
}

void certify_loop(HapticLoop& loop) {
  loop.certified = true;
  renew_certificate(loop);
}

DeviceCommand command_forces(const Model& model, Scratch& scratch, const DeviceFrame& frame,
                             const ActuatorFrame& output, std::int64_t now, HapticLoop& loop) {
  const double dt = loop.now == 0 ? 0 : in_seconds(now - loop.now);
  loop.now = now;
  const double answered_after = model.settings.rate * loop.profile.safety.answer_timeout;  // [ticks] at most
  loop.sharing = 1 + static_cast<std::uint64_t>(answered_after / static_cast<double>(loop.past.size() - 1));
  const bool angles = frame.kind == InputKind::joint_angles;
  if (angles) {
    follow_hand(model, frame, output, loop);
    update_stiffness(model, scratch, output, dt, loop);
  }
  const bool touching = output.contact_count > 0;
  if (loop.options.gaps && loop.options.feedback) weigh_gap(now, dt, touching, loop);
  const std::array<double, kFingerCount> least = least_levels(output, now, kLetGo, loop);
  for (std::size_t f = 0; f < kFingerCount; ++f)
    loop.level[f] = max(loop.gain * loop.limiter.factor[f], least[f]);
  if (angles && books_energy(loop)) pay_for(wanted_torque(output, loop), dt, loop);
  keep_least_levels(output, now, loop);
  const JointArray wanted = loop.wanted = wanted_torque(output, loop);
  keep_levels(output, loop);
  loop.fresh = false;
  note_softening(loop);

  const ActuatorSolution solution = solve_actuators(loop.profile, wanted, loop.speed);
  loop.largest_lost = max(loop.largest_lost, solution.lost_norm);
  DeviceCommand command;
  command.tick = output.tick;
  command.feedback_time = loop.any_feedback ? loop.feedback.asked : 0;
  command.wanted = solution.command;
  if (loop.options.local) put_local_models(frame, wanted, loop, command);
  return command;
}

void take_angles(DeviceLink& link, HapticLoop& loop, LoopStep& step) {
  for (DeviceFeedback feedback; link.feedback(feedback);) take_feedback(feedback, loop);
  step.blind = !put_angles(loop, link.now(), step.frame);
}

void give_forces(const Model& model, Scratch& scratch, DeviceLink& link, HapticLoop& loop, LoopStep& step) {
  step.sent_count = 0;
  for (SentCommand sent; link.sent(sent);) {
    note_exchange(sent, loop);
    keep_newest(sent, step);
  }
  step.news.reset();
  if (news_of_timing(loop)) step.news = loop.certificate.timing;
  link.publish(command_forces(model, scratch, step.frame, step.output, link.now(), loop));
}

}  // namespace lumbrical
