#include "index/cluster_tree.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "base/parallel.h"
#include "index/triangle_bound.h"
#include "model/corners.h"

namespace lumbrical {
namespace {

constexpr std::uint32_t kLeafSize = ClusterTree::kLeafSize, kWidth = ClusterBlock::kWidth;
constexpr std::uint32_t kFewEnough = 16;

// Lengths kept in single precision are made longer by this share, so that they stay bounds.
constexpr double kLonger = 1 + 1e-6;

// Clusters of up to 8 x 4^3 triangles are measured, larger ones told from their parts.
constexpr std::size_t kMeasured = 3;

// Axes of the six second moments.
constexpr int kPair[6][2] = {{0, 0}, {0, 1}, {0, 2}, {1, 1}, {1, 2}, {2, 2}};

// A cluster before it is rounded; moments about its centre.
struct Cluster {
  Vec3 centre;
  double radius = 0, area = 0, thickness = 0, edge = 0;
  Vec3 box;  // no corner is farther along an axis
  Vec3 normal, first[3], second[6];
};

Vec3 most_of(Vec3 a, Vec3 b) { return {max(a.x, b.x), max(a.y, b.y), max(a.z, b.z)}; }
Vec3 size_of(Vec3 v) { return {std::fabs(v.x), std::fabs(v.y), std::fabs(v.z)}; }

double part(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

Vec3 rounded(Vec3 v) { return {static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)}; }

Vec3 mean_normal(const Cluster& cluster) {
  const double size = norm(cluster.normal);
  return size > 1e-6 * cluster.area ? cluster.normal / size : Vec3{};
}

// Corners relative to the cluster's centre.
void add_triangle(const Vec3 (&corner)[3], Cluster& cluster) {
  const Vec3 area = 0.5 * cross(corner[1] - corner[0], corner[2] - corner[0]);
  const Vec3 sum = corner[0] + corner[1] + corner[2];
  cluster.area += norm(area);
  cluster.normal += area;
  for (int j = 0; j < 3; ++j) cluster.first[j] += (part(sum, j) / 3) * area;
  for (int m = 0; m < 6; ++m) {
    const auto [j, k] = kPair[m];
    double product = part(sum, j) * part(sum, k);
    for (const Vec3 p : corner) product += part(p, j) * part(p, k);
    cluster.second[m] += (product / 12) * area;
  }
}

// The moments of a part, moved to the centre of the whole.
void add_part(const Cluster& from, Cluster& to) {
  const Vec3 d = from.centre - to.centre;
  to.area += from.area;
  to.normal += from.normal;
  for (int j = 0; j < 3; ++j) to.first[j] += from.first[j] + part(d, j) * from.normal;
  for (int m = 0; m < 6; ++m) {
    const auto [j, k] = kPair[m];
    to.second[m] += from.second[m] + part(d, j) * from.first[k] + part(d, k) * from.first[j] +
                    (part(d, j) * part(d, k)) * from.normal;
  }
}

// Corners of the cluster's triangles relative to its centre: how far they reach, exactly.
void measure(const Triangles& triangles, Vec3 origin, std::span<const std::uint32_t> members,
             Cluster& cluster) {
  cluster.radius = cluster.thickness = cluster.edge = 0;
  cluster.box = {};
  const Vec3 n = mean_normal(cluster), centre = origin + cluster.centre;
  double farthest = 0, longest = 0;  // squares
  for (const std::uint32_t t : members) {
    const Vec3 corner[] = {triangles.vertex(triangles.a[t]) - centre,
                           triangles.vertex(triangles.b[t]) - centre,
                           triangles.vertex(triangles.c[t]) - centre};
    for (int k = 0; k < 3; ++k) {
      const Vec3 p = corner[k], edge = corner[(k + 1) % 3] - p;
      farthest = max(farthest, dot(p, p));
      longest = max(longest, dot(edge, edge));
      cluster.thickness = max(cluster.thickness, std::fabs(dot(p, n)));
      cluster.box = most_of(cluster.box, size_of(p));
    }
  }
  cluster.radius = std::sqrt(farthest);
  cluster.edge = std::sqrt(longest);
}

Cluster leaf_of(const Triangles& triangles, Vec3 origin, std::span<const std::uint32_t> members) {
  Vec3 corner[kLeafSize][3];
  Vec3 weighted, mean;
  double area = 0;
  for (std::size_t i = 0; i < members.size(); ++i) {
    const auto [a, b, c] = corners_of(triangles, members[i]);
    corner[i][0] = a - origin;
    corner[i][1] = b - origin;
    corner[i][2] = c - origin;
    const Vec3 middle = (corner[i][0] + corner[i][1] + corner[i][2]) / 3;
    const double size = 0.5 * norm(cross(corner[i][1] - corner[i][0], corner[i][2] - corner[i][0]));
    weighted += size * middle;
    mean += middle / static_cast<double>(members.size());
    area += size;
  }
  Cluster leaf;
  leaf.centre = rounded(area > 0 ? weighted / area : mean);
  for (std::size_t i = 0; i < members.size(); ++i) {
    for (Vec3& p : corner[i]) p = p - leaf.centre;
    add_triangle(corner[i], leaf);
  }
  measure(triangles, origin, members, leaf);
  return leaf;
}

// With n the parent's mean normal a corner h of a child is no farther along it than the child's centre, its
// own thickness and what the angle between the normals makes of its radius.
Cluster joined(std::span<const Cluster> parts) {
  Vec3 weighted, mean;
  double area = 0;
  for (const Cluster& c : parts) {
    weighted += c.area * c.centre;
    mean += c.centre / static_cast<double>(parts.size());
    area += c.area;
  }
  Cluster whole;
  whole.centre = rounded(area > 0 ? weighted / area : mean);
  for (const Cluster& c : parts) {
    add_part(c, whole);
    whole.radius = max(whole.radius, norm(c.centre - whole.centre) + c.radius);
    whole.box = most_of(whole.box, size_of(c.centre - whole.centre) + c.box);
    whole.edge = max(whole.edge, c.edge);
  }
  const Vec3 n = mean_normal(whole);
  for (const Cluster& c : parts) {
    const double turned = norm(n - mean_normal(c)) * c.radius;
    whole.thickness = max(whole.thickness,
                          std::fabs(dot(c.centre - whole.centre, n)) + min(c.radius, c.thickness + turned));
  }
  return whole;
}

void put_vector(Vec3 v, float (&to)[3]) {
  to[0] = static_cast<float>(v.x);
  to[1] = static_cast<float>(v.y);
  to[2] = static_cast<float>(v.z);
}

void put_cluster(const Cluster& cluster, std::uint32_t number, ClusterTree& tree) {
  ClusterBlock& block = tree.block[number / kWidth];
  const std::size_t lane = number % kWidth;
  const Vec3 n = mean_normal(cluster);
  block.x[lane] = static_cast<float>(cluster.centre.x);
  block.y[lane] = static_cast<float>(cluster.centre.y);
  block.z[lane] = static_cast<float>(cluster.centre.z);
  block.r[lane] = static_cast<float>(kLonger * cluster.radius);
  block.nx[lane] = static_cast<float>(n.x);
  block.ny[lane] = static_cast<float>(n.y);
  block.nz[lane] = static_cast<float>(n.z);
  // The normal is rounded as well.
  block.thickness[lane] = static_cast<float>(kLonger * (cluster.thickness + 1e-6 * cluster.radius));
  block.bx[lane] = static_cast<float>(kLonger * cluster.box.x);
  block.by[lane] = static_cast<float>(kLonger * cluster.box.y);
  block.bz[lane] = static_cast<float>(kLonger * cluster.box.z);
  block.edge[lane] = static_cast<float>(kLonger * cluster.edge);
  ClusterMoments& moments = tree.moments[number];
  put_vector(cluster.normal, moments.normal);
  for (int j = 0; j < 3; ++j) put_vector(cluster.first[j], moments.first[j]);
  for (int m = 0; m < 6; ++m) put_vector(cluster.second[m], moments.second[m]);
  moments.area = static_cast<float>(cluster.area);
}

Vec3 vector_of(const float (&v)[3]) { return {v[0], v[1], v[2]}; }

// A cluster as it was rounded.
Cluster get_cluster(const ClusterTree& tree, std::uint32_t number) {
  const ClusterBlock& block = tree.block[number / kWidth];
  const std::size_t lane = number % kWidth;
  const ClusterMoments& moments = tree.moments[number];
  Cluster cluster;
  cluster.centre = {block.x[lane], block.y[lane], block.z[lane]};
  cluster.radius = block.r[lane];
  cluster.thickness = block.thickness[lane];
  cluster.box = {block.bx[lane], block.by[lane], block.bz[lane]};
  cluster.edge = block.edge[lane];
  cluster.area = moments.area;
  cluster.normal = vector_of(moments.normal);
  for (int j = 0; j < 3; ++j) cluster.first[j] = vector_of(moments.first[j]);
  for (int m = 0; m < 6; ++m) cluster.second[m] = vector_of(moments.second[m]);
  return cluster;
}

LeafCorners corners_of_leaf(const Triangles& triangles, Vec3 centre, std::span<const std::uint32_t> members) {
  LeafCorners corners;
  for (std::size_t k = 0; k < kLeafSize; ++k) {
    const std::uint32_t t = members[k < members.size() ? k : 0], a = triangles.a[t];
    const bool there = k < members.size();
    const std::uint32_t vertex[] = {a, there ? triangles.b[t] : a, there ? triangles.c[t] : a};
    for (std::size_t c = 0; c < 3; ++c) {
      const Vec3 p = triangles.vertex(vertex[c]) - centre;
      for (int axis = 0; axis < 3; ++axis) corners.at[c][axis][k] = static_cast<float>(part(p, axis));
    }
  }
  return corners;
}

struct Member {
  Vec3 centre;
  std::uint32_t triangle;
};

// Members of a cluster to be; `capacity` is a cluster's size that holds them.
struct Group {
  std::span<Member> members;
  std::size_t capacity;
  [[nodiscard]] bool is_leaf() const { return capacity <= kLeafSize; }
};

// A group with the least capacity that will do.
Group group_of(std::span<Member> members, std::size_t capacity) {
  while (capacity / 2 >= members.size() && capacity > kLeafSize) capacity /= 2;
  return {members, capacity};
}

template <double Vec3::*Axis>
void part_at_half(const Group& group) {
  std::nth_element(group.members.begin(),
                   group.members.begin() + static_cast<std::ptrdiff_t>(group.capacity / 2),
                   group.members.end(), [](const Member& a, const Member& b) {
                     const double at = a.centre.*Axis, bt = b.centre.*Axis;
                     return at != bt ? at < bt : a.triangle < b.triangle;
                   });
}

// Halves a group across the longest side of the box round it; the first half is full. A tie goes by the
// triangle's number.
std::array<Group, 2> halves_of(const Group& group) {
  Box box;
  for (const Member& member : group.members) box.add(member.centre);
  const Vec3 size = box.upper - box.lower;
  if (size.x >= size.y && size.x >= size.z) {
    part_at_half<&Vec3::x>(group);
  } else if (size.y >= size.z) {
    part_at_half<&Vec3::y>(group);
  } else {
    part_at_half<&Vec3::z>(group);
  }
  const std::size_t half = group.capacity / 2;
  return {group_of(group.members.subspan(0, half), half), group_of(group.members.subspan(half), half)};
}

// Halves a group again and again, so that every cluster of every size is compact; a curve through space would
// leave clusters that jump.
void sort_for_clusters(const Group& group) {
  if (group.is_leaf()) {
    std::sort(group.members.begin(), group.members.end(),
              [](const Member& a, const Member& b) { return a.triangle < b.triangle; });
    return;
  }
  for (const Group& half : halves_of(group)) sort_for_clusters(half);
}

// Groups of the same members that are halved by a thread each. A half does not depend on what becomes of the
// other.
constexpr std::size_t kGroups = 64, kLeastGroup = 4096;

void sort_for_clusters(const Group& group, std::size_t threads) {
  std::vector<Group> groups{group};
  while (threads > 1 && groups.size() < kGroups && groups[0].capacity > kLeastGroup) {
    std::vector<Group> next(2 * groups.size());
    parallel_chunks(groups.size(), 1, threads, [&](std::size_t first, std::size_t last) {
      for (std::size_t i = first; i < last; ++i) {
        const auto [one, other] = halves_of(groups[i]);
        next[2 * i] = one;
        next[2 * i + 1] = other;
      }
    });
    groups = std::move(next);
  }
  parallel_chunks(groups.size(), 1, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) sort_for_clusters(groups[i]);
  });
}

