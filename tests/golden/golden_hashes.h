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
    {"mug.field", 0xb5a657e3cd5c0ec1},
    {"mug.column", 0x2d65dafa6e53d6e8},
    {"mug.max-depth", 0x1d24d0da7e8e4d46},
    {"mug.centroid", 0xd8df38eca320425e},
    {"mug.point", 0x5a191beadb1afacd},
    {"crowd", 0x79e4b5394713e8e4},
    {"thin.field", 0x0de35ae8e1d07fd9},
    {"thin.column", 0xe22512f744a705d7},
    {"pads", 0x9b8c1f1b7330424a},
    {"lost", 0x481e10d52ea5d5c0},
    {"not_finite", 0x7d8b487916676988},
    {"overflow", 0x793eaccdfd683652},
    {"large", 0x346bd3ce10a03fc9},
    {"hall", 0x697b269c0edc4f32},
    {"far", 0xee7faf93c02ca24f},
    {"mixed", 0xbecc4fad3fa6958d},
    {"samples.1e-3", 0x02ef8c2080ca3ebe},
    {"samples.1e-4", 0x0f8a6ea6b889ad15},
    {"samples.1e-5", 0xd6b79891738d6e7d},
    {"never.1e-4", 0x3dd72563b8fc43a2},
    {"once.exact", 0xa2285d1b8caf5700},
    {"bent", 0xf3cb83c108bb7679},
    {"objects", 0x60de343d70e91752},
    {"proxy", 0x7b32fc4a4c0491a4},
    {"surface", 0x0a330f9f5d37f8aa},
    {"jacobians", 0x22d47f9665419395},
    {"pairs", 0xda37b192c4cf50e5},
};
// clang-format on

}  // namespace lumbrical::test
