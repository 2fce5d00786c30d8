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
    {"mug.field", 0xc1ec9efbbd430605},
    {"mug.column", 0x2d65dafa6e53d6e8},
    {"mug.max-depth", 0x1d24d0da7e8e4d46},
    {"mug.centroid", 0xd8df38eca320425e},
    {"mug.point", 0x5a191beadb1afacd},
    {"crowd", 0x81740599ea276863},
    {"thin.field", 0x1e1fc096638532ae},
    {"thin.column", 0xe22512f744a705d7},
    {"pads", 0xadf241d9294a5e67},
    {"lost", 0xdbde21eacf01eb1f},
    {"not_finite", 0x4e5d4be2e633bc64},
    {"overflow", 0x793eaccdfd683652},
    {"large", 0x47e040dae85c4ac7},
    {"hall", 0xe2720797c1d7d780},
    {"far", 0x9c1db5590464b9de},
    {"mixed", 0x8411a0fbc05ddcb0},
    {"samples.1e-3", 0x02ef8c2080ca3ebe},
    {"samples.1e-4", 0x0f8a6ea6b889ad15},
    {"samples.1e-5", 0xd6b79891738d6e7d},
    {"never.1e-4", 0x3dd72563b8fc43a2},
    {"once.exact", 0x8c8ac6dff8422089},
    {"bent", 0xf8fbd0e3cbac4f7f},
    {"objects", 0x9264dfc443ad1145},
    {"proxy", 0x44f3a1eeb6d67c5d},
    {"surface", 0x94a7eac90e664c6b},
    {"jacobians", 0xe2a380565e13045c},
    {"pairs", 0x767409ad08b40967},
};
// clang-format on

}  // namespace lumbrical::test
