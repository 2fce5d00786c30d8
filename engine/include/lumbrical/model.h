// Everything about a session that never changes while it runs: hand, world, settings, and the search
// structure.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lumbrical/hand.h"
#include "lumbrical/mesh.h"
#include "lumbrical/object.h"
#include "lumbrical/shared_array.h"
#include "lumbrical/status.h"
#include "lumbrical/surface.h"

namespace lumbrical {

/// How a contacted triangle pushes back; docs/mechanics.md has the formulas.
enum class Law : std::uint8_t {
  field,      ///< K_s times the integral of the pressure field: exact, mesh-independent, conservative
  column,     ///< K_s times the integral of the paper's depth: exact, mesh-independent on planes
  max_depth,  ///< the paper: K_s dl_max A_C along the normal (Eq. 3-4)
  centroid,   ///< K_s A_C times the depth at the centroid
  point,      ///< K_s times the deepest point's depth times a fixed area: what point-based libraries do
};

/// What several fingers, or fingers and palm, hold together is felt once, by the one that is deepest in it,
/// or by all of them: up to 4 % of the hand's force on what is flat, more in a fist.
enum class FeltOnce : std::uint8_t {
  never,       ///< each part of the hand feels as if it were alone
  by_samples,  ///< by samples, for a fifth more of a drape's time; exact segments don't know
  always,      ///< exactly too, in 1 to 16 times the time, on needles 250: for the field law, and with all
               ///< segments by samples or all exact; what is taken off is off by an estimate, not a bound
};

/// Where candidate triangles come from. Never changes a result, only the time it takes.
enum class Broadphase : std::uint8_t {
  automatic,  ///< grid where triangles lie farther than kGridExtent apart along an axis, else tree
  tree,       ///< one tree of bounding spheres
  grid,       ///< a tree per cell of a grid: large environments
  voxel,  ///< lists of triangles in the voxels of an OpenVDB tree: also gives the distance from the surface
  brute,  ///< every triangle
};

/// [m] Up to here one tree is as fast as a grid or faster, whatever the number of triangles. Beyond it the
/// single precision of the tree's spheres costs time: little at 1 km, two thirds at 10 km, and fifteen
/// times as much at 100 km (bench/broadphase_bench, "apart").
inline constexpr double kGridExtent = 1000;

/// Can this build search that way? All but voxel always can; that needs OpenVDB, whose module is loaded to
/// answer.
bool available(Broadphase broadphase);

/// What the kernels are compiled for. Never changes a result, only the time it takes.
enum class Isa : std::uint8_t { automatic, scalar, sse2, avx2, avx512, neon, simd128 };

/// Can this build on this machine run the kernels of `isa`?
bool available(Isa isa);
Isa widest_isa();  ///< that is available

std::optional<Law> parse_law(std::string_view text);                ///< "field", "column", "max-depth", ...
std::optional<FeltOnce> parse_felt_once(std::string_view text);     ///< "never", "by-samples", "always"
std::optional<Broadphase> parse_broadphase(std::string_view text);  ///< "auto", "tree", "grid", ...
std::optional<Isa> parse_isa(std::string_view text);                ///< "auto", "scalar", "sse2", "avx2", ...
std::string_view law_name(Law law);
std::string_view felt_once_name(FeltOnce felt_once);
std::string_view broadphase_name(Broadphase broadphase);
std::string_view isa_name(Isa isa);

constexpr std::array<double, kSegmentCount> every_segment(double value) {
  std::array<double, kSegmentCount> values{};
  for (double& of_segment : values) of_segment = value;
  return values;
}

/// Where skin is pressed in beyond the share `from` of its radius it is harder by `stiffness` times K_s, or
/// softer.
struct PadLayer {
  double from = 0;       ///< 0.01 .. 0.99
  double stiffness = 0;  ///< -1000 .. 1000; 0: there is no layer
  bool operator==(const PadLayer&) const = default;
};
inline constexpr std::size_t kPadLayers = 2;

/// How a finger's pad and a palm give way (docs/pads.md).
struct Pad {
  std::array<PadLayer, kPadLayers>
      layer{};  ///< the shallower first; together pressure never falls with depth
  double damping =
      0;  ///< [s/m] a force grows by this times the speed of pressing in, 0 .. 1000, and at most doubles
  bool operator==(const Pad&) const = default;
};

/// What decides the result of a tick, besides hand and world. Travels inside a recording.
struct Settings {
  std::array<Law, kSegmentCount> law{};  ///< per hand segment
  double stiffness = 2e7;                ///< [N/m^3] K_s, 0.001 .. 1e15
  double rate = 1000;                    ///< [Hz] ticks per second of session time, 1 .. 100000
  double point_area = 1e-4;              ///< [m^2] in the area's place in Law::point, 1e-12 .. 1
  /// Per hand segment, under the field law: 0 exact; else the error wanted as a share of the hand's force,
  /// 1e-6 .. 0.1, which samples keep in 98 of 100 ticks; 1e-5 to two times it, 1e-6 to six (mechanics.md). A
  /// finger of which any segment is exact or follows another law is exact. What it comes to: ActuatorFrame.
  std::array<double, kSegmentCount> precision = every_segment(1e-4);
  /// [N] 0 .. 1e6: no segment's force exceeds it. Above four fifths of it forces saturate, each segment's by
  /// itself.
  double max_force = 20;
  double fade_time = 0.02;  ///< [s] 0 .. 60, in which forces that can't be trusted fade to zero, and return
  /// [N/m] of the spring from the hand to its proxy (docs/proxy.md), 10 .. 1e5; 0: there is none, and what
  /// is thinner than a finger is passed through.
  double proxy_stiffness = 0;
  FeltOnce felt_once = FeltOnce::by_samples;
  Pad pad;
  /// Most evaluations of a field that samples may spend in a tick, 0 .. 1e9; 0: as many as it takes. What a
  /// tick will spend is known before its kernels run; near the bound it takes the next coarser lattices, and
  /// in the end one cell a patch, which it takes whatever the bound (kCoarsened,
  /// ActuatorFrame::error_estimate). The world has it first, then the objects apart in their order, each
  /// before its pads' layers.
  std::uint32_t effort = 0;
  std::uint32_t max_candidates = 1u << 18;  ///< pairs (primitive, triangle) a tick can hold, 1 .. 2^24
};

/// How the work is done. Any choice gives the same bits; a replay may choose anew.
struct Execution {
  Broadphase broadphase = Broadphase::automatic;  ///< a Model holds which one that is
  std::uint32_t tree_levels =
      0;  ///< levels of bounding spheres above the leaves (paper, Table 2); 0: as many as it takes
  std::uint32_t leaf_size = 16;  ///< triangles per leaf sphere, 1 .. 64; a multiple of 16 wastes no memory
  double cell_size = 0.1;        ///< [m] side of the grid's cells, 0.001 .. 1e6
  std::uint32_t threads = 1;     ///< 1 .. 64
  Isa isa = Isa::automatic;      ///< automatic: the widest that is available; a Model holds which one that is
  double voxel_size = 0;  ///< [m] side of the index's voxels, 1e-9 .. 1e6; 0: by the rule in docs/voxels.md
  double voxel_memory = 4e9;  ///< [bytes] the most that building the voxel index may take, 1e6 .. 1e12
  std::string voxel_cache{};  ///< folder in which voxel indices are kept; empty: they are not
};

/// An object that neither moves nor rubs nor has a surface feel is part of the world; any other is felt apart
/// from it (is_apart).
struct SceneObject {
  std::string name;
  Mesh mesh;  ///< [m] in the world frame; of an object apart in its own
  Winding winding = Winding::automatic;
  Pose pose{};  ///< X_WO at the start, of an object apart; others have none
  Material material{};
  Mechanism mechanism{};
  Surface surface{};
};
inline bool is_apart(const SceneObject& object) {
  return rubs(object.material) || object.mechanism.mobility != Mobility::fixed || !is_plain(object.surface);
}

/// Moves a mesh from the frame O into W.
void place_mesh(const Pose& X_WO, Mesh& mesh);

struct World;

/// What a user puts together; build_model turns it into a Model.
struct Scene {
  Hand hand;
  std::vector<SceneObject> objects;
  Settings settings;
  std::shared_ptr<const World> world{};  ///< from a file (world.h), in the place of objects; else null
  Vec3 gravity{0, 0, -9.81};             ///< [m/s^2] on objects that move by themselves
  std::optional<Ground> ground{};        ///< that free ones rest on
};

/// All triangles of the world in the order of the scene, structure of arrays.
struct Triangles {
  SharedArray<double> x, y, z;         ///< [m] vertex coordinates in W
  SharedArray<std::uint32_t> a, b, c;  ///< vertex indices per triangle
  [[nodiscard]] std::size_t size() const { return a.size(); }
  [[nodiscard]] Vec3 vertex(std::uint32_t i) const { return {x[i], y[i], z[i]}; }
};

/// Sixteen bounding spheres [m], relative to their tree's origin. Single precision; what rounding takes away
/// is added to the radius. Empty places hold a radius of minus infinity, which nothing reaches.
struct alignas(64) SphereBlock {
  static constexpr std::uint32_t kWidth = 16;
  std::array<float, kWidth> x{}, y{}, z{}, r{};
};

/// What is known of a tree of bounding spheres but for the spheres: plain numbers, in memory and in a file
/// alike.
struct TreeHead {
  Vec3 origin;                        ///< [m] in W
  Vec3 centre;                        ///< [m] relative to `origin`: of a sphere round everything
  double radius = 0;                  ///< [m] of that sphere
  std::uint64_t first_line = 0;       ///< of the tree's own, where several trees lie in one array
  std::uint32_t leaf_count = 0;       ///< 0: no triangle
  std::uint16_t blocks_per_leaf = 0;  ///< every leaf starts a new block
  std::uint16_t level_count = 0;      ///< of bounding spheres above the triangles' own
};

/// The memory of trees. A tree's lines hold its levels of spheres in blocks of sixteen, the last first, then
/// the spheres of the triangles in leaf order (spatial order), then the triangles' numbers, 0 in empty
/// places. No pointers, children are found by index arithmetic: sphere i of level 0 bounds leaf i, sphere i
/// of a higher level block i of the level below; the last level is searched from end to end (sphere_tree.h).
struct alignas(64) TreeLine {
  std::array<std::byte, 64> bytes;
};

struct SphereTree {
  TreeHead head;
  Box box;  ///< [m] relative to head.origin: round the spheres of all triangles
  SharedArray<TreeLine> lines;
};

/// A grid of cubes with a tree in each that is not empty. A triangle is in the cell of its centroid; those
/// whose bounding sphere is wider than a cell are in a tree of their own.
struct SphereGrid {
  Vec3 origin;                      ///< [m] in W: lower corner
  double cell_size = 0;             ///< [m]
  std::uint32_t frontier = 0;       ///< the largest frontier_capacity of its trees (sphere_tree.h)
  SharedArray<std::uint64_t> cell;  ///< z << 42 | y << 21 | x, ascending
  SharedArray<TreeHead> tree;       ///< of each cell, in the same order; then that of the wide triangles
  SharedArray<TreeLine> lines;      ///< of all trees, in the same order
};

/// A world in a file, mapped: what a Model has of it, ready for use. Opened in world.h.
struct World {
  struct Object {
    std::string name;
    std::uint32_t first_triangle = 0, triangle_count = 0;
    std::uint32_t first_vertex = 0, vertex_count = 0;
    WindingReport winding{};  ///< what build_model turned; of a world file nothing: its writer has turned it
    /// What is just behind a triangle of it is inside. Asked only where the hand has a proxy, and not of
    /// world files: false.
    bool solid = false;
  };
  std::string path;           ///< of the file, as it was opened
  std::uint64_t content = 0;  ///< hash of what is in it
  Triangles triangles;
  Box extent;  ///< [m] in W: of all triangles
  SphereGrid grid;
  std::vector<Object> objects;
  double cell_size = 0;  ///< of the Execution it was built with, as are these
  std::uint32_t leaf_size = 0, tree_levels = 0;
  std::shared_ptr<const std::byte> bytes;  ///< of the whole file; what all the arrays lie in
  std::size_t byte_count = 0;
};

struct Patches;     // the world as sample points see it; patches.h inside the engine
struct VoxelIndex;  // lists of triangles by voxel; voxel_index.h inside the engine, lumbrical/voxel.h outside
struct FeltSurface;  // a Surface as ticks ask for it; felt_surface.h inside the engine

struct Model;

/// An object that is felt apart from the world.
struct ApartObject {
  std::string name;
  std::size_t place = 0;  ///< in Scene::objects
  std::shared_ptr<const Model>
      shape;   ///< for the same hand, in the object's own frame O; equal meshes share it
  Pose start;  ///< X_WO
  Material material;
  Mechanism mechanism;
  std::size_t latch = 0;       ///< in Model::apart, of Mechanism::latch; itself: nothing holds it
  std::vector<Vec3> supports;  ///< [m] in O: points that may rest on the ground
  Vec3 middle;                 ///< [m] in O, and
  double radius = 0;           ///< [m] of a sphere round it
  Surface surface;
  std::shared_ptr<const FeltSurface> felt;  ///< of the surface; null: it is plain
};

/// Immutable once built; may be shared by any number of sessions and threads. Copies share the large arrays.
struct Model {
  std::uint64_t build = 0;  ///< number of the build_model it is from, in this process; copies keep it
  Hand hand;
  Settings settings;
  Execution execution;
  Triangles triangles;
  Box extent;                                ///< [m] in W: of all triangles
  SphereTree tree;                           ///< empty unless Broadphase::tree
  SphereGrid grid;                           ///< empty unless Broadphase::grid
  std::shared_ptr<const VoxelIndex> voxels;  ///< null unless Broadphase::voxel
  std::shared_ptr<const Patches> patches;    ///< null where no segment is felt by samples
  /// What a pad's layers feel: the same world for a thinner hand, of the layer's stiffness [N/m^3].
  std::vector<std::shared_ptr<const Model>> layers;
  std::vector<World::Object> objects;  ///< of the world
  std::vector<ApartObject> apart;
  Vec3 gravity;
  std::optional<Ground> ground;
  std::shared_ptr<const World> world;  ///< that all of this is from; null: a scene in memory
};

/// Checks the scene and builds what the ticks need. Refuses settings out of range, non-finite vertices and
/// triangle indices out of range, naming the field or object; on error `model` is unchanged. Meshes are
/// turned outside out as their objects' winding says; Model::objects tells what was turned, and what could
/// not be decided. A world comes with its grid: `execution` may ask for that or for brute force, the sizes of
/// cells and leaves are the world's.
Status build_model(const Scene& scene, const Execution& execution, Model& model);

/// The objects of the world, then those apart: what each is made of, and what was turned.
std::vector<World::Object> all_objects(const Model& model);

/// Of Model::objects, the one that this triangle (Contact::triangle) belongs to.
std::size_t object_of(const Model& model, std::uint32_t triangle);

/// The same world and settings for another hand: everything that does not depend on the hand is shared, so
/// that two hands in one scene take one world's memory. Each is ticked with a State and Scratch of its own.
/// Refuses what build_model refuses of a hand, and objects that move by themselves: a State each would move
/// them apart. On error `model` is unchanged.
Status share_world(const Model& world, const Hand& hand, Model& model);

/// The same hand and world under other settings, ticked by `threads` (1 .. 64): nothing is searched or cut
/// anew but patches, and those only where law or precision differ. A State goes on with it, a Scratch is made
/// anew. Forces are the new settings' at once; where State::joints is set to 0 before the next tick they pass
/// over within fade_time, as for another hand. Refuses what build_model refuses of settings. On error
/// `changed` is unchanged.
Status change_settings(const Model& model, const Settings& settings, std::uint32_t threads, Model& changed);

/// The scene a model was built from, equal bit for bit but for what was turned outside out, so that its
/// objects are to be taken as they are: what a recording carries.
Scene scene_of(const Model& model);

}  // namespace lumbrical
