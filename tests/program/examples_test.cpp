// What the examples with objects that move promise: each is run as the README has it, and read back.
#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <string>

#include "lumbrical/recording.h"
#include "lumbrical/scene_file.h"
#include "scenes.h"

namespace lumbrical::test {
namespace {

/// Of each object, by name, from tick to tick.
using Told = std::map<std::string, std::vector<ObjectOutput>>;

double most(const std::vector<ObjectOutput>& object, const std::function<double(const ObjectOutput&)>& of) {
  double result = -1e9;
  for (const ObjectOutput& out : object) result = std::max(result, of(out));
  return result;
}

double coordinate(const ObjectOutput& out) { return out.coordinate; }
double height(const ObjectOutput& out) { return out.pose.position.z; }
double turned(const ObjectOutput& out) {
  const Quat q = out.pose.orientation;
  return 2 * std::atan2(norm(Vec3{q.x, q.y, q.z}), std::fabs(q.w));
}

// What `run` tells of an object is what stands in its recording.
void expect_told(const nlohmann::json& moved, const std::vector<ObjectOutput>& recorded) {
  const auto expect_most = [&](const nlohmann::json& told,
                               const std::function<double(const ObjectOutput&)>& of) {
    EXPECT_NEAR(told["most"], most(recorded, of), 1e-6) << moved;
    EXPECT_NEAR(told["last"], of(recorded.back()), 1e-6) << moved;
  };
  EXPECT_NEAR(moved["peak_force"],
              most(recorded, [](const ObjectOutput& out) { return norm(out.wrench.force); }), 1e-9)
      << moved;
  if (moved.contains("coordinate")) return expect_most(moved["coordinate"], coordinate);
  const Quat start = recorded.front().pose.orientation;
  expect_most(moved["turned"], [&](ObjectOutput out) {
    out.pose.orientation = out.pose.orientation * conjugate(start);
    return turned(out);
  });
}

Told run_example(const std::string& name, std::vector<TickRecord>* records = nullptr) {
  const std::filesystem::path folder = fresh_folder();
  const std::string scene = std::string("'") + LUMBRICAL_SOURCE_DIR + "/examples/" + name + ".json'";
  const Outcome ran = shell("lumbrical run " + scene + " --json --record run.mcap", folder);
  EXPECT_EQ(ran.exit_code, 0) << ran.error;
  const Outcome replayed = shell("lumbrical replay run.mcap", folder);
  EXPECT_EQ(replayed.exit_code, 0) << replayed.output << replayed.error;
  RecordingReader reader;
  EXPECT_TRUE(reader.open((folder / "run.mcap").string()).ok());
  std::vector<std::string> names;
  for (const SceneObject& object : reader.scene().objects)
    if (is_apart(object)) names.push_back(object.name);
  Told told;
  TickRecord record;
  for (bool end = false; reader.next(record, end).ok() && !end;) {
    EXPECT_EQ(record.output.flags & (kObjectMissing | kObjectImplausible), 0u);
    for (std::size_t i = 0; i < names.size(); ++i) told[names[i]].push_back(record.object[i]);
    if (records != nullptr) records->push_back(record);
  }
  EXPECT_FALSE(ran.json()["moved"].empty());
  for (const nlohmann::json& moved : ran.json()["moved"]) expect_told(moved, told.at(moved["name"]));
  return told;
}

TEST(Examples, ADoorSpringsOpenOnceItsHandleIsPressed) {
  const Told told = run_example("door");
  const auto& door = told.at("door");
  const auto& handle = told.at("handle");
  for (std::size_t i = 0; i < door.size(); ++i) {
    if (door[i].coordinate > 0) {
      EXPECT_GE(most({handle.begin(), handle.begin() + static_cast<std::ptrdiff_t>(i)}, coordinate), 0.06);
      break;
    }
  }
  EXPECT_EQ(door[500].coordinate, 0);
  EXPECT_GT(door.back().coordinate, 0.5);
}

TEST(Examples, ACapIsTurnedAndStaysSo) {
  const Told told = run_example("cap");
  EXPECT_GT(told.at("cap").back().coordinate, 0.3);
}

TEST(Examples, APenIsTwirledAndNotDropped) {
  const Told told = run_example("pen");
  const auto& pen = told.at("pen");
  EXPECT_GT(most(pen, turned), 0.5);
  for (std::size_t i = 700; i < 2500; ++i) EXPECT_GT(pen[i].pose.position.z, -0.006);
}

TEST(Examples, ATrayIsCarried) {
  const Told told = run_example("tray");
  const auto& tray = told.at("tray");
  EXPECT_GT(tray.back().pose.position.z, 0.04);
  EXPECT_GT(tray.back().pose.position.x, 0.07);
  EXPECT_LT(turned(tray.back()), 0.4);
}

#ifdef LUMBRICAL_BULLET
TEST(Examples, BulletMovesAMugBlocksAndAChain) {
  std::vector<TickRecord> records;
  const Told told = run_example("bodies", &records);
  EXPECT_GT(most(told.at("mug"), height), 0.06);
  EXPECT_LT(height(told.at("mug").back()), 0.01);
  EXPECT_LT(turned(told.at("mug").back()), 0.05);
  EXPECT_LT(height(told.at("block 3").back()), 0.06);
  const Vec3 between = told.at("link 4").back().pose.position - told.at("hook").back().pose.position;
  EXPECT_NEAR(norm(between), 4 * 0.019, 0.006);
  // The ball's path is input, as it stands in the scene file.
  SceneFile scene_file;
  ASSERT_TRUE(load_scene_file(LUMBRICAL_SOURCE_DIR "/examples/bodies.json", scene_file).ok());
  for (std::size_t i = 0; i < records.size(); i += 100)
    EXPECT_EQ(records[i].given[9].pose, resample(scene_file.paths[9], static_cast<double>(i) / 1000));
}
#endif

}  // namespace
}  // namespace lumbrical::test
