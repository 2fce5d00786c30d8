#include "narrowphase.h"

#include "depth.h"
#include "finger_depth.h"
#include "joint_border.h"
#include "parallel.h"
#include "pressure.h"
#include "prism.h"
#include "shared_contact.h"

namespace lumbrical {
namespace {

// Pairs one thread takes at a time, and the number below which threads cost more than they bring (measured,
// bench).
constexpr std::size_t kChunk = 32;
constexpr std::size_t kSerialBelow = 256;

Vec3 centre_of(const Section& section, const PressureMoments& moments, Vec3 otherwise) {
  if (!(moments.volume > 0)) return otherwise;
  return to_world(section, (1 / moments.volume) * moments.first);
}

bool collide_pair(const Model& model, const Primitives& hand, std::uint64_t pair, Boundary& boundary,
                  Contact& contact) {
  const auto index = static_cast<std::uint32_t>(pair >> 32), triangle = static_cast<std::uint32_t>(pair);
  const Primitive& primitive = hand.primitive[index];
  const Triangles& world = model.triangles;
  const Vec3 a = world.vertex(world.a[triangle]), b = world.vertex(world.b[triangle]),
             c = world.vertex(world.c[triangle]);
  contact.primitive = index;
  contact.triangle = triangle;
  if (primitive.shape == Shape::prism) {
    return collide_prism(hand.palm, primitive.law, model.settings.point_area, a, b, c, contact);
  }
  if (border_matters(hand, primitive, a, b, c))
    return collide_shared(hand, primitive, a, b, c, boundary, contact);
  return collide(primitive, {primitive.law, model.settings.point_area, &hand}, a, b, c, boundary, contact);
}

}  // namespace

bool collide(const Primitive& primitive, const ContactQuery& query, Vec3 a, Vec3 b, Vec3 c,
             Boundary& boundary, Contact& contact) {
  Section section;
  if (!look_from_plane(primitive, a, b, c, section)) return false;
  const Overlap overlap = classify(section);
  if (overlap == Overlap::apart) return false;
  const bool exact = query.law == Law::field || query.law == Law::column;
  if (overlap == Overlap::partial || exact) trace_boundary(section, boundary);
  const AreaMoments area =
      overlap == Overlap::inside ? polygon_area(section.polygon) : section_area(section, boundary);
  if (!(area.area > 0)) return false;

  const bool whole_finger = query.hand != nullptr && primitive.phalanx[0] >= 0;
  const Deepest deepest =
      whole_finger ? finger_depth(*query.hand, primitive, section) : largest_depth(section);
  contact.depth = deepest.depth;
  contact.area = area.area;
  contact.centroid = to_world(section, area.centroid);
  contact.centre = contact.centroid;
  contact.normal = section.n;
  switch (query.law) {
    case Law::field:
    case Law::column: {
      const PressureMoments moments = query.law == Law::field ? field_moments(section, area, boundary)
                                                              : column_moments(section, boundary);
      contact.volume = max(0, moments.volume);
      contact.centre = centre_of(section, moments, contact.centroid);
      break;
    }
    case Law::max_depth:
      contact.volume = area.area * deepest.depth;
      break;
    case Law::centroid: {
      const double depth = whole_finger ? finger_depth_at(*query.hand, primitive, section, area.centroid)
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

std::uint32_t find_contacts(const Model& model, const Primitives& hand,
                            std::span<const std::uint64_t> candidates, std::span<Contact> contacts) {
  // Every pair has a slot of its own, so the order of the work doesn't matter; an area of zero marks an empty
  // slot.
  const auto work = [&](std::size_t first, std::size_t last) {
    Boundary boundary;
    for (std::size_t i = first; i < last; ++i) {
      if (!collide_pair(model, hand, candidates[i], boundary, contacts[i])) contacts[i].area = 0;
    }
  };
  const std::uint32_t threads = candidates.size() < kSerialBelow ? 1 : model.execution.threads;
  parallel_chunks(candidates.size(), kChunk, threads, work);
  std::uint32_t count = 0;
  for (std::size_t i = 0; i < candidates.size(); ++i) {
    if (contacts[i].area > 0) contacts[count++] = contacts[i];
  }
  return count;
}

}  // namespace lumbrical
