#include "borders/general_contact.h"

#include "borders/joint_border.h"
#include "borders/shared_contact.h"
#include "section/depth.h"
#include "section/field_depth.h"
#include "section/finger_depth.h"
#include "section/pressure.h"
#include "section/slab.h"

namespace lumbrical {
namespace {

Vec3 centre_of(const Section& section, const PressureMoments& moments, Vec3 otherwise) {
  if (!(moments.volume > 0)) return otherwise;
  return to_world(section, (1 / moments.volume) * moments.first);
}

// The palm's depth is phi, by every law.
bool is_of_palm(const Primitive& primitive) { return primitive.segment == kPalmSegment; }

// Is depth measured through the whole finger?
bool runs_through_finger(const Primitive& primitive, const ContactQuery& query) {
  return query.hand != nullptr && primitive.phalanx[0] >= 0;
}

Deepest deepest_of(const Primitive& primitive, const ContactQuery& query, const Section& section) {
  const bool by_area =
      primitive.law == Law::field || primitive.law == Law::column || primitive.law == Law::centroid;
  if (by_area && !query.depth) return {};
  if (is_of_palm(primitive)) return largest_field(section);
  return runs_through_finger(primitive, query) ? finger_depth(*query.hand, primitive, section)
                                               : largest_depth(section);
}

double depth_below(const Primitive& primitive, const ContactQuery& query, const Section& section, Point2 p) {
  if (is_of_palm(primitive)) return field_at(section, p);
  return runs_through_finger(primitive, query) ? finger_depth_at(*query.hand, primitive, section, p)
                                               : depth_at(section, p);
}

// One pair by the laws in general. False where there is no common area.
bool collide_section(const Primitive& primitive, const ContactQuery& query, const Section& section,
                     Contact& contact) {
  const Overlap overlap = classify(section);
  if (overlap == Overlap::none) return false;
  Boundary boundary;
  if (overlap == Overlap::partial) trace_boundary(section, boundary);
  const AreaMoments area = common_area(section, overlap, boundary);
  if (!(area.area > 0)) return false;

  const Deepest deepest = deepest_of(primitive, query, section);
  contact.depth = deepest.depth;
  contact.area = area.area;
  contact.centroid = to_world(section, area.centroid);
  contact.centre = contact.centroid;
  contact.normal = section.n;
  contact.error = 0;
  switch (primitive.law) {
    case Law::field:
    case Law::column: {
      if (overlap == Overlap::inside) trace_boundary(section, boundary);
      const PressureMoments moments = is_of_palm(primitive) || primitive.law == Law::field
                                          ? field_moments(query.kernels, section, area, boundary)
                                          : column_moments(section, boundary);
      contact.error = moments.error;
      contact.volume = max(0, moments.volume);
      contact.centre = centre_of(section, moments, contact.centroid);
      break;
    }
    case Law::max_depth:
    case Law::point:
      press_by_depth(primitive.law, query.point_area, to_world(section, deepest.point), contact);
      break;
    case Law::centroid:
      contact.volume = area.area * max(0, depth_below(primitive, query, section, area.centroid));
      break;
  }
  return true;
}

}  // namespace

bool general_contact(const Primitive& primitive, const ContactQuery& query, const Corners& at,
                     Contact& contact) {
  Section section;
  if (!look_from_plane(primitive, at, section) || !collide_section(primitive, query, section, contact))
    return false;
  if (primitive.law == Law::field || primitive.law == Law::column)
    contact.error += plane_rounding(section.origin, at) * contact.area;
  return true;
}

void press_by_depth(Law law, double point_area, Vec3 deepest, Contact& contact) {
  const bool point = law == Law::point;
  contact.volume = (point ? point_area : contact.area) * contact.depth;
  contact.centre = point ? deepest : contact.centroid;
}

void hand_contact(const Primitives& hand, const ExactKernels& kernels, double point_area, const Corners& at,
                  Contact& contact) {
  const Primitive& primitive = hand.primitive[contact.primitive];
  contact.error = 0;
  bool touches = false;
  if (primitive.shape == Shape::slab) {
    touches = collide_slab(slab_of(hand.palm, primitive), primitive.law, point_area, at, contact);
  } else if (const TileBorders borders = borders_on(hand, primitive, at); borders.any()) {
    touches = collide_shared(hand, primitive, borders, kernels, at, contact);
    contact.depth = 0;
  } else {
    const ContactQuery query{point_area, &hand, kernels, primitive.law != Law::field};
    touches = general_contact(primitive, query, at, contact);
  }
  if (!touches) contact.area = 0;
}

double hand_depth(const Primitives& hand, const Primitive& primitive, const Corners& at) {
  Section section;
  if (!look_from_plane(primitive, at, section)) return 0;
  const bool whole_finger = primitive.phalanx[0] >= 0;
  return (whole_finger ? finger_depth(hand, primitive, section) : largest_depth(section)).depth;
}

}  // namespace lumbrical
