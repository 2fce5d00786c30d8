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
    {"mug.field", 0x2c4d0e2457b6158c},
    {"mug.column", 0x437b1937ecf7cdd1},
    {"mug.max-depth", 0x6b2548e101827dde},
    {"mug.centroid", 0x900782e97714a163},
    {"mug.point", 0x95e8d8d9ee283665},
    {"crowd", 0x68049814fc43e1b0},
    {"thin.field", 0x577edfb71005ad9f},
    {"thin.column", 0xd3d432956edad24e},
    {"lost", 0x4ff47ff4d5c9e7d6},
    {"not_finite", 0xbf1b57194711c969},
    {"overflow", 0x0520e1249f7dd2e6},
    {"coarse.1e-4", 0xc4ae2d0ed8e816ce},
    {"coarse.1e-2", 0x62b1fe7bae01962a},
    {"large", 0x4798ac9071e578e3},
    {"clusters", 0x404d61a031b0ad75},
    {"far", 0x7ec2805a1ed7ba05},
    {"mixed", 0xc3f6f0dd44b09d8c},
    {"jacobians", 0x2e98724939c304f7},
    {"pairs", 0x11abbd248a74739e},
};
// clang-format on

}  // namespace lumbrical::test
