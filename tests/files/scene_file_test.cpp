// Scene files: what they give, and that every mistake in one is told with its line and column.
#include "lumbrical/scene_file.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <random>
#include <string>

#include "files.h"
#include "files/json_file.h"
#include "lumbrical/world.h"
#include "motion/motion_samples.h"

namespace lumbrical {
namespace {

namespace fs = std::filesystem;

using test::read_file;
using test::write_file;

// A tetrahedron from the origin along the axes, with an unused vertex far away.
const char* const kTetrahedron =
    "v 0 0 0\nv 2 0 0\nv 0 4 0\nv 0 0 1\nv 900 0 0\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

const char* const kGrasp = R"("motion": {"grasp": {}})";

SceneFile load(const std::string& text) {
  write_file("tetrahedron.obj", kTetrahedron);
  SceneFile scene_file;
  const Status status = load_scene_file(write_file("scene.json", text), scene_file);
  EXPECT_TRUE(status.ok()) << status.message();
  return scene_file;
}

std::string error_of(const std::string& text) {
  write_file("tetrahedron.obj", kTetrahedron);
  SceneFile scene_file;
  scene_file.seconds = -1;
  const Status status = load_scene_file(write_file("scene.json", text), scene_file);
  EXPECT_FALSE(status.ok()) << text;
  EXPECT_EQ(scene_file.seconds, -1) << "an error must leave the target alone";
  return status.message();
}

TEST(SceneFile, TheBuiltInGraspIsOfTheHandThatTheMotionSays) {
  const std::string objects = R"({"objects": [{"plane": {}}], )";
  EXPECT_EQ(load(objects + R"("motion": {"grasp": {}, "side": "left"}})").scene.hand.side, Side::left);
  const std::string right = objects + R"("hand": {"side": "right"}, "motion": {"grasp": {}, )";
  EXPECT_NE(error_of(right + R"("side": "left"}})").find("motion.side is not"), std::string::npos);
  EXPECT_NE(error_of(right + R"("side": "up"}})").find("motion.side"), std::string::npos);
  EXPECT_NE(error_of(right + R"("unit": "mm"}})").find("motion.unit has no meaning"), std::string::npos);
  EXPECT_NE(error_of(right + R"("rate": 30}})").find("motion.rate has no meaning"), std::string::npos);
}

TEST(SceneFile, RefusesAMotionOfMoreTicksThanASessionHasUnlessItsSecondsAreSaid) {
  std::string motion = test::angle_file();
  motion.replace(motion.find("\"time\": 2.5"), 11, "\"time\": 900000000");
  write_file("long.json", motion);
  const std::string scene = R"({"objects": [{"plane": {}}], "motion": {"file": "long.json"})";
  const std::string error = error_of(scene + "}");
  EXPECT_NE(error.find("motion lasts"), std::string::npos) << error;
  EXPECT_NE(error.find("give settings.seconds"), std::string::npos) << error;
  EXPECT_EQ(load(scene + R"(, "settings": {"seconds": 2}})").seconds, 2);
}

TEST(SceneFile, NeedsOnlyAnObjectAndAMotion) {
  const SceneFile scene_file = load("{\n\"objects\": [{\"mesh\": \"tetrahedron.obj\", \"unit\": \"cm\"}],\n" +
                                    std::string(kGrasp) + "\n}");
  ASSERT_EQ(scene_file.scene.objects.size(), 1u);
  const SceneObject& object = scene_file.scene.objects[0];
  EXPECT_EQ(object.name, "tetrahedron");
  EXPECT_EQ(object.mesh.triangles.size(), 4u);
  EXPECT_EQ(object.mesh.vertices[1], (Vec3{2 * 0.01, 0, 0}));
  EXPECT_EQ(scene_file.scene.settings.stiffness, Settings{}.stiffness);
  EXPECT_EQ(scene_file.scene.settings.rate, Settings{}.rate);
  EXPECT_EQ(scene_file.execution.broadphase, Broadphase::automatic);
  EXPECT_NEAR(scene_file.seconds, 10, 1e-9);
  EXPECT_EQ(scene_file.scene.hand.side, Side::right);
  EXPECT_EQ(scene_file.files.size(), 2u);
}

TEST(SceneFile, FitsAnObjectWithoutUnitToItsSizeAndPosition) {
  const SceneFile scene_file =
      load(R"({"objects": [{"mesh": "tetrahedron.obj", "fit": {"size": 0.1}, "position": [1, 2, 3]}], )" +
           std::string(kGrasp) + "}");
  const std::vector<Vec3>& v = scene_file.scene.objects[0].mesh.vertices;
  EXPECT_NEAR(v[0].x, 1 - 0.025, 1e-15);
  EXPECT_NEAR(v[2].y, 2 + 0.05, 1e-15);
  EXPECT_NEAR(v[0].y, 2 - 0.05, 1e-15);
  EXPECT_NEAR(v[3].z, 3 + 0.0125, 1e-15);
}

TEST(SceneFile, AppliesScaleThenOrientationThenPosition) {
  const SceneFile scene_file = load(
      R"({"objects": [{"mesh": "tetrahedron.obj", "unit": "m", "scale": 0.5, "orientation": [5, 0, 0, 5],
                       "position": [10, 0, 0]}], )" +
      std::string(kGrasp) + "}");
  const Vec3 v =
      scene_file.scene.objects[0].mesh.vertices[1];  // (2, 0, 0): halved, turned by 90 degrees, moved
  EXPECT_NEAR(v.x, 10, 1e-15);
  EXPECT_NEAR(v.y, 1, 1e-15);
}

