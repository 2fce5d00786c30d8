// Triangles joined into parts that keep, for each triangle, whether it is wound as its part is or the other
// way round: disjoint sets with parity.
#pragma once

#include <cstdint>
#include <vector>

namespace lumbrical {

/// The smallest triangle of a part stands for it. Fewer than 2^31 triangles.
class TriangleParts {
 public:
  struct Place {
    std::uint32_t part = 0;
    bool reversed = false;  ///< wound the other way than the triangle that stands for the part
  };

  explicit TriangleParts(std::size_t count) : link_(count) {
    for (std::size_t i = 0; i < count; ++i) link_[i] = static_cast<std::uint32_t>(i << 1);
  }

  Place find(std::uint32_t triangle) {
    std::uint32_t odd = 0;
    while (link_[triangle] >> 1 != triangle) {
      std::uint32_t& link = link_[triangle];
      link = link_[link >> 1] ^ (link & 1);  // past its parent: later ways are shorter
      odd ^= link & 1;
      triangle = link >> 1;
    }
    return {triangle, odd != 0};
  }

  /// False where the two are in one part already and wound otherwise than `opposed` says.
  bool join(std::uint32_t a, std::uint32_t b, bool opposed) {
    const Place in_a = find(a), in_b = find(b);
    const bool differ = in_a.reversed != in_b.reversed;
    if (in_a.part == in_b.part) return differ == opposed;
    const std::uint32_t kept = in_a.part < in_b.part ? in_a.part : in_b.part;
    link_[in_a.part ^ in_b.part ^ kept] = kept << 1 | (differ != opposed ? 1u : 0u);
    return true;
  }

 private:
  std::vector<std::uint32_t> link_;  // parent << 1 | wound otherwise than the parent
};

}  // namespace lumbrical
