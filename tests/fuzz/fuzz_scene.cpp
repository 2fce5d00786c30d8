// Fuzzes scene files (JSON; hands and settings stand in them too).
#include "fuzz_input.h"
#include "lumbrical/scene_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumbrical;
  const test::MemoryFile file(data, size);
  if (!file.good()) return 0;
  SceneFile scene;
  const Status status = load_scene_file(file.path(), scene);
  if (status.ok() && !(scene.seconds > 0)) __builtin_trap();
  return 0;
}