TEST(SceneFile, BuildsEveryShape) {
  const SceneFile scene_file = load(
      R"({"objects": [{"mug": {"segments": 48}}, {"plane": {"cells": 2}}, {"box": {"size": [1, 2, 3], "cells": 1}},
                      {"sphere": {"radius": 0.02}}, {"height_field": {"cells": 9}, "name": "hills"}], )" +
      std::string(kGrasp) + "}");
  ASSERT_EQ(scene_file.scene.objects.size(), 5u);
  EXPECT_EQ(scene_file.scene.objects[0].name, "mug");
  EXPECT_EQ(scene_file.scene.objects[1].mesh.triangles.size(), 8u);
  EXPECT_EQ(scene_file.scene.objects[2].mesh.triangles.size(), 12u);
  EXPECT_EQ(scene_file.scene.objects[4].mesh.triangles.size(), 162u);
  EXPECT_EQ(scene_file.scene.objects[4].name, "hills");
}

TEST(SceneFile, ReadsSettingsAndLawsPerSegment) {
  const SceneFile scene_file = load(
      R"({"objects": [{"plane": {}}], "settings": {"rate": 2500, "stiffness": 1e6, "felt_once": "always", "seconds": 0.5,
               "law": "max-depth", "segments": [{"segment": "palm", "law": "point"}]},
               "execution": {"broadphase": "brute", "leaf_size": 4, "threads": 2}, )" +
      std::string(kGrasp) + "}");
  const Settings& settings = scene_file.scene.settings;
  EXPECT_EQ(settings.rate, 2500);
  EXPECT_EQ(settings.stiffness, 1e6);
  EXPECT_EQ(settings.felt_once, FeltOnce::always);
  EXPECT_EQ(scene_file.seconds, 0.5);
  EXPECT_EQ(settings.law[0], Law::max_depth);
  EXPECT_EQ(settings.law[kPalmSegment - 1], Law::max_depth);
  EXPECT_EQ(settings.law[kPalmSegment], Law::point);
  EXPECT_EQ(scene_file.execution.broadphase, Broadphase::brute);
  EXPECT_EQ(scene_file.execution.leaf_size, 4u);
  EXPECT_EQ(scene_file.execution.threads, 2u);
}

// One description makes both hands, the other as its mirror image.
TEST(SceneFile, OfACaptureOfBothMakesTwoHandsOfOneDescription) {
  const std::string frame =
      test::leap_frame(0, test::leap_hand(3, Side::right) + "," + test::leap_hand(4, Side::left),
                       test::leap_fingers(test::bent_hand(Side::right, 0.2), 3) + "," +
                           test::leap_fingers(test::bent_hand(Side::left, 0.6), 4));
  write_file("both.json", test::leap_file({frame}));
  const std::string motion = R"("motion": {"file": "both.json", "side": "both", "position": [1, 0, 0]}})";
  const SceneFile plain = load(R"({"objects": [{"plane": {}}], )" + motion);
  ASSERT_TRUE(plain.second);
  EXPECT_EQ(plain.motion.side, Side::right);
  EXPECT_EQ(plain.scene.hand.side, Side::right);
  EXPECT_EQ(plain.second->motion.side, Side::left);
  EXPECT_EQ(plain.second->hand.side, Side::left);
  EXPECT_EQ(plain.second->motion.samples.size(), plain.motion.samples.size());
  for (const char* const side : {"left", "right"}) {
    const SceneFile described =
        load(std::string(R"({"objects": [{"plane": {}}], "hand": {"side": ")") + side +
             R"(", "radii": [{"joint": "index tip", "radius": 0.009}], "palm": {"polygon":
             [{"x": 0.01, "z": 0}, {"x": 0.05, "z": 0}, {"x": 0.01, "z": 0.08}]}}, )" +
             motion);
    ASSERT_TRUE(described.second);
    EXPECT_EQ(described.second->hand.radius[kIndexTip], 0.009);
    const std::vector<Vec3>& right = described.scene.hand.palm.polygon;
    const std::vector<Vec3>& left = described.second->hand.palm.polygon;
    ASSERT_EQ(right.size(), 3u);
    ASSERT_EQ(left.size(), 3u);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(right[i].x, -left[i].x) << side;
    EXPECT_EQ(right[0].x > 0, std::string(side) == "right");
  }
}

