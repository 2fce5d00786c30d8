// Worlds in files against the same scenes in memory: the same bits, a bounded part of the file in memory, and
// a thread that has it there before the hand comes.
#include <chrono>
#include <filesystem>
#include <fstream>
#include <thread>
#include <vector>

#include "lumbrical/clearance.h"
#include "lumbrical/tick.h"
#include "pads.h"
#include "pressed_hand.h"
#include "world_file_fixture.h"

namespace lumbrical::test {
namespace {

// All stage hashes of a hand that strokes over the scene.
std::vector<std::uint64_t> hashes_of(const Scene& scene, Broadphase broadphase,
                                     const std::vector<Vec3>& way) {
  Execution execution;
  execution.broadphase = broadphase;
  const Model model = built(scene, execution);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  std::vector<std::uint64_t> hashes;
  for (std::size_t i = 0; i < way.size(); ++i) {
    DeviceFrame frame = pressed_frame(scene.hand, 0.002, static_cast<double>(i) / 20);
    frame.base.position += way[i];
    tick(model, state, scratch, frame);
    hashes.insert(hashes.end(), scratch.stage_hash.begin(), scratch.stage_hash.end());
  }
  return hashes;
}

// Fields far apart, a wide ground under them, and the way of a hand over them that jumps from one to the
// next.
Scene islands(std::vector<Vec3>& way) {
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  Random random(7);
  for (int i = 0; i < 8; ++i) {
    Mesh mesh = make_height_field(0.4, 60, 0.002, 0.04);
    const Vec3 at = random.in_box(300);
    for (Vec3& p : mesh.vertices) p += at;
    scene.objects.push_back({"island " + std::to_string(i), std::move(mesh)});
    for (int k = 0; k < 3; ++k) way.push_back(at + Vec3{0.001 * k, 0.0005 * k, 0});
  }
  scene.objects.push_back({"ground", make_height_field(600, 12, 0.1, 30)});
  return scene;
}

TEST(World, FeelsTheSameToTheLastBitAsTheSceneInMemory) {
  std::vector<Vec3> way;
  Scene scene = islands(way);
  const std::string path = (own_folder() / "islands.world").string();
  for (const Law law : {Law::field, Law::max_depth, Law::column}) {
    scene.settings.law.fill(law);
    const Scene mapped = in_world(scene, {}, path);
    const std::vector<std::uint64_t> expected = hashes_of(scene, Broadphase::grid, way);
    EXPECT_EQ(hashes_of(scene, Broadphase::tree, way), expected);
    EXPECT_EQ(hashes_of(mapped, Broadphase::automatic, way), expected);
    if (law != Law::field) continue;
    EXPECT_EQ(hashes_of(mapped, Broadphase::brute, way), expected);
  }
}

TEST(World, HasWhatMovesBesideIt) {
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"field", make_height_field(0.4, 60, 0.002, 0.04)});
  const SceneObject ball =
      body_of("ball", make_sphere(0.03, 6), 0.2, {{0, 0.05, 0.03}, {}}, {0.5, 0.4, 0, 1000});
  Scene mapped = in_world(scene, {}, (own_folder() / "field.world").string());
  scene.objects.push_back(ball);
  mapped.objects.push_back(ball);
  const std::vector<Vec3> way(20);
  const std::vector<std::uint64_t> expected = hashes_of(scene, Broadphase::grid, way);
  EXPECT_EQ(hashes_of(mapped, Broadphase::automatic, way), expected);
  const Scene back = scene_of(built(mapped));
  EXPECT_EQ(back.world, mapped.world);
  ASSERT_EQ(back.objects.size(), 1u);
  EXPECT_EQ(back.objects[0].name, "ball");
  const Clearance clearance = find_clearance(mapped, {}, 1);
  ASSERT_EQ(clearance.object.size(), 2u);
  EXPECT_EQ(clearance.object[0].middle(), ball.pose.position);
  EXPECT_EQ(clearance.object[1].upper.x, mapped.world->extent.upper.x);
}

