// Fuzzes recovery: whatever the file, what recovery writes is whole and can be read.
#include <cstdio>

#include "fuzz_input.h"
#include "lumbrical/recording.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumbrical;
  const test::MemoryFile file(data, size);
  if (!file.good()) return 0;
  static const std::string output = "/dev/shm/lumbrical_fuzz_" + std::to_string(::getpid()) + ".mcap";
  std::remove(output.c_str());
  std::uint64_t recovered = 0, lost = 0;
  if (!recover_recording(file.path(), output, recovered, lost).ok()) return 0;
  RecordingInfo info;
  if (!verify_recording(output, info).ok() || info.ticks != recovered) {
    // A message whose input was changed is copied as it is, and verify says so.
    RecordingReader reader;
    if (!reader.open(output).ok() || reader.info().ticks != recovered) __builtin_trap();
  }
  std::remove(output.c_str());
  return 0;
}
