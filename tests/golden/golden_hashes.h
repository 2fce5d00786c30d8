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
    {"mug.field", 0xc1c64ef223d471bb},
    {"mug.column", 0x437b1937ecf7cdd1},
    {"mug.max-depth", 0x6b2548e101827dde},
    {"mug.centroid", 0x900782e97714a163},
    {"mug.point", 0x95e8d8d9ee283665},
    {"crowd", 0x95da2a0888e0bd44},
    {"thin.field", 0xe9926f4a87866749},
    {"thin.column", 0xd3d432956edad24e},
    {"lost", 0x7f0acb9dd8a5f313},
    {"not_finite", 0xafcdcebd29d44065},
    {"overflow", 0x712ec8780e6e43a1},
    {"coarse.1e-4", 0x33dc2043e25ad17e},
    {"coarse.1e-2", 0x53952331dc242b34},
    {"large", 0x4ec113f5eb4c176a},
    {"clusters", 0x6e7e0a62ae03b893},
    {"far", 0x46a6f6671604de66},
    {"mixed", 0xd046df5c436550ff},
    {"jacobians", 0x3e38b90dc4332d2d},
    {"pairs", 0x750e2e6af55b7b7a},
};
// clang-format on

}  // namespace lumbrical::test
