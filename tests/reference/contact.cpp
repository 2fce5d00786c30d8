#include "contact.h"

#include "breaks.h"
#include "quadrature.h"

namespace lumbrical::reference {
namespace {

/// Area, field and column and with each of them its first moments.
constexpr std::size_t kValues = 9;

template <class T>
Values<T, kValues> across(const Scene<T>& scene, const Wanted& wanted, const T& y) {
  const Interval<T> inside = in_both(scene, y);
  if (inside.empty()) return {};
  const T width = inside.high - inside.low;
  Along<T> field, column;
  if (wanted.field) field = field_along(scene, y, inside);
  if (wanted.column) column = column_along(scene, y, inside);
  return {width,
          width * (inside.low + inside.high) / 2,
          width * y,
          field.amount,
          field.moment,
          y * field.amount,
          column.amount,
          column.moment,
          y * column.amount};
}

/// Relative to the whole, a little above rounding. Multi stops far earlier: it need only be better than long
/// double.
template <class T>
T tolerance() {
  return std::numeric_limits<T>::digits > 100 ? T(1e-22) : T(1e-16);
}

/// Golden section search for the top of a concave function.
template <class T, class Function>
T largest(const Function& function, T low, T high) {
  using std::sqrt;
  const T ratio = (sqrt(T(5)) - 1) / 2;
  T p = high - ratio * (high - low), q = low + ratio * (high - low), at_p = function(p), at_q = function(q);
  T best = at_p > at_q ? at_p : at_q;
  for (int i = 0; i < std::numeric_limits<T>::digits * 3 / 2; ++i) {
    if (at_p > at_q) {
      high = q, q = p, at_q = at_p;
      at_p = function(p = high - ratio * (high - low));
    } else {
      low = p, p = q, at_p = at_q;
      at_q = function(q = low + ratio * (high - low));
    }
    const T& better = at_p > at_q ? at_p : at_q;
    if (better > best) best = better;
  }
  return best;
}

/// The way out of something convex is a concave function of the place, and so is its top along lines.
template <class T>
T deepest_of(const Scene<T>& scene, const std::vector<T>& breaks) {
  const auto of_line = [&](const T& y) {
    const Interval<T> inside = in_both(scene, y);
    return inside.empty() ? T(-1) : deepest_along(scene, y, inside);
  };
  // The search must not start where there is nothing on either side.
  std::size_t first = 0, last = breaks.size() - 1;
  const auto empty = [&](std::size_t piece) {
    return !(of_line(T((breaks[piece] + breaks[piece + 1]) / 2)) > 0);
  };
  while (first + 1 < last && empty(first)) ++first;
  while (first + 1 < last && empty(last - 1)) --last;
  T best = largest(of_line, breaks[first], breaks[last]);
  for (const T& y : breaks) {
    const T depth = of_line(y);
    if (depth > best) best = depth;
  }
  return best;
}

template <class T>
Load<T> load_of(const Scene<T>& scene, const Panel<T, kValues>& total, std::size_t k) {
  const T& amount = total.sum[k];
  Load<T> load{amount, total.error[k], {}, total.error[k + 1] + total.error[k + 2]};
  if (amount > 0) {
    load.centre = scene.foot + (total.sum[k + 1] / amount) * scene.u + (total.sum[k + 2] / amount) * scene.v;
  }
  return load;
}

}  // namespace

template <class T>
Contact<T> contact(const Solid& solid, const Triangle& triangle, Wanted wanted) {
  const Scene<T> scene = lay_out<T>(solid, triangle);
  Contact<T> result;
  result.normal = scene.n;
  const std::vector<T> breaks = breaks_of(scene, wanted);
  if (breaks.size() < 2) return result;
  const auto line = [&](const T& y) {
    ++result.lines;
    return across(scene, wanted, y);
  };
  const auto tolerance_of = [&](const Values<T, kValues>& estimate) {
    Values<T, kValues> each;
    for (std::size_t k = 0; k < kValues; ++k)
      each[k] = tolerance<T>() * estimate[k - k % 3] * (k % 3 ? scene.size : T(1));
    return each;
  };
  const Panel<T, kValues> total = integrate<kValues>(line, breaks, tolerance_of);
  if (!(total.sum[0] > 0)) return result;
  result.touches = true;
  result.area = load_of(scene, total, 0);
  result.field = load_of(scene, total, 3);
  result.column = load_of(scene, total, 6);
  result.at_centroid = depth_at(scene, T(total.sum[1] / total.sum[0]), T(total.sum[2] / total.sum[0]));
  if (wanted.deepest) result.deepest = deepest_of(scene, breaks);
  return result;
}

template <class T>
T depth_at(const Solid& solid, Vector<double> normal, Vector<double> p) {
  using W = Wide<T>;
  Scene<W> wide;
  look_at_solid(solid, p.as<W>(), unit(normal.as<W>()), wide);
  const Scene<T> scene = narrowed<T>(wide);
  const Vector<W> place = p.as<W>() - wide.foot;
  const T x = static_cast<T>(dot(place, wide.u)), y = static_cast<T>(dot(place, wide.v));
  const Interval<T> inside = in_solid(scene, y);
  return x >= inside.low && x <= inside.high ? depth_at(scene, x, y) : T(-1);
}

template <class T>
T field_at(const Solid& solid, Vector<double> p) {
  using W = Wide<T>;
  Scene<W> wide;
  look_at_solid(solid, p.as<W>(), Vector<W>{W(0), W(0), W(1)}, wide);
  const Vector<W> place = p.as<W>() - wide.foot;
  return field_at(narrowed<T>(wide), static_cast<T>(dot(place, wide.u)), static_cast<T>(dot(place, wide.v)));
}

template Contact<long double> contact(const Solid&, const Triangle&, Wanted);
template Contact<Multi> contact(const Solid&, const Triangle&, Wanted);
template long double depth_at(const Solid&, Vector<double>, Vector<double>);
template Multi depth_at(const Solid&, Vector<double>, Vector<double>);
template long double field_at(const Solid&, Vector<double>);
template Multi field_at(const Solid&, Vector<double>);

}  // namespace lumbrical::reference