TEST(SceneFile, TakesTheHandFromItsOwnFile) {
  write_file("hand.json",
             R"({"side": "left", "length": 0.2, "radii": [{"joint": "index tip", "radius": 0.009}],
      "fingers": [{"name": "index", "bone_length": [0.07, 0.04, 0.03, 0.02], "upper": [0.2, 1.5, 1.6, 1.2]}],
      "palm": {"thickness": 0.03, "polygon": [{"x": 0, "z": 0}, {"x": 0.08, "z": 0}, {"x": 0, "z": 0.08}]}})");
  const SceneFile scene_file =
      load(R"({"objects": [{"plane": {}}], "hand_file": "hand.json", )" + std::string(kGrasp) + "}");
  const Hand& hand = scene_file.scene.hand;
  EXPECT_EQ(hand.side, Side::left);
  EXPECT_EQ(hand.radius[kIndexTip], 0.009);
  EXPECT_EQ(hand.finger[1].bone_length[2], 0.03);
  EXPECT_EQ(hand.finger[1].limit[3].upper, 1.2);
  EXPECT_EQ(hand.palm.thickness, 0.03);
  EXPECT_EQ(hand.palm.polygon.size(), 3u);
  EXPECT_EQ(scene_file.files.size(), 2u);
}

TEST(SceneFile, NamesTheFileAtFault) {
  write_file("hand.json", "{\n  \"side\": \"both\"\n}");
  EXPECT_NE(error_of(R"({"objects": [{"plane": {}}], "hand_file": "hand.json", "motion": {"grasp": {}}})")
                .find("hand.json:2:11: side must be"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"objects": [{"mesh": "gone.obj", "unit": "m"}], "motion": {"grasp": {}}})")
                .find("gone.obj"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"objects": [{"plane": {}}], "motion": {"file": "gone.csv"}})").find("gone.csv"),
            std::string::npos);
}

TEST(SceneFile, SaysWhichFieldNamesAFileThatIsNotThere) {
  const std::string grasp = R"("motion": {"grasp": {}})", plane = R"("objects": [{"plane": {}, )";
  const std::pair<std::string, const char*> scenes[] = {
      {"{\"objects\": [\n{\"mesh\": \"gone.obj\", \"unit\": \"m\"}], " + grasp + "}",
       "scene.json:2:10: objects[0].mesh: "},
      {plane + R"("friction": 1}], "motion": {"file": "gone.csv"}})", ": motion.file: "},
      {plane + R"("friction": 1}], "hand_file": "gone.json", )" + grasp + "}", ": hand_file: "},
      {plane + R"("friction": 1, "surface": {"friction_file": "gone.txt"}}], )" + grasp + "}",
       ": objects[0].surface.friction_file: "},
      {R"({"world": "gone.world", )" + grasp + "}", "scene.json:1:11: world: "},
  };
  for (const auto& [text, place] : scenes) {
    const std::string message = error_of((text[0] == '{' ? "" : "{") + text);
    EXPECT_NE(message.find(place), std::string::npos) << message;
    EXPECT_NE(message.find(": there is no such file; check the path"), std::string::npos) << message;
  }
  write_file("torn.obj", "v 0 0\n");  // whose reader tells the line
  EXPECT_EQ(error_of(R"({"objects": [{"mesh": "torn.obj", "unit": "m"}], "motion": {"grasp": {}}})")
                .find("objects[0].mesh"),
            std::string::npos);
}

