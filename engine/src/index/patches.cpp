#include "index/patches.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "base/parallel.h"
#include "base/parallel_sort.h"
#include "index/spatial_code.h"
#include "index/sphere_tree.h"
#include "model/corners.h"

namespace lumbrical {
namespace {

// [R] Longest step of a lattice at a precision of 1e-4 of the hand's force, for the last phalanx of a finger,
// which often is alone in touching, and for the others, whose errors average out. Measured:
// docs/mechanics.md; a user measures his own scene with `lumbrical run --compare-precision`. The error falls
// with the step's fourth power.
constexpr double kTipStep = 0.19, kStep = 0.30;

// [R] Largest radius of a block that is taken as one at a precision of 1e-4; the error falls with its third
// power.
constexpr double kBlockRadius = 0.45;

// A triangle cut into more than the square of this is left to the exact rung.
constexpr std::uint32_t kMostCuts = 16;

// Patches there may be beside one per triangle: about a quarter of a gigabyte.
constexpr std::size_t kSparePatches = std::size_t{1} << 22;

constexpr std::size_t kPiece = 4096;  // triangles or patches, the least that is worth another thread

// By Newton's method, since the C library's differs between machines.
double cube_root(double x) {
  double root = max(x, 1);
  for (int i = 0; i < 60; ++i) root = (2 * root + x / (root * root)) / 3;
  return root;
}

double radius_of(const Hand& hand, std::size_t segment) {
  if (segment == kPalmSegment) return 0.5 * hand.palm.thickness;
  const auto [base, tip] = kPhalanxJoints[segment];
  return min(hand.radius[base], hand.radius[tip]);
}

double step_of(const Hand& hand, const Settings& settings, std::size_t segment) {
  const double share = std::sqrt(std::sqrt(settings.precision[segment] / 1e-4));
  const bool is_tip = segment != kPalmSegment && segment % 3 == 2;
  return (is_tip ? kTipStep : kStep) * share * radius_of(hand, segment);
}

double block_radius_of(const Hand& hand, const Settings& settings, std::size_t segment) {
  return kBlockRadius * cube_root(settings.precision[segment] / 1e-4) * radius_of(hand, segment);
}

std::size_t class_for(double steps) {
  std::size_t k = 0;
  while (k + 1 < kPatchSizes && kLatticeSteps[k] < steps) ++k;
  return k;
}

// [m] The longest edge, but for slivers: of those many lie side by side, and their errors average out.
double size_of(const Corners& at) {
  const Vec3 ab = at.b - at.a, ac = at.c - at.a, bc = at.c - at.b;
  const double longest = std::sqrt(max(dot(ab, ab), max(dot(ac, ac), dot(bc, bc))));
  const double width = std::sqrt(2 * norm(cross(ab, ac)));
  return std::sqrt(longest * width);
}

// Into how many rows a triangle is cut.
std::uint32_t cuts_of(const Corners& at, double step) {
  const double cuts = std::ceil(size_of(at) / (step * kLatticeSteps.back()));
  return static_cast<std::uint32_t>(clamp(cuts, 1, 1e6));
}

bool has_area(const Corners& at) {
  const double area = norm(cross(at.b - at.a, at.c - at.a));
  return area > 0 && is_finite(area);
}

// Part `part` of `cuts` squared: rows parallel to the edge across from the first corner, from there on.
Corners part_of(const Corners& at, std::uint32_t cuts, std::uint32_t part) {
  std::uint32_t row = 0;
  while ((row + 1) * (row + 1) <= part) ++row;
  const std::uint32_t place = part - row * row, across = place / 2;
  const bool upside_down = place % 2 != 0;
  const double i = row - across, j = across + (upside_down ? 1 : 0),
               share = (upside_down ? -1.0 : 1.0) / cuts;
  const Vec3 ab = at.b - at.a, ac = at.c - at.a;
  const Vec3 corner = at.a + (i / cuts) * ab + (j / cuts) * ac;
  return {corner, corner + share * ab, corner + share * ac};
}

/// What becomes of the triangles.
struct Cutting {
  double step = 0;          // [m] the finest there is
  double block_radius = 0;  // [m] of the largest block that is taken as one
  std::uint32_t most_cuts = kMostCuts;
  std::vector<std::uint32_t> owner;  // of each patch
  std::vector<std::uint8_t> part;    // of its triangle, of each patch
};

std::size_t count_patches(const Triangles& triangles, double step, std::uint32_t most_cuts,
                          std::size_t threads) {
  std::vector<std::size_t> counts(piece_count(triangles.size(), kPiece));
  parallel_pieces(triangles.size(), kPiece, threads,
                  [&](std::size_t piece, std::size_t first, std::size_t last) {
                    std::size_t count = 0;
                    for (std::size_t i = first; i < last; ++i) {
                      const Corners at = corners_of(triangles, static_cast<std::uint32_t>(i));
                      const std::uint32_t cuts = cuts_of(at, step);
                      if (cuts <= most_cuts && has_area(at)) count += std::size_t{cuts} * cuts;
                    }
                    counts[piece] = count;
                  });
  std::size_t total = 0;
  for (const std::size_t count : counts) total += count;
  return total;
}

// The largest triangles go to the exact rung where patches would take too much memory.
Cutting cut_triangles(const Triangles& triangles, double step, double block_radius,
                      const Execution& execution, Patches& patches) {
  Cutting cutting;
  cutting.step = step;
  cutting.block_radius = block_radius;
  std::size_t total = count_patches(triangles, step, cutting.most_cuts, execution.threads);
  while (cutting.most_cuts > 1 && total > triangles.size() + kSparePatches) {
    cutting.most_cuts /= 2;
    total = count_patches(triangles, step, cutting.most_cuts, execution.threads);
  }
  cutting.owner.reserve(total);
  cutting.part.reserve(total);
  patches.is_sampled.resize(piece_count(triangles.size(), 64));
  for (std::uint32_t i = 0; i < triangles.size(); ++i) {
    const Corners at = corners_of(triangles, i);
    const std::uint32_t cuts = cuts_of(at, step);
    if (cuts > cutting.most_cuts) {
      patches.exact.push_back(i);
      continue;
    }
    patches.is_sampled[i / 64] |= std::uint64_t{1} << i % 64;
    if (!has_area(at)) continue;
    for (std::uint32_t part = 0; part < cuts * cuts; ++part) {
      cutting.owner.push_back(i);
      cutting.part.push_back(static_cast<std::uint8_t>(part));
    }
  }
  return cutting;
}

struct Patch {
  Corners at;
  std::uint32_t owner;
  std::size_t size;
};

Patch patch_of(const Triangles& triangles, const Cutting& cutting, std::uint32_t number) {
  const std::uint32_t owner = cutting.owner[number];
  const Corners whole = corners_of(triangles, owner);
  const std::uint32_t cuts = cuts_of(whole, cutting.step);
  const Corners at = cuts == 1 ? whole : part_of(whole, cuts, cutting.part[number]);
  return {at, owner, class_for(size_of(whole) / (cutting.step * cuts))};
}

Sphere sphere_round(const Corners& at, Vec3 origin) {
  const Vec3 a = at.a - origin, ab = at.b - at.a, ac = at.c - at.a, from_centre = (ab + ac) / 3.0;
  const Vec3 b = ab - from_centre, c = ac - from_centre;
  return {a + from_centre, std::sqrt(max(dot(from_centre, from_centre), max(dot(b, b), dot(c, c))))};
}

void put_patch(const Patch& patch, std::size_t lane, PatchBlock& block) {
  const double corner[3] = {patch.at.a.x, patch.at.a.y, patch.at.a.z};
  const Vec3 edge[2] = {patch.at.b - patch.at.a, patch.at.c - patch.at.a};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [high, low] = split_number(corner[axis]);
    block.corner[0][axis][lane] = high;
    block.corner[1][axis][lane] = low;
  }
  for (std::size_t k = 0; k < 2; ++k) {
    block.edge[k][0][lane] = static_cast<float>(edge[k].x);
    block.edge[k][1][lane] = static_cast<float>(edge[k].y);
    block.edge[k][2][lane] = static_cast<float>(edge[k].z);
  }
  block.radius[lane] = static_cast<float>((1 + 1e-6) * sphere_round(patch.at, patch.at.a).radius);
  block.owner[lane] = patch.owner;
  block.size[lane] = static_cast<std::uint8_t>(patch.size);
}

// An empty place lies where its block does.
void put_nothing(std::size_t lane, PatchBlock& block) {
  for (auto& part : block.corner) {
    for (auto& row : part) row[lane] = row[0];
  }
  for (auto& edge : block.edge) {
    for (auto& row : edge) row[lane] = 0;
  }
  block.radius[lane] = -1;
  block.owner[lane] = block.owner[0];
  block.size[lane] = 0;
}

// Integrals over a block's patches, h counted from the centre.
struct BlockMoments {
  Vec3 centre;                   // [m] W, of the area
  double area = 0;               // [m^2] twice
  Vec3 normal;                   // [m^2] of n, twice
  std::array<Vec3, 3> spread{};  // [m^4] rows of the area's h h, twice
};

Vec3 row_of(const Vec3 (&h)[4], double Vec3::*axis, double twice_area) {
  // Of a triangle: corners by a twelfth, the centroid by nine.
  return (twice_area / 12) *
         (h[0].*axis * h[0] + h[1].*axis * h[1] + h[2].*axis * h[2] + 9 * (h[3].*axis) * h[3]);
}

BlockMoments moments_of(std::span<const Patch> patches) {
  BlockMoments m;
  const Vec3 origin = patches[0].at.a;
  Vec3 first;
  for (const auto& [at, owner, size] : patches) {
    const Vec3 normal = cross(at.b - at.a, at.c - at.a);
    const double area = norm(normal);
    m.area += area;
    m.normal += normal;
    first += area * ((at.a - origin) + ((at.b - at.a) + (at.c - at.a)) / 3.0);
  }
  m.centre = origin + first / m.area;
  for (const auto& [at, owner, size] : patches) {
    const Vec3 a = at.a - m.centre, b = a + (at.b - at.a), c = a + (at.c - at.a);
    const Vec3 h[4] = {a, b, c, a + ((b - a) + (c - a)) / 3.0};
    const double area = norm(cross(b - a, c - a));
    m.spread[0] += row_of(h, &Vec3::x, area);
    m.spread[1] += row_of(h, &Vec3::y, area);
    m.spread[2] += row_of(h, &Vec3::z, area);
  }
  return m;
}

// Principal directions of the spread within the plane across `normal`, and that.
std::array<Vec3, 3> axes_of(const BlockMoments& m) {
  const Vec3 z = unit_or(m.normal, {0, 0, 1});
  const Vec3 x = unit_or(cross(z, std::fabs(z.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}), {1, 0, 0}),
             y = cross(z, x);
  const auto along = [&](Vec3 u, Vec3 v) {
    return dot(u, Vec3{dot(m.spread[0], v), dot(m.spread[1], v), dot(m.spread[2], v)});
  };
  const double a = along(x, x), b = along(x, y), d = along(y, y), half = 0.5 * (a - d);
  const double root = std::sqrt(half * half + b * b);
  // Of the two ways to write the larger one's direction the one that does not cancel.
  const Vec3 u = unit_or(half > 0 ? (half + root) * x + b * y : b * x + (root - half) * y, x);
  return {u, cross(z, u), z};
}

void put(Vec3 v, float (&to)[3]) {
  to[0] = static_cast<float>(v.x);
  to[1] = static_cast<float>(v.y);
  to[2] = static_cast<float>(v.z);
}

BlockSamples samples_of(std::span<const Patch> patches, double largest_radius) {
  const BlockMoments m = moments_of(patches);
  BlockSamples samples{};
  const double centre[3] = {m.centre.x, m.centre.y, m.centre.z};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [high, low] = split_number(centre[axis]);
    samples.centre[0][axis] = high;
    samples.centre[1][axis] = low;
  }
  double radius = 0;
  for (const Patch& patch : patches) {
    for (const Vec3 corner : {patch.at.a, patch.at.b, patch.at.c})
      radius = max(radius, norm(corner - m.centre));
  }
  samples.radius = static_cast<float>((1 + 1e-6) * radius);
  samples.is_small = radius <= largest_radius ? 1.0f : 0.0f;
  const std::array<Vec3, 3> axes = axes_of(m);
  Vec3 rest = m.normal;
  for (std::size_t k = 0; k < 3; ++k) {
    const Vec3 axis = axes[k];
    const double spread =
        dot(axis, Vec3{dot(m.spread[0], axis), dot(m.spread[1], axis), dot(m.spread[2], axis)}) / m.area;
    // As far out as Gauss's rule has its nodes.
    const double length = max(std::sqrt(3 * max(spread, 0)), 1e-3 * radius);
    Vec3 first, second;
    for (const auto& [at, owner, size] : patches) {
      const Vec3 normal = cross(at.b - at.a, at.c - at.a);
      const double a = dot(axis, at.a - m.centre), b = dot(axis, at.b - m.centre),
                   c = dot(axis, at.c - m.centre);
      const double middle = (a + b + c) / 3;
      first += middle * normal;
      second += ((a * a + b * b + c * c + 9 * middle * middle) / 12) * normal;
    }
    put(length * axis, samples.arm[k]);
    const Vec3 even = (0.5 / (length * length)) * second, odd = (0.5 / length) * first;
    put(even + odd, samples.weight[0][k]);
    put(even - odd, samples.weight[1][k]);
    rest -= 2.0 * even;
  }
  put(rest, samples.centre_weight);
  return samples;
}

