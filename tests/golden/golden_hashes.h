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
    {"mug.field", 0x1fe42dc789375c91},
    {"mug.column", 0x437b1937ecf7cdd1},
    {"mug.max-depth", 0x6b2548e101827dde},
    {"mug.centroid", 0x900782e97714a163},
    {"mug.point", 0x95e8d8d9ee283665},
    {"crowd", 0x9c9083baab7a78ab},
    {"thin.field", 0xd37e92687a0118f6},
    {"thin.column", 0xd3d432956edad24e},
    {"lost", 0x376154f6edc6013c},
    {"not_finite", 0xdaea45b7ed1f3f1a},
    {"overflow", 0x4c493e87737c2797},
    {"coarse.1e-4", 0xc4ae2d0ed8e816ce},
    {"coarse.1e-2", 0x62b1fe7bae01962a},
    {"large", 0xc48737410bfe767e},
    {"clusters", 0xf300e79c65515fb7},
    {"far", 0x342273d29dca2034},
    {"mixed", 0x794bfa01e836f34c},
    {"jacobians", 0x56fe208c38922878},
    {"pairs", 0x267fe43f458b7e4a},
};
// clang-format on

}  // namespace lumbrical::test
