// Opening a world file: see lumbrical/world.h and world_format.h. Every number that leads to a place in
// memory is checked before anything follows it; a wrong one is told with the byte it stands at.
#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <new>
#include <string>
#include <utility>
#include <vector>

#include "base/floating_point.h"
#include "files/world_format.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "lumbrical/world.h"
#include "model/scene_check.h"

namespace lumbrical {
namespace {

/// The one pass over a file. What lies within the bytes seen so far is checked as they are seen, so that no
/// page is needed twice.
class Check {
 public:
  Check(const std::string& path, const std::byte* bytes, std::size_t size)
      : path_(path), bytes_(bytes), size_(size) {}

  Status run();
  [[nodiscard]] const WorldEnd& end() const { return end_; }
  std::vector<World::Object> objects;

 private:
  [[nodiscard]] Status damaged(std::uint64_t byte, const std::string& why) const {
    return Status::error(path_ + ": byte " + std::to_string(byte) + ": " + why +
                         "; copy the file again, or build it again with lumbrical world");
  }
  template <class T>
  [[nodiscard]] const T* items(WorldSection section) const {
    return reinterpret_cast<const T*>(bytes_ + layout_.offset[section]);
  }
  Status read_end();
  Status check_numbers() const;
  Status check_objects();
  Status check_heads();
  Status check_cells() const;
  Status check_vertices(WorldSection section, std::uint64_t first, std::uint64_t last);
  Status check_corners(WorldSection section, std::uint64_t first, std::uint64_t last) const;
  Status check_trees(std::uint64_t last);
  Status check_tree(const TreeHead& head);
  Status check_piece(std::uint64_t first, std::uint64_t last);
  Status check_sums() const;

