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
    {"mug.field", 0x0fa06f7fd3ca3f28},
    {"mug.column", 0x9bed3d10cbfcaa90},
    {"mug.max-depth", 0x0c876a3a7ed56a6f},
    {"mug.centroid", 0x026e53a5988549ce},
    {"mug.point", 0xd1f2524224d7280a},
    {"crowd", 0x300e0b5f136cc4c7},
    {"thin.field", 0xe0d17ec94ee5d6cc},
    {"thin.column", 0xaa74a79f663fd46f},
    {"lost", 0x52c91fdbf19e43b9},
    {"not_finite", 0x0d87efa75a9a1f7d},
    {"overflow", 0x99c863d747b87e9b},
    {"coarse.1e-4", 0xf65418ffe3b8d95c},
    {"coarse.1e-2", 0xab3af1a44f6bb552},
    {"large", 0x9af475dbda994a75},
    {"clusters", 0x34ab3c5fd773ae3a},
    {"far", 0xa342e25fc7feb85c},
    {"mixed", 0xb33387cce2bf3545},
    {"jacobians", 0xec99909a0cb0475f},
    {"pairs", 0x641ebc129a58a7ca},
};
// clang-format on

}  // namespace lumbrical::test
