#include "stages/broadphase.h"

#include <algorithm>

#include "base/radix_sort.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "index/voxel_index.h"
#include "lanes/field_kernels.h"
#include "lanes/tree_search.h"

namespace lumbrical {
namespace {

constexpr std::uint32_t kBatch = MissTerms::kCapacity;

// The search for one primitive's candidates.
struct Search {
  const Model& model;
  const FieldKernels& kernels;
  Scratch& scratch;
  MissTerms& terms;
  std::uint64_t index = 0;  // of the primitive
};

void add_plane(const HalfSpace& space, double overhang, MissTerms& terms) {
  terms.plane[terms.plane_count++] = {space.normal, dot(space.normal, space.point - terms.end1) + overhang};
}

// The primitive's round hull and the planes that bound it besides.
void set_primitive(const Primitive& primitive, const Prism& palm, MissTerms& terms) {
  const Vec3 span = primitive.end2 - primitive.end1;
  terms.length = norm(span);
  terms.end1 = primitive.end1;
  terms.axis = terms.length > 0 ? span / terms.length : Vec3{};
  terms.radius1 = primitive.radius1;
  terms.radius2 = primitive.radius2;
  terms.most = max(primitive.radius1, primitive.radius2);
  terms.plane_count = 0;
  for (std::size_t i = 0; i < primitive.cut_count; ++i) {
    add_plane(primitive.cut[i], primitive.overhang[i], terms);
  }
  if (primitive.shape != Shape::prism) return;
  for (std::size_t i = 0; i < static_cast<std::size_t>(palm.face_count); ++i)
    add_plane(palm.face[i], 0, terms);
}

void set_corner(const Triangles& world, std::uint32_t vertex, std::size_t k,
                double (&corner)[3][MissTerms::kCapacity]) {
  corner[0][k] = world.x[vertex];
  corner[1][k] = world.y[vertex];
  corner[2][k] = world.z[vertex];
}

// Keeps those of up to kBatch triangles that the primitive does not certainly miss; false where there is no
// room.
bool keep(Search& search, std::span<const std::uint32_t> triangles) {
  const Triangles& world = search.model.triangles;
  MissTerms& terms = search.terms;
  terms.count = triangles.size();
  const std::size_t padded = (triangles.size() + 15) / 16 * 16;
  for (std::size_t k = 0; k < padded; ++k) {
    const std::uint32_t triangle = triangles[k < triangles.size() ? k : 0];
    set_corner(world, world.a[triangle], k, terms.a);
    set_corner(world, world.b[triangle], k, terms.b);
    set_corner(world, world.c[triangle], k, terms.c);
  }
  search.kernels.certain_misses(terms);
  Scratch& scratch = search.scratch;
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    if (terms.miss[k] != 0) continue;
    if (scratch.candidate_count == scratch.candidates.size()) return false;
    scratch.candidates[scratch.candidate_count++] = search.index << 32 | triangles[k];
  }
  return true;
}

bool search_all(Search& search) {
  const auto count = static_cast<std::uint32_t>(search.model.triangles.size());
  std::array<std::uint32_t, kBatch> batch;
  for (std::uint32_t first = 0; first < count; first += kBatch) {
    const std::uint32_t size = std::min(kBatch, count - first);
    for (std::uint32_t k = 0; k < size; ++k) batch[k] = first + k;
    if (!keep(search, {batch.data(), size})) return false;
  }
  return true;
}

bool search_tree(Search& search, const Primitive& primitive, const SphereTree& tree) {
  constexpr std::size_t kBlocks = kBatch / SphereBlock::kWidth;
  const SphereQuery query = query_of(tree, primitive);
  const auto blocks = search_leaves(tree, query, search.kernels, search.scratch.frontier);
  std::array<std::uint32_t, 2 * kBatch> batch;
  std::size_t size = 0;
  for (std::size_t i = 0; i < blocks.size(); i += kBlocks) {
    const std::size_t count = search.kernels.sphere_hits(tree.sphere.data(), query, blocks.data() + i,
                                                         std::min(kBlocks, blocks.size() - i), &batch[size]);
    for (std::size_t k = size; k < size + count; ++k) batch[k] = tree.triangle[batch[k]];
    size += count;
    if (size < kBatch) continue;
    if (!keep(search, {batch.data(), kBatch})) return false;
    size -= kBatch;
    std::copy_n(batch.begin() + kBatch, size, batch.begin());
  }
  return size == 0 || keep(search, {batch.data(), size});
}

bool search_cells(Search& search, const Primitive& primitive, std::span<const std::uint32_t> cells) {
  for (const std::uint32_t cell : cells) {
    const SphereTree& tree = search.model.grid.tree[cell];
    if (may_reach(tree, primitive) && !search_tree(search, primitive, tree)) return false;
  }
  return true;
}

// Triangles centred in the voxels near by, and the wide ones.
bool search_voxels(Search& search, const Primitive& primitive) {
  const VoxelIndex& index = *search.model.voxels;
  const std::size_t count = find_voxels(index, primitive, search.scratch.cells);
  std::array<std::uint32_t, kBatch> batch;
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (const std::uint32_t triangle : centred_in(index, search.scratch.cells[i])) {
      batch[size++] = triangle;
      if (size < kBatch) continue;
      if (!keep(search, batch)) return false;
      size = 0;
    }
  }
  if (size > 0 && !keep(search, {batch.data(), size})) return false;
  return !may_reach(index.wide, primitive) || search_tree(search, primitive, index.wide);
}

