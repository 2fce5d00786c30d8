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
    {"mug.field", 0xbfa1f49a8cce1463},
    {"mug.column", 0x2d65dafa6e53d6e8},
    {"mug.max-depth", 0x1d24d0da7e8e4d46},
    {"mug.centroid", 0xd8df38eca320425e},
    {"mug.point", 0x5a191beadb1afacd},
    {"crowd", 0x2ae973eb51130e0e},
    {"thin.field", 0xbe2a34f744875ae9},
    {"thin.column", 0xe22512f744a705d7},
    {"pads", 0xcf56cda4333346a4},
    {"lost", 0x2dbdea1c428de3fb},
    {"not_finite", 0xea539a72889f861e},
    {"overflow", 0x328b8e6a16df7324},
    {"large", 0x10db887303afb831},
    {"hall", 0xd3d0e121f066e662},
    {"far", 0x56d732ed72c397ea},
    {"mixed", 0x0fa608a68cd0fc9b},
    {"samples.1e-3", 0x1b789450e3d52a47},
    {"samples.1e-4", 0xa1e37c67029a393c},
    {"samples.1e-5", 0x598a4eb751e556f6},
    {"never.1e-4", 0xd5894f98912f60e9},
    {"once.exact", 0x8e36038fc80fa135},
    {"bent", 0xca2e131402f160a7},
    {"objects", 0x9f0cbc0b1bc5c484},
    {"proxy", 0x1c6616e8659242c0},
    {"surface", 0xa3f73890f27527bb},
    {"jacobians", 0x9d955d8cf77ad843},
    {"pairs", 0x767409ad08b40967},
};
// clang-format on

}  // namespace lumbrical::test
