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
    {"mug.field", 0xdac79798aaf4e34e},
    {"mug.column", 0xaaebdca9be1d6369},
    {"mug.max-depth", 0x28990949fc393306},
    {"mug.centroid", 0x2a34e1b8eef2ccdd},
    {"mug.point", 0x40712ff96f782746},
    {"crowd", 0x9ea44ad8a390188d},
    {"thin.field", 0x3114260949245e30},
    {"thin.column", 0x21b7d01dec703445},
    {"pads", 0xc728fca5d4cee2e9},
    {"lost", 0x0d5da45df4d4a50e},
    {"not_finite", 0x1736a76fdb896f33},
    {"overflow", 0xadac379f94998820},
    {"large", 0x0e6762be8ca40479},
    {"hall", 0xa3bd255714c4903a},
    {"far", 0x11a8b1478b085337},
    {"mixed", 0xe556c22b2fc77e9d},
    {"samples.1e-3", 0xf53f69a1a156c197},
    {"samples.1e-4", 0x182eb1210594a224},
    {"samples.1e-5", 0x481a2128963e26f7},
    {"never.1e-4", 0xf9d7889cccb9fcc6},
    {"once.exact", 0x8d6f205c07a9d9eb},
    {"bent", 0xd95b0e9e89d8dea0},
    {"objects", 0xaf0a869abf8c1dad},
    {"proxy", 0x7af7e461af4a44cf},
    {"surface", 0xaa39f998982c4234},
    {"jacobians", 0x718ea976650a35bb},
    {"pairs", 0xfbbed11c26839869},
};
// clang-format on

}  // namespace lumbrical::test
