// Fuzzes the reader of recordings: opening, reading to the end, seeking, verifying.
#include "fuzz_input.h"
#include "lumbrical/recording.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumbrical;
  const test::MemoryFile file(data, size);
  if (!file.good()) return 0;
  RecordingReader reader;
  if (reader.open(file.path()).ok()) {
    TickRecord record;
    for (bool end = false; !end && reader.next(record, end).ok();) {
    }
    for (const std::uint64_t tick : {std::uint64_t{0}, std::uint64_t{3}, ~std::uint64_t{0}}) {
      bool end = false;
      if (!reader.seek(tick).ok() || !reader.next(record, end).ok() || end) continue;
      if (record.output.tick < tick) __builtin_trap();
    }
  }
  RecordingReader messages;
  if (messages.open(file.path()).ok()) {
    RecordedMessage message;
    for (bool end = false; !end && messages.next_message(message, end).ok();) {
      if (!end && message.bytes.empty()) __builtin_trap();
    }
  }
  RecordingInfo info;
  static_cast<void>(verify_recording(file.path(), info).ok());
  return 0;
}
