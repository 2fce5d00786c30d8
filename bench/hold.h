// One body and the fingertips that hold it: the same in our engine and in others.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "lumbrical/math.h"

namespace lumbrical::bench {

inline constexpr double kTipRadius = 0.008;   // [m]
inline constexpr double kHoldTick = 1e-3;     // [s]
inline constexpr double kCoupling = 2000;     // [N/m] of a peer's fingertip to its tracked place
inline constexpr double kTipMass = 0.02;      // [kg] of a peer's fingertip
inline constexpr double kTwistRadius = 1e-3;  // [m] of a peer's torsional friction, what a patch of ours has

/// What is held: a box, or an upright cylinder round z, its middle at the origin.
struct HeldBody {
  bool cylinder = false;
  Vec3 half;  ///< [m]; of a cylinder radius, radius and half its height
  double mass = 0, friction = 0;
  Vec3 gravity;
};

/// One engine at work.
struct Holder {
  /// One tick with the tracked fingertips there.
  std::function<void(std::span<const Vec3> tips)> step;
  std::function<Pose()> pose;                    ///< of the body
  std::function<Vec3(std::size_t finger)> felt;  ///< [N] by a finger in the last tick
};

struct HoldEngine {
  std::string name;
  std::function<Holder(const HeldBody& body, std::span<const Vec3> tips)> make;
};

HoldEngine our_holder();
void add_bullet_holders(std::vector<HoldEngine>& engines);
void add_mujoco_holders(std::vector<HoldEngine>& engines);

}  // namespace lumbrical::bench
