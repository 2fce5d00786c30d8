// Turns meshes outside out. Parts are told by the edges that two triangles share; a closed one has an inside,
// the side its volume is on; one that lies within the solid of another may be its cavity. See Winding in
// lumbrical/mesh.h.
#include "model/mesh_winding.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <utility>

#include "base/disjoint_sets.h"
#include "base/floating_point.h"
#include "base/hash.h"
#include "model/border_merge.h"
#include "model/mesh_edges.h"
#include "model/part_nesting.h"
#include "model/triangle_parts.h"
#include "model/vertex_merge.h"

namespace lumbrical {
namespace {

/// A mesh taken apart.
struct Taken {
  std::vector<std::uint32_t> part_of;   // of each triangle, or kNoPart
  std::vector<std::uint8_t> reversed;   // wound otherwise than its part's first triangle
  std::vector<MeshPart> parts;          // by their first triangles
  std::vector<std::uint32_t> original;  // what each triangle is a copy of, or itself; empty: no copies
};

/// A border of a part, the way its triangle runs along it.
struct Border {
  std::uint32_t part, from, to;
};

std::uint32_t third_corner(const Triangle& t, std::uint32_t low, std::uint32_t high) {
  return t[0] != low && t[0] != high ? t[0] : t[1] != low && t[1] != high ? t[1] : t[2];
}

/// Triangles whose three corners another one before them has too, whichever way they are wound: each with
/// that other one. Where two stand back to back and touch no third, neither counts as a copy.
std::vector<std::uint32_t> find_copies(const Mesh& mesh, const std::vector<std::uint32_t>& first,
                                       const MeshEdges& edges) {
  std::vector<std::uint32_t> original;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> thirds;  // third corner, triangle
  edges.for_each([&](std::uint32_t low, std::span<const HalfEdge> around) {
    if (around.size() < 3) return;
    thirds.clear();
    for (const HalfEdge half : around) {
      const Triangle t = merged_corners(mesh.triangles[half.triangle()], first);
      thirds.emplace_back(third_corner(t, low, half.high()), half.triangle());
    }
    std::sort(thirds.begin(), thirds.end());
    for (std::size_t i = 1, same = 0; i < thirds.size(); ++i) {
      if (thirds[i].first != thirds[same].first) {
        same = i;
        continue;
      }
      if (original.empty()) {
        original.resize(mesh.triangles.size());
        std::iota(original.begin(), original.end(), 0u);
      }
      original[thirds[i].second] = thirds[same].second;
    }
  });
  return original;
}

/// Whether two triangles of the same three corners face the same way.
bool wound_alike(const Triangle& a, const Triangle& b) {
  const std::size_t at = a[0] == b[0] ? 0 : a[0] == b[1] ? 1 : 2;
  return a[1] == b[(at + 1) % 3];
}

/// The half-edges of an edge that belong to no copy.
std::span<const HalfEdge> without_copies(std::span<const HalfEdge> around,
                                         const std::vector<std::uint32_t>& original,
                                         std::vector<HalfEdge>& kept) {
  if (original.empty()) return around;
  kept.clear();
  for (const HalfEdge half : around) {
    if (original[half.triangle()] == half.triangle()) kept.push_back(half);
  }
  return kept;
}

void measure_parts(const Mesh& mesh, Taken& taken) {
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    if (taken.part_of[i] == kNoPart) continue;
    MeshPart& part = taken.parts[taken.part_of[i]];
    const Triangle& t = mesh.triangles[i];
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    if (part.triangles++ == 0) part.origin = a;
    const Vec3 doubled = cross(b - a, c - a);
    const double area = 0.5 * norm(doubled), volume = dot(a - part.origin, doubled) / 6;
    part.area += area;
    part.volume += taken.reversed[i] ? -volume : volume;
    if (!taken.reversed[i]) part.area_as_first += area;
    for (const Vec3& p : {a, b, c}) {
      if (p.x < part.box.lower.x) part.extreme[0] = p;
      if (p.x > part.box.upper.x) part.extreme[1] = p;
      if (p.y < part.box.lower.y) part.extreme[2] = p;
      if (p.y > part.box.upper.y) part.extreme[3] = p;
      if (p.z < part.box.lower.z) part.extreme[4] = p;
      if (p.z > part.box.upper.z) part.extreme[5] = p;
      part.box.add(p);
    }
  }
}

/// Where a part does not go on: an edge of its own, or one of three or more triangles that it does not run
/// through as often one way as the other. Parts too small to be closed are left out.
std::vector<Border> find_borders(const Taken& taken, const std::vector<std::uint32_t>& original,
                                 const MeshEdges& edges) {
  std::vector<Border> borders;
  std::vector<HalfEdge> kept;
  std::vector<std::pair<std::uint32_t, int>> ways;  // part, +1 upwards or -1
  edges.for_each([&](std::uint32_t low, std::span<const HalfEdge> all) {
    if (all.size() == 2 && original.empty()) return;
    const std::span<const HalfEdge> around = without_copies(all, original, kept);
    if (around.size() == 2) return;
    ways.clear();
    for (const HalfEdge half : around) {
      const std::uint32_t t = half.triangle(), part = taken.part_of[t];
      if (taken.parts[part].triangles < kFewestEnclosing) continue;
      ways.emplace_back(part, half.upwards() != (taken.reversed[t] != 0) ? 1 : -1);
    }
    std::sort(ways.begin(), ways.end());
    for (std::size_t i = 0; i < ways.size();) {
      const std::uint32_t part = ways[i].first;
      int net = 0;
      for (; i < ways.size() && ways[i].first == part; ++i) net += ways[i].second;
      for (; net > 0; --net) borders.push_back({part, low, all[0].high()});
      for (; net < 0; ++net) borders.push_back({part, all[0].high(), low});
    }
  });
  return borders;
}

/// Fills holes by cones of flat triangles over their borders, from the mean of each border's vertices.
/// Borders that share a vertex are one.
void fill_holes(const Mesh& mesh, std::vector<Border> borders, std::vector<MeshPart>& parts) {
  if (borders.empty()) return;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> corner;  // part, vertex: sorted, each once
  for (const Border& border : borders)
    corner.emplace_back(border.part, border.from), corner.emplace_back(border.part, border.to);
  std::sort(corner.begin(), corner.end());
  corner.erase(std::unique(corner.begin(), corner.end()), corner.end());
  const auto place = [&](std::uint32_t part, std::uint32_t vertex) {
    const auto found = std::lower_bound(corner.begin(), corner.end(), std::pair(part, vertex));
    return static_cast<std::uint32_t>(found - corner.begin());
  };
  DisjointSets holes(corner.size());  // of corners
  for (Border& border : borders) {
    border.from = place(border.part, border.from);
    border.to = place(border.part, border.to);
    holes.join(border.from, border.to);
  }
  std::vector<Vec3> middle(corner.size());
  std::vector<double> count(corner.size(), 0);
  for (std::uint32_t i = 0; i < corner.size(); ++i) {
    const std::uint32_t hole = holes.find(i);
    middle[hole] += mesh.vertices[corner[i].second] - parts[corner[i].first].origin;
    count[hole] += 1;
  }
  for (const Border& border : borders) {
    MeshPart& part = parts[border.part];
    const std::uint32_t hole = holes.find(border.from);
    const Vec3 apex = middle[hole] / count[hole];
    const Vec3 from = mesh.vertices[corner[border.from].second] - part.origin;
    const Vec3 to = mesh.vertices[corner[border.to].second] - part.origin;
    part.hole_area += 0.5 * norm(cross(from - apex, to - apex));
    part.volume += dot(apex, cross(to, from)) / 6;
  }
}

// [of the diagonal] Corners nearer than half of this are one to triangles that would otherwise end there:
// exporters round, each triangle's corner by itself.
constexpr double kRounding = 1e-5;

double diagonal(const Mesh& mesh) {
  const Box box = bounding_box(mesh);
  return norm(box.upper - box.lower);
}

bool has_open_edge(const MeshEdges& edges) {
  bool open = false;
  edges.for_each([&](std::uint32_t, std::span<const HalfEdge> around) { open = open || around.size() == 1; });
  return open;
}

/// The edges of a mesh and, where some are open, which vertices count as one: those at one place, and those
/// of open edges that rounding drove apart.
MeshEdges joined_edges(const Mesh& mesh, std::size_t threads, std::vector<std::uint32_t>& first) {
  first.clear();  // vertices at one place are told apart first: most closed meshes need no more
  MeshEdges edges = edges_of(mesh, first, threads);
  if (!has_open_edge(edges)) return edges;
  first = first_at_same_position(mesh.vertices);
  edges = edges_of(mesh, first, threads);
  if (merge_borders(mesh, edges, kRounding * diagonal(mesh), first)) edges = edges_of(mesh, first, threads);
  return edges;
}

Taken take_apart(const Mesh& mesh, std::size_t threads) {
  std::vector<std::uint32_t> first;
  const MeshEdges edges = joined_edges(mesh, threads, first);
  std::vector<std::uint32_t> original = find_copies(mesh, first, edges);
  TriangleParts joined(mesh.triangles.size());
  std::vector<std::uint32_t> twisted;  // triangles
  std::vector<HalfEdge> kept;
  edges.for_each([&](std::uint32_t, std::span<const HalfEdge> all) {
    const std::span<const HalfEdge> around = without_copies(all, original, kept);
    if (around.size() != 2) return;
    const bool opposed = around[0].upwards() == around[1].upwards();
    if (!joined.join(around[0].triangle(), around[1].triangle(), opposed))
      twisted.push_back(around[0].triangle());
  });

  Taken taken;
  taken.part_of.assign(mesh.triangles.size(), kNoPart);
  taken.reversed.assign(mesh.triangles.size(), 0);
  std::uint32_t count = 0;
  for (std::uint32_t i = 0; i < mesh.triangles.size(); ++i) {
    if (!original.empty() && original[i] != i) continue;
    if (corners_coincide(merged_corners(mesh.triangles[i], first))) continue;
    const TriangleParts::Place place = joined.find(i);
    taken.part_of[i] = place.part == i ? count++ : taken.part_of[place.part];
    taken.reversed[i] = place.reversed;
  }
  taken.parts.resize(count);
  for (const std::uint32_t triangle : twisted) taken.parts[taken.part_of[triangle]].twisted = true;
  measure_parts(mesh, taken);
  fill_holes(mesh, find_borders(taken, original, edges), taken.parts);
  for (std::uint32_t i = 0; i < original.size(); ++i) {  // copies go with what they are copies of
    taken.part_of[i] = taken.part_of[original[i]];
    const bool alike = wound_alike(merged_corners(mesh.triangles[i], first),
                                   merged_corners(mesh.triangles[original[i]], first));
    taken.reversed[i] = (taken.reversed[original[i]] != 0) == alike ? 1 : 0;
  }
  taken.original = std::move(original);
  return taken;
}

/// +1 where a part is wound outwards, most of it, as it came; -1 inwards.
int side_given(const MeshPart& part) {
  return (part.volume > 0) == (part.area_as_first >= 0.5 * part.area) ? 1 : -1;
}

/// The side each closed part is to have: nowhere may the winding number be negative. So what stands in a void
/// is wound outwards; what stands in a solid may be its cavity or a solid in it, and is turned if what it
/// stands in is.
std::vector<int> sides_wanted(const std::vector<MeshPart>& parts, const std::vector<Nested>& nested) {
  std::vector<std::uint32_t> depth(parts.size(), 0), order;
  for (const Nested& pair : nested) ++depth[pair.inner];
  for (std::uint32_t i = 0; i < parts.size(); ++i) order.push_back(i);
  std::sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) {
    return std::pair(depth[a], a) < std::pair(depth[b], b);
  });
  std::vector<int> wanted(parts.size(), 1);
  for (const std::uint32_t i : order) {
    auto pair = std::lower_bound(nested.begin(), nested.end(), Nested{i, 0});
    int winding = 0;
    std::uint32_t holder = i;  // the innermost of those round it
    for (; pair != nested.end() && pair->inner == i; ++pair) {
      winding += wanted[pair->outer];
      if (holder == i || depth[pair->outer] > depth[holder]) holder = pair->outer;
    }
    if (winding <= 0) continue;
    const bool holder_turned = wanted[holder] != side_given(parts[holder]);
    wanted[i] = holder_turned ? -side_given(parts[i]) : side_given(parts[i]);
  }
  return wanted;
}

