// Recordings replay to the last bit in every way this machine can run them: each golden session is recorded
// in one way, read back from its file and replayed in the others. More machines: tests/golden.
#include <gtest/gtest.h>

#include <cstdlib>

#include "golden/golden_sessions.h"
#include "recording_fixture.h"

namespace lumbrical::test {
namespace {

void record_session(const std::string& path, const GoldenSession& session, const Execution& execution) {
  const Model model = model_of(session.scene, execution);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  std::vector<TickRecord> records;
  for (const DeviceFrame& frame : session.frames) {
    TickRecord record;
    record.device = frame;
    record.output = tick(model, state, scratch, frame);
    take_results(state, scratch, record);
    records.push_back(record);
  }
  write_recording(path, session.scene, records);
}

/// All of them with LUMBRICAL_MATRIX=all, otherwise one in `share`.
std::vector<Execution> ways_to_replay(std::size_t first, std::size_t share) {
  const char* const wanted = std::getenv("LUMBRICAL_MATRIX");
  const bool all = wanted != nullptr && std::string(wanted) == "all";
  std::vector<Execution> ways;
  std::size_t number = first;
  for (const Isa isa : {Isa::scalar, Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon}) {
    if (!available(isa)) continue;
    for (const Broadphase broadphase :
         {Broadphase::tree, Broadphase::grid, Broadphase::brute, Broadphase::voxel}) {
      if (!available(broadphase)) continue;
      for (const std::uint32_t threads : {1u, 2u, 4u, 8u}) {
        if (number++ % share != 0 && !all) continue;
        Execution way;
        way.isa = isa;
        way.broadphase = broadphase;
        way.threads = threads;
        ways.push_back(way);
      }
    }
  }
  return ways;
}

TEST(ReplayMatrix, EverySessionReplaysIdenticalInEveryWay) {
  const std::string path = temporary_path("session.mcap");
  std::uint32_t number = 0;
  for (const GoldenSession& session : golden_sessions()) {
    Execution recorded_in;  // not always the same
    recorded_in.broadphase = number % 2 == 0 ? Broadphase::tree : Broadphase::grid;
    recorded_in.threads = 1 + number % 3;
    record_session(path, session, recorded_in);
    for (const Execution& way : ways_to_replay(number++, 23)) {
      RecordingReader reader;
      const Status opened = reader.open(path);
      ASSERT_TRUE(opened.ok()) << opened.message();
      ReplayOptions options;
      options.execution = way;
      ReplayResult result;
      const Status status = replay(reader, options, result);
      ASSERT_TRUE(status.ok()) << status.message();
      EXPECT_EQ(result.ticks, session.frames.size());
      EXPECT_FALSE(result.first_divergence.has_value())
          << session.name << ", " << isa_name(way.isa) << ", " << broadphase_name(way.broadphase) << ", "
          << way.threads << " threads: tick " << result.first_divergence->tick << ", "
          << result.first_divergence->stage << ", " << result.first_divergence->field;
    }
  }
}

}  // namespace
}  // namespace lumbrical::test