Box box_of(const Triangles& triangles) {
  Box box;
  for (std::size_t i = 0; i < triangles.x.size(); ++i)
    box.add({triangles.x[i], triangles.y[i], triangles.z[i]});
  return box;
}

void put_blocks(const Triangles& triangles, const Cutting& cutting, const Execution& execution,
                Patches& patches) {
  constexpr std::uint32_t kWidth = PatchBlock::kWidth;
  const Box box = box_of(triangles);
  const Vec3 origin = box.middle();
  std::vector<std::uint32_t> order(cutting.owner.size());
  for (std::uint32_t i = 0; i < order.size(); ++i) order[i] = i;
  const SpatialCode code({box.lower - origin, box.upper - origin});
  sort_by_code(order, code.bits(), kWidth, execution.threads, [&](std::uint32_t number) {
    return code(sphere_round(patch_of(triangles, cutting, number).at, origin).centre);
  });
  std::vector<PatchBlock> blocks(piece_count(order.size(), kWidth));
  std::vector<BlockSamples> samples(blocks.size());
  std::vector<Sphere> leaves(blocks.size());
  parallel_pieces(blocks.size(), kPiece / kWidth, execution.threads,
                  [&](std::size_t, std::size_t first, std::size_t last) {
                    for (std::size_t i = first; i < last; ++i) {
                      const std::size_t begin = i * kWidth,
                                        count = std::min<std::size_t>(kWidth, order.size() - begin);
                      std::array<Sphere, kWidth> spheres;
                      std::array<Patch, kWidth> members;
                      for (std::size_t lane = 0; lane < kWidth; ++lane) {
                        if (lane >= count) {
                          put_nothing(lane, blocks[i]);
                          continue;
                        }
                        members[lane] = patch_of(triangles, cutting, order[begin + lane]);
                        put_patch(members[lane], lane, blocks[i]);
                        spheres[lane] = sphere_round(members[lane].at, origin);
                      }
                      leaves[i] = bound({spheres.data(), count});
                      samples[i] = samples_of({members.data(), count}, cutting.block_radius);
                    }
                  });
  patches.block = std::move(blocks);
  patches.samples = std::move(samples);
  patches.tree = build_levels(std::move(leaves), origin, execution);
}

}  // namespace

bool is_sampled(const Settings& settings, std::size_t segment) {
  return settings.law[segment] == Law::field && settings.precision[segment] > 0;
}

std::shared_ptr<const Patches> build_patches(const Hand& hand, const Settings& settings,
                                             const Triangles& triangles, const Execution& execution) {
  double finest = std::numeric_limits<double>::infinity(), block_radius = finest;
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if (!is_sampled(settings, i)) continue;
    finest = min(finest, step_of(hand, settings, i));
    block_radius = min(block_radius, block_radius_of(hand, settings, i));
  }
  if (!is_finite(finest)) return nullptr;
  auto patches = std::make_shared<Patches>();
  for (std::size_t i = 0; i < kSegmentCount; ++i) {
    if (!is_sampled(settings, i)) continue;
    patches->step[i] = step_of(hand, settings, i);
    const double share = finest / patches->step[i];
    for (std::size_t k = 0; k < kPatchSizes; ++k)
      patches->steps[i][k] = kLatticeSteps[class_for(share * kLatticeSteps[k])];
  }
  const Cutting cutting = cut_triangles(triangles, finest, block_radius, execution, *patches);
  put_blocks(triangles, cutting, execution, *patches);
  return patches;
}

}  // namespace lumbrical