/// What is left as it is, and which way it faces.
void report_open(const Mesh& mesh, const Taken& taken, const std::vector<bool>& decided,
                 WindingReport& report) {
  Box box;
  for (std::size_t part = 0; part < decided.size(); ++part) {
    if (!decided[part]) box.add(taken.parts[part].box);
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t part = taken.part_of[i];
    if (part == kNoPart || decided[part]) continue;
    const Triangle& t = mesh.triangles[i];
    const Vec3 &a = mesh.vertices[t[0]], &b = mesh.vertices[t[1]], &c = mesh.vertices[t[2]];
    const Vec3 doubled = cross(b - a, c - a), arm = (a - box.middle()) + ((b - a) + (c - a)) / 3;
    const double area = 0.5 * norm(doubled), facing = dot(doubled, arm);
    ++report.open_triangles;
    report.open_area += area;
    // A flat part lies in its own middle: it faces neither way.
    if (std::fabs(facing) < 1e-6 * norm(doubled) * norm(arm)) continue;
    (facing > 0 ? report.outward_area : report.inward_area) += area;
  }
}

/// Copies of triangles: on closed parts both face outwards by now, on open ones they may stand back to back.
void report_copies(const Taken& taken, const std::vector<bool>& decided, WindingReport& report) {
  for (std::size_t i = 0; i < taken.original.size(); ++i) {
    const std::uint32_t of = taken.original[i];
    if (of == i) continue;
    const bool alike = taken.reversed[i] == taken.reversed[of];
    const bool closed = taken.part_of[i] != kNoPart && decided[taken.part_of[i]];
    ++(closed || alike ? report.double_triangles : report.back_to_back_triangles);
  }
}

