// The paper's experiments (its Figures 9 and 11 to 15) and what was added to them, as functions that
// bench/paper_experiments.cpp runs in full and the tests run smaller.
//
// Unless said otherwise the finger is one phalanx of radius 8 mm and length 25 mm, pressed 2 mm deep, moved
// by 0.1 mm per tick; every force comes out of tick().
#pragma once

#include <vector>

#include "scenes.h"

namespace lumbrical::bench {

inline constexpr Law kLaws[] = {Law::field, Law::column, Law::max_depth, Law::centroid, Law::point};
inline constexpr double kRadius = 0.008;  ///< [m]
inline constexpr double kDepth = 0.002;   ///< [m]
inline constexpr double kStep = 1e-4;     ///< [m] per tick

/// One tick of an experiment.
struct Sample {
  double at = 0;  ///< [m] or what the experiment counts
  Vec3 force;     ///< [N]
  Felt felt;      ///< everything else
  Vec3 theory;    ///< [N] the paper's "theoretical force": the undivided plane's; 0 where there is none
};
using Series = std::vector<Sample>;

/// How even a series is. Shares are of the mean force.
struct Evenness {
  double mean = 0;                    ///< [N] of the magnitude
  double bias = 0;                    ///< mean over the mean theoretical force, less 1; 0 without theory
  double peak_to_peak = 0;            ///< share
  double largest_step = 0;            ///< largest change of the magnitude from one tick to the next, share
  double largest_jump = 0;            ///< largest change of the force vector from one tick to the next, share
  double largest_turn = 0;            ///< [rad] largest change of direction from one tick to the next
  std::uint32_t least = 0, most = 0;  ///< contacted triangles
};
Evenness evenness_of(const Series& series);

/// The force of one_phalanx on an undivided plane, at a tilt [rad] and depth [m] of its lowest point: of
/// `field` for the field, the integral of the paper's depth (`column`) for all others, 0 for `point`.
double undivided_force(Law law, double tilt, double depth);

/// Figure 11: a slide over an irregular flat mesh.
struct Slide {
  double tilt = 0;  ///< [rad] of the phalanx over the plane
  double edge = 0;  ///< [m] mean edge of the mesh
  double depth = kDepth;
  double length = 0.04;  ///< [m]
};
Series slide(const Slide& slide, Law law);

/// Figure 9a: the fingertip (tilt pi/2) or the lying finger (0) on planes cut into cells of `edge`, at
/// `placements` places; the mean force over undivided_force. `edge` 0: one triangle.
double divided_over_undivided(Law law, double tilt, double edge, int placements);

/// Figure 9b: the fingertip on a symmetric ridge of two slopes of 15 degrees, one of large triangles (one
/// 20 mm cell), one of small (1 mm). By symmetry the force points straight up; returns by how much it leans
/// to the large triangles' side [rad].
double lean_on_ridge(Law law);

/// Figures 12 and 13: a fingertip that leans by 60 degrees follows a plane and then a slope that falls by
/// `angle` [rad] (rises where negative), at constant distance; cells of `edge`. `at` is the way gone, 0 at
/// the edge.
Series follow_slope(double angle, double edge, Law law);

/// Figure 14: a fingertip, leaning by 45 degrees, moves 30 mm over a bumpy height field (waves of 0.5 mm, 30
/// mm long) of about 80 mm / cells edges.
Series sweep_fingertip(std::uint32_t cells, Law law);

/// Figure 15 and beyond: an upright finger is pushed into a plane of 3 mm cells, down to `deepest` [m].
Series poke(double tilt, double deepest, Law law);

/// An upright finger beside a block, its tip 15 mm below the top, pulled 2 mm into the side of the block:
/// the force on it should point away from the side.
Vec3 hook(Law law);

/// A smooth closed path of a finger's frame F: an ellipse with a wobble, and a turn to and fro.
struct ClosedPath {
  Pose start;         ///< X_WF in the middle
  Vec3 cosine, sine;  ///< [m] displacement cos(2 pi t) cosine + sin(2 pi t) sine
  Vec3 wobble;        ///< [m] displacement sin(4 pi t) wobble
  Vec3 turn;          ///< [rad] turned by sin(2 pi t) turn
};
Pose pose_at(const ClosedPath& path, double t);

/// Work of the contact force round a closed path.
struct LoopWork {
  double work = 0;           ///< [J]
  double error = 0;          ///< [J] bound of the error of the quadrature along the path, see work_round
  double largest_force = 0;  ///< [N] F_max, over all nodes
  double length = 0;         ///< [m] L, of the path of the farthest joint
  int nodes = 0;             ///< ticks computed
  [[nodiscard]] double relative() const { return work / (largest_force * length); }
  [[nodiscard]] double relative_error() const { return error / (largest_force * length); }
};

/// Integrates the power of force and torque over the path by Gauss-Legendre quadrature, 16 nodes per
/// interval; an interval is halved until 8 nodes agree with the 16 to within `tolerance` times its share of
/// F_max L (or `levels` times). The sum of those differences is LoopWork::error: it is the error of the 8
/// nodes, which that of the 16 stays far below.
LoopWork work_round(Rig& rig, const ClosedPath& path, double tolerance, int levels);

/// Closed loops over edges and corners.
enum class Obstacle { edge_30, edge_90, edge_90_turning, hook_90, cube_corner, tetrahedron_vertex };
inline constexpr Obstacle kObstacles[] = {Obstacle::edge_30,         Obstacle::edge_90,
                                          Obstacle::edge_90_turning, Obstacle::hook_90,
                                          Obstacle::cube_corner,     Obstacle::tetrahedron_vertex};
const char* obstacle_name(Obstacle obstacle);
LoopWork work_over(Obstacle obstacle, const PosedFinger& finger, Law law, double tolerance, int levels);

/// Work of segment forces and torques while a finger of three phalanges whose middle joint lies on a 90
/// degree edge bends both joints round a closed loop, 30 and 25 degrees to both sides of `first` and `second`
/// [rad], and moves a little. Joints reach the engine in single precision, which leaves about 1e-7 of F_max
/// L; `error` is 0.
LoopWork work_of_bending(double first, double second, bool tapered, Law law, int ticks);

/// A finger of three phalanges bends both its joints while it lies on a mesh.
struct Bend {
  double roll = 0;          ///< [rad] 0: it bends into the plane below; pi/2: beside it, within the plane
  double depth = kDepth;    ///< [m] of the straight finger
  double ratio = 0.5;       ///< bending of the second joint over the first
  double from = -0.5236;    ///< [rad] -30 degrees, hyper-extended
  double to = 1.9199;       ///< [rad] 110 degrees
  double step = 1.7453e-3;  ///< [rad] 0.1 degrees
};
struct BendResult {
  double largest_step = 0;   ///< [N] |F - F of the tick before|
  double largest_force = 0;  ///< [N]
  /// Largest of that step over its bound K_s A d (docs/mechanics.md): d the largest displacement of a joint
  /// in the step, A the area within d of the finger.
  double share_of_bound = 0;
  double worst_at = 0;  ///< [rad] where the share is largest
  Series series;        ///< `at` is the first joint's angle [rad]
};
BendResult bend(const Mesh& mesh, const Bend& bend, Law law);

}  // namespace lumbrical::bench
