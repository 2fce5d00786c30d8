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
    {"mug.field", 0xe481f2639f1ab42f},
    {"mug.column", 0x3adc50b4b22a2780},
    {"mug.max-depth", 0x2bde30838db5fbd9},
    {"mug.centroid", 0x55a390c11c6a1138},
    {"mug.point", 0xc553818d800d8720},
    {"crowd", 0x5088e7eda4ad3f6a},
    {"thin.field", 0xdeb2bdede2eb1f09},
    {"thin.column", 0x5ff80b58595ea3c4},
    {"pads", 0x8211a2a4fc86b6b4},
    {"lost", 0xd7ca712244323d25},
    {"not_finite", 0x0d70c2de8984b2ad},
    {"overflow", 0x2c9229bf0e0c3e17},
    {"large", 0x11967b74597952fc},
    {"hall", 0x028e2ed61d7ea368},
    {"far", 0x89f572a351cfecfb},
    {"mixed", 0x6bbbb6c8c3dcb088},
    {"samples.1e-3", 0x1b789450e3d52a47},
    {"samples.1e-4", 0xa1e37c67029a393c},
    {"samples.1e-5", 0x598a4eb751e556f6},
    {"never.1e-4", 0xd5894f98912f60e9},
    {"once.exact", 0x9a7dea68c03ca593},
    {"bent", 0x1fa56d98739215bc},
    {"objects", 0x9f0cbc0b1bc5c484},
    {"proxy", 0x1c6616e8659242c0},
    {"surface", 0xa3f73890f27527bb},
    {"jacobians", 0x9d955d8cf77ad843},
    {"pairs", 0x767409ad08b40967},
};
// clang-format on

}  // namespace lumbrical::test
