// The engine inside another program: a scene, a model, and one tick per device frame. No file, clock or
// thread.
#include <cstdio>

#include "lumbrical/motion.h"
#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"

int main() {
  lumbrical::Scene scene;
  scene.hand = lumbrical::default_hand(lumbrical::Side::right);
  scene.objects.push_back({"mug", lumbrical::make_mug({})});

  lumbrical::Model model;  // immutable: share it between sessions and threads
  if (const auto status = lumbrical::build_model(scene, {}, model); !status.ok()) {
    std::fprintf(stderr, "%s\n", status.message().c_str());
    return 1;
  }
  lumbrical::State state = lumbrical::make_state(model);        // what one tick leaves for the next
  lumbrical::Scratch scratch = lumbrical::make_scratch(model);  // a tick allocates nothing

  // A tracker would deliver these frames; here a generated grasp does, 2 s of it at 1 kHz.
  const lumbrical::Motion motion = lumbrical::make_grasp(scene.hand, 0.037, 0.095, 2);
  double strongest = 0;
  for (int i = 0; i < 2000; ++i) {
    const lumbrical::DeviceFrame frame = lumbrical::resample(motion, i / model.settings.rate);
    const lumbrical::ActuatorFrame out = lumbrical::tick(model, state, scratch, frame);
    for (const lumbrical::Wrench& wrench : out.segment)
      strongest = lumbrical::max(strongest, norm(wrench.force));
  }
  std::printf("strongest force on a segment: %.2f N\n", strongest);
  return strongest > 0 ? 0 : 1;
}
