// A box as a palm, for tests.
#pragma once

#include "model/primitive.h"

namespace lumbrical::test {

/// 2 a by 2 b wide [m], its palmar face `depth` [m] below z = 0; X moves it.
inline Prism box_prism(double a, double b, double depth, double thickness, const Pose& X = {}) {
  Prism prism;
  const auto add = [&](Vec3 normal, Vec3 point) {
    prism.face[static_cast<std::size_t>(prism.face_count++)] = {rotate(X.orientation, normal),
                                                                transform(X, point)};
  };
  add({0, 0, -1}, {0, 0, -depth});
  add({0, 0, 1}, {0, 0, thickness - depth});
  add({1, 0, 0}, {a, 0, 0});
  add({-1, 0, 0}, {-a, 0, 0});
  add({0, 1, 0}, {0, b, 0});
  add({0, -1, 0}, {0, -b, 0});
  return prism;
}

}  // namespace lumbrical::test
