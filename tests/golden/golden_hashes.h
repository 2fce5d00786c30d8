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
    {"mug.field", 0x1b7393cef67e1147},
    {"mug.column", 0xdbf26a96be0d5c5d},
    {"mug.max-depth", 0x84679bf7b451fb38},
    {"mug.centroid", 0xf52d46cd02f8a773},
    {"mug.point", 0x5cb931ff6f369b4c},
    {"crowd", 0xfe765fdd0d432de9},
    {"thin.field", 0xcbbe74ebecf6b466},
    {"thin.column", 0x46fa349c1c22a5b3},
    {"pads", 0x6ac4b78d7dc31d0c},
    {"lost", 0x671782d5f6a4566b},
    {"not_finite", 0xc0b4369692138c8e},
    {"overflow", 0xab29c3ec9c109978},
    {"large", 0x9b05764dc42546e6},
    {"hall", 0xde6e826c569b1d2b},
    {"far", 0xb8a40e717e4330c4},
    {"mixed", 0x6047cf1ef511a639},
    {"samples.1e-3", 0x3b1484bfdabfa0b3},
    {"samples.1e-4", 0x619b9b9fbeb2efa9},
    {"samples.1e-5", 0xe0f331da93d2e965},
    {"never.1e-4", 0x1fa4cc9d691362a0},
    {"once.exact", 0x295ada7aff44acf9},
    {"bent", 0x0aea5ef6cd67207e},
    {"objects", 0xe4706636104be839},
    {"proxy", 0x3e550762fa6d1cf6},
    {"surface", 0x16e6fc7c277a9ec6},
    {"jacobians", 0xef6d18e0cf38b8dc},
    {"pairs", 0xfbbed11c26839869},
};
// clang-format on

}  // namespace lumbrical::test
