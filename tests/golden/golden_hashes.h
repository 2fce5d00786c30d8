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
    {"mug.field", 0x3e050a761d4c3c2c},
    {"mug.column", 0x9bed3d10cbfcaa90},
    {"mug.max-depth", 0x0c876a3a7ed56a6f},
    {"mug.centroid", 0x026e53a5988549ce},
    {"mug.point", 0x20af9356fa81e7c6},
    {"crowd", 0x5373b04f587095ab},
    {"thin.field", 0xc4d6aed24c668944},
    {"thin.column", 0x2c88c686893c251b},
    {"lost", 0x1e9e6c6799bf516a},
    {"not_finite", 0xb09686f0e874717e},
    {"overflow", 0xcc4b8a4d936ff51d},
    {"coarse.1e-4", 0x3b577551030e551b},
    {"coarse.1e-2", 0x0365467c6d94a0ee},
    {"large", 0x8880df00b1653ed2},
    {"clusters", 0x4bcc38c465361803},
    {"far", 0xaf6fc9f6efbecfef},
    {"mixed", 0x3b12ba0389797b4d},
    {"jacobians", 0x868bf69e3a5f3e60},
    {"pairs", 0xedb2a9619bd31394},
};
// clang-format on

}  // namespace lumbrical::test