std::vector<std::uint32_t> ordered_for_clusters(const Triangles& triangles, Vec3 origin,
                                                std::size_t threads) {
  std::vector<Member> members(triangles.size());
  std::vector<std::uint32_t> order(members.size());
  parallel_chunks(members.size(), 4096, threads, [&](std::size_t first, std::size_t last) {
    for (std::size_t i = first; i < last; ++i) {
      const auto triangle = static_cast<std::uint32_t>(i);
      members[i] = {bound_triangle(triangles, triangle, origin).centre, triangle};
    }
  });
  std::size_t capacity = kLeafSize;
  while (capacity < members.size()) capacity *= 2;
  sort_for_clusters(group_of(members, capacity), threads);
  for (std::size_t i = 0; i < order.size(); ++i) order[i] = members[i].triangle;
  return order;
}

constexpr std::uint32_t up_to_block(std::uint32_t count) { return (count + kWidth - 1) / kWidth * kWidth; }

// Where the clusters of each size start, and how many there are.
std::vector<std::uint32_t> count_clusters(std::uint32_t triangles, std::vector<std::uint32_t>& level) {
  std::vector<std::uint32_t> counts{(triangles + kLeafSize - 1) / kLeafSize};
  while (counts.back() > kFewEnough) counts.push_back((counts.back() + kWidth - 1) / kWidth);
  level.assign(1, 0);
  for (const std::uint32_t count : counts) level.push_back(level.back() + up_to_block(count));
  return counts;
}

}  // namespace