  const std::string& path_;
  const std::byte* const bytes_;
  const std::size_t size_;
  WorldEnd end_;
  WorldLayout layout_;
  Box extent_;
  std::uint64_t next_tree_ = 0;
  std::vector<bool> listed_;  // triangles that a tree has listed so far
};

Status Check::read_end() {
  std::uint64_t magic = 0;
  if (size_ >= sizeof(magic)) std::memcpy(&magic, bytes_, sizeof(magic));
  if (magic != kWorldMagic)
    return Status::error(path_ +
                         ": byte 0: is no world file of this version; build one with lumbrical world");
  if (size_ % kPageSize != 0 || size_ < 2 * kPageSize) return damaged(size_, "the file is cut");
  const std::uint64_t at = size_ - kPageSize;
  std::memcpy(&end_, bytes_ + at, sizeof(end_));
  if (end_.magic != kWorldMagic) return damaged(at, "the file is cut, its last page is missing");
  constexpr std::uint64_t kMost = std::uint64_t{1} << 40;
  for (const std::uint64_t count :
       {end_.vertices, end_.triangles, end_.lines, end_.cells, end_.objects, end_.name_bytes}) {
    if (count > kMost) return damaged(at, "a count is out of range");
  }
  if (!check_counts(end_.vertices, end_.triangles).ok() || end_.cells > end_.triangles)
    return damaged(at, "a count is out of range");
  layout_ = layout_of(end_);
  if (layout_.end != at) return damaged(at, "the file's size is not the one it tells");
  const std::size_t count = layout_.bytes[kHashes] / sizeof(std::uint64_t);
  if (content_of(end_, items<std::uint64_t>(kHashes), count) != end_.content)
    return damaged(layout_.offset[kHashes], "the file's last pages are damaged");
  return {};
}

Status Check::check_numbers() const {
  bool sound = end_.leaf_size >= 1 && end_.leaf_size <= 64 && end_.tree_levels <= 32;
  sound = sound && end_.cell_size >= 1e-3 && end_.cell_size <= 1e6;
  sound = sound && end_.grid_cell_size >= 0 && end_.grid_cell_size * kMostCells <= 1e13;
  sound = sound && (end_.triangles == 0 || end_.grid_cell_size > 0);
  for (const double number : end_.origin) sound = sound && std::fabs(number) <= kWorldReach;
  return sound ? Status() : damaged(layout_.end, "a setting is out of range");
}

Status Check::check_objects() {
  std::uint64_t triangles = 0, vertices = 0, name = 0;
  const char* const names = items<char>(kNames);
  for (std::uint64_t i = 0; i < end_.objects; ++i) {
    const WorldObject& object = items<WorldObject>(kObjects)[i];
    const bool follows = object.first_triangle == triangles && object.first_vertex == vertices;
    triangles += object.triangle_count;
    vertices += object.vertex_count;
    if (!follows || triangles > end_.triangles || vertices > end_.vertices ||
        object.name_size > end_.name_bytes - name)
      return damaged(layout_.offset[kObjects] + i * sizeof(object), "an object is out of range");
    objects.push_back({std::string(names + name, object.name_size), object.first_triangle,
                       object.triangle_count, object.first_vertex, object.vertex_count});
    name += object.name_size;
  }
  if (triangles == end_.triangles && vertices == end_.vertices && name == end_.name_bytes) return {};
  return damaged(layout_.offset[kObjects], "the objects do not add up to the world");
}

// Every tree's lines follow those of the tree before it.
Status Check::check_heads() {
  std::uint64_t lines = 0;
  std::size_t frontier = 0;
  const auto leaf_blocks = (end_.leaf_size + SphereBlock::kWidth - 1) / SphereBlock::kWidth;
  for (std::uint64_t i = 0; i < head_count(end_); ++i) {
    const TreeHead& head = items<TreeHead>(kHeads)[i];
    bool sound = is_finite(head.origin) && is_finite(head.centre) && head.radius >= 0 && head.radius <= 1e9 &&
                 head.first_line == lines && head.blocks_per_leaf == leaf_blocks &&
                 head.leaf_count <= end_.triangles;
    sound = sound && (head.leaf_count == 0 ? head.level_count == 0
                                           : head.level_count >= 1 && head.level_count <= kTreeLevels);
    if (sound) {
      lines += layout_of(head).lines;
      frontier = std::max(frontier, frontier_capacity(head));
    }
    if (!sound || lines > end_.lines)
      return damaged(layout_.offset[kHeads] + i * sizeof(head), "a tree of the grid is out of range");
  }
  if (lines == end_.lines && frontier == end_.frontier) return {};
  return damaged(layout_.offset[kHeads], "the trees do not add up to the grid");
}

Status Check::check_cells() const {
  const std::uint64_t* const cell = items<std::uint64_t>(kCells);
  for (std::uint64_t i = 0; i < end_.cells; ++i) {
    if (cell[i] >= std::uint64_t{1} << 63 || (i > 0 && cell[i] <= cell[i - 1]))
      return damaged(layout_.offset[kCells] + 8 * i, "the cells of the grid are out of order");
  }
  return {};
}

Status Check::check_vertices(WorldSection section, std::uint64_t first, std::uint64_t last) {
  const double* const numbers = items<double>(section);
  double &low = extent_.lower.*kAxis[section], &high = extent_.upper.*kAxis[section];
  for (std::uint64_t i = first; i < last; ++i) {
    const double number = numbers[i];
    if (!(std::fabs(number) <= kWorldReach))
      return damaged(layout_.offset[section] + 8 * i,
                     "vertex " + std::to_string(i) + " is not finite or farther than 1e8 m from the origin");
    low = min(low, number);
    high = max(high, number);
  }
  return {};
}

Status Check::check_corners(WorldSection section, std::uint64_t first, std::uint64_t last) const {
  const std::uint32_t* const corners = items<std::uint32_t>(section);
  for (std::uint64_t i = first; i < last; ++i) {
    if (corners[i] >= end_.vertices)
      return damaged(layout_.offset[section] + 4 * i, "triangle " + std::to_string(i) + " names vertex " +
                                                          std::to_string(corners[i]) + " of " +
                                                          std::to_string(end_.vertices));
  }
  return {};
}

bool is_empty(float radius) { return radius == -std::numeric_limits<float>::infinity(); }

// Spheres that are hit lead to the block of their number, so none behind the last may be there to be hit;
// every triangle is listed once, by a tree that bounds it.
Status Check::check_tree(const TreeHead& head) {
  constexpr std::uint32_t kWidth = SphereBlock::kWidth;
  const TreeLine* const lines = items<TreeLine>(kLines) + head.first_line;
  const TreeLayout layout = layout_of(head);
  const auto byte_of = [&](const void* item) {
    return static_cast<std::uint64_t>(static_cast<const std::byte*>(item) - bytes_);
  };
  const SphereBlock* block = blocks_of(lines);
  for (std::size_t level = head.level_count; level-- > 0;) {
    const std::size_t spheres = level > 0 ? layout.blocks[level - 1] : head.leaf_count;
    const SphereBlock& last = block[layout.blocks[level] - 1];
    for (std::size_t i = spheres; i < layout.blocks[level] * kWidth; ++i)
      if (!is_empty(last.r[i % kWidth])) return damaged(byte_of(&last), "a sphere bounds nothing");
    block += layout.blocks[level];
  }
  const std::uint32_t* const numbers = numbers_of(lines, layout);
  for (std::size_t i = 0; i < layout.lowest * kWidth; ++i) {
    if (is_empty(block[i / kWidth].r[i % kWidth]) && numbers[i] == 0) continue;
    if (numbers[i] >= end_.triangles || listed_[numbers[i]])
      return damaged(byte_of(numbers + i), "a tree lists a triangle that is not in it");
    listed_[numbers[i]] = true;
  }
  return {};
}

// The trees that end by byte `last`.
Status Check::check_trees(std::uint64_t last) {
  for (; next_tree_ < head_count(end_); ++next_tree_) {
    const TreeHead& head = items<TreeHead>(kHeads)[next_tree_];
    const std::uint64_t end = head.first_line + layout_of(head).lines;
    if (layout_.offset[kLines] + sizeof(TreeLine) * end > last) return {};
    if (Status status = check_tree(head); !status.ok()) return status;
  }
  return {};
}

Status Check::check_piece(std::uint64_t first, std::uint64_t last) {
  const std::uint64_t* const hashes = items<std::uint64_t>(kHashes);
  if (hash_of_bytes(bytes_ + first, last - first) != hashes[first / kHashPiece])
    return damaged(first, "up to byte " + std::to_string(last) + " something is damaged");
  for (const WorldSection section : {kX, kY, kZ, kA, kB, kC}) {
    const std::uint64_t begin = layout_.offset[section], end = begin + layout_.bytes[section];
    const std::uint64_t low = std::max(first, begin), high = std::min(last, end);
    if (low >= high) continue;
    const std::uint64_t width = section <= kZ ? 8 : 4, from = (low - begin) / width,
                        to = (high - begin) / width;
    const Status status =
        section <= kZ ? check_vertices(section, from, to) : check_corners(section, from, to);
    if (!status.ok()) return status;
  }
  return last > layout_.offset[kLines] ? check_trees(last) : Status();
}

Status Check::check_sums() const {
  if (static_cast<std::uint64_t>(std::count(listed_.begin(), listed_.end(), true)) != end_.triangles)
    return damaged(layout_.offset[kLines], "a triangle is in no tree");
  // Vertices that no triangle names may be farther away.
  bool within = true;
  for (std::size_t k = 0; k < 3; ++k)
    within = within && end_.lower[k] >= extent_.lower.*kAxis[k] && end_.upper[k] <= extent_.upper.*kAxis[k];
  return within ? Status() : damaged(layout_.end, "the world's extent is beyond its vertices");
}

Status Check::run() {
  if (Status status = read_end(); !status.ok()) return status;
  if (Status status = check_numbers(); !status.ok()) return status;
  if (Status status = check_objects(); !status.ok()) return status;
  if (Status status = check_heads(); !status.ok()) return status;
  if (Status status = check_cells(); !status.ok()) return status;
  listed_.resize(end_.triangles);
  const std::uint64_t all = layout_.offset[kHashes];
  expect_pages(bytes_, std::min<std::uint64_t>(all, 8 * kHashPiece));
  for (std::uint64_t first = 0; first < all; first += kHashPiece) {
    const std::uint64_t last = std::min<std::uint64_t>(first + kHashPiece, all);
    const std::uint64_t soon = first + 8 * kHashPiece;
    if (soon < all) expect_pages(bytes_ + soon, std::min<std::uint64_t>(kHashPiece, all - soon));
    if (Status status = check_piece(first, last); !status.ok()) return status;
    // A tree that reaches into the next piece is looked at with that one.
    if (first >= kHashPiece) release_pages(bytes_ + first - kHashPiece, kHashPiece);
  }
  if (Status status = check_sums(); !status.ok()) return status;
  release_pages(bytes_, size_);
  return {};
}

}  // namespace

Status open_world(const std::string& path, std::shared_ptr<const World>& world) try {
  const FloatingPointGuard guard;
  std::shared_ptr<const std::byte> bytes;
  std::size_t size = 0;
  if (Status status = map_file(path, bytes, size); !status.ok()) return status;
  Check check(path, bytes.get(), size);
  const Status checked = check.run();
  if (Status status = check_mapped(path, bytes.get()); !status.ok()) return status;
  if (!checked.ok()) return checked;
  const WorldEnd& end = check.end();
  const WorldLayout layout = layout_of(end);
  auto opened = std::make_shared<World>();
  opened->path = path;
  opened->content = end.content;
  opened->triangles = triangles_in(end, bytes);
  opened->extent = {{end.lower[0], end.lower[1], end.lower[2]}, {end.upper[0], end.upper[1], end.upper[2]}};
  SphereGrid& grid = opened->grid;
  grid.origin = {end.origin[0], end.origin[1], end.origin[2]};
  grid.cell_size = end.grid_cell_size;
  grid.frontier = end.frontier;
  grid.cell = array_at<std::uint64_t>(bytes, layout.offset[kCells], end.cells);
  grid.tree = array_at<TreeHead>(bytes, layout.offset[kHeads], head_count(end));
  grid.lines = array_at<TreeLine>(bytes, layout.offset[kLines], end.lines);
  opened->objects = std::move(check.objects);
  opened->cell_size = end.cell_size;
  opened->leaf_size = end.leaf_size;
  opened->tree_levels = end.tree_levels;
  opened->bytes = bytes;
  opened->byte_count = size;
  world = std::move(opened);
  return {};
} catch (const std::bad_alloc&) {
  return Status::error(path + ": not enough memory for the world's objects");
}

}  // namespace lumbrical
