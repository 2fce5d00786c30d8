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
    {"mug.field", 0x561f7171fa5f5c03},
    {"mug.column", 0x672d1dc62031d990},
    {"mug.max-depth", 0x4aa9b4b7a71d23d4},
    {"mug.centroid", 0x21175c69873340e1},
    {"mug.point", 0x5a2a21e1adb8967c},
    {"crowd", 0xb55ebc759e0aaea4},
    {"thin.field", 0xd599d1ccc8a6a58b},
    {"thin.column", 0x8ac0ff62642270f9},
    {"pads", 0x9653689b02dc7766},
    {"lost", 0xbbda3d24c76066c3},
    {"not_finite", 0xb93d7d16f84ff779},
    {"overflow", 0x913c86da50ab79a3},
    {"large", 0x562c6fbb742b1fe6},
    {"hall", 0x0ba8f084f29419e1},
    {"far", 0xaf7b67d1201ca2f9},
    {"mixed", 0xeff0d772b15276c9},
    {"samples.1e-3", 0xc25efbaa53188120},
    {"samples.1e-4", 0x3ad7a039c613d431},
    {"samples.1e-5", 0x2ead350bb9d1279d},
    {"never.1e-4", 0x4c0c2e0a7cded364},
    {"once.exact", 0x64678ac7324aca80},
    {"bent", 0x115e956719de72e8},
    {"objects", 0x9b99d01c5cd22674},
    {"proxy", 0x8e2a6e809a5401a9},
    {"surface", 0xbb2a62ecb99c8554},
    {"jacobians", 0x9d955d8cf77ad843},
    {"pairs", 0x767409ad08b40967},
};
// clang-format on

}  // namespace lumbrical::test
