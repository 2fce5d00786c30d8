// Quadrature along the boundary of polygon and section, shared by the field and the column law.
//
// The integrand is analytic along a piece except where the section's curve meets y = 0 (a square root) and
// above the point where the axis pierces the plane (a logarithm). Pieces are split there, and beside such a
// point x runs like the square of the quadrature variable, which makes the square root disappear and the
// logarithm harmless.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "base/gauss.h"
#include "section/section.h"

namespace lumbrical {

/// A parameter t in [0, 1] along a piece beside which the integrand is not smooth; a blur tells that the
/// point is that far off the real axis, so that it only matters to intervals that are not short against it.
/// A weak one is a square root or a step in a high derivative.
struct Singularity {
  double at, blur;
  bool weak;
};

struct Singularities {
  static constexpr std::size_t kMaxCount = 20;
  std::uint32_t count = 0;
  std::array<Singularity, kMaxCount> point;
  /// Ask for nodes in geometric steps towards those that are not weak: for derivatives of what the others
  /// integrate, which are a degree more singular.
  bool refine = false;
  /// Ask for nine digits only: for what is small already.
  bool coarse = false;
  /// Ask for nodes in geometric steps towards two that are near each other.
  bool crowded = false;
  void add(double at, double blur = 0, bool weak = false) {
    if (count < kMaxCount && at > -1e6 && at < 1e6) point[count++] = {at, blur, weak};
  }
};

/// The parameters at which the quadratic a t^2 + 2 b t + c, a distance squared, is zero off the real axis.
inline void add_closest_approach(double a, double b, double c, Singularities& singularities) {
  if (a > 0) singularities.add(-b / a, std::sqrt(max(0, c / a - b / a * (b / a))));
}

/// Intervals of t this short are not divided: two singularities that differ by rounding would ask for halves
/// without end, and what lies between them is nothing.
constexpr double kShortest = 1e-13;
/// Where refinement ends, as a share of the whole piece.
inline constexpr double kFinest = 2e-4;
/// Two nearer each other are one, as a share of the interval.
inline constexpr double kLeastGap = 1e-7;

/// Singularities seen from an interval: how far from it are the nearest two to either side of its middle, and
/// the nearest that is not weak; or the first that lies inside, which divides it.
struct NearSingularities {
  const Singularity* inside = nullptr;
  double left = 1e300, right = 1e300, second_left = 1e300, second_right = 1e300, strong = 1e300;
};
inline NearSingularities surroundings_of(double lower, double upper, const Singularities& singularities) {
  const double length = upper - lower;
  NearSingularities near;
  for (std::size_t i = 0; i < singularities.count; ++i) {
    const Singularity& point = singularities.point[i];
    const bool inside =
        length > kShortest && point.at > lower + 1e-9 * length && point.at < upper - 1e-9 * length;
    if (inside && point.blur < length) {
      near.inside = &point;
      return near;
    }
    const bool is_left = point.at < 0.5 * (lower + upper);
    const double distance = max(0, max(lower - point.at, point.at - upper)) + point.blur;
    double &side = is_left ? near.left : near.right, &second = is_left ? near.second_left : near.second_right;
    second = min(second, max(side, distance));
    side = min(side, distance);
    if (!point.weak) near.strong = min(near.strong, distance);
  }
  return near;
}

/// Calls f(t, weight) at nodes for the integral over lower <= t <= upper.
template <class F>
void graded_nodes(double lower, double upper, const Singularities& singularities, F&& f) {
  const double length = upper - lower;
  if (!(length > 0)) return;
  const auto [inside, left, right, second_left, second_right, strong] =
      surroundings_of(lower, upper, singularities);
  const auto divide_at = [&](double t) {
    graded_nodes(lower, t, singularities, f);
    graded_nodes(t, upper, singularities, f);
  };
  if (inside != nullptr) return divide_at(inside->at);
  const auto plain = [&](const auto& rule) {
    for (const GaussNode& node : rule) f(lower + length * node.at, length * node.weight);
  };
  // n nodes leave about (2 + 4 d / length)^(-2 n) with d the distance to the nearest singularity.
  const double scale = singularities.coarse ? length / 3 : length;
  const double near = 1.5 * scale, nearest = min(left, right);
  const double gap = left < right ? second_left - left : second_right - right;
  const double quarter = left < right ? lower + 0.25 * length : upper - 0.25 * length;
  if (left < near && right < near && length > kShortest) {
    divide_at(0.5 * (lower + upper));
  } else if (singularities.refine && strong < 0.3 * length && length > kFinest) {
    divide_at(quarter);
  } else if (singularities.crowded && nearest < near && gap > kLeastGap * length && gap < 0.1 * length) {
    divide_at(quarter);
  } else if (singularities.refine && nearest < near && nearest == strong && length > kFinest) {
    plain(kGauss16);
  } else if (nearest < near) {
    const double w1 = std::sqrt(nearest), span = length / (w1 + std::sqrt(nearest + length));
    for (const GaussNode& node : kGauss16) {
      const double step = span * node.at, along = step * (2 * w1 + step);
      f(left < right ? lower + along : upper - along, 2 * (w1 + step) * span * node.weight);
    }
  } else if (nearest < 4 * scale) {
    plain(kGauss8);
  } else if (nearest < 16 * scale) {
    plain(kGauss6);
  } else {
    plain(kGauss4);
  }
}

/// How far beyond abscissa x, going in the direction `sign`, eta reaches zero; 1e300 where it doesn't.
inline double distance_to_end(const Zone& zone, double x, double sign) {
  const double e = max(0, eta_squared(zone, x)), g = -sign * (zone.beta - zone.gamma * (x - zone.x0));
  const double discriminant = g * g + zone.gamma * e;
  const double denominator = discriminant >= 0 ? g + std::sqrt(discriminant) : 0;
  return denominator > 0 ? e / denominator : e > 0 ? 1e300 : 0;
}

/// Calls f(x, y, weight) at quadrature nodes of one piece; the weights sum to its extent in x.
/// `singularities` are the integrand's own; those of the section's curve are added here.
template <class F>
void piece_nodes(const Piece& piece, const Zone& zone, Singularities singularities, F&& f) {
  const double dx = piece.to_x - piece.from_x, dy = piece.to_y - piece.from_y;
  if (piece.kind == Piece::edge) {
    graded_nodes(0, 1, singularities, [&](double t, double weight) {
      f(piece.from_x + t * dx, piece.from_y + t * dy, weight * dx);
    });
    return;
  }
  const double sign = dx > 0 ? 1 : -1, scale = 1 / std::fabs(dx);
  singularities.add(-distance_to_end(zone, piece.from_x, -sign) * scale, 0, true);
  singularities.add(1 + distance_to_end(zone, piece.to_x, sign) * scale, 0, true);
  graded_nodes(0, 1, singularities, [&](double t, double weight) {
    const double x = piece.from_x + t * dx;
    f(x, piece.side * std::sqrt(max(0, eta_squared(zone, x))), weight * dx);
  });
}

/// The same of all pieces, one after the other; `kinks_of(piece, zone)` tells the integrand's own.
template <class Kinks, class F>
void boundary_nodes(const Section& section, const Boundary& boundary, const Kinks& kinks_of, F&& f) {
  for (std::size_t i = 0; i < boundary.count; ++i) {
    const Piece& piece = boundary.piece[i];
    if (piece.kind == Piece::none || piece.from_x == piece.to_x) continue;
    const Zone& zone = section.zone[piece.zone];
    piece_nodes(piece, zone, kinks_of(piece, zone), f);
  }
}

}  // namespace lumbrical