TEST(World, GivesBackWhatItWasBuiltFrom) {
  const Scene scene = strewn_scene(4, 10, 9);
  const std::string path = (own_folder() / "strewn.world").string();
  const Scene mapped = in_world(scene, {}, path);
  const Model model = built(mapped);
  EXPECT_EQ(model.execution.broadphase, Broadphase::grid);
  const Scene back = scene_of(model);
  EXPECT_EQ(back.world, mapped.world);
  EXPECT_TRUE(back.objects.empty());
  EXPECT_EQ(back.world->path, path);
  // The model keeps the mapping alive, even if the file is gone.
  std::filesystem::remove(path);
  const Triangle first = scene.objects[0].mesh.triangles[0];
  EXPECT_EQ(model.triangles.vertex(model.triangles.a[0]), scene.objects[0].mesh.vertices[first[0]]);
}

TEST(World, RefusesWhatWouldHaveToBeInMemory) {
  const std::string path = (own_folder() / "strewn.world").string();
  Scene mapped = in_world(strewn_scene(4, 10, 9), {}, path);
  Model model;
  Execution tree;
  tree.broadphase = Broadphase::tree;
  EXPECT_NE(build_model(mapped, tree, model).message().find("use auto or grid"), std::string::npos);
  EXPECT_TRUE(build_model(mapped, {}, model).ok());
  mapped.objects.push_back({"plane", make_plane(1, 3, 0)});
  EXPECT_NE(build_model(mapped, {}, model).message().find("put the objects into the world"),
            std::string::npos);
}

// [bytes] of the mapping at `bytes` that count as this process' memory.
std::size_t resident_bytes(const World& world) {
  const auto wanted = reinterpret_cast<std::uintptr_t>(world.bytes.get());
  std::ifstream maps("/proc/self/smaps");
  bool here = false;
  for (std::string line; std::getline(maps, line);) {
    if (line.find('-') < line.find(' ')) here = std::stoull(line, nullptr, 16) == wanted;
    if (here && line.starts_with("Rss:")) return std::stoull(line.substr(4)) * 1024;
  }
  ADD_FAILURE() << "the mapping is not in /proc/self/smaps";
  return 0;
}

// Streets of height fields: `count` blocks in a row, 0.3 m each.
std::string write_street(int count) {
  const std::string path = (own_folder() / "street.world").string();
  std::filesystem::remove(path);
  WorldWriter writer;
  EXPECT_TRUE(writer.open(path, {}).ok());
  const Mesh block = make_height_field(0.3, 150, 0.002, 0.04);
  for (int i = 0; i < count; ++i) {
    Mesh mesh = block;
    for (Vec3& p : mesh.vertices) p.x += 0.3 * i;
    EXPECT_TRUE(writer.add_object({"block " + std::to_string(i), mesh}).ok());
  }
  EXPECT_TRUE(writer.finish().ok());
  return path;
}

DeviceFrame hand_on_street(const Hand& hand, double x) {
  DeviceFrame frame = pressed_frame(hand, 0.002, 0);
  frame.base.position.x += x;
  return frame;
}

