#include "samples/near_skeleton.h"

namespace lumbrical {
namespace {

/// A patch's plane, seen from a body's origin. Heights above it are times the normal's length.
struct PatchPlane {
  float normal[3], origin_height, square;  // the normal's own square

  [[nodiscard]] float along(const float (&v)[3]) const {
    return normal[0] * v[0] + normal[1] * v[1] + normal[2] * v[2];
  }
  [[nodiscard]] float height(const float (&at)[3]) const { return along(at) + origin_height; }
};

PatchPlane plane_of(const PatchShape& shape, const SplitPoint& origin) {
  const float(&e)[2][3] = shape.edge;
  PatchPlane plane;
  float corner[3];
  for (std::size_t i = 0; i < 3; ++i) {
    const std::size_t j = (i + 1) % 3, k = (i + 2) % 3;
    plane.normal[i] = e[0][j] * e[1][k] - e[0][k] * e[1][j];
    corner[i] = difference(shape.corner, origin, i);
  }
  plane.origin_height = -plane.along(corner);
  plane.square = plane.along(plane.normal);
  return plane;
}

/// Heights of a skeleton's corners.
class Heights {
 public:
  explicit Heights(float first) : lowest_(first), highest_(first) {}
  void add(float height) {
    lowest_ = height < lowest_ ? height : lowest_;
    highest_ = height > highest_ ? height : highest_;
  }
  [[nodiscard]] bool clear_by(float distance, const PatchPlane& plane) const {
    const float nearest = lowest_ > 0 ? lowest_ : -highest_;
    return nearest > 0 && nearest * nearest >= distance * distance * plane.square;
  }

 private:
  float lowest_, highest_;
};

bool is_clear(const PatchPlane& plane, const TileFrame& tile) {
  const float centre = plane.height(tile.origin);
  Heights heights(centre);
  heights.add(centre + tile.length * plane.along(tile.axis[0]));
  return heights.clear_by(kClearOfPlane * tile.radius, plane);
}

// Of every tile that may share patches of that kind.
bool is_clear(const PatchPlane& plane, const FingerBody& finger, std::uint32_t kind) {
  for (std::size_t k = 0; k < sharers_of(kind); ++k) {
    if (!is_clear(plane, finger.tile[kTileOfKind[kind] + k])) return false;
  }
  return true;
}

bool is_clear(const PatchPlane& plane, const PalmBody& palm, std::uint32_t) {
  const float x = plane.along(palm.axis[0]), y = plane.along(palm.axis[1]);
  const auto height = [&](std::size_t k) {
    return palm.edge[k].x * x + palm.edge[k].y * y + plane.origin_height;
  };
  Heights heights(height(0));
  for (std::size_t k = 1; k < palm.corner_count; ++k) heights.add(height(k));
  return heights.clear_by(kClearOfPlane * palm.radius, plane);
}

template <class Body>
std::size_t leave_near_of(const PatchShape* shapes, const SplitPoint& origin, const Body& body,
                          FoundPatches* found, std::size_t count) {
  constexpr std::uint32_t kFirstNear = kPatchSizes * kind::kCount;
  for (std::size_t i = 0, end = count; i < end; ++i) {
    FoundPatches& near = found[i];
    if (near.key < kFirstNear) continue;
    unsigned clear = 0;
    for_numbers(near.lanes, [&](std::size_t lane) {
      const PatchPlane plane = plane_of(shapes[near.block * PatchBlock::kWidth + lane], origin);
      clear |= static_cast<unsigned>(is_clear(plane, body, kind_of(near))) << lane;
    });
    const auto key = static_cast<std::uint16_t>(near.key - kFirstNear);
    if (clear == near.lanes) {
      near.key = key;
    } else if (clear != 0) {
      near.lanes = static_cast<std::uint16_t>(near.lanes & ~clear);
      found[count++] = {key, static_cast<std::uint16_t>(clear), near.block};
    }
  }
  return count;
}

}  // namespace

std::size_t leave_near(const PatchShape* shapes, const SplitPoint& origin, const FingerBody& finger,
                       FoundPatches* found, std::size_t count) {
  return leave_near_of(shapes, origin, finger, found, count);
}
std::size_t leave_near(const PatchShape* shapes, const SplitPoint& origin, const PalmBody& palm,
                       FoundPatches* found, std::size_t count) {
  return leave_near_of(shapes, origin, palm, found, count);
}

}  // namespace lumbrical
