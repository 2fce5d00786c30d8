// The palm meets the world: its first touch is soft wherever it happens, and a way round and back costs
// nothing.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "base/gauss.h"
#include "box_palm.h"
#include "session.h"

namespace lumbrical {
namespace {

// A direction in which the palm may touch something first.
struct Feature {
  const char* name;
  Vec3 outward;  // W, unit
};

std::vector<Feature> features_of(const SweptPolygon& palm) {
  std::vector<Feature> features{{"palmar side", palm.normal}, {"back", -palm.normal}};
  const std::size_t count = palm.corner_count;
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3 at_corner = palm.outward[i] + palm.outward[(i + 1) % count];
    for (const double tilt : {-1.0, 0.0, 0.6}) {
      features.push_back({"edge", unit_or(palm.outward[i] + tilt * palm.normal, {})});
      features.push_back({"corner", unit_or(at_corner + tilt * palm.normal, {})});
    }
  }
  return features;
}

// The point of the palm's skin that is farthest in a direction.
Vec3 foremost(const SweptPolygon& palm, Vec3 outward) {
  Vec3 best = palm.corner[0];
  for (std::size_t i = 1; i < palm.corner_count; ++i) {
    if (dot(palm.corner[i] - best, outward) > 0) best = palm.corner[i];
  }
  return best + palm.radius * outward;
}

enum class Obstacle { plane, edge, corner };

// With its foremost part at the origin, facing -z: a plane, a ridge along x or a point.
Mesh obstacle(Obstacle kind) {
  const double w = 0.2;
  if (kind == Obstacle::plane) return {{{-w, -w, 0}, {-w, w, 0}, {w, 0, 0}}, {{0, 1, 2}}};
  if (kind == Obstacle::edge) return {{{-w, 0, 0}, {w, 0, 0}, {0, w, w}, {0, -w, w}}, {{0, 2, 1}, {0, 1, 3}}};
  return {{{0, 0, 0}, {w, 0, w}, {-w, w, w}, {-w, -w, w}}, {{0, 1, 3}, {0, 2, 1}, {0, 3, 2}}};
}

// The obstacle with its foremost part at `point`, coming from where `outward` points to.
Model placed(Obstacle kind, Vec3 point, Vec3 outward, test::Random& random) {
  const Vec3 x = unit_or(cross(outward, random.direction()), {}), y = cross(outward, x);
  Mesh mesh = obstacle(kind);
  for (Vec3& v : mesh.vertices) v = point + v.x * x + v.y * y + v.z * outward;
  return test::world_of(std::move(mesh));
}

SweptPolygon moved(SweptPolygon palm, Vec3 by, double wider = 0) {
  for (Vec3& corner : palm.corner) corner += by;
  palm.radius += wider;
  return palm;
}

// |F after - F before| <= K_s A d, A the area within d of the palm: phi changes by no more than d.
TEST(PalmTouch, StartsAtNothingOnEveryFaceEdgeAndCorner) {
  test::Random random(31);
  int felt = 0;
  double sharpest = 0;
  for (int round = 0; round < 3; ++round) {
    const SweptPolygon palm = round == 0
                                  ? test::box_palm(0.03, 0.02, 0.01, test::kPalmRadius, random.pose(0.3))
                                  : place_palm(test::random_palm(random), random.pose(0.3));
    for (const Feature& feature : features_of(palm)) {
      for (const Obstacle kind : {Obstacle::plane, Obstacle::edge, Obstacle::corner}) {
        SCOPED_TRACE(feature.name);
        const Model model = placed(kind, foremost(palm, feature.outward), feature.outward, random);
        Vec3 before;
        double at = -1e-5;
        for (const double step : {1e-5, 1e-5, 1e-5, 1e-5, 1e-4, 1e-4, 1e-4, 1e-3, 1e-3, 3e-3}) {
          at += step;
          const Vec3 way = at * feature.outward;
          const Vec3 force = test::press(model, test::hand_of(moved(palm, way))).force;
          const double area = test::press(model, test::hand_of(moved(palm, way, step))).area;
          ASSERT_LE(norm(force - before), area * step * (1 + 1e-9) + 1e-20) << "at " << at;
          if (at <= 0) {
            EXPECT_LT(norm(force), 1e-18);
          }
          sharpest = std::fmax(sharpest, norm(force - before) / (area * step));
          before = force;
        }
        felt += norm(before) > 1e-9 ? 1 : 0;
      }
    }
  }
  EXPECT_GT(felt, 200);
  EXPECT_GT(sharpest, 0.9);  // the bound is sharp where a flat side meets a plane
}

// As deep as the palm is thick, force rises with every step: nothing lets go or steps on the way in.
TEST(PalmTouch, PressedIntoAPlaneItNeverGivesWayBeforeItsMiddle) {
  test::Random random(32);
  const SweptPolygon palm = place_palm(test::random_palm(random), random.pose(0.3));
  for (const Feature& feature : features_of(palm)) {
    const Model model = placed(Obstacle::plane, foremost(palm, feature.outward), feature.outward, random);
    double before = 0;
    for (double at = 0; at < palm.radius; at += 0.05 * palm.radius) {
      const double volume = test::press(model, test::hand_of(moved(palm, at * feature.outward))).volume;
      EXPECT_GE(volume, before) << feature.name << ' ' << at;
      before = volume;
    }
  }
}

// ---- Closed ways ----

Quat turned_by(Vec3 turn) {
  const double angle = norm(turn);
  if (angle == 0) return {};
  const Vec3 axis = std::sin(0.5 * angle) / angle * turn;
  return {std::cos(0.5 * angle), axis.x, axis.y, axis.z};
}

// Once round an ellipse while turning to and fro.
struct Way {
  Vec3 start, cosine, sine, turn;
  Quat orientation;
};

struct Work {
  double sum = 0, error = 0, largest_force = 0;
};

class Round {
 public:
  Round(const Model& model, const Way& way) : model_(model), way_(way) {}
  void add(double from, double to, double tolerance, int levels) {
    const double rough = integral(kGauss8, from, to), fine = integral(kGauss16, from, to);
    if (levels == 0 || std::fabs(fine - rough) <= tolerance * (to - from)) {
      work.sum += fine;
      work.error += std::fabs(fine - rough);
      return;
    }
    add(from, 0.5 * (from + to), tolerance, levels - 1);
    add(0.5 * (from + to), to, tolerance, levels - 1);
  }
  Work work;

