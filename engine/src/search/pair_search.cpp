#include "search/pair_search.h"

#include <algorithm>

#include "index/sphere_tree.h"
#include "index/voxel_index.h"
#include "model/corners.h"
#include "search/tree_search.h"
#include "simd/lane_vectors.h"

namespace lumbrical {

void set_triangles(const Triangles& world, std::span<const std::uint32_t> triangles, MissTerms& terms) {
  terms.count = triangles.size();
  const std::size_t padded = (triangles.size() + 7) / 8 * 8;  // whole registers
  for (std::size_t k = 0; k < padded; ++k) {
    const auto [a, b, c] = corners_of(world, triangles[k < triangles.size() ? k : 0]);
    put_vector(a, k, terms.a);
    put_vector(b, k, terms.b);
    put_vector(c, k, terms.c);
  }
}

namespace {

constexpr std::uint32_t kBatch = MissTerms::kCapacity;

bool is_within(Vec3 point, Vec3 centre, double reach) {
  const Vec3 from = point - centre;
  return dot(from, from) <= reach * reach;
}

bool append(FoundPairs& found, std::span<const std::uint64_t> pairs) {
  const std::size_t first = found.count.fetch_add(pairs.size(), std::memory_order_relaxed);
  if (first + pairs.size() > found.room.size()) return false;
  std::copy(pairs.begin(), pairs.end(), found.room.begin() + static_cast<std::ptrdiff_t>(first));
  return true;
}

// Keeps those of up to kBatch triangles that the primitive does not certainly miss; false where there is no
// room.
bool keep(PairSearch& search, std::span<const std::uint32_t> triangles) {
  MissTerms& terms = search.terms;
  set_triangles(search.model.triangles, triangles, terms);
  std::array<std::uint64_t, kBatch> pairs;
  std::size_t count = 0;
  const std::uint64_t first = search.index << 33;
  search.kernels.certain_misses(terms);
  if (!(search.skin > 0)) {
    for (std::size_t k = 0; k < triangles.size(); ++k) {
      pairs[count] = first | std::uint64_t{triangles[k]} << 1;
      count += terms.miss[k] == 0;
    }
    return append(search.found, {pairs.data(), count});
  }
  std::array<double, kBatch> misses_wide;
  std::copy_n(terms.miss, kBatch, misses_wide.begin());
  set_terms(*search.hull, -search.skin, terms);
  search.kernels.certain_misses(terms);
  set_terms(*search.hull, search.skin, terms);
  const double reach = reach_of(*search.hull);
  for (std::size_t k = 0; k < triangles.size(); ++k) {
    const bool within = is_within(vector_at(terms.a, k), terms.end1, reach) &&
                        is_within(vector_at(terms.b, k), terms.end1, reach) &&
                        is_within(vector_at(terms.c, k), terms.end1, reach);
    const bool unclear = !within || terms.miss[k] != 0;
    pairs[count] = first | std::uint64_t{triangles[k]} << 1 | (unclear ? 1u : 0u);
    count += !within || misses_wide[k] == 0;
  }
  return append(search.found, {pairs.data(), count});
}

bool search_all(PairSearch& search) {
  const auto count = static_cast<std::uint32_t>(search.model.triangles.size());
  std::array<std::uint32_t, kBatch> batch;
  for (std::uint32_t first = 0; first < count; first += kBatch) {
    const std::uint32_t size = std::min(kBatch, count - first);
    for (std::uint32_t k = 0; k < size; ++k) batch[k] = first + k;
    if (!keep(search, {batch.data(), size})) return false;
  }
  return true;
}

bool search_tree(PairSearch& search, const Primitive& primitive, const TreeHead& tree,
                 const TreeLine* lines) {
  constexpr std::size_t kBlocks = kBatch / SphereBlock::kWidth;
  const SphereQuery query = query_of(tree, primitive);
  const TreeLayout layout = layout_of(tree);
  const auto blocks = search_leaves(tree, layout, lines, query, search.kernels, search.memory.frontier);
  const SphereBlock* const spheres = blocks_of(lines) + layout.upper;
  const std::uint32_t* const numbers = numbers_of(lines, layout);
  std::array<std::uint32_t, 2 * kBatch> batch;
  std::size_t size = 0;
  for (std::size_t i = 0; i < blocks.size(); i += kBlocks) {
    const std::size_t count = search.kernels.sphere_hits(spheres, query, blocks.data() + i,
                                                         std::min(kBlocks, blocks.size() - i), &batch[size]);
    for (std::size_t k = size; k < size + count; ++k) batch[k] = numbers[batch[k]];
    size += count;
    if (size < kBatch) continue;
    if (!keep(search, {batch.data(), kBatch})) return false;
    size -= kBatch;
    std::copy_n(batch.begin() + kBatch, size, batch.begin());
  }
  return size == 0 || keep(search, {batch.data(), size});
}

bool search_cells(PairSearch& search, const Primitive& primitive, std::span<const std::uint32_t> cells) {
  const SphereGrid& grid = search.model.grid;
  for (const std::uint32_t cell : cells) {
    const TreeHead& tree = grid.tree[cell];
    if (may_reach(tree, primitive) &&
        !search_tree(search, primitive, tree, grid.lines.data() + tree.first_line))
      return false;
  }
  return true;
}

// Triangles centred in the voxels near by, and the wide ones.
bool search_voxels(PairSearch& search, const Primitive& primitive) {
  const VoxelIndex& index = *search.model.voxels;
  const std::size_t count = find_voxels(index, primitive, search.memory.cells);
  std::array<std::uint32_t, kBatch> batch;
  std::uint32_t size = 0;
  for (std::size_t i = 0; i < count; ++i) {
    for (const std::uint32_t triangle : centred_in(index, search.memory.cells[i])) {
      batch[size++] = triangle;
      if (size < kBatch) continue;
      if (!keep(search, batch)) return false;
      size = 0;
    }
  }
  if (size > 0 && !keep(search, {batch.data(), size})) return false;
  return !may_reach(index.wide.head, primitive) ||
         search_tree(search, primitive, index.wide.head, index.wide.lines.data());
}

}  // namespace

bool search_for(PairSearch& search, std::span<const std::uint32_t> cells) {
  Primitive primitive = search.hand.primitive[search.index];
  primitive.radius1 += search.skin;
  primitive.radius2 += search.skin;
  set_terms(*search.hull, search.skin, search.terms);
  switch (search.model.execution.broadphase) {
    case Broadphase::tree:
      return !may_reach(search.model.tree, primitive) ||
             search_tree(search, primitive, search.model.tree.head, search.model.tree.lines.data());
    case Broadphase::grid:
      return search_cells(search, primitive, cells);
    case Broadphase::voxel:
      return search_voxels(search, primitive);
    case Broadphase::automatic:  // a model holds one of the others
    case Broadphase::brute:
      break;
  }
  return search_all(search);
}

}  // namespace lumbrical
