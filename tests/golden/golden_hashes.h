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
    {"mug.field", 0x6479a908097671f5},
    {"mug.column", 0xd8eaa7cae37ec3a4},
    {"mug.max-depth", 0x0798a573b64d26fa},
    {"mug.centroid", 0xf54e317386c148e2},
    {"mug.point", 0x3a183aee5ba4f004},
    {"crowd", 0xdd27cfcd31cc31d8},
    {"thin.field", 0xa83cdd8d4c4a8c76},
    {"thin.column", 0xd39de67ae28eee57},
    {"lost", 0x4793580877176aa9},
    {"not_finite", 0x212ece11f65b629e},
    {"overflow", 0xe32b7c8120ad9bd4},
    {"large", 0x2d83a4977b60f1a9},
    {"far", 0x6f72620efcae2a0c},
    {"mixed", 0xd9973f80f2e8d026},
    {"samples.1e-3", 0xec77dd6641f067ef},
    {"samples.1e-4", 0xc660a0730bc77e61},
    {"samples.1e-5", 0xd0b61b6107f79e94},
    {"bent", 0x240984258e269d07},
    {"jacobians", 0x5eda00259193fb31},
    {"pairs", 0x767409ad08b40967},
};
// clang-format on

}  // namespace lumbrical::test
