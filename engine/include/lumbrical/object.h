// Objects that are felt by themselves: they rub, or move; and what they rest on.
//
// An object that neither moves nor rubs nor has a surface feel (surface.h) is part of the world, and costs
// what the world costs. All others have a search structure each, in a frame O of their own, into which a tick
// poses the hand.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "lumbrical/hand.h"
#include "lumbrical/math.h"
#include "lumbrical/mesh.h"
#include "lumbrical/status.h"

namespace lumbrical {

/// Most objects of a scene that are felt by themselves. Worlds of many bodies belong to a physics engine
/// (Mobility::given).
inline constexpr std::size_t kMostObjects = 32;

/// Most objects of a scene, those included that the world is made of: so many fit into the memory that
/// reading a file may take (docs/recording.md).
inline constexpr std::size_t kMostSceneObjects = 1u << 15;

/// Dry friction between a hand's skin and an object. All zero: none, and it costs nothing.
struct Material {
  double static_friction = 0;     ///< mu_s, 0 .. 10, at rest
  double kinetic_friction = 0;    ///< mu_k, 0 .. mu_s, sliding; it does not follow mu_s by itself
  double viscosity = 0;           ///< [s/m] 0 .. 100: what mu grows by with the speed of sliding
  double shear_stiffness = 1000;  ///< [N/m] 1 .. 1e6, of a segment's skin sideways while it sticks
  friend bool operator==(const Material&, const Material&) = default;
};
constexpr bool rubs(const Material& material) {
  return material.static_friction > 0 || material.viscosity > 0;
}

/// How an object moves.
enum class Mobility : std::uint8_t {
  fixed,   ///< not at all
  given,   ///< as it is told, tick by tick (ObjectFrame)
  free,    ///< by its weight and by what touches it
  hinge,   ///< about an axis: door, lever, bottle cap
  slider,  ///< along an axis: button, drawer
  ball,    ///< about a point: joystick
};
std::optional<Mobility> parse_mobility(std::string_view text);  ///< "fixed", "given", "free", ...
std::string_view mobility_name(Mobility mobility);

/// Mass, centre and inertia.
struct MassProperties {
  double mass = 0;                  ///< [kg]
  Vec3 centre;                      ///< [m] in O
  std::array<double, 6> inertia{};  ///< [kg m^2] about the centre, along O: xx yy zz (1e-18 .. 1e22) xy yz zx
  friend bool operator==(const MassProperties&, const MassProperties&) = default;
};

/// Of the solid inside a closed mesh wound outwards, of a density [kg/m^3]: integrals over its triangles, by
/// the divergence theorem (Mirtich 1996). Parts that overlap count twice. Refuses a mesh that is not closed,
/// and one that encloses no volume.
Status mass_properties(const Mesh& mesh, double density, MassProperties& properties);

/// The same solid of another density, so that its mass is `mass` [kg] > 0.
void scale_to_mass(double mass, MassProperties& properties);

/// Whether an object that moves so may be given this density [kg/m^3] or mass [kg] (0: it is not given). What
/// moves by itself has one of the two, what is given where it goes at most one, what stands still none.
Status check_weight(Mobility mobility, double density, double mass);

/// A latch that holds a hinge or slider where it stands at the start until another one has opened it: while
/// q <= 0 and the other's coordinate is below `opens`, q does not rise above 0. So a door that has been
/// opened may be shut at any time, and is caught.
struct Latch {
  std::uint32_t object = kNone;  ///< in Scene::objects: the handle, a hinge or slider
  double opens = 0;              ///< [rad] or [m] of the handle's coordinate, 1e-9 .. 1e3
  static constexpr std::uint32_t kNone = 0xffffffff;
  friend bool operator==(const Latch&, const Latch&) = default;
};

/// What moves an object by itself, and what holds it. Of a hinge, the coordinate q is its angle [rad], of a
/// slider its way [m], from where it stands at the start; force means torque at a hinge.
struct Mechanism {
  Mobility mobility = Mobility::fixed;
  MassProperties body;  ///< of all but fixed; mass > 0. Of given: zero, unless a physics engine moves it
  double damping = 0;   ///< of a hinge or slider [N s/m], [N m s/rad]; of others of their rotation; 0 .. 1e6
  // ---- of a hinge, slider or ball
  Vec3 pivot;          ///< [m] in W, at the start; not by itself where the object is
  Vec3 axis{0, 0, 1};  ///< unit, in W; not of a ball
  // ---- of a hinge or slider
  double lower = -1e3, upper = 1e3;  ///< of q, -1e3 .. 0 and 0 .. 1e3; there it stops dead
  double spring = 0;                 ///< [N/m], [N m/rad] 0 .. 1e9
  double rest = 0;                   ///< q where the spring is slack, -1e3 .. 1e3
  double dry_friction = 0;           ///< [N], [N m] 0 .. 1e6
  double detent_force = 0;           ///< [N], [N m] most that holds it in a detent, 0 .. 1e6
  double detent_pitch = 0.1;         ///< from one detent to the next, one of them at q = 0; 1e-6 .. 1e3
  Latch latch{};
  friend bool operator==(const Mechanism&, const Mechanism&) = default;
};
constexpr bool moves_by_itself(const Mechanism& mechanism) { return mechanism.mobility >= Mobility::free; }
constexpr bool has_coordinate(const Mechanism& mechanism) {
  return mechanism.mobility == Mobility::hinge || mechanism.mobility == Mobility::slider;
}

/// A plane that free bodies rest on; the hand does not feel it.
struct Ground {
  Vec3 normal{0, 0, 1};   ///< unit, away from the ground
  double offset = 0;      ///< [m] the plane is normal . p = offset
  double friction = 0.5;  ///< 0 .. 10
  friend bool operator==(const Ground&, const Ground&) = default;
};

/// Where an object that is `given` stands in a tick.
struct ObjectFrame {
  Pose pose;  ///< X_WO
  friend bool operator==(const ObjectFrame&, const ObjectFrame&) = default;
};

/// One segment's hold on an object: what its skin remembers from tick to tick.
struct GripState {
  Pose segment;      ///< X_OS of the segment's base joint when it last touched
  Vec3 shear;        ///< [m] in O: how far its skin is drawn sideways
  double twist = 0;  ///< [rad] and turned about the normal
  double slip = 0;   ///< [m/s] how fast it slides, as its skin has noticed
  double holds = 0;  ///< 1: it touched in the last tick
};

/// The same of a point an object rests on.
struct SupportState {
  Vec3 shear;  ///< [m] in W
  double holds = 0;
};
inline constexpr std::size_t kMostSupports = 56;

/// What an object carries from one tick to the next. No padding: hashed as it stands.
struct ObjectState {
  Pose pose;              ///< X_WO
  Vec3 velocity;          ///< [m/s] of its centre of mass, in W
  Vec3 angular_velocity;  ///< [rad/s] in W
  double coordinate = 0;  ///< q of a hinge or slider
  double told = 0;        ///< 1: a given object has been told where it is
  std::array<GripState, kSegmentCount> grip{};
  std::array<SupportState, kMostSupports> support{};
};

/// What is felt of an object, and what it feels, in a tick.
struct ObjectOutput {
  Pose pose;              ///< X_WO that the tick has felt it at
  Wrench wrench;          ///< [N], [N m] of the hand on the object, about O's origin, in W
  double coordinate = 0;  ///< q of a hinge or slider
};

}  // namespace lumbrical