/// Tells a triangle's place, whichever way it is wound.
std::uint64_t place_hash(const Mesh& mesh, const Triangle& triangle) {
  std::array<std::array<double, 3>, 3> corners;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 p = mesh.vertices[triangle[k]] + Vec3{};  // -0 equals +0
    corners[k] = {p.x, p.y, p.z};
  }
  std::sort(corners.begin(), corners.end());
  Hasher hasher;
  for (const auto& corner : corners)
    for (const double coordinate : corner) hasher.value(coordinate);
  return hasher.digest();
}

/// A part's triangles by their places, sorted, and the side it is to have.
using PlacedPart = std::pair<std::vector<std::uint64_t>, int>;

std::vector<PlacedPart> placed(const Mesh& mesh, const Taken& taken, const std::vector<std::uint32_t>& parts,
                               const std::vector<int>& wanted) {
  std::vector<std::uint32_t> number(taken.parts.size(), kNoPart);
  std::vector<PlacedPart> placed(parts.size());
  for (std::uint32_t i = 0; i < parts.size(); ++i) {
    number[parts[i]] = i;
    placed[i].second = wanted[parts[i]];
  }
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const std::uint32_t part = taken.part_of[i];
    if (part != kNoPart && number[part] != kNoPart)
      placed[number[part]].first.push_back(place_hash(mesh, mesh.triangles[i]));
  }
  for (PlacedPart& part : placed) std::sort(part.first.begin(), part.first.end());
  return placed;
}