TEST(SceneFile, TellsAMeshOrARecordingThatIsGivenForAScene) {
  SceneFile scene_file;
  const auto told = [&scene_file](const std::string& path) {
    return load_scene_file(path, scene_file).message();
  };
  const std::string mesh = write_file("cup.obj", "v 0 0 0\n");
  EXPECT_NE(told(mesh).find("cup.obj: this is a mesh, no scene"), std::string::npos);
  EXPECT_NE(told(write_file("session.mcap", "\x89MCAP0\r\n")).find("this is a recording, no scene"),
            std::string::npos);
  EXPECT_NE(told(mesh + "/none.obj").find("none.obj: "), std::string::npos);
  EXPECT_EQ(told(mesh + "/none.obj").find("this is a mesh"), std::string::npos);
}

struct Mistake {
  const char* text;
  const char* message;  // behind the path
};

TEST(SceneFile, TellsEveryMistakeWithItsPlace) {
  const Mistake mistakes[] = {
      {"", ":1:1: input file is empty"},
      {"{}", ":1:1: motion is missing"},
      {"[]", ":1:1: expecting: {"},
      {R"({"settings": {"precision": "exact"}})",
       ":1:28: settings.precision is \"exact\" but must be a number; 0 is exact"},
      {"{\n \"objcts\": []}",
       ":2:12: unknown field: objcts; did you mean objects? schemas/scene.fbs lists the fields"},
      {R"({"motion": {"grap": {}}})", ":1:21: unknown field: grap; did you mean grasp? schemas/"},
      {R"({"objects": [{"plane": {}}, {"colour": 1}]})", ":1:40: unknown field: colour; fields here are "},
      {R"({"settings": {"gravity": [0, 0, 0]}})",
       ":1:26: unknown field: gravity; it belongs to the scene itself;"},
      {R"({"stiffness": 1e7})", ":1:17: unknown field: stiffness; it belongs into \"settings\""},
      {R"({"settings": {"pad": {"physics": 1}}})", "unknown field: physics; it belongs to the scene itself;"},
      {R"({"format": "angles", "frames": []})", ": this is a hand motion, no scene;"},
      {R"([{"jointTransforms": []}])", "; if this is a hand motion, give it to --motion"},
      {R"({"name": "x", "transport": {}})", ": this is a device profile, no scene;"},
      {R"({"motion": {"grasp": {}}})", ":1:1: objects is missing or empty"},
      {R"({"motion": {"grasp": {}}, "objects": []})", ":1:38: objects is missing or empty"},
      {"{\"motion\": {\"grasp\": {}}, \"objects\": [\n{\"plane\": {}},\n{}]}",
       ":3:1: objects[1] must be exactly one"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}, "mug": {}}]})",
       ":1:39: objects[0] must be exactly one"},
      {R"({"motion": {"grasp": {}}, "objects": [{"mesh": "tetrahedron.obj"}]})",
       ":1:39: objects[0] has no unit"},
      {R"({"motion": {"grasp": {}}, "objects": [{"mesh": "tetrahedron.obj", "unit": "inch"}]})",
       ":1:75: objects[0].unit must be \"m\", \"cm\" or \"mm\""},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}, "position": [1, 2]}]})",
       ":1:65: objects[0].position holds 2 numbers but needs 3"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}, "position": [1, nan, 2]}]})",
       ":1:69: objects[0].position[1] is nan"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}, "position": [1, 1e999, 2]}]})",
       ":1:69: objects[0].position[1] is inf"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}, "orientation": [0, 0, 0, 0]}]})",
       ":1:68: objects[0].orientation is zero"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {"extent": -1}}]})",
       ":1:60: objects[0].plane.extent is -1 but must lie in"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {"cells": 4000000000}}]})",
       ":1:59: objects[0].plane.cells is 4000000000 but must lie in 1 .. 2000"},
      {R"({"motion": {"grasp": {}}, "objects": [{"mug": {"wall": 0.03}}]})",
       ":1:47: objects[0].mug has a wall"},
      {R"({"motion": {"grasp": {}}, "objects": [{"mug": {"segments": 8, "handle_radius": 0.007}}]})",
       ":1:47: objects[0].mug can't be made"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "settings": {"law": "hard"}})",
       ":1:75: settings.law is not a law"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "settings": {"felt_once": "twice"}})",
       ":1:81: settings.felt_once has to be"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "settings": {"rate": 0}})",
       ":1:76: settings.rate is 0 but must lie in 1 .. 100000"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "settings": {"proxy_stiffness": 5}})",
       ":1:87: settings.proxy_stiffness is 5 but must be 0 or lie in 10 .. 100000 N/m"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "settings": {"precision": 1e-7}})",
       ":1:81: settings.precision is 1e-07 but must be 0 or lie in 1e-06 .. 0.1"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "settings": {"segments": [{"segment": "toe"}]}})",
       ":1:93: settings.segments[0].segment is not a hand segment"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "settings": {"segments": [
{"segment": "palm", "precision": 0}, {"segment": "palm", "law": "column"}]}})",
       ":2:50: settings.segments[1].segment is told a second time"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "settings": {"pad": {"layers": [
{"from": 0.6, "stiffness": 1}, {"from": 0.3, "stiffness": 1}]}}})",
       ":2:41: settings.pad.layers[1].from is out of range: give"},
      {R"({"motion": {"grasp": {}}, "objects": [
{"box": {}, "moves": "free", "mass": 1, "inertia": [1, 1, 3, 0, 0, 0]}]})",
       ":2:52: objects[0].inertia is no body's"},
      {R"({"motion": {"grasp": {}}, "objects": [
{"box": {}, "moves": "free", "mass": 1, "inertia": [1e-100, 1e-100, 1e-100, 0, 0, 0]}]})",
       ":2:52: objects[0].inertia is no body's: give moments of 1e-18 to 1e+22 kg m^2"},
      {R"({"motion": {"grasp": {}}, "objects": [{"box": {}, "mass": 1}]})",
       ":1:59: objects[0].mass needs \"moves\""},
      {R"({"motion": {"grasp": {}}, "objects": [{"box": {}, "damping": 1}]})",
       ":1:39: objects[0] damping acts on what moves by itself only, and this is \"fixed\": leave it out"},
      {R"({"motion": {"grasp": {}}, "objects": [{"box": {}, "moves": "ball", "mass": 1, "joint": {"spring": 1}}]})",
       ":1:39: objects[0] spring acts on a hinge or slider only, and this is \"ball\": leave it out"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "execution": {"broadphase": "heap"}})",
       ":1:83: execution.broadphase is no search"},
      {R"({"motion": {"grasp": {}, "file": "a.csv"}, "objects": [{"plane": {}}]})",
       ":1:12: motion names a file and"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "hand": {"radii": [{"joint": "index tip", "radius": -1}]}})",
       ":1:107: hand.radii[0].radius is -1"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "hand": {"radii": [
{"joint": "index tip", "radius": 0.01}, {"joint": "index tip", "radius": 0.02}]}})",
       ":2:51: hand.radii[1].joint is told a second time"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "hand": {"fingers": [
{"name": "index"}, {"name": "index"}]}})",
       ":2:29: hand.fingers[1].name is told a second time"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "hand": {}, "hand_file": "a.json"})",
       ":1:80: hand_file stands beside a hand"},
      {R"({"motion": {"grasp": {}}, "objects": [{"plane": {}}], "settings": {"rate": 1, "rate": 2}})",
       "field set more than once: rate"},
      {"{\"motion\": {\"grasp\": {}}, \"objects\": [{\"plane\": {}}]} x", "expecting: end of file"},
  };
  for (const Mistake& mistake : mistakes) {
    const std::string message = error_of(mistake.text);
    EXPECT_NE(message.find(std::string("scene.json") + (mistake.message[0] == ':' ? mistake.message : ":")),
              std::string::npos)
        << mistake.text << "\n  " << message;
    if (mistake.message[0] != ':') {
      EXPECT_NE(message.find(mistake.message), std::string::npos) << message;
    }
  }
}

