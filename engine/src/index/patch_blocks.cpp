#include "index/patch_blocks.h"

#include <algorithm>
#include <array>

#include "index/patch_cuts.h"
#include "index/triangle_bound.h"

namespace lumbrical {
namespace {

// Returns the sphere that it is searched by.
Sphere put_patch(const Corners& at, double step, Vec3 origin, std::size_t lane, PatchBlock& block,
                 PatchShape& shape) {
  const Vec3 ab = at.b - at.a, ac = at.c - at.a, area = cross(ab, ac);
  shape.corner = split_point(at.a);
  put(ab, shape.edge[0]);
  put(ac, shape.edge[1]);
  const Sphere round = sphere_round(at, origin);
  const SplitPoint centroid = split_point(at.a + (ab + ac) / 3.0);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    block.centroid[0][axis][lane] = centroid.high[axis];
    block.centroid[1][axis][lane] = centroid.low[axis];
  }
  const double radius = (1 + 1e-6) * round.radius;
  block.radius[lane] = static_cast<float>(radius);
  const Vec3 normal = area / (radius * radius);
  block.normal[0][lane] = static_cast<float>(normal.x);
  block.normal[1][lane] = static_cast<float>(normal.y);
  block.normal[2][lane] = static_cast<float>(normal.z);
  const double steps = steps_along(longest_first(at).square, norm(area), step);
  block.size[lane] = static_cast<float>(std::min<std::size_t>(steps_for(steps), kPatchSizes) - 1);
  return {round.centre, (1 + kDistanceSlack) * radius};
}

// An empty place lies where its block does.
void put_nothing(std::size_t lane, PatchBlock& block, PatchShape& shape) {
  for (auto& part : block.centroid) {
    for (auto& row : part) row[lane] = row[0];
  }
  block.radius[lane] = -1;
  block.size[lane] = 0;
  for (auto& row : block.normal) row[lane] = 0;
  shape = {};
}

}  // namespace

Sphere put_block(std::span<const Corners> patches, double step, Vec3 origin, PatchBlock& block,
                 PatchShape* shapes) {
  std::array<Sphere, PatchBlock::kWidth> spheres;
  for (std::size_t lane = 0; lane < PatchBlock::kWidth; ++lane) {
    if (lane >= patches.size()) {
      put_nothing(lane, block, shapes[lane]);
      continue;
    }
    spheres[lane] = put_patch(patches[lane], step, origin, lane, block, shapes[lane]);
  }
  return bound(std::span(spheres).first(patches.size()));
}

}  // namespace lumbrical
