// The loop of `lumbrical run` in simulated time: the engine's ticks, its haptic loop and safety envelope, and
// a simulated device with a hand in it behind a bus that takes its time. What is simulated is the wire, the
// clock and who waits for whom; all else is the code that runs with a device. The same bits every time.
#pragma once

#include <cstdint>

#include "lumbrical/device_simulation.h"
#include "lumbrical/haptic_loop.h"
#include "lumbrical/motion.h"

namespace lumbrical::bench {

/// How long an exchange takes from request to reply. The request takes half of it.
enum class Delays : std::uint8_t {
  constant,
  jittering,  ///< evenly between half and one and a half of it
  growing,    ///< from nothing to all of it while the session runs
  stepping,   ///< nothing in the first two fifths of the session, then all of it
  stalling,   ///< nothing, but for one exchange in every half second
};
inline constexpr const char* kDelayNames[] = {"constant", "jittering", "growing", "stepping", "stalling"};

struct Bus {
  Delays kind = Delays::constant;
  double delay = 0.001;  ///< [s] of an exchange
  double rate = 1000;    ///< [Hz] of exchanges, at most
  int arriving = 1;      ///< one of so many requests; no one answers the others
};

struct DelayedLoop {
  Bus bus;
  HumanJoint human;
  double friction = 1;  ///< of the device, as a share of what its profile says
  LoopOptions options;
  double sensing = 0;  ///< [s] between two looks of the device at its own sensors
};

struct LoopFelt {
  std::uint64_t shakes = 0;
  double given = 0;   ///< [J] WornDevice::given
  double taken = 0;   ///< [J] WornDevice::taken
  double step = 0;    ///< [N m] largest change of a torque from one exchange to the next
  double torque = 0;  ///< [N m] mean of the torques' sum over the session: what is felt at all
};

/// Runs `motion` on `model` once, with forces from half a second before its start on. `profile` is what the
/// loop believes of the device. Without a hold on the joints (human.stiffness 0) they begin half closed.
LoopFelt run_delayed(const Model& model, const Motion& motion, const DeviceProfile& profile,
                     const DelayedLoop& loop);

}  // namespace lumbrical::bench