 private:
  template <std::size_t N>
  double integral(const GaussNode (&rule)[N], double from, double to) {
    constexpr double kTurn = 2 * std::numbers::pi;
    double sum = 0;
    for (const GaussNode& node : rule) {
      const double a = kTurn * (from + (to - from) * node.at), c = std::cos(a), s = std::sin(a);
      const Vec3 p = way_.start + c * way_.cosine + s * way_.sine;
      const Pose X{p, turned_by(s * way_.turn) * way_.orientation};
      const test::Pressed felt =
          test::press(model_, test::hand_of(test::box_palm(0.03, 0.02, 0, test::kPalmRadius, X)));
      const Vec3 velocity = kTurn * (c * way_.sine - s * way_.cosine), spin = (kTurn * c) * way_.turn;
      sum += (to - from) * node.weight *
             (dot(felt.force, velocity) + dot(felt.torque - cross(p, felt.force), spin));
      work.largest_force = std::fmax(work.largest_force, norm(felt.force));
    }
    return sum;
  }
  const Model& model_;
  const Way& way_;
};

TEST(PalmTouch, AWayOverAnEdgeAndBackCostsNoWork) {
  Mesh box = make_box({0.1, 0.1, 0.1}, 2);
  for (Vec3& vertex : box.vertices) vertex += Vec3{-0.05, 0, -0.05};  // an edge of it is the y axis
  const Model model = test::world_of(box);
  const double r = test::kPalmRadius;
  const Quat level{}, upright{std::sqrt(0.5), 0, std::sqrt(0.5), 0}, oblique = turned_by({0.5, 0.4, 0.2});
  const Way ways[] = {
      {{0.01, 0, -0.002}, {0.01, 0.002, 0}, {0, 0.004, 0.004}, {0, 0, 0}, level},  // over the edge, palm down
      {{0.02, 0, -0.002}, {0.02, 0.002, 0}, {0, 0.004, 0.004}, {0.1, 0.2, 0.3}, level},  // turning
      {{0.0, 0, r + 0.028}, {0.02, 0, 0}, {0, 0.01, 0.004}, {0.1, 0.1, 0.1}, upright},   // on its own edge
      {{0.02, 0, 0.008}, {0.02, 0.002, 0}, {0, 0.004, 0.01}, {0, 0.2, 0}, oblique},      // on a corner
  };
  for (const Way& way : ways) {
    Round first(model, way);
    first.add(0, 1, 1, 3);
    const double length = std::numbers::pi * (norm(way.cosine) + norm(way.sine));
    const double scale = first.work.largest_force * length;
    ASSERT_GT(first.work.largest_force, 1e-8) << &way - ways;
    Round fine(model, way);
    for (int i = 0; i < 16; ++i) fine.add(i / 16.0, (i + 1) / 16.0, 2e-11 * scale, 12);
    EXPECT_LT(fine.work.error, 2e-10 * scale);
    EXPECT_LT(std::fabs(fine.work.sum), 1e-9 * scale) << &way - ways;
  }
}

}  // namespace
}  // namespace lumbrical
