// What a recording holds beside its ticks, for the tests of those channels.
#pragma once

#include "recording_fixture.h"

namespace lumbrical::test {

struct View {
  MessageKind kind;
  std::uint64_t tick;
  std::vector<std::uint8_t> bytes;
};

inline std::vector<View> views_of(const std::string& path) {
  RecordingReader reader;
  EXPECT_TRUE(reader.open(path).ok());
  std::vector<View> views;
  for (;;) {
    RecordedMessage message;
    bool end = true;
    EXPECT_TRUE(reader.next_message(message, end).ok());
    if (end) return views;
    if (message.kind != MessageKind::tick)
      views.push_back({message.kind, message.tick, {message.bytes.begin(), message.bytes.end()}});
  }
}

}  // namespace lumbrical::test
