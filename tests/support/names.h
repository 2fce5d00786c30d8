// Names for parameters of tests and failed comparisons. Every file of a program that prints one of these
// types must include it: the linker keeps one way to print a type.
#pragma once

#include <ostream>

#include "lumbrical/device.h"
#include "lumbrical/recording.h"

namespace lumbrical {

inline void PrintTo(Compression compression, std::ostream* out) {
  static constexpr const char* kNames[] = {"none", "lz4", "zstd"};
  *out << kNames[static_cast<int>(compression)];
}

inline void PrintTo(InputKind kind, std::ostream* out) {
  *out << (kind == InputKind::joint_poses ? "joint_poses" : "joint_angles");
}

}  // namespace lumbrical
