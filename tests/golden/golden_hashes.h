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
    {"mug.field", 0xbde9f5b9e55334c4},
    {"mug.column", 0x437b1937ecf7cdd1},
    {"mug.max-depth", 0x6b2548e101827dde},
    {"mug.centroid", 0x900782e97714a163},
    {"mug.point", 0x95e8d8d9ee283665},
    {"crowd", 0x02c5a89ae015d267},
    {"thin.field", 0x35d46de5433a8a8d},
    {"thin.column", 0xd3d432956edad24e},
    {"lost", 0x658d0d0959fe52c6},
    {"not_finite", 0xe5952d322fa443ec},
    {"overflow", 0x0520e1249f7dd2e6},
    {"coarse.1e-4", 0xc4ae2d0ed8e816ce},
    {"coarse.1e-2", 0x62b1fe7bae01962a},
    {"large", 0xc48737410bfe767e},
    {"clusters", 0x88f833e97d8deb5f},
    {"far", 0x17983193b1457425},
    {"mixed", 0xf6b0ef7718546921},
    {"jacobians", 0xaedc7a0a4c5c0b58},
    {"pairs", 0xeeff2b1a705308bf},
};
// clang-format on

}  // namespace lumbrical::test
