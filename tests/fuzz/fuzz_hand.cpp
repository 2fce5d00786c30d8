// Fuzzes hand files (JSON), as a scene with a `hand_file` reads them: what is taken makes a hand.
#include "fuzz_input.h"
#include "lumbrical/scene_file.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace lumbrical;
  const test::MemoryFile hand(data, size);
  if (!hand.good()) return 0;
  const std::string text =
      R"({"objects": [{"plane": {"cells": 1}}], "motion": {"grasp": {}}, "hand_file": ")" + hand.path() +
      "\"}";
  const test::MemoryFile file(reinterpret_cast<const std::uint8_t*>(text.data()), text.size());
  if (!file.good()) return 0;
  SceneFile scene;
  if (!load_scene_file(file.path(), scene).ok()) return 0;
  if (!check_hand(scene.scene.hand).ok()) __builtin_trap();
  return 0;
}
