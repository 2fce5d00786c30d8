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
    {"mug.field", 0xa994fd31e8794d76},
    {"mug.column", 0x437b1937ecf7cdd1},
    {"mug.max-depth", 0x6b2548e101827dde},
    {"mug.centroid", 0x900782e97714a163},
    {"mug.point", 0x95e8d8d9ee283665},
    {"crowd", 0xe6f5acea078afc9c},
    {"thin.field", 0x577edfb71005ad9f},
    {"thin.column", 0xd3d432956edad24e},
    {"lost", 0xa5437e791362a544},
    {"not_finite", 0x258803085b14c390},
    {"overflow", 0x0520e1249f7dd2e6},
    {"coarse.1e-4", 0xc4ae2d0ed8e816ce},
    {"coarse.1e-2", 0x62b1fe7bae01962a},
    {"large", 0x4798ac9071e578e3},
    {"clusters", 0x57b86595ce9f82b0},
    {"far", 0x2fc81b25efa7817c},
    {"mixed", 0xc3f6f0dd44b09d8c},
    {"jacobians", 0x7e42fddb4f224ac0},
    {"pairs", 0x11abbd248a74739e},
};
// clang-format on

}  // namespace lumbrical::test
