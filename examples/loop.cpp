// A hand, a scene and a device in a loop: everything that `lumbrical run --sink` does for the safety of the
// hand, in a program of one's own. The device is another process at shared memory (shared_device.c); a wire
// to one's own device is a class of three functions (lumbrical/device_wire.h).
//   loop SCENE.json PROFILE.json SECONDS
#include <cstdio>
#include <cstdlib>

#include "lumbrical/loop.h"
#include "lumbrical/motion.h"
#include "lumbrical/real_time.h"
#include "lumbrical/scene_file.h"
#include "lumbrical/shared_memory_wire.h"
#include "lumbrical/ways_out.h"

using namespace lumbrical;

int fail(const Status& status) { return std::fprintf(stderr, "%s\n", status.message().c_str()), 1; }

int main(int argc, char** argv) {
  if (argc != 4) return std::fprintf(stderr, "loop SCENE.json PROFILE.json SECONDS\n"), 2;
  SceneFile scene;
  DeviceProfile profile;
  Model model;
  std::unique_ptr<DeviceWire> wire;
  if (Status status = load_scene_file(argv[1], scene); !status.ok()) return fail(status);
  if (Status status = load_device_profile(argv[2], profile); !status.ok()) return fail(status);
  if (Status status = build_model(scene.scene, scene.execution, model); !status.ok()) return fail(status);
  if (Status status = make_shared_memory_wire(profile, wire); !status.ok()) return fail(status);

  const StopSignals signals;  // Ctrl-C ends the loop below, and forces fade
  DeviceLoop loop;
  LoopSettings settings;
  settings.sink.thread = true;  // forces fade too when a tick never comes back
  settings.stop_on_loss = true;
  if (Status status = loop.open(model, profile, std::move(wire), settings); !status.ok()) return fail(status);
  fade_before_dying(&loop.sink);  // and when this program crashes

  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  LoopStep step;
  step.frame = resample(scene.motion, 0);
  if (!loop.measure(model, scratch, step.frame, 0.5)) return 1;  // how slow is the way to the device?
  const RealTime real_time = enter_real_time(80, Pinning::last_processor);
  for (const std::string& refused : real_time.refused) std::fprintf(stderr, "%s\n", refused.c_str());
  if (!loop.start(model, scratch, step.frame)) return 1;  // from here on forces may flow

  Pace pace = start_pace(model.settings.rate);
  const auto ticks = static_cast<std::uint64_t>(std::atof(argv[3]) * pace.rate);
  double strongest = 0;
  for (std::uint64_t i = 0; i < ticks && !stop_requested(); ++i) {
    sleep_until_ns(moment_of(pace, i));
    step.frame = resample(scene.motion, static_cast<double>(i) / pace.rate);
    if (!loop.step(model, state, scratch, step)) break;
    for (const Wrench& wrench : step.output.segment) strongest = max(strongest, norm(wrench.force));
    forgive_late(i, clock_ns(), pace);
  }
  const bool safe = loop.close();
  fade_before_dying(nullptr);
  std::printf("strongest force %.2f N; forces %s the device, which %s at safe values\n", strongest,
              loop.figures.was_active ? "reached" : "never reached", safe ? "is" : "is NOT known to be");
  return safe && loop.figures.was_active && strongest > 0 ? 0 : 1;
}
