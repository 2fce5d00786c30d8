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
    {"mug.field", 0xe993475efb329a3d},
    {"mug.column", 0x7659e8796436091a},
    {"mug.max-depth", 0xd3fc2c4b5ca69a52},
    {"mug.centroid", 0xa17f2d1bb0fe64a6},
    {"mug.point", 0x283a9a0d820869a1},
    {"crowd", 0xc0cd6007efd1453d},
    {"thin.field", 0x4a92ff552a47f7a0},
    {"thin.column", 0xbff20e064a201276},
    {"pads", 0xf624cc2020aaa191},
    {"lost", 0xecdf5276dd95fd80},
    {"not_finite", 0x99eff3299f93b5bf},
    {"overflow", 0x1be36847d7b1533c},
    {"large", 0xa239ed3c1609d9ff},
    {"hall", 0x221b856fa0ce30af},
    {"far", 0x23e64ab1626cb5cc},
    {"mixed", 0xc457c333b92ca99b},
    {"samples.1e-3", 0x7515c6be0affb1c2},
    {"samples.1e-4", 0xf330c63372288854},
    {"samples.1e-5", 0x093b0b4a8f4b6ec1},
    {"never.1e-4", 0xeb3c8638e72d0a39},
    {"once.exact", 0x856fed2d5bc63fd3},
    {"bent", 0x553879e650c63c03},
    {"plump", 0x636ca2dbdb2c2db1},
    {"fists", 0x7ac93474521ec0cd},
    {"objects", 0x9cb4e5656590cb05},
    {"proxy", 0x2c3394d146c2104c},
    {"surface", 0x0bd551152ee7d965},
    {"jacobians", 0x718ea976650a35bb},
    {"pairs", 0xfbbed11c26839869},
};
// clang-format on

}  // namespace lumbrical::test
