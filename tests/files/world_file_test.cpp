// World files: written object by object, they hold what build_model makes in memory; damaged in whatever way,
// they are refused and nothing else happens.
#include <algorithm>
#include <cerrno>
#include <cstddef>
#include <limits>
#include <vector>

#include "faulty_disk.h"
#include "file_size_limit.h"
#include "files/cell_sort.h"
#include "files/world_format.h"
#include "index/sphere_tree.h"
#include "lumbrical/tick.h"
#include "sanitized.h"
#include "world_file_fixture.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

Execution with_grid() {
  Execution execution;
  execution.broadphase = Broadphase::grid;
  return execution;
}

TEST(WorldFile, HoldsTheGridThatBuildModelMakes) {
  for (const double cell_size : {0.1, 0.03, 7.0}) {
    for (const std::uint32_t leaf_size : {16u, 5u, 64u}) {
      Execution execution = with_grid();
      execution.cell_size = cell_size;
      execution.leaf_size = leaf_size;
      execution.threads = leaf_size == 5 ? 3 : 1;
      const Scene scene = strewn_scene(leaf_size, cell_size > 1 ? 2000 : 20, 40);
      const std::string path = (own_folder() / "strewn.world").string();
      expect_same_world(built(scene, execution), built(in_world(scene, execution, path)));
    }
  }
}

TEST(WorldFile, HoldsSmallAndOddWorlds) {
  Scene empty;
  empty.hand = default_hand(Side::right);
  Scene one = empty, all_wide = empty, no_triangle = empty, flat = empty;
  one.objects.push_back({"", {{{0, 0, 0}, {0.01, 0, 0}, {0, 0.01, -0.0}}, {{0, 1, 2}}}});
  all_wide.objects.push_back({"wide", make_plane(30, 3, 0)});
  no_triangle.objects.push_back({"points", {{{1, 2, 3}}, {}}});
  flat.objects.push_back({"point", {{{1, 1, 1}, {1, 1, 1}}, {{0, 0, 0}, {0, 1, 1}}}});
  int number = 0;
  for (const Scene& scene : {empty, one, all_wide, no_triangle, flat}) {
    SCOPED_TRACE(++number);
    const std::string path = (own_folder() / "odd.world").string();
    expect_same_world(built(scene, with_grid()), built(in_world(scene, with_grid(), path)));
  }
}

TEST(WorldFile, OfTheSameObjectsHasTheSameBytes) {
  const Scene scene = strewn_scene(1, 10, 12);
  Execution threads = with_grid();
  threads.threads = 4;
  const fs::path folder = own_folder();
  ASSERT_TRUE(write_world(scene, with_grid(), (folder / "a.world").string()).ok());
  ASSERT_TRUE(write_world(scene, threads, (folder / "b.world").string()).ok());
  EXPECT_EQ(read_file(folder / "a.world"), read_file(folder / "b.world"));
  EXPECT_EQ(std::distance(fs::directory_iterator(folder), fs::directory_iterator()), 2);
}

TEST(WorldFile, SortsMoreThanFitsInMemory) {
  CellSort sorted;
  const std::string path = (own_folder() / "sort").string();
  ASSERT_TRUE(sorted.open(path, 64 << 10).ok());
  Random random(5);
  std::vector<std::uint64_t> keys;
  for (std::uint32_t i = 0; i < 100000; ++i) {
    keys.push_back(random.bits() % 300 << 32 | i);
    ASSERT_TRUE(sorted.add({keys.back() >> 32, i}).ok());
  }
  std::sort(keys.begin(), keys.end());
  ASSERT_TRUE(sorted.merge().ok());
  CellEntry entry;
  bool end = false;
  for (const std::uint64_t key : keys) {
    ASSERT_TRUE(sorted.next(entry, end).ok());
    ASSERT_FALSE(end);
    ASSERT_EQ(entry.cell << 32 | entry.triangle, key);
  }
  ASSERT_TRUE(sorted.next(entry, end).ok());
  EXPECT_TRUE(end);
}

