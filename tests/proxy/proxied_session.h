// Hands and scenes of the proxy's tests.
#pragma once

#include "pads.h"

namespace lumbrical::test {

constexpr double kProxyStiffness = 3000;  // [N/m]

// A fingertip of its own on a wrist that does not turn, so that it gives way like the wrist's spring.
inline DeviceFrame fingertip_at(Vec3 tip, Vec3 away = {0, 0, 1}) {
  DeviceFrame frame = frame_of({{tip, away}});
  const Vec3 wrist = tip + 0.15 * away;
  frame.joint[kWrist].position = {static_cast<float>(wrist.x), static_cast<float>(wrist.y),
                                  static_cast<float>(wrist.z)};
  frame.valid |= 1u << kWrist;
  return frame;
}

inline Scene proxy_scene(Mesh mesh) {
  Scene scene = pad_scene();
  scene.settings.proxy_stiffness = kProxyStiffness;
  scene.objects.push_back({"object", std::move(mesh)});
  return scene;
}

inline const ActuatorFrame& feel(Session& run, const DeviceFrame& frame) {
  return run.output = tick(run.model, run.state, run.scratch, frame);
}

inline Vec3 proxy_at(const Session& run, int joint) {
  return run.state.proxy->joint[static_cast<std::size_t>(joint)].position;
}

}  // namespace lumbrical::test