/// Closed parts that stand where another one does, with vertices of their own: no edge is open, so nobody
/// asked which vertices lie at one place. As exporters write surfaces that are to be seen from both sides.
void report_second_parts(const Mesh& mesh, const Taken& taken, const std::vector<bool>& decided,
                         const std::vector<int>& wanted, WindingReport& report) {
  const auto key = [&](std::uint32_t i) {
    const MeshPart& part = taken.parts[i];
    const Vec3 &a = part.box.lower, &b = part.box.upper;
    return std::array<double, 7>{double(part.triangles), a.x, a.y, a.z, b.x, b.y, b.z};
  };
  std::vector<std::uint32_t> order;
  for (std::uint32_t i = 0; i < taken.parts.size(); ++i)
    if (decided[i]) order.push_back(i);
  std::sort(order.begin(), order.end(),
            [&](std::uint32_t a, std::uint32_t b) { return std::pair(key(a), a) < std::pair(key(b), b); });
  std::vector<std::uint32_t> alike;  // in number and box, as their neighbours in the order are
  for (std::size_t i = 0; i < order.size(); ++i) {
    if ((i > 0 && key(order[i - 1]) == key(order[i])) ||
        (i + 1 < order.size() && key(order[i]) == key(order[i + 1])))
      alike.push_back(order[i]);
  }
  if (alike.empty()) return;
  std::vector<PlacedPart> parts = placed(mesh, taken, alike, wanted);
  std::sort(parts.begin(), parts.end());
  for (std::size_t i = 1; i < parts.size(); ++i) {
    const auto& [places, side] = parts[i];
    if (places == parts[i - 1].first)
      (side == parts[i - 1].second ? report.double_triangles : report.back_to_back_triangles) +=
          places.size();
  }
}