TEST(WorldFile, RefusesWhatBuildModelRefuses) {
  const fs::path path = own_folder() / "bad.world";
  WorldWriter writer;
  ASSERT_TRUE(writer.open(path.string(), {}).ok());
  Mesh mesh = make_plane(1, 3, 0);
  mesh.vertices[5].y = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(writer.add_object({"plane", mesh}).message().find("vertex 5 is not finite"), std::string::npos);
  mesh = make_plane(1, 3, 0);
  mesh.triangles[4][1] = 77;
  EXPECT_NE(writer.add_object({"plane", mesh}).message().find("triangle 4 names vertex 77"),
            std::string::npos);
  SceneObject rubbing{"plane", make_plane(1, 3, 0)};
  rubbing.material.static_friction = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(writer.add_object(rubbing).message().find("static friction is out of range"), std::string::npos);
  rubbing.material = {0.5, 0.5, 0, 1000};
  EXPECT_NE(writer.add_object(rubbing).message().find("a world file holds what stands still"),
            std::string::npos);
  EXPECT_FALSE(writer.open(path.string(), {}).ok());
  // What was refused is not in it.
  ASSERT_TRUE(writer.finish().ok());
  std::shared_ptr<const World> world;
  ASSERT_TRUE(open_world(path.string(), world).ok());
  EXPECT_EQ(world->objects.size(), 0u);
  EXPECT_FALSE(writer.finish().ok());
  EXPECT_FALSE(writer.add_object({"plane", mesh}).ok());
  Execution bad;
  bad.cell_size = 0;
  EXPECT_FALSE(writer.open(path.string(), bad).ok());
}

TEST(WorldFile, IsNotFinishedAfterAnObjectThatIsThereInPart) {
  const fs::path folder = own_folder();
  const std::string path = (folder / "part.world").string();
  WorldWriter writer;
  ASSERT_TRUE(writer.open(path, {}).ok());
  ASSERT_TRUE(writer.add_object({"plane", make_plane(1, 3, 0)}).ok());
  Status full;
  {
    const FileSizeLimit limit(30000);
    ASSERT_TRUE(limit.is_set());
    full = writer.add_object({"sphere", make_sphere(0.1, 60)});
  }
  EXPECT_NE(full.message().find("File too large"), std::string::npos) << full.message();
  // There is room again, but the arrays have no longer the same length.
  EXPECT_EQ(writer.add_object({"plane", make_plane(1, 3, 0)}).message(), full.message());
  EXPECT_EQ(writer.finish().message(), full.message());
  EXPECT_TRUE(fs::is_empty(folder));
}

TEST(WorldFile, LeavesNothingHalfWritten) {
  const fs::path folder = own_folder();
  const std::string path = (folder / "half.world").string();
  const Scene scene = strewn_scene(2, 10, 12);
  {
    WorldWriter writer;
    ASSERT_TRUE(writer.open(path, {}).ok());
    ASSERT_TRUE(writer.add_object({"plane", make_plane(1, 3, 0)}).ok());
  }
  EXPECT_TRUE(fs::is_empty(folder));
  ASSERT_TRUE(write_world(scene, {}, path).ok());
  const std::string good = read_file(path);
  EXPECT_NE(write_world(scene, {}, path).message().find("is there already"), std::string::npos);
  EXPECT_EQ(read_file(path), good);
  fs::remove(path);
  for (std::uint64_t bytes = 0; bytes < good.size(); bytes += good.size() / 7) {
    FaultyDisk disk(path);
    disk.fail_after(bytes, ENOSPC);
    const Status status = write_world(scene, {}, path);
    EXPECT_NE(status.message().find("No space left"), std::string::npos) << status.message();
    EXPECT_TRUE(fs::is_empty(folder));
  }
  EXPECT_NE(write_world(scene, {}, "/nowhere/x.world").message().find("/nowhere/x.world"), std::string::npos);
}

