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
    {"mug.field", 0x18f00b231bd07ffa},
    {"mug.column", 0x9c627624411f57e4},
    {"mug.max-depth", 0x1a6de6247bac4a9a},
    {"mug.centroid", 0x1e69f09e9f4f974b},
    {"mug.point", 0xe57660258455683e},
    {"crowd", 0xfef289e31d1d2823},
    {"thin.field", 0x4fd4a7e7962dbf3a},
    {"thin.column", 0x1ab74b2501437ed7},
    {"lost", 0x38c4e03a4d06341f},
    {"not_finite", 0x53cc1d9a043224c1},
    {"overflow", 0xc1c31b8c691af729},
    {"coarse.1e-4", 0x1a5fe21f3165a942},
    {"coarse.1e-2", 0x1f8c9b4d746676fe},
    {"large", 0x0daed4c8fe7f8c56},
    {"clusters", 0x9e183d123eea04b1},
    {"far", 0x4b01181ac06b41b9},
    {"mixed", 0x001bbb0cad6ee16c},
    {"jacobians", 0x868bf69e3a5f3e60},
    {"pairs", 0xedb2a9619bd31394},
};
// clang-format on

}  // namespace lumbrical::test
