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
    {"mug.field", 0xbd51d2f0958bd235},
    {"mug.column", 0x437b1937ecf7cdd1},
    {"mug.max-depth", 0x6b2548e101827dde},
    {"mug.centroid", 0x900782e97714a163},
    {"mug.point", 0x95e8d8d9ee283665},
    {"crowd", 0x99079a4b4b87a6d7},
    {"thin.field", 0xd3576080f0a1f9b3},
    {"thin.column", 0xd3d432956edad24e},
    {"lost", 0x8b320003ff845c2b},
    {"not_finite", 0xe14e22f150a2b59d},
    {"overflow", 0x0520e1249f7dd2e6},
    {"coarse.1e-4", 0xc4ae2d0ed8e816ce},
    {"coarse.1e-2", 0x62b1fe7bae01962a},
    {"large", 0xc48737410bfe767e},
    {"clusters", 0x88f833e97d8deb5f},
    {"far", 0x38e0c5a56c22bc1d},
    {"mixed", 0x49f1dd28ce597966},
    {"jacobians", 0x3e38b90dc4332d2d},
    {"pairs", 0x43e9cca726d85c78},
};
// clang-format on

}  // namespace lumbrical::test
