// The control between a device and the ticks: angles and time stamps in, a command out. Functions over one
// struct, without thread, input, output or allocation; step_loop calls them in their order, on whatever link
// and clock: DeviceLoop (loop.h) on a device's, bench/delay_sweep in simulated time. Times are nanoseconds of
// that one clock.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

#include "lumbrical/device_link.h"
#include "lumbrical/jacobian.h"
#include "lumbrical/passivity.h"

namespace lumbrical {

/// What may be left out, to see what it is good for.
struct LoopOptions {
  bool feedback = true;  ///< the device's angles move the hand; else the motion does
  bool limiter = true;   ///< stiffness stays below the certificate
  bool account = true;   ///< torques stay below what each finger's energy account can pay
  bool follow = true;    ///< the certificate follows the bus; else it stays what certify_loop made of it
  bool gaps = true;      ///< forces fade while angles are stale or in doubt, and come back by soft start
  bool local = true;     ///< local models, where the device has them; none where its angles are left out
};

/// How much of each finger's touch a command passed on.
struct GivenTouch {
  std::uint64_t tick = 0;
  std::array<double, kFingerCount> level{};   ///< share of the torque, 0 .. 1
  std::array<double, kFingerCount> torque{};  ///< [N m] norm of that share
};

struct HapticLoop {
  DeviceProfile profile;
  LoopOptions options;

  // What the device said.
  DeviceFeedback feedback;
  bool any_feedback = false;
  bool fresh = false;            ///< `feedback` came after the last command, and is not booked
  DeviceFeedback answered_from;  ///< the newest when the last command was made
  DeviceFeedback booked;         ///< up to which energy is booked
  std::array<double, 3 * kFingerCount> moved{};  ///< [rad] closing, from `booked` to `feedback`
  double between = 0;                            ///< [s] those two; 0: the device had let go meanwhile
  JointArray still{};                            ///< [s] since its angle changed, up to `booked`
  JointArray speed{};                            ///< [rad/s] from `answered_from` to `feedback`

  // The bus.
  TimingMeter meter;
  std::int64_t measured_from = 0;  ///< only commands made of angles asked for since then count for `meter`
  SentCommand answered;            ///< the newest command acknowledged
  StiffnessCertificate certificate;
  bool certified = false;
  /// No angles come over the bus and every actuator has a local model: the only loop is the device's own.
  bool local_loop = false;
  LoopTiming told;  ///< what news_of_timing told last

  // The touch.
  std::size_t turn = 0;  ///< the finger whose stiffness the newest command looked at
  std::array<SegmentJacobian, kSegmentCount> jacobians{};
  HandStiffness stiffness{};
  StiffnessLimiter limiter;
  std::array<EnergyAccount, kFingerCount> account{};
  std::array<double, kFingerCount> arm{};  ///< [J] by the arm to the whole touch since the last sample
  std::array<Pose, kJointCount> X_WJ{};
  Pose base_before;         ///< of the wrist, and
  bool base_known = false;  ///< the tick before knew it
  double gain = 1;          ///< of the soft start after a gap
  double settling = 0;      ///< [s] until it may grow again
  bool letting_go = false;  ///< some finger still gets clearly more than gain and limiter say: none falls
  /// Share of its touch that each finger gets: gain, limiter and account, but no less than lets go of what
  /// the last command gave without a kick.
  std::array<double, kFingerCount> level{};
  JointArray wanted{};                 ///< [N m] by the last command
  GivenTouch given, acting;            ///< by the last command acknowledged, and by the one before
  std::array<GivenTouch, 256> past{};  ///< by the commands of the last ticks, each at its tick's place
  std::uint64_t sharing = 1;  ///< ticks that share a place of `past`, so as to reach answer_timeout back
  std::int64_t now = 0;       ///< of the last command; 0: none yet

  // Figures.
  std::array<double, kFingerCount> least_factor = {1, 1, 1, 1, 1};  ///< of the limiter, starts left out
  std::array<double, kFingerCount> least_share = {1, 1, 1, 1, 1};   ///< that accounts left
  LoopTiming slowest{0, 0, 0};  ///< that was measured since forces are let through
  double largest_lost = 0;      ///< [N m] torque the actuators could not make
  JointArray largest_told{};    ///< [N m] about each joint, by what was sent, either way
  std::uint64_t gaps = 0;       ///< times the angles became stale while torques were wanted
};

HapticLoop start_loop(const DeviceProfile& profile, const LoopOptions& options);

/// What the device said; call it with every feedback, once and in their order, before the tick that uses the
/// newest. Where other torques acted than before, the energy of the way before that is booked here.
void take_feedback(const DeviceFeedback& feedback, HapticLoop& loop);

/// Puts the device's angles into the place of the motion's fingers; the wrist stays the motion's. Flags
/// kTrackingLost and why the device's were not believed, and is false, where there are none, or none that are
/// younger than SafetyTimes::answer_timeout.
bool put_angles(const HapticLoop& loop, std::int64_t now, DeviceFrame& frame);

/// What became of a command; call it with every one the link tells. Renews the certificate.
void note_exchange(const SentCommand& sent, HapticLoop& loop);

/// True: since the last true the certificate's timing has changed by a tenth of what it was, or more.
bool news_of_timing(HapticLoop& loop);

/// Forgets how long exchanges took, also of commands that are under way: what was before `now` is not how it
/// will be.
void forget_timing(std::int64_t now, HapticLoop& loop);

/// From here on forces are let through: as far as the exchanges so far allow, and nothing before two of them
/// were measured.
void certify_loop(HapticLoop& loop);

/// After the tick on `scratch` with `frame`: its forces as a command.
DeviceCommand command_forces(const Model& model, Scratch& scratch, const DeviceFrame& frame,
                             const ActuatorFrame& output, std::int64_t now, HapticLoop& loop);

/// Whether fingers have energy accounts: not without angles of the device, nor where its own loop is the only
/// one, whose torques change between two commands unseen.
bool keeps_accounts(const HapticLoop& loop);

/// One step: what goes in and what comes out.
struct LoopStep {
  DeviceFrame frame;               ///< in: the motion's; the tick gets it with the device's angles
  ActuatorFrame output;            ///< of the tick
  bool blind = false;              ///< there were no angles that could be believed
  std::optional<LoopTiming> news;  ///< of the certificate, where news_of_timing had some
  std::uint32_t sent_count = 0;
  std::array<SentCommand, kMaxSentPerTick> sent{};  ///< the newest that became known since the last step
};

/// The half of a step before its tick, and the one after it.
void take_angles(DeviceLink& link, HapticLoop& loop, LoopStep& step);
void give_forces(const Model& model, Scratch& scratch, DeviceLink& link, HapticLoop& loop, LoopStep& step);

/// One step of the loop: what the device says, `tick`, what the device is told. `tick(step)` makes
/// `step.output` of `step.frame` on `scratch`; false: nothing of this step may reach the device. Neither
/// locks, allocates nor calls the system except for the link's clock.
template <class Tick>
bool step_loop(const Model& model, Scratch& scratch, Tick&& tick, DeviceLink& link, HapticLoop& loop,
               LoopStep& step) {
  take_angles(link, loop, step);
  if (!tick(step)) return false;
  give_forces(model, scratch, link, loop, step);
  return true;
}

}  // namespace lumbrical
