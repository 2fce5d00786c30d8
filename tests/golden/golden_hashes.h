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
    {"mug.field", 0x79d88f1aa9a17b08},
    {"mug.column", 0xd8eaa7cae37ec3a4},
    {"mug.max-depth", 0x0798a573b64d26fa},
    {"mug.centroid", 0xf54e317386c148e2},
    {"mug.point", 0x3a183aee5ba4f004},
    {"crowd", 0x93c1202149e778a6},
    {"thin.field", 0xd4d965c7b6b9500a},
    {"thin.column", 0xd39de67ae28eee57},
    {"lost", 0x57b9ea213ea78b0d},
    {"not_finite", 0x8c1305893a9dc68c},
    {"overflow", 0xcfd50e7417eeecaa},
    {"large", 0x9c09ef0df2394f30},
    {"far", 0xa44d6ec5bbb7245c},
    {"mixed", 0xc5783817ab3e02dc},
    {"samples.1e-3", 0x26d8a3e8cfd7467b},
    {"samples.1e-4", 0x9f3c41ffc481f9fc},
    {"samples.1e-5", 0x7223b758499086b3},
    {"bent", 0xb0cc7c502bf77f31},
    {"jacobians", 0xa6c38a408113f01d},
    {"pairs", 0xcedace5b4c794da8},
};
// clang-format on

}  // namespace lumbrical::test
