// Places along a Morton curve through a box, whose sides may differ: an axis that needs fewer bits than the
// others has none in the upper part of the code (Morton, A computer oriented geodetic data base, 1966).
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "index/triangle_bound.h"

namespace lumbrical {

class SpatialCode {
 public:
  explicit SpatialCode(const Box& box) : low_(box.lower) {
    const Vec3 size = box.upper - box.lower;
    const double longest = max(size.x, max(size.y, size.z));
    scale_ = longest > 0 ? kMostCells / longest : 0;
    const auto bits_of = [&](double length) { return static_cast<int>(std::bit_width(cell(length))); };
    const std::array<int, 3> width = {bits_of(size.x), bits_of(size.y), bits_of(size.z)};
    for (int level = 0; level < kLevels; ++level) {
      for (std::size_t axis = 0; axis < 3; ++axis) {
        if (level < width[axis]) place_bit(axis, level);
      }
    }
  }

  /// Of a point in the box; others count as the nearest in it.
  [[nodiscard]] std::uint64_t operator()(Vec3 p) const {
    return code(0, cell(p.x - low_.x)) | code(1, cell(p.y - low_.y)) | code(2, cell(p.z - low_.z));
  }
  [[nodiscard]] int bits() const { return bits_; }  ///< at most 63

 private:
  static constexpr int kLevels = 21, kGroup = 7;  // bits per axis; of them, looked up at a time
  static constexpr double kMostCells = (1 << kLevels) - 1;

  [[nodiscard]] std::uint32_t cell(double x) const {
    return static_cast<std::uint32_t>(clamp(x * scale_, 0, kMostCells));
  }
  [[nodiscard]] std::uint64_t code(std::size_t axis, std::uint32_t cell) const {
    return share_[axis][0][cell & 127] | share_[axis][1][cell >> kGroup & 127] |
           share_[axis][2][cell >> 2 * kGroup];
  }
  // Gives a bit of an axis the next higher place in the code.
  void place_bit(std::size_t axis, int level) {
    const std::uint32_t bit = 1u << level % kGroup;
    auto& share = share_[axis][static_cast<std::size_t>(level / kGroup)];
    for (std::uint32_t i = 0; i < share.size(); ++i) {
      if ((i & bit) != 0) share[i] |= std::uint64_t{1} << bits_;
    }
    ++bits_;
  }

  Vec3 low_;          // [m]
  double scale_ = 0;  // [1/m]
  int bits_ = 0;
  std::array<std::array<std::array<std::uint64_t, 1 << kGroup>, 3>, 3> share_{};  // of axis, group, its value
};

}  // namespace lumbrical
