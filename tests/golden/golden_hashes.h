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
    {"pads", 0xbac4026f4d9abe5a},
    {"lost", 0xdbde21eacf01eb1f},
    {"not_finite", 0x4e5d4be2e633bc64},
    {"overflow", 0x793eaccdfd683652},
    {"large", 0x47e040dae85c4ac7},
    {"hall", 0xe2720797c1d7d780},
    {"far", 0x9c1db5590464b9de},
    {"mixed", 0x8411a0fbc05ddcb0},
    {"samples.1e-3", 0x1b789450e3d52a47},
    {"samples.1e-4", 0xa1e37c67029a393c},
    {"samples.1e-5", 0x598a4eb751e556f6},
    {"never.1e-4", 0xd5894f98912f60e9},
    {"once.exact", 0x85a4ccd2f586f6fc},
    {"bent", 0xf8fbd0e3cbac4f7f},
    {"objects", 0xa72e33b2bf7ea819},
    {"proxy", 0x44f3a1eeb6d67c5d},
    {"surface", 0x1a48e7934b0332c8},
    {"jacobians", 0xe2a380565e13045c},
    {"pairs", 0x767409ad08b40967},
};
// clang-format on

}  // namespace lumbrical::test