Box box_round(const Primitives& hand) {
  Box box;
  for (std::size_t i = 0; i < static_cast<std::size_t>(hand.count); ++i) {
    const Primitive& primitive = hand.primitive[i];
    const double reach = (1 + 1e-6) * max(primitive.radius1, primitive.radius2);
    box.add(primitive.end1, reach);
    box.add(primitive.end2, reach);
  }
  return box;
}

}  // namespace

void size_candidates(const Model& model, Scratch& scratch) {
  const std::size_t all_pairs = Primitives::kMaxCount * model.triangles.size();
  const std::size_t capacity = std::min<std::size_t>(model.settings.max_candidates, all_pairs);
  scratch.candidates.resize(capacity);
  scratch.sorting.resize(capacity);
  std::size_t frontier_size = frontier_capacity(model.tree);
  for (const SphereTree& tree : model.grid.tree)
    frontier_size = std::max(frontier_size, frontier_capacity(tree));
  if (model.voxels) frontier_size = std::max(frontier_size, frontier_capacity(model.voxels->wide));
  for (auto& frontier : scratch.frontier) frontier.resize(frontier_size);
  scratch.cells.resize(model.voxels ? model.voxels->lists.voxel.size() : model.grid.tree.size());
}

bool find_candidates(const Model& model, const Primitives& hand, Scratch& scratch) {
  scratch.candidate_count = 0;
  if (hand.count == 0 || model.triangles.size() == 0) return true;
  std::span<const std::uint32_t> cells;
  if (model.execution.broadphase == Broadphase::grid)
    cells = {scratch.cells.data(), find_cells(model.grid, box_round(hand), scratch.cells)};
  MissTerms terms;
  Search search{model, field_kernels(model.execution.isa), scratch, terms};
  for (std::size_t i = 0; i < static_cast<std::size_t>(hand.count); ++i) {
    const Primitive& primitive = hand.primitive[i];
    search.index = i;
    set_primitive(primitive, hand.palm, search.terms);
    bool fits = true;
    switch (model.execution.broadphase) {
      case Broadphase::tree:
        fits = search_tree(search, primitive, model.tree);
        break;
      case Broadphase::grid:
        fits = search_cells(search, primitive, cells);
        break;
      case Broadphase::voxel:
        fits = search_voxels(search, primitive);
        break;
      case Broadphase::automatic:  // a model holds one of the others
      case Broadphase::brute:
        fits = search_all(search);
        break;
    }
    if (!fits) {
      scratch.candidate_count = 0;
      return false;
    }
  }
  // Brute force finds them in order.
  if (model.execution.broadphase != Broadphase::brute)
    radix_sort({scratch.candidates.data(), scratch.candidate_count}, scratch.sorting);
  return true;
}

}  // namespace lumbrical
