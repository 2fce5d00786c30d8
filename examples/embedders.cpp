// Seven programs round one engine, each a function: two hands, a tactile array, a task system, rollback, a
// sweep, settings that change, a recording. examples/embed.cpp comes first.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <future>
#include <string>
#include <vector>

#include "lumbrical/batch.h"
#include "lumbrical/motion.h"
#include "lumbrical/recording.h"
#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"

using namespace lumbrical;

// Whoever embeds it has a way of its own to say that something is wrong.
void require(bool holds, const std::string& what) {
  if (holds) return;
  std::fprintf(stderr, "%s\n", what.c_str());
  std::exit(1);
}
void require(const Status& status) { require(status.ok(), status.message()); }

Model mug_model(const Hand& hand) {
  Scene scene;
  scene.hand = hand;
  scene.objects.push_back({"mug", make_mug({})});
  Model model;
  require(build_model(scene, {}, model));
  return model;
}

double strongest(const ActuatorFrame& output) {
  double most = 0;
  for (const Wrench& wrench : output.segment) most = max(most, norm(wrench.force));
  return most;
}

// A grasp of the mug, to whose middle it is closed after `share` of it.
DeviceFrame grasping(const Motion& grasp, double share) { return resample(grasp, share * duration(grasp)); }

// Two hands in one world: its triangles and its index are there once.
void two_hands(const Model& right) {
  Model left;
  require(share_world(right, default_hand(Side::left), left));
  const auto feels = [](const Model& model) {
    const Motion grasp = make_grasp(model.hand, 0.037, 0.095, 2);
    State state = make_state(model);
    Scratch scratch = make_scratch(model);
    double most = 0;
    for (int i = 0; i < 1000; ++i)
      most = max(most, strongest(tick(model, state, scratch, grasping(grasp, 1e-3 * i))));
    return most > 0;
  };
  require(feels(right) && feels(left), "both hands feel the mug");
  require(left.triangles.x.data() == right.triangles.x.data(), "and it is there once");
}

// What a robot's skin would say: forces of the index' last phalanx on four by four fields of its length and
// breadth.
void tactile_array(const Model& model, const Motion& grasp) {
  constexpr int kFields = 4, kSegment = 5;  // index distal
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  for (int i = 0; i <= 500; ++i) tick(model, state, scratch, grasping(grasp, 1e-3 * i));
  std::array<std::array<double, kFields>, kFields> skin{};
  const Pose X_WS = placed_joints(scratch)[kIndexDistal];
  for (const Contact& contact : find_contacts(model, scratch)) {
    if (contact_segment(scratch, contact) != kSegment) continue;
    require(model.objects[object_of(model, contact.triangle)].name == "mug", "what it touches has a name");
    const Vec3 at = transform(inverse(X_WS), contact.centre);  // -z is along the phalanx, x across it
    const auto field = [](double from, double to, double x) {
      return static_cast<std::size_t>(clamp(std::floor(kFields * (x - from) / (to - from)), 0, kFields - 1));
    };
    skin[field(0, 0.025, -at.z)][field(-0.008, 0.008, at.x)] += model.settings.stiffness * contact.volume;
  }
  double sum = 0;
  for (const auto& row : skin)
    for (const double force : row) sum += force;
  require(sum > 0, "the skin is pressed");
}

// Tasks of one's own: a Model is for all of them, State and Scratch are each one's own.
void own_tasks(const Model& model, const Motion& grasp) {
  const auto session = [&] {
    State state = make_state(model);
    Scratch scratch = make_scratch(model);
    for (int i = 0; i < 300; ++i) tick(model, state, scratch, grasping(grasp, 2e-3 * i));
    return hash_state(state);
  };
  std::vector<std::future<std::uint64_t>> tasks;
  for (int i = 0; i < 4; ++i) tasks.push_back(std::async(std::launch::async, session));
  const std::uint64_t first = tasks[0].get();
  for (std::size_t i = 1; i < tasks.size(); ++i)
    require(tasks[i].get() == first, "the same bits on every thread");
}

