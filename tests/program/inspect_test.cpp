// lumbrical inspect and probe: what is wrong with a mesh, and what a sphere feels.
#include <cmath>
#include <cstdio>
#include <fstream>
#include <sstream>
#include <string>

#include "scenes.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

TEST(CommandLine, AMeshThatIsInsideOutIsFeltAsIfItWereRightAndTheRunSaysSo) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "right.obj") << cube_text(false);
  std::ofstream(folder / "wrong.obj") << cube_text(true);
  const auto run = [&](const std::string& mesh, const std::string& more) {
    std::ofstream(folder / "scene.json")
        << R"({"objects": [{"mesh": ")" << mesh << R"(", "unit": "m")" << more
        << R"(, "position": [0, 0, 0.05]}], "motion": {"grasp": {}}, "settings": {"rate": 100}})";
    const Outcome outcome = shell(
        "rm -f " + mesh + ".mcap; lumbrical run scene.json --ticks 600 --record " + mesh + ".mcap --json",
        folder);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    return outcome.json();
  };
  const nlohmann::json right = run("right.obj", ""), turned = run("wrong.obj", "");
  EXPECT_GT(right["peak_force"]["index"], 0.1);
  expect_same_peaks(turned, right);
  EXPECT_EQ(right["objects"][0]["winding"]["turned_triangles"], 0);
  EXPECT_EQ(turned["objects"][0]["winding"]["turned_triangles"], 12);
  EXPECT_EQ(shell("lumbrical replay wrong.obj.mcap", folder).exit_code, 0);
  EXPECT_NE(shell("lumbrical run scene.json --ticks 1", folder)
                .output.find("wrong: 1 of 1 part turned outside out"),
            std::string::npos);
  const nlohmann::json as_is = run("wrong.obj", R"(, "winding": "as is")");
  EXPECT_EQ(as_is["objects"][0]["winding"]["turned_triangles"], 0);
  EXPECT_EQ(shell("lumbrical replay wrong.obj.mcap", folder).exit_code, 0);
  const nlohmann::json flipped = run("right.obj", R"(, "winding": "flip")");
  expect_same_peaks(flipped, as_is);
  const Outcome outcome = shell("lumbrical inspect wrong.obj --unit m --json", folder);
  EXPECT_EQ(outcome.json()["winding"]["turned_triangles"], 12);
}

TEST(CommandLine, AFixedMeshIsWhatASceneWouldTakeAndNothingElseIsChanged) {
  const fs::path folder = fresh_folder();
  // A tetrahedron inside out, in numbers that no power of two makes shorter; one corner twice, one triangle
  // flat, one there twice.
  std::ofstream(folder / "wrong.obj") << "v 0.1 0 0\nv 3 0.3 0\nv 0 3 0.7\nv 0 0 3\nv 0 0 3\n"
                                         "f 1 2 3\nf 1 4 2\nf 2 4 3\nf 1 3 5\nf 1 2 2\nf 2 3 1\n";
  const Outcome outcome = shell("lumbrical inspect wrong.obj --unit cm --fix right.obj --json", folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json fixed = outcome.json()["fixed"];
  EXPECT_EQ(fixed["turned_triangles"], 5);
  EXPECT_EQ(fixed["merged_vertices"], 1);
  EXPECT_EQ(fixed["degenerate_triangles"], 1);
  EXPECT_EQ(fixed["duplicate_triangles"], 1);
  EXPECT_EQ(read_file((folder / "right.obj").string()),
            "v 0.1 0 0\nv 3 0.3 0\nv 0 3 0.7\nv 0 0 3\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 1 4 3\n");
  const nlohmann::json again = shell("lumbrical inspect right.obj --unit cm --json", folder).json();
  EXPECT_EQ(again["watertight"], true);
  EXPECT_GT(again["volume"], 0);
  EXPECT_EQ(shell("lumbrical inspect wrong.obj --unit cm --fix right.obj", folder).exit_code, 2)
      << "not over it";
  EXPECT_EQ(shell("lumbrical inspect - --unit cm --fix piped.obj <wrong.obj", folder).exit_code, 0)
      << "what is piped can be read once";
  EXPECT_EQ(read_file(folder / "piped.obj"), read_file(folder / "right.obj"));
  EXPECT_NE(shell("lumbrical inspect scene.json --fix a.obj", folder).exit_code, 0);
}

// As exporters leave it that round each triangle's corners by themselves: a scene takes it for closed.
TEST(CommandLine, AFixedMeshIsClosedWhereOnlyRoundingDroveItApart) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "torn.obj") << "v 0 0 0\nv 3 0 0\nv 0 3 0\nv 0 0 3\nv 0.000002 0 3\nv 3 0.000003 0\n"
                                        "f 1 3 2\nf 1 2 4\nf 6 3 5\nf 1 4 3\n";
  const auto inspected = [&](const std::string& arguments) {
    return shell("lumbrical inspect " + arguments + " --unit cm --json", folder).json();
  };
  const nlohmann::json torn = inspected("torn.obj --fix whole.obj");
  EXPECT_EQ(torn["watertight"], false);
  EXPECT_EQ(torn["winding"]["open_parts"], 0);
  EXPECT_EQ(torn["fixed"]["merged_vertices"], 2);
  const nlohmann::json whole = inspected("whole.obj");
  EXPECT_EQ(whole["watertight"], true);
  EXPECT_NEAR(whole["volume"], 4.5e-6, 1e-11);
}