TEST(SceneFile, TellsAValueOfAWrongKindWithItsFieldAndWhatItHasToBe) {
  const Mistake mistakes[] = {
      {R"({"settings": {"effort": -1}})", ":1:25: settings.effort is -1 but must be a whole number"},
      {R"({"settings": {"effort": 1.5}})", "settings.effort is 1.5 but must be a whole number"},
      {R"({"settings": {"rate": 5, "effort": "many"}})",
       "settings.effort is \"many\" but must be a whole number"},
      {R"({"settings": {"effort": many}})", "settings.effort is many but must be a whole number"},
      {R"({"settings": {"effort": ""}})", "settings.effort is \"\" but must be a whole number"},
      {R"({"settings": {"effort": 5000000000}})", "settings.effort is 5000000000 but must be far smaller"},
      {"{\"settings\": {\n\"effort\":\n -1\n}\n}", ":3:2: settings.effort is -1"},
      {R"({"settings": {"effort": [1]}})", "settings.effort is a list but must be a whole number"},
      {R"({"settings": {"rate": "1 kHz"}})",
       ":1:23: settings.rate is \"1 kHz\" but must be a number, without quotes"},
      // Which the parser would take for numbers.
      {R"({"settings": {"rate": "1000"}})",
       ":1:23: settings.rate is \"1000\" but must be a number, without quotes"},
      {R"({"settings": {"effort": "5"}})", "settings.effort is \"5\" but must be a whole number"},
      {R"({"objects": [{"position": [0, "1", 2]}]})", "objects[0].position[1] is \"1\" but must be a number"},
      {R"({"settings": {"rate": {}}})", "settings.rate is an object but must be a number"},
      {R"({"settings": {"rate": true}})",
       ":1:23: settings.rate is true but must be a number, without quotes"},
      {R"({"settings": {"law": 5}})", "settings.law is 5 but must be text, in quotes"},
      {R"({"settings": 5})", "settings is 5 but must be an object"},
      {R"({"objects": {"box": {}}})", "objects is an object but must be a list"},
      {R"({"objects": [{"plane": {}}, {"box": {"cells": -4}}]})", "objects[1].box.cells is -4 but must be"},
      {R"({"objects": [{"position": [0, "a", 1]}]})", "objects[0].position[1] is \"a\" but must be a number"},
      {R"({"objects": [7]})", "objects[0] is 7 but must be an object"},
      {R"({"hand": {"palm": {"polygon": [{"x": 1, "z": "b"}]}}})",
       "hand.palm.polygon[0].z is \"b\" but must be"},
      {R"({"settings": {"effort": -1, "rate": 5}, "motion": {}})", ":1:25: settings.effort is -1"},
      {R"({"hand": {"palm": {"polygon": [{"x": "b", "z": 1}]}}})",
       "hand.palm.polygon[0].x is \"b\" but must be"},
      // What comes behind a value is no fault of it.
      {R"({"settings": {"rate": 5 x}})", "expecting: "},
      {R"({"settings": {"law": null x}})", "expecting: "},
      {R"({"settings": {"effort": "many)", "illegal character"},
  };
  for (const Mistake& mistake : mistakes)
    EXPECT_NE(error_of(mistake.text).find(mistake.message), std::string::npos)
        << mistake.text << "\n  " << error_of(mistake.text);
}

