// What any parts of a hand feel of sixteen patches that they share (sample_kernels.h): each where its body is
// the deepest and it is the first of that. In a fist the same parts share few patches each, so a register
// takes what different ones do; fields are computed once for all borders.
#pragma once

#include <optional>

#include "base/set_bits.h"
#include "samples/deepest_kernels.h"

namespace lumbrical::LUMBRICAL_ISA {

/// The parts of a hand that share any patch of a register, seen from each; not all share every patch.
template <class V>
class SharingParts {
 public:
  static constexpr std::size_t kMost = kSegmentCount;
  /// What tells of parts at a point: their fields; what is positive where each is the first of its body's;
  /// and the largest field of each body.
  struct Point {
    V field[kMost], among_own[kMost], of_body[Bodies::kMostFingers + 1];
  };
  /// A part's borders with other bodies, and in its own's place with the others of its finger. There are more
  /// bodies only where fingers lack phalanges; then several have one border.
  static constexpr std::size_t kBorders = kFingerCount + 1;

  SharingParts(const PatchRows& rows, std::size_t lane, const Bodies& bodies, const std::uint64_t* parts,
               const PatchList& list)
      : bodies_(bodies), tie_(number_of(kTie) * V(bodies.finger[0].tile[0].radius)) {
    constexpr std::size_t kLanes = wide::Lanes<V>::kCount;
    std::uint64_t in_lane[kLanes];
    for (std::size_t i = 0; i < kLanes; ++i) {
      const std::size_t patch = (rows.first + lane + i) / lanes_of_patch(list);
      in_lane[i] = patch < list.count ? parts[patch] : 0;
      numbers_ |= in_lane[i];
    }
    for_numbers(numbers_, [&](std::size_t part) {
      alignas(64) float most[kLanes];
      for (std::size_t i = 0; i < kLanes; ++i)
        most[i] = has_bit(in_lane[i], part) ? 1e30f : static_cast<float>(kNowhere);
      if (count_ == 0 || body_of(part) != body_of(part_[count_ - 1].number)) see_body(rows, lane, part);
      see_part(rows, lane, part, get(most, V{}));
    });
  }
  [[nodiscard]] std::size_t count() const { return count_; }
  [[nodiscard]] std::uint64_t numbers() const { return numbers_; }
  [[nodiscard]] std::size_t number(std::size_t k) const { return part_[k].number; }
  [[nodiscard]] const PatchInFrame<V>& patch(std::size_t k) const { return part_[k].patch; }

  void at(V u, V v, Point& point) const {
    for (std::size_t body = 0; body < body_count_; ++body) {
      const std::size_t first = first_[body], count = first_[body + 1] - first;
      TileClaim<V> claim[FingerBody::kMostTiles];
      V& most = point.of_body[body];
      most = number_of(kNowhere);
      for (std::size_t i = 0; i < count; ++i) {
        claim[i] = claim_at(part_[first + i], u, v);
        point.field[first + i] = min(claim[i].field, part_[first + i].most);
        point.among_own[first + i] = number_of(1e30);
        most = max(most, point.field[first + i]);
      }
      for (std::size_t outer = 1; outer < count; ++outer) {
        for (std::size_t inner = 0; inner < outer; ++inner)
          part(first + inner, first + outer, claim[inner], claim[outer], point);
      }
    }
  }

  /// A cell's corners and centroid, and where the largest fields of bodies are.
  struct Corners {
    const Point &a, &b, &c, &centre;
    AtCorners<V> of_body[Bodies::kMostFingers + 1];

    Corners(const SharingParts& parts, const Point& at_a, const Point& at_b, const Point& at_c,
            const Point& at_centre)
        : a(at_a), b(at_b), c(at_c), centre(at_centre) {
      for (std::size_t i = 0; i < parts.body_count_; ++i)
        of_body[i] = in_cell(a.of_body[i], b.of_body[i], c.of_body[i], centre.of_body[i]);
    }
  };
  /// What of a cell is the k-th part's.
  [[nodiscard]] Cell<V> cell_of(std::size_t k, const Corners& at) const {
    const PartCell<V> own(at.a.field[k], at.b.field[k], at.c.field[k], at.centre.field[k]);
    if (!any(own.whole.mean > number_of(0))) return number_of(0) * own.whole;
    const std::array<AtCorners<V>, kBorders> border = borders_of(k, at);
    constexpr std::size_t kFew = 3;
    if (border_count_ > kFew) return cell_within(own, border);
    return cell_within(own, std::array<AtCorners<V>, kFew>{border[0], border[1], border[2]});
  }

 private:
  struct Part {
    std::size_t number, body;
    PatchInFrame<V> patch;
    TileNumbers<V> tile;  // unless it is the palm
    V most;               // of its field: low in lanes that it does not share
  };
  static V number_of(double value) { return lumbrical::LUMBRICAL_ISA::number<V>(value); }

