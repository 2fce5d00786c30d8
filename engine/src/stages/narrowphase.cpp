#include "stages/narrowphase.h"

#include <array>

#include "base/fixed_list.h"
#include "base/parallel.h"
#include "borders/border_batch.h"
#include "borders/border_cut.h"
#include "borders/joint_border.h"
#include "borders/shared_contact.h"
#include "lanes/round_batch.h"
#include "lanes/slab_batch.h"
#include "model/corners.h"
#include "section/depth.h"
#include "section/field_depth.h"
#include "section/finger_depth.h"
#include "section/pressure.h"
#include "section/slab.h"

namespace lumbrical {
namespace {

// Pairs one thread takes at a time, and the number below which threads cost more than they bring (measured,
// bench).
constexpr std::size_t kChunk = 128;
constexpr std::size_t kSerialBelow = 256;

Vec3 centre_of(const Section& section, const PressureMoments& moments, Vec3 otherwise) {
  if (!(moments.volume > 0)) return otherwise;
  return to_world(section, (1 / moments.volume) * moments.first);
}

PressureMoments exact_moments(const Section& section, Law law, const ContactQuery& query,
                              const AreaMoments& area, Boundary& boundary) {
  trace_boundary(section, boundary);
  return law == Law::field ? field_moments(query.kernels, section, area, boundary)
                           : column_moments(section, boundary);
}

// One pair by the laws in general. False where there is no common area.
bool collide_section(const Primitive& primitive, const ContactQuery& query, const Section& section,
                     Boundary& boundary, Contact& contact) {
  const Overlap overlap = classify(section);
  if (overlap == Overlap::apart) return false;
  if (overlap == Overlap::partial) trace_boundary(section, boundary);
  const AreaMoments area =
      overlap == Overlap::inside ? polygon_area(section.polygon) : section_area(section, boundary);
  if (!(area.area > 0)) return false;

  const bool whole_finger = query.hand != nullptr && primitive.phalanx[0] >= 0;
  const bool palm = primitive.segment == kPalmSegment;  // whose depth is phi, by every law
  const bool by_area = query.law == Law::field || query.law == Law::column || query.law == Law::centroid;
  Deepest deepest{};
  if (query.depth || !by_area) {
    deepest = palm           ? largest_field(section)
              : whole_finger ? finger_depth(*query.hand, primitive, section)
                             : largest_depth(section);
  }
  contact.depth = deepest.depth;
  contact.area = area.area;
  contact.centroid = to_world(section, area.centroid);
  contact.centre = contact.centroid;
  contact.normal = section.n;
  contact.error = 0;
  switch (query.law) {
    case Law::field:
    case Law::column: {
      const PressureMoments moments =
          exact_moments(section, palm ? Law::field : query.law, query, area, boundary);
      contact.error = moments.error + section.rounded * area.area;
      contact.volume = max(0, moments.volume);
      contact.centre = centre_of(section, moments, contact.centroid);
      break;
    }
    case Law::max_depth:
      contact.volume = area.area * deepest.depth;
      break;
    case Law::centroid: {
      const double depth = palm           ? field_at(section, area.centroid)
                           : whole_finger ? finger_depth_at(*query.hand, primitive, section, area.centroid)
                                          : depth_at(section, area.centroid);
      contact.volume = area.area * max(0, depth);
      break;
    }
    case Law::point:
      contact.volume = query.point_area * deepest.depth;
      contact.centre = to_world(section, deepest.point);
      break;
  }
  return true;
}

// One pair at a time; an area of zero marks that there is no contact.
void collide_pair(const Model& model, const Primitives& hand, const FieldKernels& kernels, Boundary& boundary,
                  Contact& contact) {
  const Primitive& primitive = hand.primitive[contact.primitive];
  const auto [a, b, c] = corners_of(model.triangles, contact.triangle);
  contact.area = 0;
  contact.error = 0;
  if (primitive.shape == Shape::slab) {
    const Slab slab = slab_of(hand.palm, primitive);
    if (!collide_slab(slab, primitive.law, model.settings.point_area, a, b, c, contact)) contact.area = 0;
    return;
  }
  const TileBorders borders = borders_on(hand, primitive, a, b, c);
  if (borders.any()) {
    if (!collide_shared(hand, primitive, borders, kernels, a, b, c, boundary, contact)) contact.area = 0;
    contact.depth = 0;
    return;
  }
  Section section;
  if (!look_from_plane(primitive, a, b, c, section)) return;
  const ContactQuery query{primitive.law, model.settings.point_area, &hand, kernels,
                           primitive.law != Law::field};
  if (!collide_section(primitive, query, section, boundary, contact)) contact.area = 0;
}

// Pairs of round primitives on their way through the lanes.
struct RoundQueue {
  RoundBatch batch;
  // Pairs of the batch with cuts of their own.
  struct Shared {
    Contact* contact;
    std::array<HalfSpace, 2> cut;
    BulgeMoments bulge;
  };
  FixedList<Shared, RoundTerms::kCapacity> shared;
};

// Pairs on their way through the lanes, of one thread.
struct PairWork {
  const Model& model;
  const Primitives& hand;
  const FieldKernels& kernels;
  std::array<RoundQueue, kRoundZones> round;
  SliverBatch slivers{kernels};
  RoundHull hull{};
  BorderBatch borders{kernels};
  SlabBatch slab{kernels};
  std::uint32_t hull_of = Primitives::kMaxCount;     // the primitive the hull is of
  std::uint32_t slab_index = Primitives::kMaxCount;  // the slab whose pairs are being gathered
  Boundary boundary;
  PairWork(const Model& m, const Primitives& h, const FieldKernels& k) : model(m), hand(h), kernels(k) {
    round[static_cast<std::size_t>(RoundZone::flat)].batch.pairs.flat = true;
  }
};

const RoundQueue::Shared* shared_of(const Contact& contact, const RoundQueue& queue) {
  for (const RoundQueue::Shared& shared : queue.shared) {
    if (shared.contact == &contact) return &shared;
  }
  return nullptr;
}

// A pair the lanes are unsure of, with the cuts it had there.
void collide_anew(const RoundQueue& queue, PairWork& work, Contact& contact) {
  const RoundQueue::Shared* shared = shared_of(contact, queue);
  if (shared == nullptr) return collide_pair(work.model, work.hand, work.kernels, work.boundary, contact);
  const auto [a, b, c] = corners_of(work.model.triangles, contact.triangle);
  const Primitive tile = tile_cut_so(work.hand.primitive[contact.primitive], shared->cut);
  const Settings& settings = work.model.settings;
  const ContactQuery query{tile.law, settings.point_area, nullptr, work.kernels, false};
  contact.area = 0;
  Section section;
  if (look_from_plane(tile, a, b, c, section) &&
      !collide_section(tile, query, section, work.boundary, contact))
    contact.area = 0;
}

void finish_slab(PairWork& work) {
  for (Contact* contact : finish_batch(work.slab))
    collide_pair(work.model, work.hand, work.kernels, work.boundary, *contact);
}

void take_slab(const Corners& at, Contact& contact, PairWork& work) {
  const bool other = contact.primitive != work.slab_index;
  if (other || is_full(work.slab)) finish_slab(work);
  if (other) begin_batch(slab_of(work.hand.palm, work.hand.primitive[contact.primitive]), work.slab);
  work.slab_index = contact.primitive;
  add_to_batch(at, contact, work.slab);
}

// All but the slivers of the batch's cones.
void finish(RoundQueue& queue, PairWork& work) {
  for (Contact* contact : finish_batch(queue.batch, work.slivers)) collide_anew(queue, work, *contact);
  for (const auto& [contact, cut, bulge] : queue.shared) {
    if (contact->area > 0) add_bulge(bulge, *contact);
  }
  queue.shared.clear();
}

void finish_borders(PairWork& work);

// All pairs of round primitives.
void finish_round(PairWork& work) {
  finish_borders(work);
  for (RoundQueue& queue : work.round) finish(queue, work);
  for (Contact* contact : finish_slivers(work.slivers))
    collide_pair(work.model, work.hand, work.kernels, work.boundary, *contact);
}

const RoundHull& hull_of(const Contact& contact, PairWork& work) {
  if (contact.primitive != work.hull_of) work.hull = round_hull(work.hand.primitive[contact.primitive]);
  work.hull_of = contact.primitive;
  return work.hull;
}

// Adds a pair of a round primitive, cut by its planes or by others in their place, to the queue it is for.
RoundQueue& queue_pair(const Corners& at, std::span<const HalfSpace> cuts, Contact& contact, PairWork& work) {
  const RoundHull& hull = hull_of(contact, work);
  RoundQueue& queue = work.round[static_cast<std::size_t>(zone_of(hull, at.a, at.b, at.c))];
  if (!has_room(queue.batch, hull)) finish(queue, work);
  add_to_batch(hull, at.a, at.b, at.c, cuts, contact, queue.batch);
  return queue;
}

// The same where the cuts and what lies beyond them are the triangle's own.
void queue_shared(const Corners& at, const std::array<HalfSpace, 2>& cut, const BulgeMoments& bulge,
                  Contact& contact, PairWork& work) {
  const Primitive& tile = work.hand.primitive[contact.primitive];
  RoundQueue& queue = queue_pair(at, std::span(cut).first(tile.cut_count), contact, work);
  queue.shared.push_back({&contact, cut, bulge});
}

// A pair that is not plain enough for the borders' lanes.
void take_alone(const Corners& at, Contact& contact, PairWork& work) {
  const Primitive& tile = work.hand.primitive[contact.primitive];
  const TileBorders near = borders_in_reach(work.hand, tile, at.a, at.b, at.c);
  const BorderCut cut = cut_at_borders(work.kernels, work.hand, tile, near, at.a, at.b, at.c);
  if (cut.kind == CutKind::gone) return;
  if (cut.kind == CutKind::general)
    return collide_pair(work.model, work.hand, work.kernels, work.boundary, contact);
  queue_shared(at, cut.cut, cut.bulge, contact, work);
}

void finish_borders(PairWork& work) {
  for (const BorderPair& pair : finish_batch(work.hand, work.borders)) {
    const Corners at = corners_of(work.model.triangles, pair.contact->triangle);
    if (!pair.clear) {
      take_alone(at, *pair.contact, work);
    } else {
      queue_shared(at, pair.cut, pair.bulge, *pair.contact, work);
    }
  }
}

// A pair of a tile with a triangle that others may have a share of.
void take_shared(const TileBorders& near, const Corners& at, Contact& contact, PairWork& work) {
  const Primitive& tile = work.hand.primitive[contact.primitive];
  const TriangleCuts cuts = cross_borders(work.hand, tile, near, at.a, at.b, at.c);
  contact.area = 0;
  if (cuts.kind == CutKind::gone) return;
  if (cuts.kind == CutKind::general)
    return collide_pair(work.model, work.hand, work.kernels, work.boundary, contact);
  if (!cuts.crossing[0].exists && !cuts.crossing[1].exists)
    return queue_shared(at, cuts.cut, {}, contact, work);
  if (!has_room(work.borders)) finish_borders(work);
  add_to_batch(work.hand, tile, hull_of(contact, work), cuts, at.a, at.b, at.c, contact, work.borders);
}

void take_pair(Contact& contact, PairWork& work) {
  const Primitive& primitive = work.hand.primitive[contact.primitive];
  const Corners at = corners_of(work.model.triangles, contact.triangle);
  if (primitive.shape == Shape::slab && primitive.law == Law::field) return take_slab(at, contact, work);
  if (!suits_batch(primitive))
    return collide_pair(work.model, work.hand, work.kernels, work.boundary, contact);
  const TileBorders near = borders_in_reach(work.hand, primitive, at.a, at.b, at.c);
  if (near.any()) return take_shared(near, at, contact, work);
  queue_pair(at, std::span(primitive.cut).first(primitive.cut_count), contact, work);
}

}  // namespace

bool collide(const Primitive& primitive, const ContactQuery& query, Vec3 a, Vec3 b, Vec3 c,
             Boundary& boundary, Contact& contact) {
  if (suits_batch(primitive) && query.law == Law::field) {
    const RoundHull hull = round_hull(primitive);
    RoundBatch batch;
    SliverBatch slivers(query.kernels);
    batch.pairs.flat = lies_flat(hull, a, b, c);
    batch.pairs.depths = true;
    add_to_batch(hull, a, b, c, std::span(primitive.cut).first(primitive.cut_count), contact, batch);
    if (finish_batch(batch, slivers).empty() && finish_slivers(slivers).empty()) return contact.area > 0;
  }
  Section section;
  return look_from_plane(primitive, a, b, c, section) &&
         collide_section(primitive, query, section, boundary, contact);
}

std::uint32_t find_contacts(const Model& model, const Primitives& hand,
                            std::span<const std::uint64_t> candidates, std::span<Contact> contacts) {
  // Every pair has a slot of its own, so the order of the work doesn't matter.
  const FieldKernels& kernels = field_kernels(model.execution.isa);
  const auto work = [&](std::size_t first, std::size_t last) {
    PairWork pairs{model, hand, kernels};
    for (std::size_t i = first; i < last; ++i) {
      contacts[i].primitive = static_cast<std::uint32_t>(candidates[i] >> 32);
      contacts[i].triangle = static_cast<std::uint32_t>(candidates[i]);
      take_pair(contacts[i], pairs);
    }
    finish_round(pairs);
    finish_slab(pairs);
  };
  const std::uint32_t threads = candidates.size() < kSerialBelow ? 1 : model.execution.threads;
  parallel_chunks(candidates.size(), kChunk, threads, work);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (!(contacts[i].area > 0)) continue;
    if (count != i) contacts[count] = contacts[i];
    ++count;
  }
  return count;
}

double depth_of(const Model& model, const Primitives& hand, const Contact& contact) {
  const Primitive& primitive = hand.primitive[contact.primitive];
  if (primitive.law != Law::field || primitive.shape == Shape::slab) return contact.depth;
  const auto [a, b, c] = corners_of(model.triangles, contact.triangle);
  Section section;
  if (!look_from_plane(primitive, a, b, c, section)) return 0;
  const bool whole_finger = primitive.phalanx[0] >= 0;
  return (whole_finger ? finger_depth(hand, primitive, section) : largest_depth(section)).depth;
}

}  // namespace lumbrical
