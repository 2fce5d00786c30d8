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
    {"mug.field", 0xa8b22becdeb7df6d},
    {"mug.column", 0xd8eaa7cae37ec3a4},
    {"mug.max-depth", 0x0798a573b64d26fa},
    {"mug.centroid", 0xf54e317386c148e2},
    {"mug.point", 0x3a183aee5ba4f004},
    {"crowd", 0x8ec461cf2ab0d428},
    {"thin.field", 0x74452dd5f79b13e5},
    {"thin.column", 0xd39de67ae28eee57},
    {"lost", 0x57a1b9714d8a9723},
    {"not_finite", 0x41340fbc5dbf2f6c},
    {"overflow", 0xe32b7c8120ad9bd4},
    {"large", 0x2d83a4977b60f1a9},
    {"far", 0x1d2831bbc4ca6e41},
    {"mixed", 0xd9973f80f2e8d026},
    {"samples.1e-3", 0x26d8a3e8cfd7467b},
    {"samples.1e-4", 0x9f3c41ffc481f9fc},
    {"samples.1e-5", 0x7223b758499086b3},
    {"bent", 0xa70706ce22d1f3e9},
    {"jacobians", 0xc432211d2a3b4861},
    {"pairs", 0x767409ad08b40967},
};
// clang-format on

}  // namespace lumbrical::test
