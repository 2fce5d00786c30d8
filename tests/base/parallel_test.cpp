// Work on several threads: sorting by code, the order in space, and the same trees, grids, messages and ticks
// for any number of threads.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <numeric>

#include "base/parallel_sort.h"
#include "index/spatial_order.h"
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
        sort_by_code(members, bits, threads, [&](std::uint32_t i) { return codes[i]; });
        EXPECT_EQ(members, expected) << bits << " bits, " << count << ", " << threads << " threads";
      }
    }
  }
}

// By the definition: sorted whole, and halved.
void order_slowly(std::span<PlacedNumber> numbers, std::size_t run) {
  const auto by_number = [](const PlacedNumber& a, const PlacedNumber& b) { return a.number < b.number; };
  if (numbers.size() <= run) return std::sort(numbers.begin(), numbers.end(), by_number);
  std::int32_t side[3];
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto [low, high] =
        std::minmax_element(numbers.begin(), numbers.end(),
                            [axis](const auto& a, const auto& b) { return a.cell[axis] < b.cell[axis]; });
    side[axis] = high->cell[axis] - low->cell[axis];
  }
  const auto axis = static_cast<std::size_t>(std::max_element(side, side + 3) - side);
  std::sort(numbers.begin(), numbers.end(), [axis](const PlacedNumber& a, const PlacedNumber& b) {
    return a.cell[axis] != b.cell[axis] ? a.cell[axis] < b.cell[axis] : a.number < b.number;
  });
  std::size_t lower = run;
  while (2 * lower < numbers.size()) lower *= 2;
  order_slowly(numbers.first(lower), run);
  order_slowly(numbers.subspan(lower), run);
}

std::vector<std::uint32_t> numbers_of(std::span<const PlacedNumber> placed) {
  std::vector<std::uint32_t> numbers;
  for (const PlacedNumber& at : placed) numbers.push_back(at.number);
  return numbers;
}

// Anywhere, many in the same cell, in a row, in one cell, and rising to the middle and falling again.
enum class Places { anywhere, grid, row, one, peak };
PlacedNumber place(Places places, std::uint32_t i, std::size_t count, Random& random) {
  const auto any = [&](std::int32_t size) { return static_cast<std::int32_t>(random.between(0, size)); };
  const auto number = static_cast<std::int32_t>(i);
  switch (places) {
    case Places::anywhere:
      return {{any(1 << 30), any(2147483647), any(1 << 20)}, i};
    case Places::grid:
      return {{any(8), any(8), any(4)}, i};
    case Places::row:
      return {{0, 0, number}, i};
    case Places::one:
      return {{1, 2, 3}, i};
    case Places::peak:
      break;
  }
  return {{std::min(number, static_cast<std::int32_t>(count) - number), 0, 0}, i};
}

TEST(OrderInSpace, HalvesBoxesAcrossTheirLongestSideOnAnyNumberOfThreads) {
  Random random(2);
  for (const Places places : {Places::anywhere, Places::grid, Places::row, Places::one, Places::peak}) {
    for (const std::size_t count : {0u, 1u, 16u, 17u, 33u, 1000u, 70000u}) {
      std::vector<PlacedNumber> placed, spare(count);
      for (std::uint32_t i = 0; i < count; ++i) placed.push_back(place(places, i, count, random));
      for (const std::size_t run : {1u, 16u, 24u}) {
        std::vector<PlacedNumber> expected = placed;
        order_slowly(expected, run);
        for (const std::size_t threads : {1u, 2u, 4u}) {
          std::vector<PlacedNumber> ordered = placed;
          order_in_space(ordered, spare, run, threads);
          EXPECT_EQ(numbers_of(ordered), numbers_of(expected))
              << static_cast<int>(places) << ", " << count << ", runs of " << run << ", " << threads
              << " threads";
        }
      }
    }
  }
}

TEST(OrderInSpace, OrdersMembersByWhereTheyAre) {
  const auto centre_of = [](std::uint32_t member) { return Vec3{0, member < 5 ? 1.0 : -1.0, 0}; };
  for (const Box& box :
       {Box{{-1, -1, -1}, {1, 1, 1}}, Box{{0, 0, 0}, {0, 0.5, 0}}}) {  // also those beside it
    std::vector<std::uint32_t> members = {7, 1, 4, 9};
    order_in_space(members, box, 2, 1, centre_of);
    EXPECT_EQ(members, (std::vector<std::uint32_t>{7, 9, 1, 4}));
  }
  std::vector<std::uint32_t> members = {7, 1, 4, 9};
  order_in_space(members, {{2, 2, 2}, {2, 2, 2}}, 2, 1, centre_of);  // a box of no size
  EXPECT_EQ(members, (std::vector<std::uint32_t>{1, 4, 7, 9}));
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
