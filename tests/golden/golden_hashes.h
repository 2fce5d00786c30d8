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
    {"mug.field", 0xf90e42caa5fc55aa},
    {"mug.column", 0x437b1937ecf7cdd1},
    {"mug.max-depth", 0x6b2548e101827dde},
    {"mug.centroid", 0x900782e97714a163},
    {"mug.point", 0x95e8d8d9ee283665},
    {"crowd", 0x64272712e8171672},
    {"thin.field", 0x90840c1db21811ba},
    {"thin.column", 0xd3d432956edad24e},
    {"lost", 0xe2d7748227d378f9},
    {"not_finite", 0x64de68a883b8126b},
    {"overflow", 0xee34d95c564cbdfc},
    {"coarse.1e-4", 0x6c0e0bcd325bd5f0},
    {"coarse.1e-2", 0x5ee8c666cc8d8db3},
    {"large", 0x8b2db95aef1ff713},
    {"far", 0xcd04eb5e3f7a47a7},
    {"mixed", 0x75e437f831ff5468},
    {"jacobians", 0xe083edee2b2b9f31},
    {"pairs", 0x11df48f22b0bf711},
};
// clang-format on

}  // namespace lumbrical::test