TEST(WorldFile, AsksAtEveryMegabyteWhetherToStopAndThenLeavesNothing) {
  const fs::path folder = own_folder();
  const std::string path = (folder / "stopped.world").string();
  const SceneObject field{"field", make_height_field(3, 200, 0.002, 0.04)};
  // Asked so many times it says yes.
  const auto write_until = [&](std::size_t last, std::size_t& asked) {
    asked = 0;
    WorldWriter writer;
    Status status = writer.open(path, {}, [&asked, last] { return ++asked >= last; });
    if (status.ok()) status = writer.add_object(field);
    return status.ok() ? writer.finish() : status;
  };
  std::size_t all = 0, asked = 0;
  ASSERT_TRUE(write_until(std::numeric_limits<std::size_t>::max(), all).ok());
  EXPECT_GE(all, fs::file_size(path) >> 20);
  EXPECT_GT(all, 5u);
  fs::remove(path);
  for (std::size_t last = 1; last <= all; ++last) {
    EXPECT_NE(write_until(last, asked).message().find("stopped"), std::string::npos) << last << " of " << all;
    EXPECT_EQ(asked, last);
    EXPECT_TRUE(fs::is_empty(folder)) << last << " of " << all;
  }
}

// Any error names the file and a byte of it, and leaves the world as it was.
void expect_refused(const std::string& path, const std::string& content) {
  write_file(fs::path(path).filename().string(), content);
  const auto before = std::make_shared<const World>();
  std::shared_ptr<const World> world = before;
  const Status status = open_world(path, world);
  ASSERT_FALSE(status.ok());
  EXPECT_EQ(status.message().find(path + ": byte "), 0u) << status.message();
  EXPECT_NE(status.message().find("lumbrical world"), std::string::npos) << status.message();
  EXPECT_EQ(world, before);
}

std::string small_world() {
  const std::string path = (own_folder() / "good.world").string();
  EXPECT_TRUE(write_world(strewn_scene(3, 2, 4), {}, path).ok());
  return read_file(path);
}

TEST(WorldFile, IsRefusedWhereverItIsCut) {
  const std::string good = small_world();
  const std::string path = (own_folder() / "cut.world").string();
  for (std::size_t size = 0; size < good.size(); size += size < 9000 ? 501 : 4096 * 3 - 1)
    expect_refused(path, good.substr(0, size));
  for (std::size_t size = kPageSize; size < good.size(); size += kPageSize)
    expect_refused(path, good.substr(0, size));
  expect_refused(path, good + std::string(kPageSize, '\0'));
  expect_refused(path, good + good);
}

TEST(WorldFile, IsRefusedWhateverByteIsFlipped) {
  const std::string good = small_world();
  const std::string path = (own_folder() / "flip.world").string();
  WorldEnd end;
  std::memcpy(&end, good.data() + good.size() - kPageSize, sizeof(end));
  Random random(9);
  std::vector<std::size_t> places = {0, 7};
  for (std::size_t i = 0; i < sizeof(end); i += 3) places.push_back(good.size() - kPageSize + i);
  for (int i = 0; i < 150; ++i) places.push_back(random.below(layout_of(end).offset[kHashes]));
  for (const std::size_t place : places) {
    SCOPED_TRACE(place);
    std::string bad = good;
    bad[place] = static_cast<char>(bad[place] ^ (1 << random.below(8)));
    expect_refused(path, bad);
  }
}

// Hashes made anew: what is left is what the numbers themselves say.
std::string sealed(std::string file) {
  WorldEnd end;
  char* const last = file.data() + file.size() - kPageSize;
  std::memcpy(&end, last, sizeof(end));
  const WorldLayout layout = layout_of(end);
  if (layout.end != file.size() - kPageSize) return file;
  std::vector<std::uint64_t> hashes;
  for (std::uint64_t first = 0; first < layout.offset[kHashes]; first += kHashPiece)
    hashes.push_back(hash_of_bytes(file.data() + first,
                                   std::min<std::uint64_t>(kHashPiece, layout.offset[kHashes] - first)));
  std::memcpy(file.data() + layout.offset[kHashes], hashes.data(), 8 * hashes.size());
  end.content = content_of(end, hashes.data(), hashes.size());
  std::memcpy(last, &end, sizeof(end));
  return file;
}