// Lockstep over a network: input comes eight ticks late. What is shown is guessed from the last one that
// came, anew each time from the state after it.
void rollback(const Model& model, const Motion& grasp) {
  constexpr int kLate = 8;
  State certain = make_state(model), shown, truth = certain;
  Scratch scratch = make_scratch(model);
  for (int i = 0; i < 500; ++i) {
    const DeviceFrame came = grasping(grasp, 1e-3 * i);
    tick(model, certain, scratch, came);
    shown = certain;
    for (int k = 0; k < kLate; ++k) tick(model, shown, scratch, came);
  }
  for (int i = 0; i < 500; ++i) tick(model, truth, scratch, grasping(grasp, 1e-3 * i));
  require(shown.tick == 508 && hash_state(certain) == hash_state(truth),
          "the same bits as without a network");
}

// Ten thousand hands: ten lengths, each in a thousand poses, on all cores.
void sweep(const Model& model) {
  std::vector<double> force;
  std::vector<Scratch> scratch;
  for (int length = 0; length < 10; ++length) {
    Model sized;
    require(share_world(model, default_hand(Side::right, 0.16 + 0.006 * length), sized));
    Settings at_once = sized.settings;
    at_once.fade_time = 0;  // single poses: forces are there in the first tick
    require(change_settings(sized, at_once, 1, sized));
    const Motion grasp = make_grasp(sized.hand, 0.037, 0.095, 2);
    std::vector<DeviceFrame> frames;
    for (int i = 0; i < 1000; ++i) frames.push_back(grasping(grasp, 1e-3 * i));
    std::vector<State> states(frames.size());
    std::vector<ActuatorFrame> outputs(frames.size());
    tick_each(sized, frames, states, outputs, core_count(), scratch);
    for (const ActuatorFrame& output : outputs) force.push_back(strongest(output));
  }
  std::sort(force.begin(), force.end());
  require(force.size() == 10000 && force.back() > force.front(), "some of them touch");
}

// Softer, coarser and on two threads while it runs: the index stays, the State goes on.
void settings_change(const Model& model, const Motion& grasp) {
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  double stiff = 0, soft = 0;
  for (int i = 0; i < 500; ++i) stiff = strongest(tick(model, state, scratch, grasping(grasp, 1e-3 * i)));
  Settings settings = model.settings;
  settings.stiffness /= 2;
  settings.precision.fill(1e-3);
  Model softer;
  require(change_settings(model, settings, 2, softer));
  Scratch of_softer = make_scratch(softer);
  for (int i = 0; i < 10; ++i) soft = strongest(tick(softer, state, of_softer, grasping(grasp, 0.499)));
  require(state.tick == 510 && soft < 0.7 * stiff, "half as stiff is half as strong");
}

// A session on the record, and the same ticks again.
void record_and_replay(const Model& model, const Motion& grasp) {
  const std::string path = "embedders.mcap";
  std::remove(path.c_str());
  RecorderOptions options;
  options.wait_when_full = true;
  Recorder recorder;
  require(recorder.open(path, scene_of(model), options));
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  TickRecord record;
  for (int i = 0; i < 500; ++i) {
    record.device = grasping(grasp, 1e-3 * i);
    record.output = tick(model, state, scratch, record.device);
    take_results(state, scratch, record);
    require(recorder.record(record, &state), "recorded");
  }
  require(recorder.close());
  RecordingReader reader;
  require(reader.open(path));
  ReplayResult result;
  require(replay(reader, {}, result));
  require(result.ticks == 500 && !result.first_divergence, "replayed to the last bit");
  std::remove(path.c_str());
}

int main() {
  const Model model = mug_model(default_hand(Side::right));
  const Motion grasp = make_grasp(model.hand, 0.037, 0.095, 2);
  two_hands(model);
  tactile_array(model, grasp);
  own_tasks(model, grasp);
  rollback(model, grasp);
  sweep(model);
  settings_change(model, grasp);
  record_and_replay(model, grasp);
  std::printf("all seven work\n");
}
