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
    {"mug.field", 0xe08cacfc4df2e915},
    {"mug.column", 0x9bed3d10cbfcaa90},
    {"mug.max-depth", 0x0c876a3a7ed56a6f},
    {"mug.centroid", 0x026e53a5988549ce},
    {"mug.point", 0xd1f2524224d7280a},
    {"crowd", 0xa3a0aef7fee3c010},
    {"thin.field", 0xc4d6aed24c668944},
    {"thin.column", 0xaa74a79f663fd46f},
    {"lost", 0x391e4b8d00bc408a},
    {"not_finite", 0xfea2025864ad024b},
    {"overflow", 0xcc4b8a4d936ff51d},
    {"coarse.1e-4", 0x2bf8645855a1fd36},
    {"coarse.1e-2", 0x2bf8645855a1fd36},
    {"large", 0xa6cc4b7097086be2},
    {"clusters", 0xd7dfc75444ab6765},
    {"far", 0x9449fc9011e1c5e8},
    {"mixed", 0x316026e3deef0b7b},
    {"jacobians", 0x1cbfd9e939d6fe53},
    {"pairs", 0x56bdbe15753425a0},
};
// clang-format on

}  // namespace lumbrical::test
