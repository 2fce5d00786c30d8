// The one file that knows OpenVDB (Museth, VDB, 2013): builds its trees from plain arrays, searches them node
// by node. It is a module by itself, see voxel_grid.cpp.
#include <openvdb/Grid.h>
#include <openvdb/Types.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/MeshToVolume.h>
#include <openvdb/tools/SignedFloodFill.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>

#include "index/voxel_grid.h"

namespace lumbrical {
namespace {

constexpr float kBand = 3;  // [voxels] to either side

// Vertices [voxels] as meshToVolume wants them, where voxel (i, j, k) has its middle at (i, j, k). Rounding
// to float moves none by more than 2^-5 voxels. Of other types than these the library has no compiled
// meshToVolume, and compiling it takes a minute and a half.
std::vector<openvdb::Vec3s> vertices_of(const Triangles& triangles, const VoxelLists& lists) {
  std::vector<openvdb::Vec3s> vertices;
  vertices.reserve(triangles.x.size());
  for (std::uint32_t i = 0; i < triangles.x.size(); ++i) {
    const Vec3 p = (triangles.vertex(i) - lists.origin) / lists.voxel_size;
    vertices.emplace_back(p.x - 0.5, p.y - 0.5, p.z - 0.5);
  }
  return vertices;
}

std::vector<openvdb::Vec3I> corner_numbers(const Triangles& triangles) {
  std::vector<openvdb::Vec3I> corners;
  corners.reserve(triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i)
    corners.emplace_back(triangles.a[i], triangles.b[i], triangles.c[i]);
  return corners;
}

openvdb::Coord coord_of(std::uint64_t key, std::int32_t shift) {
  const VoxelPlace place = voxel_place(key);
  return {place.x - shift, place.y - shift, place.z - shift};
}

// OpenVDB tells by exceptions what went wrong; here they end.
template <class Work>
Status guarded(const Work& work) {
  try {
    work();
    return {};
  } catch (const std::bad_alloc&) {
    return Status::error("there is not enough memory for the voxel index; use broadphase tree or grid");
  } catch (const std::exception& error) {
    return Status::error(std::string("OpenVDB can't build the voxel index: ") + error.what() +
                         "; use broadphase tree or grid");
  }
}

// ---- The search ----

struct Search {
  std::span<const Voxel> voxels;
  const VoxelQuery& query;
  double margin;             // by which home voxels may lie farther away than the query's reach
  openvdb::Coord low, high;  // no home voxel outside
  std::vector<std::uint32_t>& found;
  std::size_t count = 0;
};

// The square of the distance from the query's axis.
double square_from_axis(const VoxelQuery& query, Vec3 p) {
  const Vec3 from = p - query.end;
  const double t = clamp(dot(from, query.axis) * query.per_square, 0, 1);
  const Vec3 gap = from - t * query.axis;
  return dot(gap, gap);
}

constexpr double kHalfDiagonal = 0.8660255;  // of a cube, a little more

bool may_hold(const Search& search, const openvdb::Coord& origin, double size, double margin) {
  const double reach = search.query.reach + margin + kHalfDiagonal * size;
  const Vec3 middle{origin.x() + 0.5 * size, origin.y() + 0.5 * size, origin.z() + 0.5 * size};
  return square_from_axis(search.query, middle) <= reach * reach;
}

// Places of low .. high inside a node of `places` along an axis, 2^shift voxels each.
struct Range {
  openvdb::Int32 first, last;
};
Range range_in(openvdb::Int32 origin, openvdb::Int32 low, openvdb::Int32 high, int shift,
               openvdb::Int32 places) {
  return {std::max((low - origin) >> shift, 0), std::min((high - origin) >> shift, places - 1)};
}

using Leaf = openvdb::Int32Tree::LeafNodeType;

void visit(const Leaf& leaf, Search& search) {
  const openvdb::Coord origin = leaf.origin();
  const Range x = range_in(origin.x(), search.low.x(), search.high.x(), 0, 8),
              y = range_in(origin.y(), search.low.y(), search.high.y(), 0, 8),
              z = range_in(origin.z(), search.low.z(), search.high.z(), 0, 8);
  const openvdb::Int32* const numbers = leaf.buffer().data();
  for (openvdb::Int32 i = x.first; i <= x.last; ++i) {
    // A word of the mask is a slab of voxels with the same x.
    std::uint64_t active = leaf.getValueMask().getWord<std::uint64_t>(static_cast<openvdb::Index>(i));
    for (; active != 0; active &= active - 1) {
      const int place = std::countr_zero(active), j = place >> 3, k = place & 7;
      if (j < y.first || j > y.last || k < z.first || k > z.last) continue;
      const auto number = static_cast<std::uint32_t>(numbers[i << 6 | place]);
      const float reach = search.voxels[number].reach;
      if (reach < 0 || !may_hold(search, origin.offsetBy(i, j, k), 1, static_cast<double>(reach))) continue;
      search.found[search.count++] = number;
    }
  }
}

template <class Node>
void visit(const Node& node, Search& search) {
  using Child = typename Node::ChildNodeType;
  constexpr int kShift = Child::TOTAL, kLog2 = Node::LOG2DIM;
  const openvdb::Coord origin = node.origin();
  const auto range = [&](int axis) {
    return range_in(origin[axis], search.low[axis], search.high[axis], kShift, 1 << kLog2);
  };
  const Range x = range(0), y = range(1), z = range(2);
  for (openvdb::Int32 i = x.first; i <= x.last; ++i) {
    for (openvdb::Int32 j = y.first; j <= y.last; ++j) {
      for (openvdb::Int32 k = z.first; k <= z.last; ++k) {
        const auto place = static_cast<openvdb::Index>((i << 2 * kLog2) | (j << kLog2) | k);
        if (!node.isChildMaskOn(place)) continue;
        const Child& child = *node.getTable()[place].getChild();
        if (may_hold(search, child.origin(), Child::DIM, search.margin)) visit(child, search);
      }
    }
  }
}

// Voxels that the box round the query, widened by the margin, meets.
void set_box(Search& search) {
  const VoxelQuery& query = search.query;
  const double reach = query.reach + search.margin;
  const auto voxel = [](double x) {
    return static_cast<openvdb::Int32>(std::floor(clamp(x, 0, static_cast<double>(kMostVoxels))));
  };
  const Vec3 other = query.end + query.axis;
  search.low = {voxel(min(query.end.x, other.x) - reach), voxel(min(query.end.y, other.y) - reach),
                voxel(min(query.end.z, other.z) - reach)};
  search.high = {voxel(max(query.end.x, other.x) + reach), voxel(max(query.end.y, other.y) + reach),
                 voxel(max(query.end.z, other.z) + reach)};
}

class OpenvdbGrid final : public VoxelGrid {
 public:
  openvdb::Int32Tree::RootNodeType number{-1};  // of the voxel, where a triangle touches it
  openvdb::FloatTree distance;                  // [voxels]
  bool has_distance = false;

