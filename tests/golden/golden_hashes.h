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
    {"mug.field", 0xe0159433fff91411},
    {"mug.column", 0x9bed3d10cbfcaa90},
    {"mug.max-depth", 0x0c876a3a7ed56a6f},
    {"mug.centroid", 0x026e53a5988549ce},
    {"mug.point", 0xd1f2524224d7280a},
    {"crowd", 0x86d6b09fecd121ea},
    {"thin.field", 0x72186c8d13d5cf9a},
    {"thin.column", 0xaa74a79f663fd46f},
    {"lost", 0x80ca967d4b4f11f9},
    {"not_finite", 0x277f0d2aa574f53d},
    {"overflow", 0x79ed9e824cd45b32},
    {"coarse.1e-4", 0x4d9ab03b1536b622},
    {"coarse.1e-2", 0xd92e620f024308fd},
    {"large", 0x9a3890797a860d94},
    {"clusters", 0x5d5efbeb981095cf},
    {"far", 0x64af1465c787ad9e},
    {"mixed", 0x0759260943b01097},
    {"jacobians", 0xd45820877fb30ca6},
    {"pairs", 0x824d0d441c78d3ab},
};
// clang-format on

}  // namespace lumbrical::test
