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
    {"mug.field", 0x1582de71ed243996},
    {"mug.column", 0x2d65dafa6e53d6e8},
    {"mug.max-depth", 0x1d24d0da7e8e4d46},
    {"mug.centroid", 0xd8df38eca320425e},
    {"mug.point", 0x5a191beadb1afacd},
    {"crowd", 0x1cf1e2794e54cc40},
    {"thin.field", 0xb1c13b0399c3b2c2},
    {"thin.column", 0xe22512f744a705d7},
    {"pads", 0xcf56cda4333346a4},
    {"lost", 0x7496e3fd0ec6465c},
    {"not_finite", 0x4f9b5846ff4d656e},
    {"overflow", 0x328b8e6a16df7324},
    {"large", 0x10db887303afb831},
    {"hall", 0x224e1fd08a038a71},
    {"far", 0x68a5a0345a7c0ef5},
    {"mixed", 0x0fa608a68cd0fc9b},
    {"samples.1e-3", 0x1b789450e3d52a47},
    {"samples.1e-4", 0xa1e37c67029a393c},
    {"samples.1e-5", 0x598a4eb751e556f6},
    {"never.1e-4", 0xd5894f98912f60e9},
    {"once.exact", 0x07519d4806bece2b},
    {"bent", 0x04a260e3e2cc8bfa},
    {"objects", 0xbb0b7d20c22a6878},
    {"proxy", 0x0b38ce6b9adc6b4d},
    {"surface", 0x11974cfc053310aa},
    {"jacobians", 0x9b583e60bbf1891e},
    {"pairs", 0x767409ad08b40967},
};
// clang-format on

}  // namespace lumbrical::test
