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
    {"mug.field", 0xf4655e60f23339b1},
    {"mug.column", 0x46aa935979aeb5ea},
    {"mug.max-depth", 0x736f1d0ff1a6b0d6},
    {"mug.centroid", 0xaf4c378504eed8b8},
    {"mug.point", 0xdecd028b3d50eb28},
    {"crowd", 0xdc4e7456d4678760},
    {"thin.field", 0xe4218c7d32678c35},
    {"thin.column", 0x2c3181902ca3a1f0},
    {"pads", 0x2072482bf44abd94},
    {"lost", 0x4a871cb08dc0b648},
    {"not_finite", 0xe1a2c657fc3d113d},
    {"overflow", 0x54a9f4739ab5e991},
    {"large", 0xbc83a355b3585f37},
    {"hall", 0xbfad4573a522577a},
    {"far", 0x2634e917067adf5d},
    {"mixed", 0xce4607d9d95b6e28},
    {"samples.1e-3", 0x0f09deff61b6fd15},
    {"samples.1e-4", 0x8484abedd9761685},
    {"samples.1e-5", 0xc4261d545fe17f40},
    {"never.1e-4", 0x5c8220844d2983d8},
    {"once.exact", 0x0a1ff8db5842ae5b},
    {"bent", 0x1244bd5d5c71e5ec},
    {"objects", 0x70667a5dfa7e29e1},
    {"proxy", 0xcf456dfd9d12d1e3},
    {"surface", 0xa1cae56903145d61},
    {"jacobians", 0x718ea976650a35bb},
    {"pairs", 0xfbbed11c26839869},
};
// clang-format on

}  // namespace lumbrical::test
