#include "narrowphase.h"

#include "depth.h"
#include "field_batch.h"
#include "finger_depth.h"
#include "joint_border.h"
#include "parallel.h"
#include "pressure.h"
#include "pressure_rules.h"
#include "prism.h"
#include "shared_contact.h"

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

// Spheres and capsules under the field law: phi is made of discs. Two radii make it a cone.
bool made_of_discs(const Primitive& primitive) {
  return primitive.law == Law::field && primitive.shape == Shape::round &&
         primitive.radius1 == primitive.radius2;
}

PressureMoments exact_moments(const Section& section, const ContactQuery& query, const AreaMoments& area,
                              bool whole, Boundary& boundary) {
  PressureMoments moments;
  const bool field = query.law == Law::field && section.shape == Shape::round;
  if (field && field_by_points(section, area, whole, query.tolerance, moments)) return moments;
  trace_boundary(section, boundary);
  return query.law == Law::field ? field_moments(query.kernels, section, area, boundary)
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
  const Deepest deepest =
      whole_finger ? finger_depth(*query.hand, primitive, section) : largest_depth(section);
  contact.depth = deepest.depth;
  contact.area = area.area;
  contact.centroid = to_world(section, area.centroid);
  contact.centre = contact.centroid;
  contact.normal = section.n;
  contact.error = 0;
  switch (query.law) {
    case Law::field:
    case Law::column: {
      const bool whole = overlap == Overlap::inside;
      const PressureMoments moments = exact_moments(section, query, area, whole, boundary);
      contact.error = moments.error;
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

// Computes a pair at once or leaves it in the batch; an area of zero marks that there is no contact.
void collide_pair(const Model& model, const Primitives& hand, std::uint64_t pair, FieldBatch& batch,
                  Boundary& boundary, Contact& contact) {
  const auto index = static_cast<std::uint32_t>(pair >> 32), triangle = static_cast<std::uint32_t>(pair);
  const Primitive& primitive = hand.primitive[index];
  const Triangles& world = model.triangles;
  const Vec3 a = world.vertex(world.a[triangle]), b = world.vertex(world.b[triangle]),
             c = world.vertex(world.c[triangle]);
  contact.primitive = index;
  contact.triangle = triangle;
  contact.area = 0;
  contact.error = 0;
  if (primitive.shape == Shape::prism) {
    if (!collide_prism(hand.palm, primitive.law, model.settings.point_area, a, b, c, contact))
      contact.area = 0;
    return;
  }
  const TileBorders borders = borders_on(hand, primitive, a, b, c);
  if (borders.any()) {
    if (!collide_shared(hand, primitive, borders, batch.kernels, a, b, c, boundary, contact))
      contact.area = 0;
    return;
  }
  Section section;
  if (!look_from_plane(primitive, a, b, c, section)) return;
  const ContactQuery query{primitive.law, model.settings.point_area, &hand, model.settings.tolerance,
                           batch.kernels};
  if (made_of_discs(primitive) && add_to_batch(section, query.tolerance, contact, batch)) return;
  if (!collide_section(primitive, query, section, boundary, contact)) contact.area = 0;
}

}  // namespace

bool collide(const Primitive& primitive, const ContactQuery& query, Vec3 a, Vec3 b, Vec3 c,
             Boundary& boundary, Contact& contact) {
  Section section;
  if (!look_from_plane(primitive, a, b, c, section)) return false;
  FieldBatch batch(query.kernels);
  if (made_of_discs(primitive) && query.law == Law::field &&
      add_to_batch(section, query.tolerance, contact, batch)) {
    finish_batch(batch);
    return contact.area > 0;
  }
  return collide_section(primitive, query, section, boundary, contact);
}

std::uint32_t find_contacts(const Model& model, const Primitives& hand,
                            std::span<const std::uint64_t> candidates, std::span<Contact> contacts) {
  // Every pair has a slot of its own, so the order of the work doesn't matter.
  const FieldKernels& kernels = field_kernels(model.execution.isa);
  const auto work = [&](std::size_t first, std::size_t last) {
    Boundary boundary;
    FieldBatch batch(kernels);
    for (std::size_t i = first; i < last; ++i)
      collide_pair(model, hand, candidates[i], batch, boundary, contacts[i]);
    finish_batch(batch);
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