TEST(SceneFile, ReadsNoImagesOfObjectsBeyondThoseThatMayBeFelt) {
  std::string objects = R"({"plane": {"cells": 1}, "friction": 0.5})";
  for (std::size_t i = 1; i <= kMostObjects; ++i)
    objects += ", {\"plane\": {\"cells\": 1}, \"friction\": 0.5}";
  objects += R"(, {"plane": {}, "surface": {"bumps": {"image": "none.pgm", "period": 1, "white": 0.1}}})";
  const std::string message = error_of("{" + std::string(kGrasp) + ", \"objects\": [" + objects + "]}");
  EXPECT_NE(message.find("objects[32] is one more than the 32 that may"), std::string::npos) << message;
}

TEST(SceneFile, RefusesWhatIsNoTextFile) {
  SceneFile scene_file;
  EXPECT_FALSE(load_scene_file(::testing::TempDir(), scene_file).ok());
  EXPECT_FALSE(load_scene_file("/dev/zero", scene_file).ok());
  EXPECT_FALSE(load_scene_file(::testing::TempDir() + "no such file.json", scene_file).ok());
  EXPECT_NE(error_of(std::string("{\n\0}", 4)).find("scene.json:2:1: holds a zero byte"), std::string::npos);
  EXPECT_NE(error_of(std::string(17u << 20, ' ')).find("larger than 16 MiB"), std::string::npos);
  EXPECT_FALSE(error_of("{\"objects\": " + std::string(100000, '[')).empty());
}

TEST(SceneFile, ReadsTheDemoAndNoTruncationOfIt) {
  const std::string demo = read_file(LUMBRICAL_SOURCE_DIR "/examples/demo.json");
  ASSERT_FALSE(demo.empty());
  load(demo);
  const std::size_t end = demo.find_last_of('}');
  for (std::size_t length = 0; length < end; length += 3) error_of(demo.substr(0, length));
}

TEST(SceneFile, SurvivesDamagedFiles) {
  const std::string demo =
      R"({"objects": [{"plane": {"cells": 2}, "position": [0, 0, 0]}], "hand": {"side": "left"},
      "motion": {"grasp": {"seconds": 0.5}}, "settings": {"law": "field"}})";
  std::mt19937 random(1);
  SceneFile scene_file;
  for (int round = 0; round < 300; ++round) {
    std::string text = demo;
    for (int i = 0; i < 3; ++i) text[random() % text.size()] = static_cast<char>(random() % 256);
    const Status status = load_scene_file(write_file("damaged.json", text), scene_file);
    EXPECT_TRUE(status.ok() || status.message().find(".json") != std::string::npos) << status.message();
  }
}

