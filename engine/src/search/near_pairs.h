// Which pairs of primitive and triangle are near enough to be asked again in the ticks to come: a hand moves
// little from one tick to the next.
//
// Where a primitive is searched for, its hull is widened by a skin. Pairs that certainly miss the widened
// hull are left out, pairs that do not even certainly miss a hull narrowed by the skin are sure candidates,
// and all others are unclear: `certain_misses` is asked about them in every tick. As long as hull and planes
// have moved by no more than kUse of the skin, that gives the candidates of a fresh search.
//
// Why that is so. Let nothing have moved by more than d, and let the skin be m. The distance between the
// hull's segment and a triangle's bounding sphere has changed by at most d, so have the ends' heights over
// the triangle's plane and the distances of their feet from its edges. The feet are held against the reach
// s = sqrt(R^2 - h^2), h the least height: sqrt((R + m)^2 - (h + d)^2) >= s + d where d <= m / sqrt(2),
// because h + s <= sqrt(2) R. So every comparison that a fresh search fails, one with the widened hull fails
// too, and every one that the narrowed hull fails, a fresh search fails. Whether a triangle's normal is
// certain is a question to the triangle alone. kUse is less than 1 / sqrt(2): what is left, a tenth of the
// skin, is far more than rounding can take away (`skin_limits`, and `is_within` of pair_search.cpp, see to
// that).
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "model/primitive.h"
#include "search/miss_terms.h"

namespace lumbrical {

/// What decides a primitive's candidates: two spheres' hull and the planes that cut it.
struct Hull {
  Vec3 end1, end2;                  ///< [m] W
  double radius1 = 0, radius2 = 0;  ///< [m]
  int plane_count = -1;             ///< -1: nothing is known yet
  std::array<MissTerms::Plane, MissTerms::kPlaneCapacity> plane{};
};

void set_hull(const Primitive& primitive, const SweptPolygon& palm, Hull& hull);

/// Sets everything in the terms but the triangles; radii and planes moved outwards by `skin` [m].
void set_terms(const Hull& hull, double skin, MissTerms& terms);

struct NearPairs {
  struct List {
    Hull at;                           ///< where the primitive was searched
    double skin = 0;                   ///< [m]; 0: there is no list
    std::size_t first = 0, count = 0;  ///< of `pairs`
  };
  std::uint64_t build = 0;  ///< Model::build of the world the lists are of
  std::array<List, Primitives::kMaxCount> list;
  /// Of this tick and of the one before.
  std::vector<Hull> now = std::vector<Hull>(Primitives::kMaxCount), last = now;
  /// primitive << 33 | triangle << 1 | unclear, ascending within a list; the first `size` of them. `other`
  /// is where lists move when one among them gives way.
  std::vector<std::uint64_t> pairs, other;
  std::size_t size = 0;
  std::uint32_t rest = 0;      ///< ticks without lists, since they did not fit
  std::uint32_t searches = 0;  ///< primitives searched for in the last tick
  std::uint32_t asked = 0;     ///< unclear pairs asked about in the last tick
};

/// Share of the skin a hull may use up until its list is of no use.
inline constexpr double kUse = 0.6;

/// [m] by how much a hull has moved, planes included; infinite where it is another hull altogether. Of planes
/// that counts within reach_of(from) of its first end.
double distance_moved(const Hull& from, const Hull& to);

/// The thinnest and the thickest skin [m] of a hand's primitives; both 0 where rounding does not allow any.
struct SkinLimits {
  double least = 0, most = 0;
};
SkinLimits skin_limits(const Primitives& hand);

/// The skin [m] of a primitive that moved by `moved` [m] in a tick: a thick one lasts longer but leaves more
/// pairs in doubt. 0 where no list would last long enough to be worth making.
double skin_for(double moved, const SkinLimits& limits);

/// [m] Farther from a hull's first end no corner of a triangle may be, or the pair is unclear.
double reach_of(const Hull& hull);

/// Keeps the lists with `keep` set, gives up the others and makes room at the end.
void keep_lists(const std::array<bool, Primitives::kMaxCount>& keep, NearPairs& near);

}  // namespace lumbrical
