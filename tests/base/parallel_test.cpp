// Work on several threads: sorting by code, the order along the Morton curve, and the same trees, grids,
// messages and ticks for any number of threads.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "base/parallel_sort.h"
#include "index/spatial_code.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "lumbrical/shapes.h"
#include "pressed_hand.h"
#include "random.h"

namespace lumbrical::test {
namespace {

std::vector<std::uint32_t> first_numbers(std::size_t count) {
  std::vector<std::uint32_t> numbers(count);
  std::iota(numbers.begin(), numbers.end(), 0u);
  return numbers;
}

std::uint64_t some_bits(Random& random, int bits) { return random.bits() & ((std::uint64_t{1} << bits) - 1); }

TEST(SortByCode, SortsCodesOfAnyWidthStablyOnAnyNumberOfThreads) {
  Random random(1);
  for (const int bits : {1, 8, 31, 32, 33, 47, 63}) {
    for (const std::size_t count : {0u, 1u, 17u, 1000u, 200000u}) {
      std::vector<std::uint64_t> codes(count);
      for (std::uint64_t& code : codes) code = some_bits(random, bits);
      // Many codes that agree in the upper half, or wholly.
      for (std::size_t i = 0; i + 1 < count; i += 3) codes[i + 1] = codes[i / 2] ^ (i % 2);
      std::vector<std::uint32_t> expected = first_numbers(count);
      std::sort(expected.begin(), expected.end(), [&](std::uint32_t a, std::uint32_t b) {
        return codes[a] != codes[b] ? codes[a] < codes[b] : a < b;
      });
      for (const std::size_t threads : {1u, 2u, 4u}) {
        std::vector<std::uint32_t> members = first_numbers(count);
        sort_by_code(members, bits, 1, threads, [&](std::uint32_t i) { return codes[i]; });
        EXPECT_EQ(members, expected) << bits << " bits, " << count << ", " << threads << " threads";
      }
    }
  }
}

TEST(SortByCode, RunsOfUpToTheGivenLengthKeepTheirOrder) {
  // Four codes agree in the upper half; a run of four is left alone, one of five is not.
  for (const std::size_t length : {4u, 5u}) {
    std::vector<std::uint32_t> members = first_numbers(length);
    sort_by_code(members, 40, 4, 1, [](std::uint32_t i) { return std::uint64_t{1} << 39 | (7 - i); });
    EXPECT_EQ(members.front(), length == 4 ? 0u : 4u);
  }
}

// Bit by bit: the definition.
bool is_before(std::array<std::uint32_t, 3> a, std::array<std::uint32_t, 3> b) {
  for (int bit = 20; bit >= 0; --bit) {
    for (std::size_t axis = 3; axis-- > 0;) {
      const std::uint32_t of_a = a[axis] >> bit & 1, of_b = b[axis] >> bit & 1;
      if (of_a != of_b) return of_a < of_b;
    }
  }
  return false;
}

TEST(SpatialCode, OrdersPointsAlongTheMortonCurve) {
  Random random(2);
  for (const Vec3 size : {Vec3{1, 1, 1}, {3, 0.2, 0.01}, {1e-3, 5, 5}, {2, 0, 1e-9}, {0, 0, 0}}) {
    const Box box{{-1, 2, 1000}, Vec3{-1, 2, 1000} + size};
    const SpatialCode code(box);
    EXPECT_LE(code.bits(), 63);
    const double longest = max(size.x, max(size.y, size.z));
    const auto cells = [&](Vec3 p) {
      const Vec3 scaled = longest > 0 ? 2097151 / longest * (p - box.lower) : Vec3{};
      return std::array{static_cast<std::uint32_t>(scaled.x), static_cast<std::uint32_t>(scaled.y),
                        static_cast<std::uint32_t>(scaled.z)};
    };
    const auto point = [&] {
      return box.lower + Vec3{size.x * random.between(0, 1), size.y * random.between(0, 1),
                              size.z * random.between(0, 1)};
    };
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p = point(), q = point();
      EXPECT_EQ(code(p) < code(q), is_before(cells(p), cells(q))) << i;
      EXPECT_LT(code(p) >> code.bits(), 1u);
    }
  }
}

bool same_lines(const SharedArray<TreeLine>& a, const SharedArray<TreeLine>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(a[0])) == 0);
}

bool same_head(const TreeHead& a, const TreeHead& b) {
  return a.origin == b.origin && a.centre == b.centre && a.radius == b.radius &&
         a.first_line == b.first_line && a.leaf_count == b.leaf_count &&
         a.blocks_per_leaf == b.blocks_per_leaf && a.level_count == b.level_count;
}

