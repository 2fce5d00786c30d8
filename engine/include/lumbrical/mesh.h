// Triangle meshes: what the hand touches, how they are read from files, and what can be wrong with them.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "lumbrical/math.h"
#include "lumbrical/status.h"

namespace lumbrical {

using Triangle = std::array<std::uint32_t, 3>;  ///< vertex indices, counter-clockwise seen from outside

struct Mesh {
  std::vector<Vec3> vertices;       ///< [m]
  std::vector<Triangle> triangles;  ///< in the file's order; polygons become fans of their first corner
};

enum class Unit : std::uint8_t { metre, centimetre, millimetre };

/// "m", "cm" or "mm"; nothing for any other text.
std::optional<Unit> parse_unit(std::string_view text);
double metres_per(Unit unit);

/// Reads OBJ, STL (binary or ASCII, whatever its header claims), PLY (ASCII, both endians), OFF or glTF 2
/// (.glb, or .gltf with files beside it; builds with nlohmann-json); the format is told by the content first
/// and the file name second. All groups, solids or nodes of a file are one mesh; those of glTF stand where
/// the file's scene puts them. Vertices of STL files at exactly the same position are merged (-0 equals +0).
/// Triangles keep the order of the file and none is dropped, not even a degenerate one, but for those that
/// only join strips. Concave polygons that a fan folds over are cut into ears. "-" is standard input.
/// At most 8 GiB, 2^32 - 2 vertices and 2^31 - 1 triangles, one at least. `unit` is the file's; the mesh is
/// in metres, all coordinates are finite. On error `mesh` is unchanged and the message starts with
/// "path:line:column:" or "path: byte N:" (from 0), or with "path:" alone where there is no place.
Status load_mesh(const std::string& path, Unit unit, Mesh& mesh);

/// Of vertices that are numbers of this unit: what load_mesh makes of them.
void convert_to_metres(Unit unit, Mesh& mesh);

/// The same for a file already in memory; `name` stands in for the path in messages and in the choice of
/// format. It may name no other files.
Status parse_mesh(std::string_view content, const std::string& name, Unit unit, Mesh& mesh);

/// What is wrong with a mesh. Vertices are compared by exact position (merged first, -0 equals +0), triangles
/// by their merged vertices. Triangles of which corners coincide have no edges to speak of: they count in
/// `degenerate`, but in no edge count and in no component.
struct MeshReport {
  std::size_t triangles = 0;
  std::size_t vertices = 0;         ///< as stored in the file
  std::size_t merged_vertices = 0;  ///< distinct positions
  std::size_t unused_vertices = 0;  ///< stored vertices no triangle names
  std::size_t degenerate = 0;       ///< triangles of zero area (two corners coincide or three are collinear)
  std::size_t sliver = 0;           ///< triangles not degenerate whose smallest angle is below 1 degree
  std::size_t duplicate = 0;        ///< triangles whose three corners already occurred, in any order
  std::size_t boundary_edges = 0;   ///< edges of exactly one triangle
  std::size_t non_manifold_edges = 0;  ///< edges of more than two triangles
  std::size_t misoriented_edges = 0;   ///< edges of exactly two triangles that run through it the same way
  std::size_t components = 0;          ///< parts connected through shared edges
  bool watertight = false;             ///< no boundary, non-manifold or misoriented edge, and not empty
  double area = 0;                     ///< [m^2]
  /// [m^3] signed: negative where a closed mesh is inside out. Of an open mesh, the volume of the cones from
  /// the middle of the bounding box to its triangles.
  double volume = 0;
  double shortest_edge = 0;  ///< [m] longer than 0; 0 where there is none
  double longest_edge = 0;   ///< [m]
  Vec3 lower, upper;         ///< [m] bounding box of the vertices that triangles name
  /// First few offenders of each kind, named by their indices (from 0) in `Mesh`, for a person to look at:
  /// "triangle 17 is degenerate (corners 3 and 4 coincide)".
  std::vector<std::string> examples;
};

/// O(n log n). Fewer than 2^31 triangles, their indices in range and the vertices finite.
MeshReport inspect_mesh(const Mesh& mesh);

/// Round the vertices that triangles name: scans carry stray ones far away.
Box bounding_box(const Mesh& mesh);

/// Which way triangles are wound. Forces follow their normals: a mesh that is inside out pulls the hand in.
enum class Winding : std::uint8_t {
  automatic,  ///< closed parts are turned outside out, open ones stay as they are; see WindingReport
  as_is,      ///< as the triangles stand
  flip,       ///< every triangle the other way round
};
std::optional<Winding> parse_winding(std::string_view text);  ///< "auto", "as is" or "flip"
std::string_view winding_name(Winding winding);

/// What was done for a mesh to face outwards. Its parts are what hangs together across edges that exactly two
/// triangles share (vertices at one position are one, on open edges also those that rounding drove apart, by
/// less than 5e-6 of the mesh's diagonal; a T-junction without a sliver parts them; copies of a triangle go
/// with the first, those of a closed part face outwards like it). A part is closed when it can be wound one
/// way throughout, encloses a volume, and what its holes leave open is at most a twentieth of its area. It is
/// wound so that its volume is positive, each of its triangles. But where it lies inside the solid of another
/// closed part it may be a cavity or a solid in a solid: then it stays as it is to the part it lies in, and
/// is turned where that is turned as a whole.
struct WindingReport {
  std::size_t parts = 0;             ///< 0 where nobody looked: Winding::as_is and flip
  std::size_t inner_parts = 0;       ///< closed and inside others
  std::size_t turned_parts = 0;      ///< with at least one triangle turned
  std::size_t turned_triangles = 0;  ///< their last two corners changed places
  std::size_t open_parts = 0;        ///< left as they are: only the user knows which side is outside
  std::size_t open_triangles = 0;
  double hole_area = 0;     ///< [m^2] of the closed parts' holes
  double open_area = 0;     ///< [m^2] of the open parts, of which
  double outward_area = 0;  ///< [m^2] faces away from the middle of their bounding box,
  double inward_area = 0;   ///< [m^2] faces it, and the rest neither
  /// Triangles that stand where an earlier one does and face as it does: both are felt.
  std::size_t double_triangles = 0;
  /// The same of open parts and cavities that face the other way: what both push cancels, neither is felt.
  std::size_t back_to_back_triangles = 0;
  friend bool operator==(const WindingReport&, const WindingReport&) = default;
};

/// Turns a mesh's triangles as build_model does. What faces the right way keeps its bits. A pure function of
/// the mesh.
WindingReport wind_outwards(Mesh& mesh, Winding winding = Winding::automatic);

}  // namespace lumbrical