std::vector<bool> find_turned(const Mesh& mesh, std::size_t threads, WindingReport& report) {
  const Taken taken = take_apart(mesh, threads);
  std::vector<Nested> nested;
  const bool known = find_nested(mesh, taken.part_of, taken.reversed, taken.parts, nested);
  const std::vector<int> wanted = sides_wanted(taken.parts, nested);

  report = {};
  report.parts = taken.parts.size();
  std::vector<bool> decided(taken.parts.size(), false), touched(taken.parts.size(), false);
  for (std::size_t i = 0; i < taken.parts.size(); ++i) {
    decided[i] = known && taken.parts[i].closed();
    if (!decided[i]) ++report.open_parts;
    if (decided[i]) report.hole_area += taken.parts[i].hole_area;
  }
  for (std::size_t i = 0; i < nested.size(); ++i) {
    if (i == 0 || nested[i].inner != nested[i - 1].inner) ++report.inner_parts;
  }
  std::vector<bool> turned(mesh.triangles.size(), false);
  for (std::size_t i = 0; i < turned.size(); ++i) {
    const std::uint32_t part = taken.part_of[i];
    if (part == kNoPart || !decided[part]) continue;
    const int side = (taken.parts[part].volume > 0) != (taken.reversed[i] != 0) ? 1 : -1;
    turned[i] = side != wanted[part];
    if (!turned[i]) continue;
    ++report.turned_triangles;
    if (!touched[part]) ++report.turned_parts;
    touched[part] = true;
  }
  if (report.open_parts > 0) report_open(mesh, taken, decided, report);
  report_copies(taken, decided, report);
  report_second_parts(mesh, taken, decided, wanted, report);
  return turned;
}

}  // namespace

std::vector<bool> turned_triangles(const Mesh& mesh, Winding winding, std::size_t threads,
                                   WindingReport& report) {
  const FloatingPointGuard guard;
  report = {};
  if (winding == Winding::automatic) return find_turned(mesh, threads, report);
  if (winding == Winding::as_is) return {};
  report.turned_triangles = mesh.triangles.size();
  return std::vector<bool>(mesh.triangles.size(), true);
}

bool is_solid(const Mesh& mesh, std::size_t threads) {
  WindingReport report;
  static_cast<void>(turned_triangles(mesh, Winding::automatic, threads, report));
  return report.parts > 0 && report.open_parts == 0 && report.hole_area == 0 && report.turned_triangles == 0;
}

void close_cracks(Mesh& mesh) {
  const FloatingPointGuard guard;
  std::vector<std::uint32_t> first;
  joined_edges(mesh, 1, first);
  for (std::size_t i = 0; i < first.size(); ++i) mesh.vertices[i] = mesh.vertices[first[i]];
}

WindingReport wind_outwards(Mesh& mesh, Winding winding) {
  WindingReport report;
  const std::vector<bool> turned = turned_triangles(mesh, winding, 1, report);
  for (std::size_t i = 0; i < turned.size(); ++i) {
    if (turned[i]) std::swap(mesh.triangles[i][1], mesh.triangles[i][2]);
  }
  return report;
}

}  // namespace lumbrical
