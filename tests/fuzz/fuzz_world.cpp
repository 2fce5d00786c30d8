// Fuzzes world files: what is opened can be ticked in. The input is a file's end and its arrays, one behind
// the other; pages and hashes are made here, so that damage gets past them. An odd first byte: the file as it
// is.
#include <cstring>
#include <vector>

#include "files/world_format.h"
#include "fuzz_input.h"
#include "lumbrical/tick.h"
#include "lumbrical/world.h"
#include "world_input.h"

namespace {

using namespace lumbrical;

// A hand in the middle of the world, and one at its corner.
void tick_in(const std::shared_ptr<const World>& world, double precision) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.settings.precision.fill(precision);
  scene.settings.max_candidates = 1000;
  scene.world = world;
  Model model;
  if (!build_model(scene, {}, model).ok()) return;
  State state;
  Scratch scratch = make_scratch(model);
  DeviceFrame frame;
  frame.kind = InputKind::joint_angles;
  frame.valid = ~0u;
  for (const Vec3 at : {(world->extent.lower + world->extent.upper) * 0.5, world->extent.lower}) {
    frame.base.position = at;
    static_cast<void>(tick(model, state, scratch, frame));
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span<const std::uint8_t> bytes(data + 1, size - 1);
  const std::vector<std::uint8_t> content = data[0] % 2 != 0
                                                ? std::vector<std::uint8_t>(bytes.begin(), bytes.end())
                                                : test::world_from_input(bytes);
  const test::MemoryFile file(content.data(), content.size());
  if (!file.good()) return 0;
  std::shared_ptr<const World> world;
  if (!open_world(file.path(), world).ok()) return 0;
  for (const double precision : {0.0, 1e-4}) tick_in(world, precision);
  return 0;
}
