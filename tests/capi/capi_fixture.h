// Scenes, frames and handles that the tests of lumbrical.h share.
#pragma once

#include <gtest/gtest.h>

#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "files.h"
#include "lumbrical/scene_file.h"
#include "session.h"
#include "touch.h"

namespace lumbrical::test {

inline Scene ball_scene() {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"ball", make_sphere(0.04, 6)});
  return scene;
}

/// Palm down over the ball, lower with every frame, fingers slowly bending.
inline DeviceFrame touching_frame(std::size_t i) {
  const double share = static_cast<double>(i) / 100;
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  frame.base.orientation = {0.70710678118654752, 0.70710678118654752, 0, 0};
  frame.base.position = {0.001 * share, -0.12, 0.07 - 0.03 * share};
  for (std::size_t a = 0; a < kAngleCount; ++a)
    frame.angle[a] = a % 4 == 0 ? 0 : static_cast<float>(0.2 * share);
  return frame;
}

/// All zero but its size.
template <class Struct>
Struct sized() {
  Struct result{};
  result.size = sizeof result;
  return result;
}

inline lumbrical_frame new_frame() {
  lumbrical_frame frame;
  EXPECT_EQ(lumbrical_frame_init(&frame), LUMBRICAL_OK);
  return frame;
}

inline lumbrical_frame touching_frame_c(std::size_t i) {
  const DeviceFrame from = touching_frame(i);
  lumbrical_frame frame = new_frame();
  frame.kind = LUMBRICAL_JOINT_ANGLES;
  const auto& [p, q] = from.base;
  frame.base = {{p.x, p.y, p.z}, {q.x, q.y, q.z, q.w}};
  std::memcpy(frame.angle, from.angle.data(), sizeof frame.angle);
  return frame;
}

inline std::vector<lumbrical_frame> touching_frames(std::size_t count) {
  std::vector<lumbrical_frame> frames;
  for (std::size_t i = 0; i < count; ++i) frames.push_back(touching_frame_c(i));
  return frames;
}

inline void expect_same(const ActuatorFrame& expected, const lumbrical_output& output) {
  EXPECT_EQ(output.tick, expected.tick);
  EXPECT_EQ(output.flags, expected.flags);
  EXPECT_EQ(output.contact_count, expected.contact_count);
  EXPECT_EQ(output.evaluations, expected.evaluations);
  EXPECT_EQ(output.error_estimate, expected.error_estimate);
  EXPECT_EQ(output.force_error, expected.force_error);
  static_assert(sizeof output.segment == sizeof expected.segment);
  EXPECT_EQ(std::memcmp(output.segment, expected.segment.data(), sizeof output.segment), 0) << expected.tick;
  EXPECT_EQ(std::memcmp(output.joint_torque, expected.joint_torque.data(), sizeof output.joint_torque), 0);
  EXPECT_EQ(std::memcmp(output.flexion_torque, expected.flexion_torque.data(), sizeof output.flexion_torque),
            0);
  Vec3 sum;
  for (const Wrench& wrench : expected.segment) sum += wrench.force;
  EXPECT_EQ(sum, (Vec3{output.hand_force[0], output.hand_force[1], output.hand_force[2]}));
}

/// A mesh as arrays, and an object of it.
struct MeshObject {
  explicit MeshObject(const Mesh& mesh) {
    for (const Vec3& v : mesh.vertices)
      for (const double x : {v.x, v.y, v.z}) vertices.push_back(x);
    for (const Triangle& t : mesh.triangles) triangles.insert(triangles.end(), t.begin(), t.end());
    EXPECT_EQ(lumbrical_object_init(&object), LUMBRICAL_OK);
    object.vertices = vertices.data();
    object.vertex_count = mesh.vertices.size();
    object.triangles = triangles.data();
    object.triangle_count = mesh.triangles.size();
  }
  MeshObject(const MeshObject&) = delete;
  MeshObject& operator=(const MeshObject&) = delete;
  std::vector<double> vertices;
  std::vector<std::uint32_t> triangles;
  lumbrical_object object;
};

/// The three handles of a session, destroyed at the end.
struct CSession {
  CSession() = default;
  explicit CSession(const lumbrical_object& object) {
    create();
    EXPECT_EQ(lumbrical_scene_add_object(scene, &object), LUMBRICAL_OK) << lumbrical_message();
    start();
  }
  ~CSession() {
    lumbrical_session_destroy(session);
    lumbrical_model_destroy(model);
    lumbrical_scene_destroy(scene);
  }
  CSession(const CSession&) = delete;
  CSession& operator=(const CSession&) = delete;
  void create(int side = LUMBRICAL_RIGHT) {
    ASSERT_EQ(lumbrical_scene_create(side, 0.19, &scene), LUMBRICAL_OK) << lumbrical_message();
  }
  template <class Edit>
  void set(const Edit& edit) {
    auto settings = sized<lumbrical_settings>();
    ASSERT_EQ(lumbrical_scene_settings(scene, &settings), LUMBRICAL_OK);
    edit(settings);
    ASSERT_EQ(lumbrical_scene_set_settings(scene, &settings), LUMBRICAL_OK) << lumbrical_message();
  }
  void start() {
    ASSERT_EQ(lumbrical_model_build(scene, nullptr, &model), LUMBRICAL_OK) << lumbrical_message();
    ASSERT_EQ(lumbrical_session_create(model, &session), LUMBRICAL_OK) << lumbrical_message();
  }
  const lumbrical_output& step(const lumbrical_frame& frame) {
    EXPECT_EQ(lumbrical_session_tick(session, &frame, nullptr, 0, &output), LUMBRICAL_OK)
        << lumbrical_message();
    return output;
  }
  const lumbrical_output& step(std::size_t i) { return step(touching_frame_c(i)); }

  lumbrical_scene* scene = nullptr;
  lumbrical_model* model = nullptr;
  lumbrical_session* session = nullptr;
  lumbrical_output output = sized<lumbrical_output>();
};

}  // namespace lumbrical::test
