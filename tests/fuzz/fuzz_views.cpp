// Fuzzes what a recording holds for others to draw, and its ways out: whatever posed hands, contact points
// and scenes a file claims to hold, they are verified, copied and exported, or refused.
#include <cstdio>
#include <vector>

#include "fuzz_input.h"
#include "lumbrical/recording.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumbrical;
  const test::MemoryFile file(data, size);
  if (!file.good()) return 0;
  static const std::string output = "/dev/shm/lumbrical_fuzz_views_" + std::to_string(::getpid());
  RecordingInfo info;
  static_cast<void>(verify_recording(file.path(), info).ok());
  CopyResult copied;
  std::remove(output.c_str());
  static_cast<void>(copy_recordings({file.path()}, output, {1, 3, std::nullopt}, copied).ok());
  std::vector<RecordingReader> readers;
  if (!open_hands(file.path(), readers).ok()) return 0;
  for (const MessageKind kind : {MessageKind::pose, MessageKind::contacts}) {
    for (const ExportFormat format : {ExportFormat::csv, ExportFormat::json, ExportFormat::npz}) {
      ExportOptions options;
      options.format = format;
      options.step = format == ExportFormat::csv ? 1 : 2;
      std::remove(output.c_str());
      static_cast<void>(export_views(readers, kind, options, output).ok());
    }
  }
  std::remove(output.c_str());
  return 0;
}