TEST(SceneFile, NamesAWorldFileInThePlaceOfObjects) {
  write_file("tetrahedron.obj", kTetrahedron);
  const std::string objects = R"("objects": [{"mesh": "tetrahedron.obj", "unit": "cm"}, {"plane": {}}])";
  const std::string scene = write_file("objects.json", "{" + objects + R"(, "execution": {"leaf_size": 8}})");
  WorldWriter writer;
  std::size_t count = 0;
  const auto begin = [&](const Execution& execution) {
    return writer.open((test::own_folder() / "things.world").string(), execution);
  };
  const auto take = [&](SceneObject&& object) {
    ++count;
    return writer.add_object(object);
  };
  ASSERT_TRUE(load_scene_objects(scene, begin, take).ok());
  ASSERT_TRUE(writer.finish().ok());
  EXPECT_EQ(count, 2u);
  const std::string world = R"({"world": "things.world", )";
  const SceneFile scene_file = load(world + kGrasp + "}");
  ASSERT_TRUE(scene_file.scene.world);
  EXPECT_TRUE(scene_file.scene.objects.empty());
  EXPECT_EQ(scene_file.scene.world->triangles.size(), 4u + 2 * 32 * 32);
  EXPECT_EQ(scene_file.scene.world->leaf_size, 8u);
  EXPECT_EQ(scene_file.files.size(), 2u);
  const std::string mover =
      R"("objects": [{"name": "ball", "sphere": {"radius": 0.03}, "moves": "free", "mass": 0.1}], )";
  const SceneFile both = load(world + mover + kGrasp + "}");
  ASSERT_TRUE(both.scene.world);
  ASSERT_EQ(both.scene.objects.size(), 1u);
  EXPECT_EQ(both.scene.objects[0].name, "ball");
  EXPECT_NE(error_of(world + objects + ", " + kGrasp + "}")
                .find("objects[0] stands still beside a world file; put it into the world"),
            std::string::npos);
  EXPECT_NE(error_of(world + mover + R"("physics": {"engine": "bullet"}, )" + kGrasp + "}")
                .find("physics stands beside a world file"),
            std::string::npos);
  EXPECT_NE(error_of(world + kGrasp + R"(, "execution": {"cell_size": 1}})").find("leave out cell_size"),
            std::string::npos);
  EXPECT_NE(error_of(R"({"world": "missing.world", )" + std::string(kGrasp) + "}")
                .find("missing.world: there is no such file"),
            std::string::npos);
  // A fault of a later object ends it, and is told where it stands.
  const std::string bad = write_file("bad.json", R"({"objects": [{"plane": {}},
{"mesh": "nowhere.obj", "unit": "m"}]})");
  EXPECT_FALSE(load_scene_objects(
                   bad, [](const Execution&) { return Status(); }, take)
                   .ok());
  EXPECT_EQ(count, 3u);
  const std::string again = write_file("again.json", world + kGrasp + "}");
  EXPECT_NE(load_scene_objects(again, begin, take).message().find("is a world file already"),
            std::string::npos);
}

TEST(JsonPlace, FindsValuesBehindStringsCommentsAndNesting) {
  const std::string text = "{ // x: {\n \"a\\\"b\": [1, {\"c\": \"}\"}],\n /* [ */ \"d\": {\"e\": [[], 7]}}";
  const auto place = [&](const std::string& path) {
    const TextPlace found = find_json_value(text, path);
    return std::to_string(found.line) + ":" + std::to_string(found.column);
  };
  EXPECT_EQ(place(""), "1:1");
  EXPECT_EQ(place("d.e[1]"), "3:26");
  EXPECT_EQ(place("d.e[0]"), "3:22");
  EXPECT_EQ(place("d.e[2]"), "3:21") << "the innermost part that is there";
  EXPECT_EQ(place("nothing.here"), "1:1");
  for (std::size_t length = 0; length < text.size(); ++length)
    find_json_value(text.substr(0, length), "d.e[1]");
}

std::string with_object(const std::string& fields) {
  return R"({"objects": [{"name": "thing", "box": {}, )" + fields + "}], " + kGrasp + "}";
}

