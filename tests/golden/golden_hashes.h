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
    {"mug.field", 0x5580a62258c8eb57},
    {"mug.column", 0x437b1937ecf7cdd1},
    {"mug.max-depth", 0x6b2548e101827dde},
    {"mug.centroid", 0x900782e97714a163},
    {"mug.point", 0x95e8d8d9ee283665},
    {"crowd", 0x559a68b04ab458b7},
    {"thin.field", 0x80704f73bc509eea},
    {"thin.column", 0xd3d432956edad24e},
    {"lost", 0x4ae9ec827009d77a},
    {"not_finite", 0xe1b951372ef176d6},
    {"overflow", 0x47640da5023da1e6},
    {"coarse.1e-4", 0xbe087015731d5a79},
    {"coarse.1e-2", 0x905d246bfe13d3d1},
    {"large", 0x3ae1cd3ec6829d51},
    {"clusters", 0x90ddf9a3e6b7cccd},
    {"far", 0xcfe79585166a5c79},
    {"mixed", 0x3b8e849fbc940061},
    {"jacobians", 0x9f661396e4ae4340},
    {"pairs", 0x3e19651affb8e67f},
};
// clang-format on

}  // namespace lumbrical::test
