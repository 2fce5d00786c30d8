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
    {"mug.field", 0x32b4350e9e293ffc},
    {"mug.column", 0xe3daa1c15bb1d623},
    {"mug.max-depth", 0x0c876a3a7ed56a6f},
    {"mug.centroid", 0x026e53a5988549ce},
    {"mug.point", 0xd1f2524224d7280a},
    {"crowd", 0x52cb199903d0ff48},
    {"thin.field", 0xdf18b58f4053fdd1},
    {"thin.column", 0x2bc9116f51b9303a},
    {"lost", 0xe9e9fb56d8213938},
    {"not_finite", 0x0d7c5832a237729b},
    {"overflow", 0x953a5b76c736e0b2},
    {"coarse.1e-4", 0xda3392697dc03246},
    {"coarse.1e-2", 0xda3392697dc03246},
    {"large", 0x420faee7f6f1840b},
    {"clusters", 0xd4e85d3c36f45920},
    {"far", 0x44fd44ee99284596},
    {"mixed", 0xdf1d27f17358bab1},
    {"jacobians", 0x1cbfd9e939d6fe53},
    {"pairs", 0xcedace5b4c794da8},
};
// clang-format on

}  // namespace lumbrical::test