TEST(SceneFile, AGivenObjectsPathIsReadAndSmooth) {
  const SceneFile scene_file = load(with_object(
      R"("moves": "given", "path": [{"time": 1, "position": [0, 0, 0.1]}, {"time": 2, "position": [0.2, 0, 0.1]},
         {"time": 4, "position": [0.2, 0.4, 0.1], "orientation": [0, 0, 0, 2]}])"));
  ASSERT_EQ(scene_file.paths.size(), 1u);
  const ObjectPath& path = scene_file.paths[0];
  ASSERT_EQ(path.size(), 3u);
  EXPECT_EQ(scene_file.scene.objects[0].pose, path[0].pose);
  EXPECT_EQ(path[2].pose.orientation, (Quat{0, 0, 0, 1}));
  EXPECT_EQ(resample(path, -1), path[0].pose);
  EXPECT_EQ(resample(path, 2), path[1].pose);
  EXPECT_EQ(resample(path, 9), path[2].pose);
  EXPECT_NEAR(resample(path, 1.5).position.x, 0.1, 0.03);
  Vec3 last = resample(path, 0).position, speed;
  for (int i = 1; i <= 5000; ++i) {
    const Vec3 now = resample(path, 0.001 * i).position;
    EXPECT_LT(norm(1000 * (now - last) - speed), 0.002);  // no jump of speed
    speed = 1000 * (now - last);
    last = now;
  }
}

TEST(SceneFile, WhoMovesGivenObjectsIsRead) {
  const SceneFile scene_file =
      load(R"({"objects": [{"box": {}, "moves": "given", "mass": 0.3}, {"box": {}, "moves": "given"}],
               "physics": {"engine": "bullet", "friction": 0.7}, )" +
           std::string(kGrasp) + "}");
  ASSERT_TRUE(scene_file.physics.has_value());
  EXPECT_EQ(scene_file.physics->engine, "bullet");
  EXPECT_EQ(scene_file.physics->friction, 0.7);
  EXPECT_EQ(scene_file.scene.objects[0].mechanism.body.mass, 0.3);
  EXPECT_EQ(scene_file.scene.objects[1].mechanism.body, MassProperties{});
  ASSERT_EQ(scene_file.paths.size(), 2u);
  EXPECT_TRUE(scene_file.paths[0].empty() && scene_file.paths[1].empty());
}

TEST(SceneFile, ALatchNamesItsHandle) {
  const SceneFile scene_file = load(
      R"({"objects": [{"name": "door", "box": {}, "moves": "hinge", "mass": 1,
                       "joint": {"latch": {"object": "handle", "opens": 0.3}}},
                      {"name": "handle", "box": {}, "moves": "hinge", "mass": 0.1}], )" +
      std::string(kGrasp) + "}");
  EXPECT_EQ(scene_file.scene.objects[0].mechanism.latch, (Latch{1, 0.3}));
  EXPECT_EQ(scene_file.scene.objects[1].mechanism.latch, Latch{});
}

TEST(SceneFile, MistakesOfPathsLatchesAndPhysicsAreNamed) {
  const auto expect = [](const std::string& text, const std::string& part) {
    EXPECT_NE(error_of(text).find(part), std::string::npos) << error_of(text);
  };
  const std::string given = R"("moves": "given", )";
  expect(with_object(R"("path": [{"time": 0}])"), "needs \"moves\": \"given\"");
  expect(with_object(given + R"("path": [])"), "has no points");
  expect(with_object(given + R"("path": [{}])"), "path[0] has no time");
  expect(with_object(given + R"("path": [{"time": 1}, {"time": 1}])"), "path[1].time is not after");
  expect(with_object(given + R"("path": [{"time": 0}], "mass": 1)"), "stands beside a mass");
  expect(with_object(given + R"("path": [{"time": 0}], "position": [0, 0, 0])"), "stands beside a position");
  expect(with_object(R"("moves": "hinge", "mass": 1, "joint": {"latch": {"object": "key", "opens": 1}})"),
         "latch.object names no object");
  expect(with_object(R"("moves": "hinge", "mass": 1, "joint": {"latch": {"object": "thing"}})"),
         "does not say where it opens");
  expect(with_object(R"("moves": "hinge", "mass": 1, "joint": {"latch": {"object": "thing", "opens": 1}})"),
         "latch.object must be another hinge or slider");
  expect(R"({"objects": [{"box": {}}], "physics": {"engine": "newton"}, )" + std::string(kGrasp) + "}",
         "physics.engine must be \"bullet\"");
  expect(with_object(R"("moves": "free", "mass": 1)").insert(1, R"("physics": {"engine": "bullet"}, )"),
         "physics moves what has \"moves\": \"given\" and a mass");
}

}  // namespace
}  // namespace lumbrical