TEST(World, HoldsABoundedPartOfItsFile) {
  constexpr int kBlocks = 60;  // 2.7 million triangles
  Scene scene;
  scene.hand = default_hand(Side::right);
  const Status status = open_world(write_street(kBlocks), scene.world);
  ASSERT_TRUE(status.ok()) << status.message();
  const std::size_t file_bytes = scene.world->byte_count;
  EXPECT_GT(file_bytes, 100'000'000u);
  EXPECT_LT(resident_bytes(*scene.world), file_bytes / 50) << "after opening";

  const Model model = built(scene);
  WorldPager pager(model, {0.15, 0});
  State state;
  Scratch scratch = make_scratch(model);
  std::size_t most = 0, most_held = 0;
  std::uint64_t contacts = 0;
  for (int i = 0; i < 3 * kBlocks; ++i) {
    const DeviceFrame frame = hand_on_street(scene.hand, 0.1 * i);
    pager.hand_at(frame);
    pager.catch_up();
    contacts += tick(model, state, scratch, frame).contact_count;
    if (i % 10 != 0) continue;
    most = std::max(most, resident_bytes(*scene.world));
    most_held = std::max(most_held, pager.held_bytes());
  }
  EXPECT_GT(contacts, 10'000u);
  EXPECT_LT(most, file_bytes / 3);
  EXPECT_GT(most, file_bytes / 1000);
  EXPECT_LE(most, most_held + (2u << 20));  // and the table of cells
}

// Share of what a tick at the frame reads that is mapped already: no page fault then, major or minor.
void expect_read_ahead(double precision) {
  Scene scene;
  scene.settings.precision.fill(precision);
  scene.hand = default_hand(Side::right);
  ASSERT_TRUE(open_world(write_street(12), scene.world).ok());
  const World& world = *scene.world;
  const Model model = built(scene);
  WorldPager pager(model, {});
  ASSERT_EQ(resident_bytes(world), 0u);
  pager.hand_at(hand_on_street(scene.hand, 0.5));
  pager.catch_up();
  const std::size_t near = resident_bytes(world);
  EXPECT_GT(near, 100'000u);
  EXPECT_LE(near, pager.held_bytes() + (2u << 20));  // and the table of cells
  // A tick there touches nothing that is not there.
  State state;
  Scratch scratch = make_scratch(model);
  const std::size_t before = resident_bytes(world);
  const ActuatorFrame output = tick(model, state, scratch, hand_on_street(scene.hand, 0.5));
  EXPECT_GT(output.contact_count, 100u);
  EXPECT_EQ(resident_bytes(world), before);
  // Nor does one a hand's breadth further on.
  tick(model, state, scratch, hand_on_street(scene.hand, 0.6));
  EXPECT_EQ(resident_bytes(world), before);
  // A hand at rest has nothing there so far ahead, but one that comes at 4 m/s does: a metre farther.
  constexpr double kFar = 0.95, kSpeed = 4;
  const auto feel_ahead_of = [&](double place) {
    return tick(model, state, scratch, hand_on_street(scene.hand, place + kFar)).contact_count;
  };
  EXPECT_GT(feel_ahead_of(0.5), 100u);
  EXPECT_GT(resident_bytes(world), before);
  // By the clock, since a busy machine would make it slower; again where it stood still for long.
  double way = 0;
  do {
    const auto begun = std::chrono::steady_clock::now();
    for (way = 0; way < 0.8;) {
      way = kSpeed * std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
      pager.hand_at(hand_on_street(scene.hand, 0.5 + way));
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  } while (way > 1.2);
  pager.catch_up();
  const std::size_t ahead = resident_bytes(world);
  EXPECT_GT(feel_ahead_of(0.5 + way), 100u);
  EXPECT_EQ(resident_bytes(world), ahead);
}
TEST(World, IsReadAheadOfTheHand) { expect_read_ahead(Settings().precision[0]); }
TEST(World, IsReadAheadOfAHandThatFeelsExactly) { expect_read_ahead(0); }

TEST(World, IsReadAheadOfBothHandsWhereverTheyAre) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  ASSERT_TRUE(open_world(write_street(12), scene.world).ok());
  const World& world = *scene.world;
  const Model model = built(scene);
  Model other;
  ASSERT_TRUE(share_world(model, default_hand(Side::left), other).ok());
  WorldPager pager(model, {});
  const auto touches_nothing_new = [&](const Model& felt, double place) {
    const std::size_t before = resident_bytes(world);
    State state;
    Scratch scratch = make_scratch(felt);
    EXPECT_GT(tick(felt, state, scratch, hand_on_street(felt.hand, place)).contact_count, 100u);
    EXPECT_EQ(resident_bytes(world), before) << place;
  };
  pager.hand_at(hand_on_street(scene.hand, 0.5), 0);
  pager.hand_at(hand_on_street(other.hand, 3.2), 1);
  pager.catch_up();
  touches_nothing_new(model, 0.5);
  touches_nothing_new(other, 3.2);
  // One hand goes elsewhere: what was near it may be let go of, what is near the other may not.
  pager.hand_at(hand_on_street(scene.hand, 1.9), 0);
  pager.catch_up();
  touches_nothing_new(model, 1.9);
  touches_nothing_new(other, 3.2);
}

void make_newer(const std::string& path, int seconds) {
  std::filesystem::last_write_time(path,
                                   std::filesystem::last_write_time(path) + std::chrono::seconds(seconds));
}

// Over what is mapped there; the pager's thread notices by the file's time, and only a while later.
void expect_led_nowhere(const Scene& scene, const void* place, const void* bytes, std::size_t size) {
  const World& world = *scene.world;
  const Model model = built(scene);
  std::fstream file(world.path, std::ios::binary | std::ios::in | std::ios::out);
  file.seekp(static_cast<const std::byte*>(place) - world.bytes.get());
  file.write(static_cast<const char*>(bytes), static_cast<std::streamsize>(size));
  file.close();
  make_newer(world.path, 10);
  WorldPager pager(model, {});
  pager.hand_at(hand_on_street(scene.hand, 0));
  pager.catch_up();
  EXPECT_GT(pager.held_bytes(), 0u);
  EXPECT_FALSE(pager.failure().ok());
}

Scene hand_in_street() {
  Scene scene;
  scene.hand = default_hand(Side::right);
  EXPECT_TRUE(open_world(write_street(1), scene.world).ok());
  return scene;
}

TEST(World, WhatIsWrittenIntoItsFileLeadsThePagerNowhere) {
  const Scene scene = hand_in_street();
  const SharedArray<TreeLine>& lines = scene.world->grid.lines;
  const std::string numbers(lines.size() * sizeof(TreeLine), '\xff');
  expect_led_nowhere(scene, lines.data(), numbers.data(), numbers.size());
  for (const bool far : {false, true}) {
    const Scene other = hand_in_street();
    const SharedArray<TreeHead>& trees = other.world->grid.tree;
    std::vector<TreeHead> heads(trees.begin(), trees.end());
    for (TreeHead& head : heads) {
      if (far)
        head.first_line = std::uint64_t{1} << 50;
      else
        head.level_count = UINT16_MAX;
    }
    expect_led_nowhere(other, trees.data(), heads.data(), heads.size() * sizeof(TreeHead));
  }
}

TEST(World, ThatWasChangedAndChangedBackIsAFailure) {
  const Scene scene = hand_in_street();
  make_newer(scene.world->path, 10);
  WorldPager pager(built(scene), {});
  pager.hand_at(hand_on_street(scene.hand, 0));
  pager.catch_up();
  EXPECT_TRUE(pager.changed());
  make_newer(scene.world->path, -10);
  EXPECT_NE(pager.failure().message().find("was changed while it was read"), std::string::npos);
}

TEST(World, FramesThatTellNoPlaceAreNoTroubleToThePager) {
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  ASSERT_TRUE(open_world(write_street(1), scene.world).ok());
  WorldPager pager(built(scene), {});
  DeviceFrame frame;
  frame.valid = 0;
  pager.hand_at(frame);
  pager.catch_up();
  frame.valid = ~0u;
  frame.base.position.x = std::numeric_limits<double>::quiet_NaN();
  pager.hand_at(frame);
  frame.base.position.x = std::numeric_limits<double>::infinity();
  pager.hand_at(frame);
  pager.catch_up();
  EXPECT_EQ(pager.held_bytes(), 0u);
  WorldPager idle(built(strewn_scene(1, 1, 1)), {});
  idle.hand_at(frame);
  idle.catch_up();
  EXPECT_EQ(idle.held_bytes(), 0u);
}

}  // namespace
}  // namespace lumbrical::test
