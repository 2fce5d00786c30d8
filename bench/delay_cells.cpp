// See delay_cells.h.
#include "delay_cells.h"

#include "lumbrical/shapes.h"

namespace lumbrical::bench {

Status load_patient_profile(const std::string& path, DeviceProfile& profile) {
  const Status status = load_device_profile(path, profile);
  profile.response_timeout = 0.2;
  profile.safety.answer_timeout = 0.5;
  return status;
}

Status build_mug(double stiffness, Model& model) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.stiffness = stiffness;
  scene.settings.rate = 1000;
  MugShape mug;
  mug.segments = 24;
  scene.objects.push_back({"mug", make_mug(mug)});
  return build_model(scene, {}, model);
}

Motion mug_grasp(const Model& model, double seconds) {
  const MugShape mug;
  return make_grasp(model.hand, mug.radius, mug.height, seconds);
}

}  // namespace lumbrical::bench
