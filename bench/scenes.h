// Meshes and single fingers for the paper's experiments, shared by bench/paper_experiments.cpp and the tests.
//
// Every plane is z = 0 with normal +z; its coordinates are exact, so cutting it differently changes nothing
// but the triangles.
#pragma once

#include <cstdint>
#include <vector>

#include "lumbrical/tick.h"

namespace lumbrical::bench {

/// Irregular rectangle [0, size_x] x [0, size_y] [m] of the plane: grid lines `edge` [m] apart times
/// e^(-0.6 .. 0.6), inner vertices moved by up to 30 % of the narrower cell beside them, diagonals at random.
Mesh graded_rectangle(double size_x, double size_y, double edge, std::uint64_t seed);

/// The same, centred on the origin.
Mesh graded_plane(double size_x, double size_y, double edge, std::uint64_t seed);

/// How a square of the plane is cut into triangles.
enum class Cut {
  whole,       ///< one triangle that covers the square
  grid,        ///< equal squares of two triangles
  graded,      ///< graded_plane
  slivers,     ///< strips of uneven width across the whole square, each of two triangles
  shards,      ///< random triangles split at random inner points, again and again
  t_junctions  ///< random triangles split across their longest edge, their neighbours not
};

/// A square of side `extent` [m] centred on the origin, cut into about `count` >= 2 triangles.
Mesh cut_plane(double extent, std::size_t count, Cut cut, std::uint64_t seed);

/// Two half planes that meet in the y axis: z = 0 for x < 0, and for x > 0 a slope that falls by `angle`
/// [rad] (rises where negative). Each reaches `reach` [m] from the edge and runs over |y| <= reach; cells as
/// in graded_plane, of `edge_left` and `edge_right` [m]. Their vertices on the y axis need not meet.
Mesh bent_plane(double angle, double reach, double edge_left, double edge_right, std::uint64_t seed);

/// A ridge along the y axis that falls by `angle` [rad] to both sides, otherwise like bent_plane.
Mesh ridge(double angle, double reach, double edge_left, double edge_right, std::uint64_t seed);

/// Regular tetrahedron, edges `edge` [m]; vertex 0 is the origin, the others are below, their face
/// horizontal.
Mesh tetrahedron(double edge);

/// One to three phalanges in a frame F of their own.
struct PosedFinger {
  std::vector<Vec3> joints;    ///< [m] in F from base to tip, 2 to 4; kept in single precision
  std::vector<double> radius;  ///< [m] at each joint
};

/// One phalanx of length `length` [m] whose tip's centre is F's origin and which runs along +z: pressed down
/// at identity it points straight at the plane.
PosedFinger one_phalanx(double radius = 0.008, double length = 0.025);

/// A finger of three phalanges (40, 25, 20 mm, radius 8 mm) from F's origin along x, bent towards -z by
/// `first` and `second` [rad]; negative angles are hyper-extended.
PosedFinger bent_finger(double first, double second, double radius = 0.008);

/// The orientation of one_phalanx whose axis rises by `tilt` [rad] over the plane (upright: pi/2) and is
/// turned by `heading` about z.
Quat leaning(double tilt, double heading);

/// A finger in a world of triangles, ready for ticks.
struct Rig {
  Model model;
  Scratch scratch;
  DeviceFrame frame;
  ActuatorFrame output;  ///< of the last tick
};

/// Throws where the scene can't be built. All segments follow `law`; forces are neither limited nor faded.
Rig make_rig(const Mesh& mesh, const PosedFinger& finger, Law law);

/// Gives the rig's finger other joints (as many as it has).
void set_joints(const PosedFinger& finger, Rig& rig);

/// What a finger feels as a whole, in W, from one tick.
struct Felt {
  Vec3 force;                   ///< [N]
  Vec3 torque;                  ///< [N m] about F's origin
  double area = 0;              ///< [m^2] contacted area
  std::uint32_t contacts = 0;   ///< contacts, pairs of primitive and triangle
  std::uint32_t triangles = 0;  ///< contacted triangles
  std::uint32_t flags = 0;      ///< TickFlag bits
};

/// One tick with the finger's frame at X_WF.
Felt feel(Rig& rig, const Pose& X_WF);

}  // namespace lumbrical::bench
