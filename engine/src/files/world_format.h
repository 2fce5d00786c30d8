// How a world file is laid out: arrays one behind the other, each from a page of its own, in the bytes they
// have in memory (little-endian); behind them a hash for every piece of them; in the last page what they are.
//
// A file is written from its start to its end, so what is only known at the end stands there. See
// docs/worlds.md.
#pragma once

#include <array>
#include <cstdint>

#include "base/hash.h"
#include "files/mapped_file.h"
#include "lumbrical/model.h"

namespace lumbrical {

/// "LWORLD01" in the first eight bytes, and again in the last page; a new number with every change.
inline constexpr std::uint64_t kWorldMagic = 0x3130444c524f574cu;

inline constexpr std::size_t kHashPiece = std::size_t{1} << 20;  ///< [bytes] that one hash is of

/// The arrays in their order. Lines of a tree lie together, and trees in the order of their cells.
enum WorldSection : std::uint8_t {
  kX,
  kY,
  kZ,
  kA,
  kB,
  kC,
  kLines,
  kCells,
  kHeads,
  kObjects,
  kNames,
  kHashes
};
inline constexpr std::size_t kWorldSections = 12;

/// An object as it stands in the file; its name lies behind those of the objects before it.
struct WorldObject {
  std::uint32_t first_triangle = 0, triangle_count = 0, first_vertex = 0, vertex_count = 0, name_size = 0;
};

/// The file's last page begins with it.
struct WorldEnd {
  std::uint64_t magic = kWorldMagic;
  std::uint64_t content = 0;                          ///< hash of all the rest of this, and of the hashes
  double lower[3] = {0, 0, 0}, upper[3] = {0, 0, 0};  ///< [m] World::extent
  double origin[3] = {0, 0, 0};                       ///< [m] of the grid
  double grid_cell_size = 0;                          ///< [m]
  double cell_size = 0;                               ///< [m] that was asked for
  std::uint64_t vertices = 0, triangles = 0, lines = 0, cells = 0, objects = 0, name_bytes = 0;
  std::uint32_t leaf_size = 0, tree_levels = 0, frontier = 0, unused = 0;
};
static_assert(sizeof(WorldEnd) == 168 && sizeof(TreeHead) == 72 && sizeof(WorldObject) == 20);

struct WorldLayout {
  std::array<std::uint64_t, kWorldSections> offset{}, bytes{};
  std::uint64_t end = 0;  ///< offset of the last page
};

constexpr std::uint64_t to_page(std::uint64_t offset) {
  return (offset + kPageSize - 1) / kPageSize * kPageSize;
}

/// The heads of all trees: of the cells and of the wide triangles.
constexpr std::uint64_t head_count(const WorldEnd& end) { return end.triangles > 0 ? end.cells + 1 : 0; }

/// Counts must be under 2^40.
inline WorldLayout layout_of(const WorldEnd& end) {
  WorldLayout layout;
  layout.bytes = {8 * end.vertices,
                  8 * end.vertices,
                  8 * end.vertices,
                  4 * end.triangles,
                  4 * end.triangles,
                  4 * end.triangles,
                  sizeof(TreeLine) * end.lines,
                  8 * end.cells,
                  sizeof(TreeHead) * head_count(end),
                  sizeof(WorldObject) * end.objects,
                  end.name_bytes,
                  0};
  std::uint64_t offset = kPageSize;
  for (std::size_t section = 0; section < kWorldSections; ++section) {
    if (section == kHashes) layout.bytes[section] = 8 * ((offset + kHashPiece - 1) / kHashPiece);
    layout.offset[section] = offset;
    offset = to_page(offset + layout.bytes[section]);
  }
  layout.end = offset;
  return layout;
}

inline std::uint64_t content_of(WorldEnd end, const std::uint64_t* hashes, std::size_t count) {
  end.content = 0;
  Hasher hasher;
  hasher.bytes(&end, sizeof(end));
  hasher.bytes(hashes, count * sizeof(*hashes));
  return hasher.digest();
}

inline constexpr std::array<double Vec3::*, 3> kAxis = {&Vec3::x, &Vec3::y, &Vec3::z};

/// An array in a mapped file.
template <class T>
SharedArray<T> array_at(const std::shared_ptr<const std::byte>& file, std::uint64_t offset,
                        std::uint64_t count) {
  return {reinterpret_cast<const T*>(file.get() + offset), count, file};
}

/// The six arrays of triangles.
inline Triangles triangles_in(const WorldEnd& end, const std::shared_ptr<const std::byte>& file) {
  const WorldLayout layout = layout_of(end);
  const auto numbers = [&](WorldSection section) {
    return array_at<double>(file, layout.offset[section], end.vertices);
  };
  const auto corners = [&](WorldSection section) {
    return array_at<std::uint32_t>(file, layout.offset[section], end.triangles);
  };
  return {numbers(kX), numbers(kY), numbers(kZ), corners(kA), corners(kB), corners(kC)};
}

}  // namespace lumbrical
