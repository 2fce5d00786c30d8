// The field's integral over small regions, by product rules.
#include "section/field.h"
#include "section/pressure.h"
#include "section/small_region.h"
#include "section/stated_errors.h"

namespace lumbrical {

bool field_of_small_region(const Section& section, const Slant& slant, const AreaMoments& area,
                           const Boundary& boundary, PressureMoments& moments) {
  moments = {};
  moments.error = kDiscError * section.radius1 * section.radius1 * section.radius1;
  return small_region_nodes(section, slant, area, boundary, 1, [&](int zone, Point2 p, double weight) {
    const double share = weight * field_of(section, slant, zone, p);
    moments.volume += share;
    moments.first = moments.first + share * p;
  });
}

}  // namespace lumbrical
