// A few passes over arrays. Every pair has a slot, which holds its contact in the end, and what a pass finds
// of a pair depends on nothing but the pair: neither the order of the lists nor what shares a register or a
// thread with it shows.
#include "stages/narrowphase.h"

#include <algorithm>
#include <array>
#include <cstring>

#include "base/fixed_list.h"
#include "base/parallel.h"
#include "borders/border_pairs.h"
#include "borders/general_contact.h"
#include "borders/joint_border.h"
#include "exact/pair_slots.h"
#include "exact/round_pairs.h"
#include "exact/slab_pairs.h"
#include "exact/through_lanes.h"
#include "model/swept_polygon.h"
#include "section/finger_depth.h"

namespace lumbrical {
namespace {

// Pairs one thread takes at a time, at most, and the number below which threads cost more than they bring
// (measured, bench).
constexpr std::size_t kChunk = 512, kSerialBelow = 1024;

// Chunks of which every thread gets as many, unless they would be too small to fill lanes.
std::size_t chunk_for(std::size_t count, std::size_t threads) {
  const std::size_t rounds = piece_count(count, threads * kChunk);
  return std::max(kChunk / 2, piece_count(count, threads * rounds));
}

// Pairs with cuts of their own that go through the passes together, and pairs that are sorted at once.
constexpr std::size_t kMostOwn = 512, kMostOfRun = KindTerms::kCapacity;

constexpr std::int16_t kTilesOwn = -1;  // no others

// Pairs on their way through the passes.
struct Work {
  PairSlots pairs;
  std::span<const RoundHull> hulls;  // of the primitives that suit the lanes
  double point_area;                 // [m^2] Settings::point_area
  // By slot, of round pairs: the triangle seen from the hull's origin, which hull, the kind, and which cuts
  // it has in the place of its tile's.
  std::byte at[kMostPairs][sizeof(Corners)];  // not initialised
  std::array<std::uint8_t, kMostPairs> hull_of, kind;
  std::array<std::int16_t, kMostPairs> own_of;
  std::array<int, RoundKind::kCount> cut_count{};  // the most of any pair of a kind
  FixedList<OwnCuts, kMostOwn> own;
  FixedList<BorderWay, 2 * kMostOwn> ways;
  PairList round, slab, crossed, slivers, alone;

