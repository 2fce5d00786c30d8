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
    {"mug.field", 0xd36091b036ba1144},
    {"mug.column", 0x437b1937ecf7cdd1},
    {"mug.max-depth", 0x6b2548e101827dde},
    {"mug.centroid", 0x900782e97714a163},
    {"mug.point", 0x95e8d8d9ee283665},
    {"crowd", 0xeace5a5f0ce7c385},
    {"thin.field", 0x83f62f18347d3cd6},
    {"thin.column", 0xd3d432956edad24e},
    {"lost", 0x5b5a52eeb3467f5e},
    {"not_finite", 0xfb830bbd58b2f645},
    {"overflow", 0x0371a66795353981},
    {"coarse.1e-4", 0x2785a5014965b72c},
    {"coarse.1e-2", 0xfd61ab50bddb6135},
    {"large", 0x9844dfdcc2f4f75c},
    {"clusters", 0x88f833e97d8deb5f},
    {"far", 0xaad8e12a568b76c8},
    {"mixed", 0xf3499cb8b91b778e},
    {"jacobians", 0x9746d5d70253c9ec},
    {"pairs", 0x43e9cca726d85c78},
};
// clang-format on

}  // namespace lumbrical::test