TEST(CommandLine, OfACubeWithSecondSidesARunSaysThatTheyAreFeltTwiceAndTheFixHelps) {
  const fs::path folder = fresh_folder();
  const std::string text = cube_text(false);
  std::string behind;  // the first triangle of each face, the other way round
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    int a = 0, b = 0, c = 0;
    if (std::sscanf(line.c_str(), "f %d %d %d", &a, &b, &c) == 3)
      behind += "f " + std::to_string(a) + ' ' + std::to_string(c) + ' ' + std::to_string(b) + '\n';
  }
  std::ofstream(folder / "two.obj") << text << behind;
  const std::string advice = "6 triangles stand there twice, and felt twice; lumbrical inspect --fix";
  const Outcome inspected = shell("lumbrical inspect two.obj --unit m --fix one.obj", folder);
  EXPECT_NE(inspected.output.find(advice), std::string::npos) << inspected.output;
  for (const auto& [mesh, works] : {std::pair{"two.obj", false}, std::pair{"one.obj", true}}) {
    std::ofstream(folder / "scene.json")
        << R"({"objects": [{"mesh": ")" << mesh << R"(", "unit": "m"}], "motion": {"grasp": {}}})";
    const Outcome still = shell("lumbrical run scene.json --ticks 1", folder);
    EXPECT_EQ(still.output.find(advice) == std::string::npos, works) << still.output;
    std::ofstream(folder / "free.json")
        << R"({"objects": [{"mesh": ")" << mesh
        << R"(", "unit": "m", "moves": "free", "density": 500}], "motion": {"grasp": {}}})";
    const Outcome free = shell("lumbrical run free.json --ticks 1", folder);
    EXPECT_EQ(free.exit_code == 0, works) << free.error;
    EXPECT_EQ(free.error.find("6 triangles twice") == std::string::npos, works) << free.error;
  }
}

TEST(CommandLine, AProbeFeelsTheFileAsItIsAndWarnsOfWhatASceneWouldTurn) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "wrong.obj") << cube_text(true);
  const Outcome outcome =
      shell("lumbrical probe --mesh wrong.obj --unit m --sphere 0,0,0.055,0.01 --json", folder);
  EXPECT_EQ(outcome.exit_code, 0);
  EXPECT_LT(outcome.json()["total"]["force"][2], 0);
  EXPECT_NE(outcome.error.find("12 of its triangles turned outside out"), std::string::npos);
}

TEST(CommandLine, AnOpenMeshIsToldWithTheShareThatFacesOutwards) {
  const fs::path folder = fresh_folder();
  std::string open = cube_text(true);
  std::ofstream(folder / "open.obj") << open.substr(0, open.rfind("f "));
  std::ofstream(folder / "scene.json")
      << R"({"objects": [{"mesh": "open.obj", "unit": "m"}], "motion": {"grasp": {}}})";
  const Outcome outcome = shell("lumbrical run scene.json --ticks 10", folder);
  EXPECT_NE(outcome.output.find(
                "open: 1 part not closed, left as wound: 0 % of its area faces away from its middle, "
                "100 % towards it"),
            std::string::npos)
      << outcome.output;
}

