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
    {"mug.field", 0xad73f212d66c4e47},
    {"mug.column", 0x719dcf0ca4c26fdf},
    {"mug.max-depth", 0x495e8d64e318e02c},
    {"mug.centroid", 0x1575752d056b99f3},
    {"mug.point", 0xa2c94b866747d8ad},
    {"crowd", 0x193c0d5cd0db6c1e},
    {"thin.field", 0x86c89df953a4900d},
    {"thin.column", 0xf96dfdf029bfd5a9},
    {"lost", 0xe3a30908d2fb88f1},
    {"not_finite", 0x768e08073193f033},
    {"overflow", 0x3ed1e708e297e920},
    {"coarse.1e-4", 0x0d8332e6fad80469},
    {"coarse.1e-2", 0x601a8842d0cc585d},
    {"large", 0xbd0a9ca6b4e53e6b},
    {"clusters", 0xc0154c723127722c},
    {"far", 0x2bd04e113a46bebe},
    {"mixed", 0x77c760a25fdc917f},
    {"jacobians", 0xbfffdae3dcd01213},
    {"pairs", 0xedb2a9619bd31394},
};
// clang-format on

}  // namespace lumbrical::test
