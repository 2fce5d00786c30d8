// The cells that bench/delay_sweep sweeps and the tests take a few of: hands that touch something with the
// shipped exoskeleton on, over delays, stiffness, hold, friction and rate.
#pragma once

#include <string>

#include "delayed_loop.h"

namespace lumbrical::bench {

/// What hand does what. The control was tuned on the first, then looked at on all.
enum class Play : std::uint8_t {
  grasp,  ///< the demo's: a right hand grasps and strokes a mug, 10 s
  thin,   ///< the same by a smaller left hand and a thinner mug
  press,  ///< a larger hand lies on bumps, pressed down, let off and moved across by the arm, 8 s
  taps,   ///< four fingertips of a left hand tap on a plate once a second, 4 s
};
inline constexpr const char* kPlayNames[] = {"grasp", "thin", "press", "taps"};
inline constexpr Play kPlays[] = {Play::grasp, Play::thin, Play::press, Play::taps};

struct HeldHand {
  const char* name;
  HumanJoint hold;
};
/// From a relaxed finger's spring and damper to none.
inline constexpr HeldHand kHands[] = {
    {"relaxed", {0.5, 0.01}}, {"light", {0.2, 0.004}}, {"limp", {0.05, 0.001}}, {"none", {0, 0}}};
inline constexpr Bus kBuses[] = {
    {Delays::constant, 0, 0},      {Delays::constant, 0.005, 0}, {Delays::constant, 0.015, 0},
    {Delays::constant, 0.03, 0},   {Delays::constant, 0.05, 0},  {Delays::jittering, 0.005, 0},
    {Delays::jittering, 0.015, 0}, {Delays::jittering, 0.05, 0}, {Delays::growing, 0.015, 0},
    {Delays::growing, 0.05, 0},    {Delays::stepping, 0.015, 0}, {Delays::stepping, 0.05, 0},
    {Delays::stalling, 0.03, 0},   {Delays::stalling, 0.08, 0}};
inline constexpr double kStiffnesses[] = {5e6, 2e7, 1e8};  ///< [N/m^3]; the demo's is the second
inline constexpr double kFrictions[] = {1, 0};             ///< as a share of the profile's
inline constexpr double kRates[] = {1000, 200};            ///< [Hz] of the device

/// The shipped exoskeleton with time-outs for the slowest of these buses.
Status load_patient_profile(const std::string& path, DeviceProfile& profile);

/// What is touched in `play`, felt at 1 kHz, and with which hand.
Status build_play(Play play, double stiffness, Model& model);
Motion play_motion(Play play, const Model& model);

/// The demo's grasp in another time [s].
Motion mug_grasp(const Model& model, double seconds);

}  // namespace lumbrical::bench
