// Golden hashes: the bits of golden_sessions.h on every machine. Regenerate, on purpose and in a commit
// that says why, with
//   build/dev/tests/golden/golden_hashes print >golden && mv golden tests/golden/golden_hashes.h
#pragma once

#include <cstdint>

namespace lumbrical::test {

struct GoldenHash {
  const char* name;
  std::uint64_t hash;
};

// clang-format off
inline constexpr GoldenHash kGolden[] = {
    {"mug.field", 0x9e71bbf001dc4b98},
    {"mug.column", 0x437b1937ecf7cdd1},
    {"mug.max-depth", 0x6b2548e101827dde},
    {"mug.centroid", 0x900782e97714a163},
    {"mug.point", 0x95e8d8d9ee283665},
    {"crowd", 0xc83a8b1c54521945},
    {"thin.field", 0x11a1e72192f484af},
    {"thin.column", 0xd3d432956edad24e},
    {"lost", 0x4ccea0e0ca1104f8},
    {"not_finite", 0xe6fdf8e7c2dcbbfa},
    {"overflow", 0xa92958d4a05c9eb5},
    {"coarse.1e-4", 0xab55e9538cf05ade},
    {"coarse.1e-2", 0x42e728f98888d35a},
    {"large", 0x0d92e1faf9d00bd9},
    {"far", 0x046c215e8a170760},
    {"mixed", 0xbf7faae1ca46fda2},
    {"jacobians", 0xa5a06c6f755eb8b0},
    {"pairs", 0x4463ca2c02473e08},
};
// clang-format on

}  // namespace lumbrical::test
