// stage_times: where a tick's time goes, stage by stage, scene by scene.
//
//   stage_times [FOLDER]
//
// Writes FOLDER/stages.json for `lumbrical report`, and a table to standard output. Of each pose the fastest
// of many ticks counts, stage by stage; what is told is the mean over the poses.
#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <vector>

#include "../tools/lumbrical/stage_clock.h"
#include "hand_scenes.h"
#include "lumbrical/motion.h"
#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"
#include "machine.h"
#include "origin.h"
#include "print.h"
#include "usage.h"

namespace lumbrical::bench {
namespace {

constexpr int kPoses = 16, kTimes = 60;
using Times = std::array<double, kStageCount>;  // [us]

/// A pose as a session would meet it: the frames up to it are ticked first.
struct Case {
  std::string name;
  Scene scene;
  std::vector<DeviceFrame> frames;
  int every = 1;  // of them is measured
};

Times fastest(const Model& model, const State& before, const DeviceFrame& frame, Scratch& scratch) {
  Times least;
  least.fill(std::numeric_limits<double>::max());
  for (int i = 0; i < kTimes; ++i) {
    tool::StageClock clock;
    tool::set_watch({&tool::StageClock::ended, &clock}, scratch);
    State state = before;
    clock.begin();
    tick(model, state, scratch, frame);
    for (std::size_t s = 0; s < least.size(); ++s) least[s] = std::min(least[s], clock.microseconds[s]);
  }
  return least;
}

bool measure(const Case& one, Times& mean) {
  Model model;
  if (const Status status = build_model(one.scene, {}, model); !status.ok()) {
    std::fprintf(stderr, "%s: %s\n", one.name.c_str(), status.message().c_str());
    return false;
  }
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  scratch.hash_stages = false;
  scratch.keep_near = false;  // the same pose again must not be spared its search
  mean = {};
  int measured = 0;
  for (std::size_t i = 0; i < one.frames.size(); ++i) {
    if (i % static_cast<std::size_t>(one.every) == 0) {
      const Times times = fastest(model, state, one.frames[i], scratch);
      for (std::size_t s = 0; s < mean.size(); ++s) mean[s] += times[s];
      ++measured;
    }
    tool::set_watch({}, scratch);
    tick(model, state, scratch, one.frames[i]);
  }
  for (double& time : mean) time /= measured;
  return true;
}

Case field_case(const std::string& name, Touch touch, double precision) {
  const Hand hand = default_hand(Side::right);
  Case one{name, field_scene(hand, true, 69), touching_frames(hand, touch, 0.3, kPoses)};
  one.scene.settings.precision.fill(precision);
  return one;
}

/// The built-in grasp round the mug, from the first touch on.
Case mug_case(const std::string& name, double precision, bool moves, double proxy_stiffness) {
  Case one{name, {}, {}, 40};
  one.scene.hand = default_hand(Side::right);
  one.scene.settings.precision.fill(precision);
  one.scene.settings.proxy_stiffness = proxy_stiffness;
  SceneObject mug{"mug", make_mug({})};
  if (moves) {
    mug.mechanism.mobility = Mobility::free;
    mug.material.static_friction = mug.material.kinetic_friction = 0.8;
    static_cast<void>(mass_properties(mug.mesh, 700, mug.mechanism.body));
    one.scene.ground.emplace();
  }
  one.scene.objects.push_back(std::move(mug));
  const Motion motion = make_grasp(one.scene.hand, 0.037, 0.095, 2);
  for (int i = 600; i < 1400; ++i) one.frames.push_back(resample(motion, i * 1e-3));
  return one;
}

std::vector<Case> all_cases() {
  return {field_case("whole hand, 9,522 triangles, 1e-4", Touch::drape, 1e-4),
          field_case("whole hand, 9,522 triangles, exact", Touch::drape, 0),
          field_case("four fingertips, 9,522 triangles, 1e-4", Touch::tips, 1e-4),
          field_case("four fingertips, 9,522 triangles, exact", Touch::tips, 0),
          field_case("one finger, 9,522 triangles, 1e-4", Touch::finger, 1e-4),
          field_case("nothing near", Touch::none, 1e-4),
          mug_case("grasp of a mug, 1e-4", 1e-4, false, 0),
          mug_case("grasp of a mug, exact", 0, false, 0),
          mug_case("grasp of a mug that moves, 1e-4", 1e-4, true, 0),
          mug_case("grasp of a mug with a proxy, 1e-4", 1e-4, false, 3000)};
}

std::string list_of(const Times& times) {
  std::string text;
  for (const double time : times) text += (text.empty() ? "" : ", ") + print("%.4g", time);
  return "[" + text + "]";
}

void print_heading() {
  std::printf("%-42s %9s", "scene, times in us", "tick");
  for (const char* const stage : tool::kStageWords) std::printf(" %9s", stage);
  std::printf("\n");
}

void print_row(const std::string& name, double whole, const Times& times) {
  std::printf("%-42s %9.2f", name.c_str(), whole);
  for (const double time : times) std::printf(" %9.2f", time);
  std::printf("\n");
}

int run(const std::string& folder) {
  if (!folder.empty() &&
      !std::filesystem::is_directory(folder)) {  // before minutes of work that would be lost
    std::fprintf(stderr, "stage_times: %s is no folder\n", folder.c_str());
    return 2;
  }
  const std::string origin = origin_members();  // the load before it
  std::string rows;
  print_heading();
  for (const Case& one : all_cases()) {
    Times times;
    if (!measure(one, times)) return 1;
    double whole = 0;
    for (const double time : times) whole += time;
    print_row(one.name, whole, times);
    rows += (rows.empty() ? "" : ",\n ") + ("{\"scene\": " + quoted(one.name)) +
            ", \"stage_us\": " + list_of(times) + "}";
  }
  if (folder.empty()) return 0;
  std::string stages;
  for (const char* const stage : tool::kStageWords) stages += (stages.empty() ? "" : ", ") + quoted(stage);
  std::ofstream file(folder + "/stages.json");
  file << "{" << origin << "\"cpu\": " << quoted(cpu_name())
       << ", \"isa\": " << quoted(std::string(isa_name(widest_isa())))
       << ", \"compiler\": " << quoted(__VERSION__)
       << ", \"flags\": \"\", \"command\": \"build/release/bench/stage_times FOLDER\",\n"
       << "\"note\": "
       << quoted(
              "Of each pose the fastest of 60 ticks, stage by stage; the mean of the poses. "
              "Samples find and sum contacts in one stage; of objects that move or rub their "
              "own search and contacts count with the world's, friction and motion with sums; "
              "a proxy's way with the hand's pose.")
       << ",\n\"stages\": [" << stages << "],\n\"scenes\": [" << rows << "]}\n";
  return file ? 0 : 2;
}

}  // namespace
}  // namespace lumbrical::bench

int main(int count, char** words) {
  if (count > 2 || lumbrical::bench::has_switch(count, words))
    return lumbrical::bench::tell_usage("stage_times [FOLDER]    FOLDER/stages.json is written", count,
                                        words);
  return lumbrical::bench::run(count == 2 ? words[1] : "");
}