  std::size_t find(const VoxelLists& lists, const VoxelQuery& query,
                   std::vector<std::uint32_t>& found) const override {
    Search search{lists.voxel, query, static_cast<double>(lists.reach), {}, {}, found};
    set_box(search);
    for (auto child = number.cbeginChildOn(); child; ++child) {
      using Child = openvdb::Int32Tree::RootNodeType::ChildNodeType;
      if (may_hold(search, child->origin(), Child::DIM, search.margin)) visit(*child, search);
    }
    return search.count;
  }

  std::int32_t number_at(VoxelPlace place) const override {
    return number.getValue({place.x, place.y, place.z});
  }

  bool has_field() const override { return has_distance; }

  double sample_field(Vec3 p) const override {
    return static_cast<double>(
        openvdb::tools::BoxSampler::sample(distance, openvdb::Vec3d(p.x - 0.5, p.y - 0.5, p.z - 0.5)));
  }

  std::size_t byte_count() const override {
    return number.memUsage() + (has_distance ? distance.memUsage() : 0);
  }
};

Status distance_field_of(const Triangles& triangles, const VoxelLists& lists, DistanceField& field) {
  return guarded([&] {
    const auto vertices = vertices_of(triangles, lists);
    const auto corners = corner_numbers(triangles);
    openvdb::util::NullInterrupter never;
    const auto grid = openvdb::tools::meshToVolume<openvdb::FloatGrid>(
        never, openvdb::tools::QuadAndTriangleDataAdapter<openvdb::Vec3s, openvdb::Vec3I>(vertices, corners),
        *openvdb::math::Transform::createLinearTransform(1.0), kBand, kBand, 0, nullptr);
    std::vector<std::pair<std::uint64_t, float>> values;
    for (auto value = grid->cbeginValueOn(); value; ++value) {
      if (!value.isVoxelValue()) continue;
      const openvdb::Coord at = value.getCoord().offsetBy(DistanceField::kShift);
      values.emplace_back(voxel_key(static_cast<std::uint64_t>(at.x()), static_cast<std::uint64_t>(at.y()),
                                    static_cast<std::uint64_t>(at.z())),
                          *value);
    }
    std::sort(values.begin(), values.end());
    field = {};
    for (const auto& [key, value] : values) {
      field.key.push_back(key);
      field.value.push_back(value);
    }
  });
}

Status grid_of(const VoxelLists& lists, const DistanceField& field,
               std::shared_ptr<const VoxelGrid>& result) {
  return guarded([&] {
    const auto grid = std::make_shared<OpenvdbGrid>();
    for (std::size_t i = 0; i < lists.key.size(); ++i)
      grid->number.setValueOn(coord_of(lists.key[i], 0), static_cast<openvdb::Int32>(i));
    grid->has_distance = !field.key.empty();
    grid->distance.root().setBackground(kBand, false);
    for (std::size_t i = 0; i < field.key.size(); ++i)
      grid->distance.root().setValueOn(coord_of(field.key[i], DistanceField::kShift), field.value[i]);
    if (grid->has_distance) openvdb::tools::signedFloodFill(grid->distance);
    result = grid;
  });
}

}  // namespace
}  // namespace lumbrical

extern "C" const lumbrical::VoxelGridModule* lumbrical_voxel_grid_module() {
  static constexpr lumbrical::VoxelGridModule kModule{lumbrical::distance_field_of, lumbrical::grid_of};
  return &kModule;
}
