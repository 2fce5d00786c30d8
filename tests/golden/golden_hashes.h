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
    {"mug.field", 0x11bfc58ad4df3b33},
    {"mug.column", 0xecf3a45a7600a8a1},
    {"mug.max-depth", 0x4aa9b4b7a71d23d4},
    {"mug.centroid", 0x21175c69873340e1},
    {"mug.point", 0x5a2a21e1adb8967c},
    {"crowd", 0x8cd8ef885435912c},
    {"thin.field", 0x4f5ca3ad71208562},
    {"thin.column", 0xc47751bd6dc1271d},
    {"pads", 0x28fabbeb4cdfef2a},
    {"lost", 0x6600c41a9c31bbe6},
    {"not_finite", 0x2b44b6e994f303b5},
    {"overflow", 0x913c86da50ab79a3},
    {"large", 0x562c6fbb742b1fe6},
    {"hall", 0x04112fc0eda081a5},
    {"far", 0xd95e03aefc4006fa},
    {"mixed", 0x344540ffb677a72c},
    {"samples.1e-3", 0xc25efbaa53188120},
    {"samples.1e-4", 0x3ad7a039c613d431},
    {"samples.1e-5", 0x2ead350bb9d1279d},
    {"never.1e-4", 0x4c0c2e0a7cded364},
    {"once.exact", 0x5cf0287e57af798c},
    {"bent", 0x09a8144b746ad1c7},
    {"objects", 0xdf5b2999247a8e34},
    {"proxy", 0xf4fbf12b00a20b39},
    {"surface", 0x9b498c33054cf626},
    {"jacobians", 0x9d955d8cf77ad843},
    {"pairs", 0x767409ad08b40967},
};
// clang-format on

}  // namespace lumbrical::test
