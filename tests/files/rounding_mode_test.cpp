// Whatever rounding and denormal modes the host has set: the same scene is read, the same model is built, and
// the modes are the host's again afterwards.
#include <gtest/gtest.h>

#include <cfenv>
#include <cstring>
#include <memory>

#if defined(__SSE2__)
#include <immintrin.h>
#endif

#include "base/hash.h"
#include "files.h"
#include "index/patches.h"
#include "lumbrical/device_profile.h"
#include "lumbrical/mesh_fix.h"
#include "lumbrical/scene_file.h"
#include "lumbrical/tick.h"
#include "recording/session_message.h"
#include "tick/field_lists.h"
#include "world_file_fixture.h"

namespace lumbrical::test {
namespace {

constexpr int kRoundings[] = {FE_TONEAREST, FE_UPWARD, FE_DOWNWARD, FE_TOWARDZERO};

/// The host's modes for the length of a scope.
class HostModes {
 public:
  HostModes(int rounding, bool flushes_denormals) {
    std::fegetenv(&before_);
    std::fesetround(rounding);
#if defined(__SSE2__)
    if (flushes_denormals) _mm_setcsr(_mm_getcsr() | 0x8040);
#else
    static_cast<void>(flushes_denormals);
#endif
  }
  ~HostModes() { std::fesetenv(&before_); }
  HostModes(const HostModes&) = delete;
  HostModes& operator=(const HostModes&) = delete;

 private:
  std::fenv_t before_{};
};

template <class T>
void add(const SharedArray<T>& array, Hasher& hasher) {
  hasher.array(std::span(reinterpret_cast<const std::uint8_t*>(array.data()), array.size() * sizeof(T)));
}

void add(const Model& model, Hasher& hasher) {
  for (const auto* const corner : {&model.triangles.x, &model.triangles.y, &model.triangles.z})
    add(*corner, hasher);
  add(model.tree.lines, hasher);
  add(model.grid.cell, hasher);
  add(model.grid.lines, hasher);
  if (!model.patches) return;
  add(model.patches->tree.lines, hasher);
  add(model.patches->block, hasher);
  add(model.patches->shape, hasher);
  add(model.patches->samples, hasher);
}

struct Read {
  std::uint64_t scene = 0, model = 0, world = 0, motion = 0, ticks = 0, device = 0;
};

std::uint64_t model_hash(const Scene& scene, const Execution& execution) {
  Hasher hasher;
  add(built(scene, execution), hasher);
  return hasher.digest();
}

std::uint64_t world_hash(const Scene& scene) {
  Scene exact = scene;
  exact.settings.precision.fill(0);
  Hasher hasher;
  add(built(in_world(exact, {}, (own_folder() / "a.world").string())), hasher);
  return hasher.digest();
}

// A few ticks of the motion, resampled in the host's modes too.
void hash_ticks(const SceneFile& file, Read& read) {
  const Model model = built(file.scene, file.execution);
  State state;
  Scratch scratch = make_scratch(model);
  Hasher motion, ticks;
  for (int i = 0; i < 40; ++i) {
    const DeviceFrame frame = resample(file.motion, 0.125 * i);
    motion.value(hash_fields(frame));
    static_cast<void>(tick(model, state, scratch, frame));
    for (const std::uint64_t hash : scratch.stage_hash) ticks.value(hash);
  }
  read.motion = motion.digest();
  read.ticks = ticks.digest();
}

std::uint64_t device_hash() {
  DeviceProfile profile;
  EXPECT_TRUE(load_device_profile(LUMBRICAL_SOURCE_DIR "/examples/devices/exoskeleton.json", profile).ok());
  Hasher hasher;
  for (const auto& actuator : profile.actuators) {
    hasher.value(actuator.lower);
    hasher.value(actuator.upper);
  }
  return hasher.digest();
}

Read read_all(const std::string& path, int rounding, bool flushes_denormals) {
  const HostModes modes(rounding, flushes_denormals);
  Read read;
  SceneFile file;
  const Status status = load_scene_file(path, file);
  EXPECT_TRUE(status.ok()) << status.message();
  std::vector<std::uint8_t> session;
  EXPECT_TRUE(encode_session(file.scene, session).ok());
  Hasher hasher;
  hasher.array(session);
  read.scene = hasher.digest();
  for (const Broadphase broadphase : {Broadphase::tree, Broadphase::grid}) {
    Execution execution;
    execution.broadphase = broadphase;
    execution.threads = 2;
    read.model ^= model_hash(file.scene, execution);
  }
  read.world = world_hash(file.scene);
  hash_ticks(file, read);
  read.device = device_hash();
  EXPECT_EQ(std::fegetround(), rounding) << "the host's mode is its own";
  return read;
}

std::uint64_t motion_hash(const Motion& motion) {
  Hasher hasher;
  for (const MotionSample& sample : motion.samples) {
    hasher.value(sample.time);
    hasher.value(hash_fields(sample.frame));
  }
  return hasher.digest();
}

std::uint64_t mesh_hash(const Mesh& mesh) {
  Hasher hasher;
  for (const Vec3& p : mesh.vertices)
    for (const double coordinate : {p.x, p.y, p.z}) hasher.value(coordinate);
  return hasher.digest();
}

// Each by itself, without the file that is around it as a rule.
std::vector<std::uint64_t> hashes_of_parts(const std::string& scene, int rounding) {
  const HostModes modes(rounding, rounding != FE_TONEAREST);
  std::vector<std::uint64_t> hashes;
  Motion grasp = make_grasp(default_hand(Side::right), 0.037, 0.095, 10);
  hashes.push_back(motion_hash(grasp));
  const Pose pose{{0.1, -0.3, 0.0123}, {0.48, 0.6, 0.64, 0}};
  EXPECT_TRUE(place_motion({pose, 1}, grasp).ok());
  hashes.push_back(motion_hash(grasp));
  Mesh mesh = make_sphere(0.1, 12);
  place_mesh(pose, mesh);
  hashes.push_back(mesh_hash(mesh));
  const MeshReport report = inspect_mesh(mesh);
  Hasher of_report;
  for (const double number : {report.area, report.volume, report.shortest_edge, report.longest_edge})
    of_report.value(number);
  hashes.push_back(of_report.digest());
  FixReport fixes;
  hashes.push_back(mesh_hash(fixed_mesh(mesh, fixes)));
  const Status status = load_scene_objects(
      scene, [](const Execution&) { return Status(); },
      [&](SceneObject&& object) {
        hashes.push_back(mesh_hash(object.mesh));
        return Status();
      });
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(std::fegetround(), rounding) << "the host's mode is its own";
  return hashes;
}

TEST(RoundingMode, OfTheHostChangesNoneOfThePartsThatAreMadeByThemselves) {
  const std::string path = write_file("objects.json", R"({"objects": [
    {"name": "mug", "mug": {"radius": 0.037, "height": 0.095, "segments": 24}, "position": [0.3, 0.1, 0.7],
     "orientation": [0.9, 0.1, 0.3, 0.2], "scale": 1.1}]})");
  const std::vector<std::uint64_t> expected = hashes_of_parts(path, FE_TONEAREST);
  EXPECT_EQ(expected.size(), 6u);
  for (const int rounding : kRoundings) EXPECT_EQ(hashes_of_parts(path, rounding), expected) << rounding;
}

