// See peer_truth.h.
#include "peer_truth.h"

#include <cmath>

namespace lumbrical::bench {
namespace {

double square_between(Vec3 p, Vec3 q, Vec3 a, Vec3 b) {
  const Vec3 u = q - p, v = b - a, w = p - a;
  const double uu = dot(u, u), uv = dot(u, v), vv = dot(v, v), uw = dot(u, w), vw = dot(v, w);
  const double det = uu * vv - uv * uv;
  double s = det > 1e-14 * uu * vv ? clamp((uv * vw - vv * uw) / det, 0, 1) : 0;
  const double t = vv > 0 ? clamp((s * uv + vw) / vv, 0, 1) : 0;
  s = uu > 0 ? clamp((t * uv - uw) / uu, 0, 1) : 0;
  const Vec3 gap = w + s * u - t * v;
  return dot(gap, gap);
}

bool above_triangle(Vec3 p, Vec3 a, Vec3 b, Vec3 c, Vec3 n) {
  return dot(cross(b - a, p - a), n) >= 0 && dot(cross(c - b, p - b), n) >= 0 &&
         dot(cross(a - c, p - c), n) >= 0;
}

// [m] between the phalanx' axis and the triangle.
double distance_between(const Primitive& phalanx, Vec3 a, Vec3 b, Vec3 c) {
  const Vec3 p = phalanx.end1, q = phalanx.end2, n = cross(b - a, c - a);
  const double hp = dot(n, p - a), hq = dot(n, q - a), square = dot(n, n);
  if (square > 0 && (hp < 0) != (hq < 0) && above_triangle(p + hp / (hp - hq) * (q - p), a, b, c, n))
    return 0;
  double least = min(square_between(p, q, a, b), min(square_between(p, q, b, c), square_between(p, q, c, a)));
  if (square > 0 && above_triangle(p, a, b, c, n)) least = min(least, hp * hp / square);
  if (square > 0 && above_triangle(q, a, b, c, n)) least = min(least, hq * hq / square);
  return std::sqrt(least);
}

}  // namespace

Truth touched_by(std::span<const Primitive> phalanges, const Mesh& mesh) {
  constexpr double kDoubt = 1e-6;
  Truth truth;
  for (std::uint32_t t = 0; t < mesh.triangles.size(); ++t) {
    const Triangle& triangle = mesh.triangles[t];
    const Vec3 a = mesh.vertices[triangle[0]], b = mesh.vertices[triangle[1]], c = mesh.vertices[triangle[2]];
    double outside = 1;
    const double reach = max(norm(b - a), norm(c - a));
    for (const Primitive& phalanx : phalanges) {
      const double far = phalanx.radius1 + reach + norm(phalanx.end2 - phalanx.end1);
      const Vec3 away = a - phalanx.end1;
      if (dot(away, away) > far * far) continue;
      outside = min(outside, distance_between(phalanx, a, b, c) - phalanx.radius1);
    }
    if (outside < -kDoubt) truth.touched.push_back(t);
    if (std::fabs(outside) <= kDoubt) truth.doubtful.push_back(t);
  }
  return truth;
}

}  // namespace lumbrical::bench