// Large enough for several pieces everywhere, with clusters far apart and triangles wider than a cell.
Scene clusters() {
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  Random random(3);
  for (int i = 0; i < 6; ++i) {
    Mesh mesh = make_height_field(0.3, 80, 0.002, 0.04);
    const Vec3 shift{random.between(-40, 40), random.between(-40, 40), random.between(-1, 1)};
    for (Vec3& p : mesh.vertices) p += shift;
    scene.objects.push_back({"cluster " + std::to_string(i), std::move(mesh)});
  }
  scene.objects.push_back({"ground", make_height_field(100, 8, 0.1, 30)});
  return scene;
}

TEST(ParallelBuild, GivesTheSameModelForAnyNumberOfThreads) {
  const Scene scene = clusters();
  for (const Broadphase broadphase : {Broadphase::tree, Broadphase::grid}) {
    for (const std::uint32_t leaf_size : {16u, 5u, 64u}) {
      Model one, many;
      Execution execution;
      execution.broadphase = broadphase;
      execution.leaf_size = leaf_size;
      ASSERT_TRUE(build_model(scene, execution, one).ok());
      for (const std::uint32_t threads : {2u, 3u, 8u}) {
        execution.threads = threads;
        ASSERT_TRUE(build_model(scene, execution, many).ok());
        EXPECT_EQ(one.triangles.x, many.triangles.x);
        EXPECT_EQ(one.triangles.c, many.triangles.c);
        EXPECT_TRUE(same_head(one.tree.head, many.tree.head) && same_lines(one.tree.lines, many.tree.lines));
        EXPECT_TRUE(same_lines(one.grid.lines, many.grid.lines));
        EXPECT_EQ(one.grid.cell, many.grid.cell);
        ASSERT_EQ(one.grid.tree.size(), many.grid.tree.size());
        for (std::size_t i = 0; i < one.grid.tree.size(); ++i)
          EXPECT_TRUE(same_head(one.grid.tree[i], many.grid.tree[i])) << i;
      }
    }
  }
}

TEST(ParallelBuild, NamesTheFirstOfManyFaultsOnAnyNumberOfThreads) {
  Scene scene = clusters();
  Mesh& mesh = scene.objects[0].mesh;
  mesh = make_height_field(0.3, 400, 0.002, 0.04);
  for (const std::uint32_t threads : {1u, 4u}) {
    Execution execution;
    execution.threads = threads;
    Model model;
    Scene broken = scene;
    for (const std::size_t i : {70001u, 90000u, 150000u})
      broken.objects[0].mesh.vertices[i].y = std::numeric_limits<double>::quiet_NaN();
    EXPECT_NE(build_model(broken, execution, model).message().find("vertex 70001 "), std::string::npos);
    broken = scene;
    for (const std::size_t i : {65537u, 300000u}) broken.objects[0].mesh.triangles[i][1] = 1u << 31;
    EXPECT_NE(build_model(broken, execution, model).message().find("triangle 65537 names vertex 2147483648"),
              std::string::npos);
  }
}

TEST(ParallelBuild, TreesTakeFewerBytesThanTheirTrianglesAllow) {
  // All included: vertices, indices, blocks, tree.
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"field", make_height_field(0.3, 300, 0.002, 0.04)});
  for (const Broadphase broadphase : {Broadphase::tree, Broadphase::grid}) {
    Execution execution;
    execution.broadphase = broadphase;
    Model model;
    ASSERT_TRUE(build_model(scene, execution, model).ok());
    const Triangles& world = model.triangles;
    const std::size_t bytes =
        24 * world.x.size() + 12 * world.a.size() + byte_count(model.tree) + byte_count(model.grid);
    EXPECT_LE(static_cast<double>(bytes) / static_cast<double>(world.size()), 50);
  }
}

TEST(ParallelTick, ThousandsOfContactsGiveTheSameBitsOnAnyNumberOfThreads) {
  const Scene scene = pressed_scene(kWidthA, 150);
  std::vector<std::uint64_t> expected;
  for (const std::uint32_t threads : {1u, 2u, 3u, 8u}) {
    Execution execution;
    execution.threads = threads;
    Model model;
    ASSERT_TRUE(build_model(scene, execution, model).ok());
    State state;
    Scratch scratch = make_scratch(model);
    std::vector<std::uint64_t> hashes;
    for (int i = 0; i < 3; ++i) {
      tick(model, state, scratch, pressed_frame(scene.hand, 0.002, i / 3.0));
      EXPECT_GT(scratch.contact_count, 2000u);
      hashes.insert(hashes.end(), scratch.stage_hash.begin(), scratch.stage_hash.end());
    }
    if (threads == 1) expected = hashes;
    EXPECT_EQ(hashes, expected) << threads << " threads";
  }
}

}  // namespace
}  // namespace lumbrical::test
