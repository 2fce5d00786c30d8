// What a device loop carries from tick to tick; device_loop.cpp runs it, device_figures.cpp tells of it.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <thread>
#include <vector>

#include "device_guard.h"
#include "device_loop.h"
#include "lumbrical/actuator_model.h"
#include "lumbrical/modbus_sink.h"
#include "lumbrical/passivity.h"
#include "sink_uri.h"

namespace lumbrical::tool {

struct DeviceLoop::Loop {
  SinkUri uri;
  DeviceProfile profile;
  const Model* model = nullptr;
  double period = 0.001;  // [s] of ticks

  DeviceGuard guard;
  ModbusSink sink;
  DeviceFeedback feedback;
  bool any_feedback = false, fresh_feedback = false;
  std::int64_t feedback_before = 0;
  JointArray speed{};

  bool certified = false, measured = false, local_loop = false;
  StiffnessCertificate certificate;
  StiffnessLimiter limiter;
  std::size_t turn = 0;  // the finger whose stiffness is computed in this tick
  std::array<SegmentJacobian, kSegmentCount> jacobians{};
  HandStiffness stiffness{};
  std::array<Pose, kJointCount> X_WJ{};
  Pose base_before;
  std::array<double, kFingerCount> arm{};  // [J] given by the arm since the last feedback
  std::array<PassivityObserver, kPhalanxCount> observer{};
  JointArray damping{};  // [N m] the controller adds until the next feedback

  // Figures.
  TickTimes loop_delays, intervals;
  std::int64_t sent_before = 0, last_acknowledged = 0;
  bool was_active = false;
  std::int64_t armed_at = 0;
  std::uint64_t blind_ticks = 0;  // since then, without angles to go by
  double largest_lost = 0, oldest = 0;
  std::array<double, kFingerCount> least_factor = {1, 1, 1, 1, 1};

  // Tells people what happens while it happens.
  std::thread reporter;
  std::atomic<bool> ending{false};
  std::vector<SinkEvent> events;
  SinkReport last;
  bool safe_at_end = false;

  void report();
  void take_angles();
  void update_stiffness(const Scratch& scratch, const ActuatorFrame& output);
  void follow_hand(const DeviceFrame& frame, const ActuatorFrame& output);
  void observe(const DeviceFrame& frame, const JointArray& wanted);
  JointArray acted_torque() const;
  void note(const SentCommand& sent);
  bool lost(SafetyState now) const;
};

}  // namespace lumbrical::tool
