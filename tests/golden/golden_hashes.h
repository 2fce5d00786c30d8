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
    {"mug.field", 0xbfb89068d151e609},
    {"mug.column", 0xe423bea75ad6fd5c},
    {"mug.max-depth", 0xc474e349c7e2a7a3},
    {"mug.centroid", 0x7b895a8a3f638de3},
    {"mug.point", 0x1a2d7cc61a2143d7},
    {"crowd", 0x572dddf05b6e8a4d},
    {"thin.field", 0xb44bf9e79cf3441c},
    {"thin.column", 0x07a9faf375fd7ac5},
    {"pads", 0x70eb1e617a93c87e},
    {"lost", 0x51057f31a3f9d583},
    {"not_finite", 0x7ab3275c232fb9f4},
    {"overflow", 0xc9ff04ce6b56fdd9},
    {"large", 0x83023c88e760b0c9},
    {"far", 0x90cd2672f40c2f28},
    {"mixed", 0xb9e1774d9b236288},
    {"samples.1e-3", 0x5db30c0a478890fd},
    {"samples.1e-4", 0xe3db0ac501859dec},
    {"samples.1e-5", 0x4d10cc0d28f30732},
    {"bent", 0xc00b90d647139697},
    {"objects", 0x0393fc5150fdcb6c},
    {"proxy", 0xa743d3b26d48bcf8},
    {"surface", 0x237c7b45b926c734},
    {"jacobians", 0x9d955d8cf77ad843},
    {"pairs", 0x767409ad08b40967},
};
// clang-format on

}  // namespace lumbrical::test