TEST(RoundingMode, OfTheHostChangesNothingThatIsReadOrBuilt) {
  write_file("odd.obj",
             "v 0.1 0.2 0.30000000000000004\nv 12.3456789012345678 1e-1 0.7\nv 3.3 44.4 5.55\n"
             "v 0.000001 7.7 1.0000000000000001\nf 1 2 3\nf 1 3 4\nf 4 2 1\n");
  const std::string path = write_file("scene.json", R"({
    "objects": [
      {"name": "mug", "mug": {"radius": 0.037, "height": 0.095, "segments": 24}},
      {"name": "box", "box": {"size": [0.1, 0.23, 0.07], "cells": 5}, "position": [0.3, 0.1, 0.7]},
      {"name": "odd", "mesh": "odd.obj", "unit": "mm", "position": [0.1, -0.3, 0.0123],
       "orientation": [0.9, 0.1, 0.3, 0.2], "scale": 1.1}],
    "hand": {"side": "right", "length": 0.187},
    "motion": {"grasp": {"radius": 0.037, "height": 0.095, "seconds": 10}},
    "settings": {"rate": 1000, "stiffness": 1.7e7}})");
  const Read expected = read_all(path, FE_TONEAREST, false);
  for (const int rounding : kRoundings) {
    for (const bool flushes : {false, true}) {
      SCOPED_TRACE("rounding " + std::to_string(rounding) + (flushes ? ", denormals flushed" : ""));
      const Read read = read_all(path, rounding, flushes);
      EXPECT_EQ(read.scene, expected.scene);
      EXPECT_EQ(read.model, expected.model);
      EXPECT_EQ(read.world, expected.world);
      EXPECT_EQ(read.motion, expected.motion);
      EXPECT_EQ(read.ticks, expected.ticks);
      EXPECT_EQ(read.device, expected.device);
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
