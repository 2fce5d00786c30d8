#include "borders/pair_contact.h"

#include <span>

#include "exact/round_pairs.h"
#include "exact/through_lanes.h"

namespace lumbrical {

bool collide(const Primitive& primitive, const ContactQuery& query, const Corners& at, Contact& contact) {
  if (!suits_lanes(primitive) || primitive.law != Law::field)
    return general_contact(primitive, query, at, contact);
  const RoundHull hull = round_hull(primitive);
  const Corners seen = seen_from(hull.origin, at);
  RoundTerms terms;
  terms.depths = true;
  set_kind(kind_of(query.kernels, hull, seen), hull.cut_count, terms);
  const auto gather = [&](const RoundHull& of, std::size_t k, RoundTerms& to) {
    put_pair(of, seen, of.cut, k, to);
  };
  contact.area = 0;
  double status = kUnclear;
  const std::span<const RoundHull> alone(&hull, 1);
  through_lanes(alone, terms, query.kernels.round_contacts, gather,
                [&](const RoundHull&, std::size_t k, const RoundTerms& from) {
                  status = from.status[k];
                  if (status == kContact || status == kSlivers) read_contact(from, k, hull.origin, contact);
                });
  for (terms.patient = false; status == kSlivers; terms.patient = true) {
    through_lanes(alone, terms, query.kernels.cone_slivers, gather,
                  [&](const RoundHull&, std::size_t k, const RoundTerms& from) {
                    status = from.status[k] == kContact || terms.patient ? from.status[k] : kSlivers;
                    if (status == kContact) add_sliver(from, k, hull.origin, contact);
                  });
  }
  if (status == kUnclear) return general_contact(primitive, query, at, contact);
  return contact.area > 0;
}

}  // namespace lumbrical
