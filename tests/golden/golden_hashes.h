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
    {"mug.field", 0x25db1b8d11286b4a},
    {"mug.column", 0x109b4e4dc06754b9},
    {"mug.max-depth", 0x0c7dd10349d59721},
    {"mug.centroid", 0xaab8dedd2e0945a1},
    {"mug.point", 0x196f5897ed1c8420},
    {"crowd", 0xfe765fdd0d432de9},
    {"thin.field", 0xcbbe74ebecf6b466},
    {"thin.column", 0x46fa349c1c22a5b3},
    {"pads", 0x6ac4b78d7dc31d0c},
    {"lost", 0xe714a3f030fec9fd},
    {"not_finite", 0x3c4af4f48800de8e},
    {"overflow", 0x1397c66a87743c03},
    {"large", 0x9b05764dc42546e6},
    {"hall", 0xde6e826c569b1d2b},
    {"far", 0x51476b7d0a9d4b4f},
    {"mixed", 0xc6eff274d2fffb94},
    {"samples.1e-3", 0xb869884b5c22d3b0},
    {"samples.1e-4", 0xbad339639b167290},
    {"samples.1e-5", 0xe57bdfe2574de8cc},
    {"never.1e-4", 0xf29f9612dbc5019a},
    {"once.exact", 0x52f669d56f798aa6},
    {"bent", 0x9a1eae41cdddb7df},
    {"plump", 0xcf833ed578082b7b},
    {"objects", 0xbf1a29215da23cd2},
    {"proxy", 0x88e7a430604cc7fe},
    {"surface", 0x794a8bee8a294c5f},
    {"jacobians", 0x718ea976650a35bb},
    {"pairs", 0xfbbed11c26839869},
};
// clang-format on

}  // namespace lumbrical::test
