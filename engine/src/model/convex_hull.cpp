#include "model/convex_hull.h"

#include <algorithm>

namespace lumbrical {

// Andrew's monotone chain.
std::vector<Vec3> convex_hull(std::vector<Vec3> points, double hair) {
  std::stable_sort(points.begin(), points.end(),
                   [](Vec3 a, Vec3 b) { return a.x < b.x || (a.x == b.x && a.z < b.z); });
  std::vector<Vec3> hull;
  for (int pass = 0; pass < 2; ++pass) {
    const std::size_t start = hull.size();
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3 p = pass == 0 ? points[i] : points[points.size() - 1 - i];
      while (hull.size() >= start + 2 && turn(hull[hull.size() - 2], hull.back(), p) <= hair) hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();  // it begins the other half
  }
  return hull;
}

}  // namespace lumbrical