TEST(WorldFile, ForgedNumbersAreRefusedOrHarmless) {
  const std::string good = small_world();
  ASSERT_EQ(sealed(good), good);
  WorldEnd end;
  std::memcpy(&end, good.data() + good.size() - kPageSize, sizeof(end));
  const WorldLayout layout = layout_of(end);
  const std::string path = (own_folder() / "forged.world").string();
  const auto put = [](std::string file, std::size_t place, const auto& value) {
    std::memcpy(file.data() + place, &value, sizeof(value));
    return sealed(std::move(file));
  };
  const std::uint32_t large = 0xfffffff0u;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  expect_refused(path, put(good, layout.offset[kB] + 40, large));
  expect_refused(path, put(good, layout.offset[kY] + 80, nan));
  expect_refused(path, put(good, layout.offset[kY] + 80, 1e9));
  expect_refused(path, put(good, layout.offset[kCells] + 8, std::uint64_t{0}));
  expect_refused(path, put(good, layout.offset[kHeads] + offsetof(TreeHead, first_line), std::uint64_t{3}));
  expect_refused(path, put(good, layout.offset[kHeads] + offsetof(TreeHead, leaf_count), large));
  expect_refused(path, put(good, layout.offset[kHeads] + offsetof(TreeHead, level_count), std::uint16_t{9}));
  expect_refused(path, put(good, layout.offset[kHeads] + offsetof(TreeHead, origin), nan));
  expect_refused(path, put(good, layout.offset[kObjects], large));
  const std::size_t at = good.size() - kPageSize;
  for (const std::size_t field :
       {offsetof(WorldEnd, vertices), offsetof(WorldEnd, triangles), offsetof(WorldEnd, lines),
        offsetof(WorldEnd, cells), offsetof(WorldEnd, objects), offsetof(WorldEnd, name_bytes)}) {
    for (const std::uint64_t count : {std::uint64_t{0}, std::uint64_t{1}, ~std::uint64_t{0},
                                      std::uint64_t{1} << 40, std::uint64_t{1} << 62})
      expect_refused(path, put(good, at + field, count));
  }
  expect_refused(path, put(good, at + offsetof(WorldEnd, frontier), 1u));
  // A tree of which a lane that should be empty could be hit, and one that lists a triangle twice.
  TreeHead head;
  std::memcpy(&head, good.data() + layout.offset[kHeads], sizeof(head));
  ASSERT_LT(head.leaf_count, 16u);
  expect_refused(path, put(good, layout.offset[kLines] + offsetof(SphereBlock, r) + 4 * 15, 1e30f));
  const std::size_t numbers = layout.offset[kLines] + 64 * (layout_of(head).lines - head.leaf_count);
  std::uint32_t second = 0;
  std::memcpy(&second, good.data() + numbers + 4, 4);
  expect_refused(path, put(good, numbers, second));
  expect_refused(path, put(good, numbers, large));
}

TEST(WorldFile, AnyForgedByteIsRefusedOrRuns) {
  const std::string good = small_world();
  const std::string path = (own_folder() / "any.world").string();
  Random random(11);
  for (std::size_t i = 0; i < 300; i += sanitized_step(3)) {
    std::string bad = good;
    // Most of the file is coordinates and spheres; places near its end are tables.
    const std::size_t place = i % 2 == 0
                                  ? random.below(good.size())
                                  : good.size() - 1 - random.below(std::min<std::size_t>(good.size(), 80000));
    bad[place] = static_cast<char>(random.bits());
    write_file("any.world", sealed(bad));
    Scene scene;
    scene.settings.precision.fill(0);
    scene.hand = default_hand(Side::right);
    if (!open_world(path, scene.world).ok()) continue;
    const Model model = built(scene);
    State state;
    Scratch scratch = make_scratch(model);
    DeviceFrame frame;
    frame.kind = InputKind::joint_angles;
    frame.base.position = random.in_box(1);
    tick(model, state, scratch, frame);
  }
}

TEST(WorldFile, OtherFilesAreNoWorlds) {
  std::shared_ptr<const World> world;
  const fs::path folder = own_folder();
  expect_refused((folder / "text.world").string(), "{\"objects\": []}");
  expect_refused((folder / "none.world").string(), "");
  EXPECT_NE(open_world((folder / "missing").string(), world).message().find("there is no such file"),
            std::string::npos);
  EXPECT_NE(open_world(folder.string(), world).message().find("regular file"), std::string::npos);
}

}  // namespace
}  // namespace lumbrical::test