TEST(CommandLine, AWrongUnitIsSuspectedByItsSize) {
  const fs::path folder = fresh_folder();
  std::ofstream(folder / "mug.obj")
      << "v 0 0 0\nv 95 0 0\nv 0 80 0\nv 0 0 80\nf 1 3 2\nf 1 2 4\nf 2 3 4\nf 3 1 4\n";
  for (const auto& [unit, hint] : {std::pair("m", "mm read as m"), std::pair("mm", "")}) {
    std::ofstream(folder / "scene.json") << R"({"objects": [{"mesh": "mug.obj", "unit": ")" << unit
                                         << R"(", "position": [1, 0, 0]}], "motion": {"grasp": {}}})";
    const nlohmann::json scene = shell("lumbrical inspect scene.json --json", folder).json();
    EXPECT_EQ(scene["objects"][0]["likely_unit"], hint) << scene;
  }
}

TEST(CommandLine, InspectReportsASquare) {
  const Outcome outcome = shell("lumbrical inspect square.obj --unit cm --json", folder_with_square());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json json = outcome.json();
  EXPECT_EQ(json["triangles"], 2);
  EXPECT_EQ(json["vertices"], 4);
  EXPECT_EQ(json["degenerate"], 0);
  EXPECT_EQ(json["duplicate"], 0);
  EXPECT_EQ(json["boundary_edges"], 4);
  EXPECT_EQ(json["non_manifold_edges"], 0);
  EXPECT_EQ(json["watertight"], false);
  ASSERT_EQ(json["extent"].size(), 3u);
  EXPECT_NEAR(json["extent"][0].get<double>(), 0.02, 1e-15);
}

TEST(CommandLine, ProbeFeelsTheDiscASphereCutsFromAPlane) {
  const Outcome outcome =
      shell("lumbrical probe --mesh square.obj --unit m --sphere 0.5,-0.25,0.006,0.008 --json",
            folder_with_square());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json json = outcome.json();
  expect_keys(json, {"contacts", "total"});
  ASSERT_EQ(json["contacts"].size(), 1u);
  const nlohmann::json& contact = json["contacts"][0];
  expect_keys(contact, {"triangle", "primitive", "depth", "area", "centroid", "volume", "force"});
  const double area = 4 * std::atan(1.0) * (0.008 * 0.008 - 0.006 * 0.006);
  EXPECT_EQ(contact["triangle"], 0);
  EXPECT_NEAR(contact["area"].get<double>(), area, 1e-9 * area);
  EXPECT_NEAR(contact["depth"].get<double>(), 0.002, 1e-12);
  EXPECT_NEAR(contact["centroid"][0].get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(contact["centroid"][1].get<double>(), -0.25, 1e-12);
  EXPECT_GT(contact["force"][2].get<double>(), 0);
  EXPECT_EQ(json["total"]["area"], contact["area"]);
  EXPECT_EQ(json["total"]["force"], contact["force"]);
  EXPECT_EQ(json["total"]["volume"], contact["volume"]);
}

TEST(CommandLine, ProbeNumbersPrimitivesInTheOrderGiven) {
  const Outcome outcome = shell(
      "lumbrical probe --mesh square.obj --unit m --capsule 0.5,-0.2,0.006,0.53,-0.2,0.006,0.008 "
      "--sphere -0.5,0.2,0.007,0.008 --cylinder 0.5,-0.5,-0.01,0.5,-0.5,0.02,0.003 --sphere "
      "-0.5,0.5,0.006,0.008 --json",
      folder_with_square());
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const nlohmann::json json = outcome.json();
  ASSERT_EQ(json["contacts"].size(), 4u);
  const double disc = 4 * std::atan(1.0);
  const double areas[] = {28e-6 * disc + 2 * std::sqrt(28e-6) * 0.03, 15e-6 * disc, 9e-6 * disc,
                          28e-6 * disc};
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(json["contacts"][i]["primitive"], i);
    EXPECT_NEAR(json["contacts"][i]["area"].get<double>(), areas[i], 1e-9 * areas[i]) << i;
  }
}

}  // namespace
}  // namespace lumbrical::test