ClusterTree build_clusters(const Triangles& triangles, const Execution& execution) {
  ClusterTree tree;
  const auto triangle_count = static_cast<std::uint32_t>(triangles.size());
  Box corners;
  for (const std::uint32_t vertex : triangles.a) corners.add(triangles.vertex(vertex));
  tree.origin = corners.middle();
  tree.triangle = ordered_for_clusters(triangles, tree.origin, execution.threads);

  const std::vector<std::uint32_t> counts = count_clusters(triangle_count, tree.level);
  ClusterBlock empty;
  empty.r.fill(-1);
  tree.block.assign(tree.level.back() / kWidth, empty);
  tree.moments.resize(tree.level.back());
  tree.corners.resize(counts[0]);
  // Chunks of whole blocks: every chunk writes to its own.
  parallel_chunks((counts[0] + kWidth - 1) / kWidth, 1024, execution.threads,
                  [&](std::size_t first, std::size_t last) {
                    const auto end = std::min(static_cast<std::uint32_t>(last) * kWidth, counts[0]);
                    for (auto i = static_cast<std::uint32_t>(first) * kWidth; i < end; ++i) {
                      const std::span members = triangles_of(tree, i);
                      const Cluster leaf = leaf_of(triangles, tree.origin, members);
                      put_cluster(leaf, i, tree);
                      tree.corners[i] = corners_of_leaf(triangles, tree.origin + leaf.centre, members);
                    }
                  });
  for (std::size_t size = 1; size < counts.size(); ++size) {
    parallel_chunks(counts[size], 1024, execution.threads, [&](std::size_t begin, std::size_t end) {
      for (auto i = static_cast<std::uint32_t>(begin); i < end; ++i) {
        Cluster parts[kWidth];
        const std::uint32_t first = i * kWidth, count = std::min(kWidth, counts[size - 1] - first);
        for (std::uint32_t k = 0; k < count; ++k)
          parts[k] = get_cluster(tree, tree.level[size - 1] + first + k);
        Cluster whole = joined({parts, count});
        const std::uint32_t number = tree.level[size] + i;
        if (size <= kMeasured) measure(triangles, tree.origin, triangles_of(tree, number), whole);
        put_cluster(whole, number, tree);
      }
    });
  }
  if (execution.broadphase != Broadphase::tree) {
    tree.place.resize(triangle_count);
    for (std::uint32_t i = 0; i < triangle_count; ++i) tree.place[tree.triangle[i]] = i;
  }
  return tree;
}

std::span<const std::uint32_t> triangles_of(const ClusterTree& tree, std::uint32_t cluster) {
  std::size_t level = 0, size = kLeafSize;
  for (; cluster >= tree.level[level + 1]; ++level) size *= kWidth;
  const std::size_t first = (cluster - tree.level[level]) * size;
  return {tree.triangle.data() + first, std::min(size, tree.triangle.size() - first)};
}

std::size_t byte_count(const ClusterTree& tree) {
  return (tree.triangle.size() + tree.place.size() + tree.level.size()) * sizeof(std::uint32_t) +
         tree.block.size() * sizeof(ClusterBlock) + tree.moments.size() * sizeof(ClusterMoments) +
         tree.corners.size() * sizeof(LeafCorners);
}

}  // namespace lumbrical
