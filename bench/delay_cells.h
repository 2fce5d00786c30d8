// The cells that bench/delay_sweep sweeps and the tests take a few of: the demo's grasp on the shipped
// exoskeleton, over delays, stiffness, hand, friction and rate.
#pragma once

#include <string>
#include <vector>

#include "delayed_loop.h"

namespace lumbrical::bench {

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
    {Delays::growing, 0.05, 0},    {Delays::stepping, 0.015, 0}, {Delays::stepping, 0.05, 0}};
inline constexpr double kStiffnesses[] = {5e6, 2e7, 1e8};  ///< [N/m^3]; the demo's is the second
inline constexpr double kFrictions[] = {1, 0};             ///< as a share of the profile's
inline constexpr double kRates[] = {1000, 200};            ///< [Hz] of the device

/// The shipped exoskeleton with time-outs for the slowest of these buses.
Status load_patient_profile(const std::string& path, DeviceProfile& profile);

/// The demo's mug, felt at 1 kHz.
Status build_mug(double stiffness, Model& model);
Motion mug_grasp(const Model& model, double seconds);

}  // namespace lumbrical::bench
