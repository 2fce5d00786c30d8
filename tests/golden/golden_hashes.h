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
    {"mug.field", 0x83ead04920efea43},
    {"mug.column", 0x437b1937ecf7cdd1},
    {"mug.max-depth", 0x6b2548e101827dde},
    {"mug.centroid", 0x900782e97714a163},
    {"mug.point", 0x95e8d8d9ee283665},
    {"crowd", 0x131a65a60c83dfb3},
    {"thin.field", 0x4199434dc95228a1},
    {"thin.column", 0xd3d432956edad24e},
    {"lost", 0x736d94260712587d},
    {"not_finite", 0x82b9b35927397a1a},
    {"overflow", 0x712ec8780e6e43a1},
    {"coarse.1e-4", 0x4d950302cbbeaa62},
    {"coarse.1e-2", 0x8ae2320506b4ca95},
    {"large", 0xaf707e4554605c87},
    {"clusters", 0xe328266da29e07cd},
    {"far", 0xcecf5d9a5825c259},
    {"mixed", 0x3e01c2b9a775eb83},
    {"jacobians", 0xd27356cf9b70c4e7},
    {"pairs", 0x750e2e6af55b7b7a},
};
// clang-format on

}  // namespace lumbrical::test
