// Batches over several threads: every job once, the results of one after the other.
#include "lumbrical/batch.h"

#include <gtest/gtest.h>

#include <atomic>
#include <cstring>
#include <stdexcept>

#include "pressed_hand.h"
#include "session.h"

namespace lumbrical::test {
namespace {

TEST(Batch, RunsEveryJobOnce) {
  for (const std::uint32_t threads : {1u, 2u, 3u, 64u}) {
    for (const std::size_t count : {0u, 1u, 2u, 100u}) {
      std::vector<std::atomic<int>> runs(count);
      run_jobs(count, threads, [&](std::size_t i) { ++runs[i]; });
      for (const std::atomic<int>& times : runs) EXPECT_EQ(times, 1);
    }
  }
  EXPECT_GE(core_count(), 1u);
}

TEST(Batch, JobsMayShareOutWorkThemselves) {
  std::atomic<int> runs{0};
  run_jobs(8, 4, [&](std::size_t) {
    run_jobs(8, 4, [&](std::size_t) { run_jobs(8, 2, [&](std::size_t) { ++runs; }); });
  });
  EXPECT_EQ(runs, 512);
}

TEST(Batch, AJobsExceptionComesOut) {
  EXPECT_THROW(run_jobs(10, 2,
                        [](std::size_t i) {
                          if (i == 5) throw std::runtime_error("five");
                        }),
               std::runtime_error);
}

// Poses in any order, from new states and from states amid a session.
void expect_same_as_one_by_one(const Model& model, const std::vector<DeviceFrame>& frames,
                               std::vector<Scratch>& kept) {
  std::vector<State> expected_state(frames.size());
  std::vector<ActuatorFrame> expected(frames.size());
  Scratch scratch = make_scratch(model);
  for (std::size_t i = 0; i < frames.size(); ++i) {
    for (std::size_t before = 0; before < i % 3; ++before) tick(model, expected_state[i], scratch, frames[0]);
  }
  const std::vector<State> start = expected_state;
  std::uint32_t contacts = 0;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    expected[i] = tick(model, expected_state[i], scratch, frames[i]);
    contacts += expected[i].contact_count;
  }
  EXPECT_GT(contacts, frames.size());
  for (const std::uint32_t threads : {1u, 2u, 5u, 64u}) {
    std::vector<State> state = start;
    std::vector<ActuatorFrame> output(frames.size());
    tick_each(model, frames, state, output, threads, kept);
    for (std::size_t i = 0; i < frames.size(); ++i) {
      EXPECT_EQ(hash_state(state[i]), hash_state(expected_state[i])) << "pose " << i;
      EXPECT_EQ(std::memcmp(&output[i], &expected[i], sizeof(ActuatorFrame)), 0) << "pose " << i;
    }
  }
}

TEST(Batch, PosesGiveTheSameBitsAsOneByOne) {
  const Scene scene = mug_scene(Law::max_depth);
  auto frames = grasp_frames(scene.hand, 60);
  frames.erase(frames.begin(), frames.begin() + 20);
  frames[7].base.position.x = NAN;
  frames[9].flags |= kTrackingLost;
  std::vector<Scratch> kept;  // from one call to the next, whatever their models and threads
  for (const std::uint32_t threads : {1u, 3u}) {
    Execution execution;
    execution.threads = threads;
    expect_same_as_one_by_one(model_of(scene, execution), frames, kept);
  }
  expect_same_as_one_by_one(model_of(scene), {frames.begin() + 15, frames.begin() + 17}, kept);
}

// Enough pairs for every stage to be shared out, with lists and without.
TEST(Batch, ATickOfManyPairsGivesTheSameBitsWithAnyNumberOfThreads) {
  Scene scene = pressed_scene(kWidthA, 250);
  scene.settings.law.fill(Law::point);
  std::vector<DeviceFrame> frames;
  for (const double time : {0.0, 0.0, 0.0005, 0.001, 0.0015, 0.2, 0.4, 0.4, 0.4005})
    frames.push_back(pressed_frame(scene.hand, 0.002, time));
  std::uint32_t contacts = 0;
  const std::uint64_t expected = hash_run(model_of(scene), frames, &contacts);
  EXPECT_GT(contacts, frames.size() * 10000);
  for (const Broadphase broadphase : {Broadphase::tree, Broadphase::grid, Broadphase::voxel}) {
    if (!available(broadphase)) continue;
    for (const std::uint32_t threads : {2u, 8u}) {
      Execution execution;
      execution.broadphase = broadphase;
      execution.threads = threads;
      EXPECT_EQ(hash_run(model_of(scene, execution), frames), expected) << broadphase_name(broadphase);
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