  void see_body(const PatchRows& rows, std::size_t lane, std::size_t part) {
    const bool is_palm = part == palm_number(bodies_);
    const Vec3 origin = is_palm ? bodies_.palm.origin : bodies_.finger[body_of(part)].origin;
    for_tiles<V>(rows, lane, [&](std::uint32_t code, bool all, auto its) {
      float offset[3];
      put_offset(origin, bodies_, code, offset);
      offset_ = all ? in_all_lanes<V>(offset) : select(its, in_all_lanes<V>(offset), offset_);
    });
    first_[body_count_] = count_;
    const bool has_room = bodies_.finger_count < kBorders;
    border_of_[body_count_++] = has_room ? border_count_ : body_of(part) % kBorders;
    border_count_ = has_room ? border_count_ + 1 : kBorders;
  }
  void see_part(const PatchRows& rows, std::size_t lane, std::size_t number, V most) {
    Part& part = part_[count_++];
    part.number = number;
    part.body = body_count_ - 1;
    part.most = most;
    if (number == palm_number(bodies_)) {
      part.patch = see_patch(rows, lane, bodies_.palm.axis, offset_);
      palm_.emplace(bodies_.palm, part.patch);
    } else {
      const TileFrame& tile = tile_at(bodies_.finger.data(), number);
      part.patch = see_patch(rows, lane, tile.axis, offset_ + in_all_lanes<V>(tile.origin));
      part.tile = numbers_of<V>(tile);
    }
    first_[body_count_] = count_;
  }

  [[nodiscard]] TileClaim<V> claim_at(const Part& part, V u, V v) const {
    const Wide3<V> at = part.patch.at(u, v);
    if (part.number == palm_number(bodies_)) return {palm_->field(at), number_of(0)};
    const TilePoint<V> point = tile_point(at);
    return {tile_field(part.tile, point), place_on(part.tile, point)};
  }
  // Neighbours part along their joint's border, the ends of a finger where their fields are equal. All is a
  // part's own in lanes that the other one does not share.
  void part(std::size_t inner, std::size_t outer, const TileClaim<V>& of_inner, const TileClaim<V>& of_outer,
            Point& point) const {
    const Part &in = part_[inner], &out = part_[outer];
    const JointSides& joint = bodies_.finger[body_of(in.number)].joint[in.number % Bodies::kTilesApart];
    const V beyond = in.number + 1 == out.number
                         ? side_of_joint(numbers_of<V>(joint), in.tile, of_inner, out.tile, of_outer)
                         : point.field[outer] - point.field[inner];
    const V zero = number_of(0), lead = beyond - number_of(kTie) * in.tile.radius;
    point.among_own[inner] = min(point.among_own[inner], max(zero - lead, zero - out.most));
    point.among_own[outer] = min(point.among_own[outer], max(lead, zero - in.most));
  }

  // Positive where a point is the k-th part's: first among its body's, and by how much more its body has
  // there than others.
  [[nodiscard]] std::array<AtCorners<V>, kBorders> borders_of(std::size_t k, const Corners& at) const {
    const std::size_t own = part_[k].body;
    const AtCorners<V>& mine = at.of_body[own];
    const V none = number_of(1e30);
    std::array<AtCorners<V>, kBorders> border;
    border.fill({none, none, none});
    border[border_of_[own]] =
        in_cell(at.a.among_own[k], at.b.among_own[k], at.c.among_own[k], at.centre.among_own[k]);
    for (std::size_t body = 0; body < body_count_; ++body) {
      if (body == own) continue;
      // What they have in common is the first one's.
      const V tie = body < own ? tie_ : number_of(0) - tie_;
      const AtCorners<V>& its = at.of_body[body];
      AtCorners<V>& lead = border[border_of_[body]];
      lead = {min(lead.a, (mine.a - its.a) - tie), min(lead.b, (mine.b - its.b) - tie),
              min(lead.c, (mine.c - its.c) - tie)};
    }
    return border;
  }

  const Bodies& bodies_;
  const V tie_;
  std::uint64_t numbers_ = 0;  // a bit each
  std::size_t count_ = 0, body_count_ = 0;
  std::size_t border_count_ = 0;
  std::size_t border_of_[Bodies::kMostFingers + 1];  // each body: the same for all who share a patch
  std::size_t first_[Bodies::kMostFingers + 2];      // part of each body
  Part part_[kMost];
  Wide3<V> offset_;                    // of the last body from where patches are seen [m]
  std::optional<PalmNearby<V>> palm_;  // the last part, if it is one of them
};

/// Patches that any parts share, `parts` of each.
template <class V>
std::uint32_t parts_lattice(const PatchList& list, const Bodies& bodies, const std::uint64_t* parts,
                            const TileSums& sums) {
  using Sharing = SharingParts<V>;
  using Point = typename Sharing::Point;
  const std::size_t steps = steps_of_lane(list);
  std::uint32_t touched = 0;
  for_rows<V>(list, [&](const PatchRows& rows, std::size_t lane) LUMBRICAL_INLINE {
    const Sharing sharing(rows, lane, bodies, parts, list);
    const auto for_wanted = [&](const auto& take) LUMBRICAL_INLINE {
      for (std::size_t k = 0; k < sharing.count(); ++k)
        if (has_bit(sums.wanted, sharing.number(k))) take(k);
    };
    if ((sharing.numbers() & sums.wanted) == 0) return;
    CellSums<V> cells[Sharing::kMost];
    for_cells<Point>(
        steps, [](float u) LUMBRICAL_INLINE { return V(u); },
        [&](V u, float v, Point& point) LUMBRICAL_INLINE { sharing.at(u, V(v), point); },
        [&](float u, float v, bool upright, const Point& a, const Point& b, const Point& c,
            const Point& centre) LUMBRICAL_INLINE {
          const typename Sharing::Corners at(sharing, a, b, c, centre);
          for_wanted([&](std::size_t k) { cells[k].add(V(u), V(v), upright, sharing.cell_of(k, at)); });
        });
    for_wanted([&](std::size_t k) {
      const auto [force, moment] = share_of(sharing.patch(k), cells[k].means(steps));
      add_wrench(force, moment, lane, sums.of[sharing.number(k)]);
      touched += count_of(lanes_with(force));
    });
  });
  return touched;
}

}  // namespace lumbrical::LUMBRICAL_ISA
