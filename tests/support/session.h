// Scenes and motions shared by tests of the whole tick.
#pragma once

#include <vector>

#include "base/hash.h"
#include "lumbrical/motion.h"
#include "lumbrical/shapes.h"
#include "lumbrical/tick.h"

namespace lumbrical::test {

inline Scene mug_scene(Law law) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.law.fill(law);
  scene.settings.precision.fill(0);
  scene.objects.push_back({"mug", make_mug({})});
  return scene;
}

inline Model model_of(const Scene& scene, const Execution& execution = {}) {
  Model model;
  const Status status = build_model(scene, execution, model);
  if (!status.ok()) throw std::runtime_error(status.message());
  return model;
}

/// The demo's grasp, sampled at `count` moments of its `seconds`.
inline std::vector<DeviceFrame> grasp_frames(const Hand& hand, std::size_t count) {
  const MugShape mug;
  const Motion motion = make_grasp(hand, mug.radius, mug.height, 10);
  std::vector<DeviceFrame> frames;
  for (std::size_t i = 0; i < count; ++i) {
    frames.push_back(resample(motion, 10.0 * static_cast<double>(i) / static_cast<double>(count)));
  }
  return frames;
}

/// Hash of all stages and states of a run.
inline std::uint64_t hash_run(const Model& model, const std::vector<DeviceFrame>& frames,
                              std::uint32_t* contacts = nullptr) {
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  Hasher hasher;
  for (const DeviceFrame& frame : frames) {
    const ActuatorFrame output = tick(model, state, scratch, frame);
    if (contacts != nullptr) *contacts += output.contact_count;
    for (const std::uint64_t hash : scratch.stage_hash) hasher.value(hash);
    hasher.value(hash_state(state));
  }
  return hasher.digest();
}

}  // namespace lumbrical::test
