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
    {"mug.field", 0x27c5ec12080223ca},
    {"mug.column", 0x95bd133c85caaba9},
    {"mug.max-depth", 0x319efef5a7265974},
    {"mug.centroid", 0x9145ee5d4cd32a6b},
    {"mug.point", 0xbd0227154d7a47b8},
    {"crowd", 0x4e29d0cf887f5169},
    {"thin.field", 0xd9b062e1f749e1bd},
    {"thin.column", 0xbd78cbd22d1f5ac9},
    {"lost", 0x0cffb7263a01b98b},
    {"not_finite", 0x9242faac9e197bac},
    {"overflow", 0xb94aec47b96e57b8},
    {"coarse.1e-4", 0xb3cb49298153614f},
    {"coarse.1e-2", 0x808f3485e0d0e6b6},
    {"large", 0xb0758dda022d8a53},
    {"clusters", 0xe4d381a3c75b56c7},
    {"far", 0x448c3b6fa9fe2027},
    {"mixed", 0xc9fe0174778c9382},
    {"jacobians", 0x876f61a721a7808c},
    {"pairs", 0xedb2a9619bd31394},
};
// clang-format on

}  // namespace lumbrical::test