  Work(const PairSlots& slots, std::span<const RoundHull> of_primitives, double area)
      : pairs(slots), hulls(of_primitives), point_area(area) {}
  [[nodiscard]] const RoundHull& hull(std::uint32_t slot) const { return hulls[hull_of[slot]]; }
  [[nodiscard]] std::uint32_t slot_of(const Contact& contact) const {
    return static_cast<std::uint32_t>(&contact - pairs.contact.data());
  }
  [[nodiscard]] OwnCuts* own_cuts(std::uint32_t slot) {
    return own_of[slot] == kTilesOwn ? nullptr : own.begin() + own_of[slot];
  }
};

// ---- 1. Every pair onto the list of its way ----

// A pair of a tile with a triangle that others may have a share of.
void sort_shared(std::uint32_t slot, const Corners& at, const TileBorders& near, Work& work) {
  const Primitive& tile = work.pairs.primitive(slot);
  const TriangleCuts cuts = cross_borders(work.pairs.hand, tile, near, at);
  if (cuts.kind == CutKind::gone) return;
  if (cuts.kind == CutKind::unclear) {
    work.alone.push_back(slot);
    return;
  }
  const auto own = static_cast<std::uint32_t>(work.own.size());
  work.own_of[slot] = static_cast<std::int16_t>(own);
  work.own.push_back({slot, cuts.cut}).bulge.base = work.hull(slot).origin;
  bool crossed = false;
  for (const bool outer : {false, true}) {
    const BorderCrossing& crossing = cuts.crossing[outer];
    if (crossing.exists) work.ways.push_back({own, outer, crossing.from, crossing.to});
    crossed = crossed || crossing.exists;
  }
  (crossed ? work.crossed : work.round).push_back(slot);
}

// Where a border is to be looked at more closely.
void set_border(const JointBorder& border, Vec3 origin, KindTerms::Border& terms) {
  put_vector(border.normal, terms.normal);
  terms.height = dot(border.normal, border.centre - origin);
  terms.slab = kReachMargin * border.slab;
}

// Pairs of one round primitive, no more at a time than the terms hold.
void sort_round(std::span<const Contact> contacts, Work& work) {
  const Primitives& hand = work.pairs.hand;
  const auto index = static_cast<std::uint8_t>(contacts[0].primitive);
  const Primitive& primitive = hand.primitive[index];
  const RoundHull& hull = work.hulls[index];
  RoundKind kind{.sphere = hull.is_sphere(), .cone = hull.is_cone(), .paper = follows_paper(primitive)};
  KindTerms terms;
  set_hull(hull, terms);
  for (const bool outer : {false, true}) {
    if (const JointBorder* const border = tile_border(hand, primitive, outer); border != nullptr)
      set_border(*border, hull.origin, terms.border[outer]);
  }
  const bool folded = is_folded(hand, primitive);
  const auto gather = [&](const Contact& contact, std::size_t k, KindTerms& to) {
    const Corners at = seen_from(hull.origin, corners_of(work.pairs.world, contact.triangle));
    std::memcpy(work.at[work.slot_of(contact)], &at, sizeof at);
    put_corners(at, k, to);
  };
  const auto give = [&](const Contact& contact, std::size_t k, const KindTerms& from) {
    const std::uint32_t slot = work.slot_of(contact);
    kind.zone = static_cast<RoundZone>(from.zone[k]);
    const std::uint8_t number = kind.number();
    work.kind[slot] = number;
    work.hull_of[slot] = index;
    work.cut_count[number] = std::max(work.cut_count[number], hull.cut_count);
    if (from.near[0][k] != 0 || from.near[1][k] != 0 || folded) {
      const Corners at = work.pairs.corners(slot);
      const TileBorders near = borders_in_reach(hand, primitive, at);
      if (near.any()) return sort_shared(slot, at, near, work);
    }
    work.round.push_back(slot);
  };
  through_lanes(contacts, terms, work.pairs.kernels.pair_kinds, gather, give);
}

// Pairs of one primitive.
void sort_run(std::span<const Contact> contacts, Work& work) {
  const Primitive& primitive = work.pairs.hand.primitive[contacts[0].primitive];
  if (suits_lanes(primitive)) return sort_round(contacts, work);
  const bool slab = primitive.shape == Shape::slab && primitive.law == Law::field;
  const std::uint32_t first = work.slot_of(contacts[0]);
  for (std::uint32_t i = 0; i < contacts.size(); ++i) (slab ? work.slab : work.alone).push_back(first + i);
}

// Returns how many of the candidates there was room for.
std::size_t sort_pairs(std::span<const std::uint64_t> candidates, Work& work) {
  std::size_t slot = 0;
  while (slot < candidates.size() && work.own.size() + kMostOfRun <= kMostOwn) {
    const std::size_t first = slot, last = std::min(candidates.size(), first + kMostOfRun);
    const auto primitive = static_cast<std::uint32_t>(candidates[slot] >> 32);
    for (; slot < last && candidates[slot] >> 32 == primitive; ++slot) {
      Contact& contact = work.pairs.contact[slot];
      contact.primitive = primitive;
      contact.triangle = static_cast<std::uint32_t>(candidates[slot]);
      contact.area = 0;
      work.own_of[slot] = kTilesOwn;
    }
    sort_run(work.pairs.contact.subspan(first, slot - first), work);
  }
  return slot;
}

// ---- 2. Borders across triangles become cuts ----

void cut_crossed(Work& work) {
  const PairSlots& pairs = work.pairs;
  follow_borders(pairs, work.hulls, work.ways, work.own);
  for (const std::uint32_t slot : work.crossed) {
    const Corners at = pairs.corners(slot);
    OwnCuts& own = *work.own_cuts(slot);
    if (!own.clear) {
      const Primitive& tile = pairs.primitive(slot);
      const TileBorders near = borders_in_reach(pairs.hand, tile, at);
      const BorderCut cut = cut_at_borders(pairs.kernels, pairs.hand, tile, near, at);
      if (cut.kind == CutKind::gone) continue;
      if (cut.kind == CutKind::unclear) {
        work.own_of[slot] = kTilesOwn;
        work.alone.push_back(slot);
        continue;
      }
      own.cut = cut.cut;
      own.bulge = cut.bulge;
    }
    work.round.push_back(slot);
  }
}

// ---- 3. Round pairs and slabs, kind by kind ----

void gather_round(Work& work, std::uint32_t slot, std::size_t k, RoundTerms& terms) {
  const RoundHull& hull = work.hull(slot);
  const OwnCuts* const own = work.own_cuts(slot);
  Corners at;
  std::memcpy(&at, work.at[slot], sizeof at);
  const auto put = [&](const auto& cuts) {
    put_pair(hull, at, std::span(cuts).first(static_cast<std::size_t>(hull.cut_count)), k, terms);
  };
  if (own == nullptr) return put(hull.cut);
  put(std::array{seen_from(hull.origin, own->cut[0]), seen_from(hull.origin, own->cut[1])});
}

// What a kernel has found of a pair.
void take_round(Work& work, std::uint32_t slot, std::size_t k, const RoundTerms& terms) {
  const double status = terms.status[k];
  if (status == kUnclear) work.alone.push_back(slot);
  if (status == kSlivers) work.slivers.push_back(slot);
  if (status == kContact || status == kSlivers)
    read_contact(terms, k, work.hull(slot).origin, work.pairs.contact[slot]);
}

// The same under `max-depth` and `point`: the contact's centre is the deepest point of the primitive, whose
// depth goes on through the finger.
void take_paper(Work& work, std::uint32_t slot, std::size_t k, const RoundTerms& terms) {
  take_round(work, slot, k, terms);
  if (terms.status[k] != kContact) return;
  Contact& contact = work.pairs.contact[slot];
  const Primitive& primitive = work.pairs.primitive(slot);
  const Vec3 along = vector_at(terms.b, k) - vector_at(terms.a, k);
  if (go_through_finger(work.pairs.hand, primitive, contact.centre, contact.normal, along, contact.depth)) {
    press_by_depth(primitive.law, work.point_area, contact.centre, contact);
  } else {
    work.alone.push_back(slot);
  }
}

void collide_round(Work& work) {
  std::array<std::size_t, RoundKind::kCount + 1> start{};
  for (const std::uint32_t slot : work.round) ++start[work.kind[slot] + 1u];
  for (std::size_t kind = 0; kind < RoundKind::kCount; ++kind) start[kind + 1] += start[kind];
  std::array<std::uint32_t, kMostPairs> by_kind;
  std::array<std::size_t, RoundKind::kCount + 1> next = start;
  for (const std::uint32_t slot : work.round) by_kind[next[work.kind[slot]]++] = slot;

  RoundTerms terms;
  const auto gather = [&](std::uint32_t slot, std::size_t k, RoundTerms& to) {
    gather_round(work, slot, k, to);
  };
  for (std::size_t kind = 0; kind < RoundKind::kCount; ++kind) {
    const bool paper = round_kind(kind).paper;
    set_kind(round_kind(kind), work.cut_count[kind], terms);
    const std::span<std::uint32_t> slots =
        std::span(by_kind).subspan(start[kind], start[kind + 1] - start[kind]);
    const ExactKernels& kernels = work.pairs.kernels;
    through_lanes(slots, terms, paper ? kernels.paper_contacts : kernels.round_contacts, gather,
                  [&](std::uint32_t slot, std::size_t k, const RoundTerms& from) {
                    paper ? take_paper(work, slot, k, from) : take_round(work, slot, k, from);
                  });
  }
}

void collide_slabs(Work& work) {
  std::span<const std::uint32_t> rest(work.slab.begin(), work.slab.end());  // one slab after the other
  while (!rest.empty()) {
    const std::uint32_t index = work.pairs.contact[rest[0]].primitive;
    std::size_t count = 0;
    while (count < rest.size() && work.pairs.contact[rest[count]].primitive == index) ++count;
    collide_slab_pairs(work.pairs, slab_of(work.pairs.hand.palm, work.pairs.hand.primitive[index]),
                       rest.first(count), work.alone);
    rest = rest.subspan(count);
  }
}

// ---- 4. What is missing of contacts is added in their slots ----

// Adds what the tile gains beyond its chord. Where a border runs from corner to corner the chord is an edge,
// and may leave the tile nothing else.
void add_own_bulge(Work& work, std::uint32_t slot) {
  const BulgeMoments& bulge = work.own_cuts(slot)->bulge;
  Contact& contact = work.pairs.contact[slot];
  if (!(contact.area > 0)) {
    const Corners at = work.pairs.corners(slot);
    if (!(bulge.area > 0) || !normal_of(at, contact.normal)) return;
    contact.depth = contact.volume = contact.error = 0;
    contact.centroid = contact.centre = bulge.base;
  }
  add_bulge(bulge, contact);
}

void add_bulges(Work& work) {
  for (const std::uint32_t slot : work.crossed) {
    if (work.own_cuts(slot) != nullptr) add_own_bulge(work, slot);
  }
}

// Few take many steps: those are kept apart from the others.
void add_slivers(Work& work) {
  PairList uneven;
  RoundTerms terms;
  const auto gather = [&](std::uint32_t slot, std::size_t k, RoundTerms& to) {
    gather_round(work, slot, k, to);
  };
  const auto first = work.cut_count.begin() + RoundKind{false, true}.number();
  set_kind({false, true}, *std::max_element(first, first + kRoundZones), terms);
  for (terms.patient = false;; terms.patient = true) {
    PairList& left = terms.patient ? work.alone : uneven;
    const auto give = [&](std::uint32_t slot, std::size_t k, const RoundTerms& from) {
      if (from.status[k] == kContact) {
        add_sliver(from, k, work.hull(slot).origin, work.pairs.contact[slot]);
      } else {
        left.push_back(slot);
      }
    };
    const PairList& list = terms.patient ? uneven : work.slivers;
    through_lanes(std::span(list.begin(), list.end()), terms, work.pairs.kernels.cone_slivers, gather, give);
    if (terms.patient) return;
  }
}

// ---- 5. One at a time, what the lanes don't know or is unclear to them ----

void collide_alone(Work& work) {
  const PairSlots& pairs = work.pairs;
  for (const std::uint32_t slot : work.alone) {
    Contact& contact = pairs.contact[slot];
    const Corners at = pairs.corners(slot);
    const OwnCuts* const own = work.own_cuts(slot);
    if (own == nullptr) {
      hand_contact(pairs.hand, pairs.kernels, work.point_area, at, contact);
      continue;
    }
    const Primitive tile = tile_cut_so(pairs.primitive(slot), own->cut);
    const ContactQuery query{work.point_area, nullptr, pairs.kernels, false};
    if (!general_contact(tile, query, at, contact)) contact.area = 0;
    add_own_bulge(work, slot);
  }
}

// Returns how many candidates there was room for; their contacts are in the first slots.
std::size_t collide_some(const PairSlots& pairs, std::span<const RoundHull> hulls, double point_area,
                         std::span<const std::uint64_t> candidates) {
  Work work(pairs, hulls, point_area);
  const std::size_t count = sort_pairs(candidates.first(std::min(candidates.size(), kMostPairs)), work);
  cut_crossed(work);
  collide_round(work);
  collide_slabs(work);
  add_bulges(work);
  add_slivers(work);
  collide_alone(work);
  return count;
}

// Of a force that is hardly more than its error, where area is rounding too, a quotient may lie anywhere.
void keep_in_triangle(const Triangles& world, Contact& contact) {
  constexpr double kDoubtful = 1000;
  if (!(contact.volume < kDoubtful * contact.error)) return;
  const Corners at = corners_of(world, contact.triangle);
  const Vec3 middle = at.a + (1.0 / 3) * ((at.b - at.a) + (at.c - at.a));
  contact.centroid = last_within(at, middle, contact.centroid);
  contact.centre = last_within(at, middle, contact.centre);
}

}  // namespace

std::uint32_t collide_pairs(const Model& model, const Primitives& hand,
                            std::span<const std::uint64_t> candidates, std::span<Contact> contacts) {
  if (candidates.empty()) return 0;
  const ExactKernels& kernels = exact_kernels(model.execution.isa);
  FixedList<RoundHull, Primitives::kMaxCount> hulls;
  for (std::size_t i = 0; i < hand.count; ++i)
    hulls.push_back(suits_lanes(hand.primitive[i]) ? round_hull(hand.primitive[i]) : RoundHull{});
  const std::uint32_t threads = candidates.size() < kSerialBelow ? 1 : model.execution.threads;
  const std::size_t chunk = chunk_for(candidates.size(), threads);
  parallel_chunks(candidates.size(), chunk, threads, [&](std::size_t next, std::size_t last) {
    while (next < last) {
      const PairSlots pairs{model.triangles, hand, kernels, contacts.subspan(next)};
      next += collide_some(pairs, hulls, model.settings.point_area, candidates.subspan(next, last - next));
    }
  });
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!(contacts[i].area > 0)) continue;
    if (count != i) contacts[count] = contacts[i];
    keep_in_triangle(model.triangles, contacts[count++]);
  }
  return count;
}

double depth_of(const Model& model, const Primitives& hand, const Contact& contact) {
  const Primitive& primitive = hand.primitive[contact.primitive];
  if (primitive.law != Law::field || primitive.shape == Shape::slab) return contact.depth;
  // Beyond a curved border the primitive, which a plane cuts, is no more; phi, whose mean this is, still is.
  const double mean = contact.area > 0 ? contact.volume / contact.area : 0;
  return max(hand_depth(hand, primitive, corners_of(model.triangles, contact.triangle)), mean);
}

}  // namespace lumbrical
