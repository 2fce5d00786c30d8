// Takes pairs apart into disc terms (field_kernels.h) and puts contacts together from their sums.
//
// In the plane of a triangle, phi of a capsule is R - distance to the nearest of three: the first end's
// centre, the axis line, the second end's centre. The borders between are the lines q = 0 and q = H of the
// axial coordinate q = s x - c h1, which are lines x = const. About an end, phi is that of a disc of height
// h. On the side, distance^2 = e^2 + y^2 with e = c x + s h1: in coordinates (e, y), stretched by c along x,
// it is a disc of height 0. So the integral over a polygon is three sums over its edges, clipped to the three
// strips, and no arc of the section is ever traced.
#include "field_batch.h"

#include <algorithm>
#include <cmath>

#include "depth.h"
#include "pressure_rules.h"

namespace lumbrical {
namespace {

// Below this cosine the side's stretched disc degenerates and the closed form divides rounding by it.
constexpr double kLeastCosine = 1e-2;

// Where no point of the region has more than this share of R, closed forms cancel.
constexpr double kShallow = 0.05;

// Triangles of less than this share of R drown in the disc's scale; points do as well to rounding.
constexpr double kSmall = 0.006, kPointwise = 1e-13;

// Of the section's scale times the polygon's: rounding leaves less of nothing.
constexpr double kLeastArea = 1e-14;

// A convex polygon small enough for a triangle cut by two half-planes and two borders.
struct Corners {
  int count = 0;
  std::array<Point2, 12> corner;
  void add(Point2 p) {
    if (count < 12) corner[static_cast<std::size_t>(count++)] = p;
  }
};

struct Extent {
  double low, high;  // of x
};

Extent extent_of(const Polygon2& polygon) {
  Extent extent{polygon.corner[0].x, polygon.corner[0].x};
  for (int i = 1; i < polygon.count; ++i) {
    extent.low = min(extent.low, polygon.corner[static_cast<std::size_t>(i)].x);
    extent.high = max(extent.high, polygon.corner[static_cast<std::size_t>(i)].x);
  }
  return extent;
}

double size_of(const Polygon2& polygon) {
  double square = 0;
  for (int i = 1; i < polygon.count; ++i) {
    const Point2 d = polygon.corner[static_cast<std::size_t>(i)] - polygon.corner[0];
    square = max(square, dot(d, d));
  }
  return std::sqrt(square);
}

// y of the line through p and q at abscissa x, from the end nearer to the origin.
double height_at(double x, Point2 p, Point2 q) {
  const Point2 base = dot(p, p) < dot(q, q) ? p : q;
  return base.y + (x - base.x) * ((q.y - p.y) / (q.x - p.x));
}

Corners all_of(const Polygon2& polygon) {
  Corners corners;
  for (int i = 0; i < polygon.count; ++i) corners.add(polygon.corner[static_cast<std::size_t>(i)]);
  return corners;
}

// The part of the polygon with lower <= x <= upper.
Corners strip_of(const Polygon2& polygon, Extent extent, double lower, double upper) {
  if (extent.low >= lower && extent.high <= upper) return all_of(polygon);
  Corners strip;
  if (extent.high < lower || extent.low > upper) return strip;
  for (int i = 0; i < polygon.count; ++i) {
    const Point2 p = polygon.corner[static_cast<std::size_t>(i)];
    const Point2 q = polygon.corner[static_cast<std::size_t>(i + 1 == polygon.count ? 0 : i + 1)];
    if (p.x >= lower && p.x <= upper) strip.add(p);
    if ((p.x < lower) == (q.x < lower) && (p.x < upper) == (q.x < upper)) continue;
    const bool forward = p.x < q.x;
    const double first = forward ? lower : upper, second = forward ? upper : lower;
    for (const double x : {first, second}) {
      if ((p.x < x) != (q.x < x) && p.x != x && q.x != x) strip.add({x, height_at(x, p, q)});
    }
  }
  return strip;
}

struct Disc {
  double scale, shift, radius, height;
};

template <class T>
void add_terms(const Section& section, const Disc& disc, const Corners& corners, std::uint16_t pair,
               DiscTerms<T>& terms) {
  const auto number = [](double value) { return static_cast<T>(value); };
  for (int i = 0; i < corners.count; ++i) {
    const Point2 p = corners.corner[static_cast<std::size_t>(i)];
    const Point2 q = corners.corner[static_cast<std::size_t>(i + 1 == corners.count ? 0 : i + 1)];
    const std::size_t k = terms.count++;
    terms.x1[k] = number(p.x);
    terms.y1[k] = number(p.y);
    terms.x2[k] = number(q.x);
    terms.y2[k] = number(q.y);
    terms.scale[k] = number(disc.scale);
    terms.shift[k] = number(disc.shift);
    terms.per_scale[k] = number(1 / disc.scale);
    terms.radius[k] = number(disc.radius);
    terms.height[k] = number(disc.height);
    terms.h1[k] = number(section.h1);
    terms.span[k] = number(section.x2);
    terms.rise[k] = number(section.h2 - section.h1);
    terms.cosine[k] = number(section.c);
    terms.per_span[k] = number(section.x2 > 0 ? 1 / section.x2 : 0);
    terms.pair[k] = pair;
  }
}

// |distance of the axis from the plane| over the whole primitive, at least.
double least_height(const Section& section) {
  if (section.h1 * section.h2 <= 0) return 0;
  return min(std::fabs(section.h1), std::fabs(section.h2));
}

template <class T>
void add_discs(const Section& section, std::uint16_t pair, DiscTerms<T>& terms) {
  const double r = section.radius1;
  const auto end = [&](double shift, double h, const Corners& corners) {
    if (corners.count >= 3 && std::fabs(h) < r)
      add_terms(section, {1, shift, r, std::fabs(h)}, corners, pair, terms);
  };
  if (section.length == 0) return end(0, section.h1, all_of(section.polygon));
  constexpr double kFar = 1e300;
  double lower = -kFar, upper = kFar;  // the axis stands upright: one zone everywhere
  if (section.s > 0) {
    lower = section.c * section.h1 / section.s;
    upper = (section.length + section.c * section.h1) / section.s;
  } else if (section.h1 > 0) {
    lower = kFar;
  } else if (section.h2 < 0) {
    upper = -kFar;
  }
  const Extent extent = extent_of(section.polygon);
  end(0, section.h1, strip_of(section.polygon, extent, -kFar, lower));
  const Corners side = strip_of(section.polygon, extent, lower, upper);
  if (side.count >= 3) {
    add_terms(section, {section.c, section.s * section.h1, r, 0}, side, pair, terms);
  }
  end(-section.x2, section.h2, strip_of(section.polygon, extent, upper, kFar));
}

// A triangle wholly inside, computed by points.
void write_contact(const Section& section, const AreaMoments& area, const PressureMoments& moments,
                   Contact& contact) {
  contact.area = area.area;
  contact.depth = largest_depth(section).depth;
  contact.centroid = to_world(section, area.centroid);
  contact.volume = max(0, moments.volume);
  contact.centre =
      contact.volume > 0 ? to_world(section, (1 / contact.volume) * moments.first) : contact.centroid;
  contact.normal = section.n;
  contact.error = moments.error;
}

void write_contact(const FieldBatch::Pair& pair) {
  Contact& contact = *pair.contact;
  const auto world = [&](double x, double y) { return pair.base + x * pair.u + y * pair.v; };
  if (!(pair.area > pair.least)) {
    contact.area = 0;
    return;
  }
  contact.area = pair.area;
  contact.depth = pair.depth;
  contact.centroid = world(pair.area_x / pair.area, pair.area_y / pair.area);
  contact.volume = max(0, pair.volume);
  contact.centre =
      contact.volume > 0 ? world(pair.volume_x / pair.volume, pair.volume_y / pair.volume) : contact.centroid;
}

template <class T>
void pad(DiscTerms<T>& terms) {
  const std::size_t last = terms.count - 1;
  for (std::size_t k = terms.count; k % 16 != 0; ++k) {
    for (auto* array :
         {terms.x1, terms.y1, terms.x2, terms.y2, terms.scale, terms.shift, terms.per_scale, terms.radius,
          terms.height, terms.h1, terms.span, terms.rise, terms.cosine, terms.per_span}) {
      array[k] = array[last];
    }
  }
}

template <class T>
void compute_terms(void (*kernel)(DiscTerms<T>&), DiscTerms<T>& terms, FieldBatch& batch) {
  if (terms.count == 0) return;
  pad(terms);
  kernel(terms);
  for (std::size_t k = 0; k < terms.count; ++k) {
    FieldBatch::Pair& pair = batch.pair[terms.pair[k]];
    if (!pair.whole) {
      pair.area += terms.area[k];
      pair.area_x += terms.area_x[k];
      pair.area_y += terms.area_y[k];
    }
    pair.volume += terms.volume[k];
    pair.volume_x += terms.volume_x[k];
    pair.volume_y += terms.volume_y[k];
    if (!pair.depth_known) pair.depth = max(pair.depth, terms.depth[k]);
  }
  terms.count = 0;
}

void compute_terms(FieldBatch& batch) {
  compute_terms(batch.kernels.closed_terms, batch.closed, batch);
  compute_terms(batch.kernels.closed_terms_single, batch.single, batch);
}

// Single precision where its error is within the tolerance: for regions that are not small, and not for
// axes that lie nearly in the plane.
bool single_will_do(const Section& section, double area, double tolerance) {
  const double radius2 = section.radius1 * section.radius1;
  return (section.length == 0 || section.c >= 0.2) && kDiscErrorSingle * radius2 <= tolerance * area;
}

}  // namespace

bool add_to_batch(const Section& section, double tolerance, Contact& contact, FieldBatch& batch) {
  if (section.length > 0 && section.c < kLeastCosine) return false;
  if (least_height(section) > (1 - kShallow) * section.radius1) return false;
  const Overlap overlap = classify(section);
  if (overlap == Overlap::apart) {
    contact.area = 0;
    return true;
  }
  const AreaMoments area = polygon_area(section.polygon);
  const bool whole = overlap == Overlap::inside;
  const double size = size_of(section.polygon);
  const bool small = size < kSmall * section.radius1;
  PressureMoments moments;
  if (whole &&
      field_by_points(section, area, true, small ? max(tolerance, kPointwise) : tolerance, moments)) {
    write_contact(section, area, moments, contact);
    return true;
  }
  if (small) return false;
  constexpr std::size_t kMostTerms = 3 * 12;
  if (batch.pair_count == kBatchPairs) finish_batch(batch);
  if (std::max(batch.closed.count, batch.single.count) + kMostTerms > kTermCapacity) compute_terms(batch);
  const auto index = static_cast<std::uint16_t>(batch.pair_count++);
  FieldBatch::Pair& pair = batch.pair[index];
  pair = {};
  pair.contact = &contact;
  pair.base = to_world(section, {0, 0});
  pair.u = section.u;
  pair.v = section.v;
  contact.normal = section.n;
  pair.least = whole ? 0 : kLeastArea * section.radius1 * min(section.radius1, size);
  if (whole) {
    pair.whole = true;
    pair.area = area.area;
    pair.area_x = area.area * area.centroid.x;
    pair.area_y = area.area * area.centroid.y;
  }
  Deepest deepest;
  pair.depth_known = deepest_in_polygon(section, deepest);
  pair.depth = deepest.depth;
  const double radius3 = section.radius1 * section.radius1 * section.radius1;
  if (whole && single_will_do(section, area.area, tolerance)) {
    contact.error = kDiscErrorSingle * radius3;
    add_discs(section, index, batch.single);
  } else {
    contact.error = kDiscError * radius3;
    add_discs(section, index, batch.closed);
  }
  return true;
}

void finish_batch(FieldBatch& batch) {
  compute_terms(batch);
  for (std::size_t i = 0; i < batch.pair_count; ++i) write_contact(batch.pair[i]);
  batch.pair_count = 0;
}

}  // namespace lumbrical
