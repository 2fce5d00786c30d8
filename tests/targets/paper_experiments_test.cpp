// The paper's experiments (bench/experiments.h) at a smaller size: what the paper says of them and what it
// doesn't, law by law, with numbers.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "experiments.h"

namespace lumbrical::bench {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr double kDegree = kPi / 180;

TEST(PaperExperiment, UndividedForceIsTheIntegralKnownByHand) {
  const double stiffness = 2e7, length = 0.025, h = kRadius - kDepth,
               a = std::sqrt(kRadius * kRadius - h * h);
  const double cap_field = kPi * kDepth * kDepth * (kRadius + 2 * h) / 3;
  const double cap = kPi * kDepth * kDepth * (3 * kRadius - kDepth) / 3;
  const double strip_field = a * kRadius - h * h * std::asinh(a / h);
  const double segment = kRadius * kRadius * std::acos(h / kRadius) - a * h;
  EXPECT_NEAR(undivided_force(Law::field, 90 * kDegree, kDepth) / (stiffness * cap_field), 1, 1e-7);
  EXPECT_NEAR(undivided_force(Law::column, 90 * kDegree, kDepth) / (stiffness * cap), 1, 1e-7);
  // Lying: lengths are kept in single precision.
  EXPECT_NEAR(undivided_force(Law::field, 0, kDepth) / (stiffness * (length * strip_field + cap_field)), 1,
              1e-6);
  EXPECT_NEAR(undivided_force(Law::column, 0, kDepth) / (stiffness * (length * segment + cap)), 1, 1e-6);
}

// Figure 9a. The paper's force of one large triangle is A dl_max, for a shallow cap twice the integral of
// depth, and falls towards it as triangles shrink; without areas the force grows with their number.
TEST(PaperExperiment, ForceOfLargeAndSmallTriangles) {
  for (const double tilt : {90.0, 0.0}) {
    double previous = 2;
    for (const double edge : {0.0, 0.008, 0.002, 0.0005}) {
      EXPECT_NEAR(divided_over_undivided(Law::field, tilt * kDegree, edge, 4), 1, 1e-12);
      EXPECT_NEAR(divided_over_undivided(Law::column, tilt * kDegree, edge, 4), 1, 1e-12);
      const double paper = divided_over_undivided(Law::max_depth, tilt * kDegree, edge, 4);
      EXPECT_LT(paper, previous);
      previous = paper;
    }
    EXPECT_NEAR(divided_over_undivided(Law::max_depth, tilt * kDegree, 0, 1), tilt > 0 ? 1.909 : 1.550, 1e-3);
    EXPECT_NEAR(divided_over_undivided(Law::max_depth, tilt * kDegree, 0.001, 8), tilt > 0 ? 1.25 : 1.17,
                0.03);
    EXPECT_NEAR(divided_over_undivided(Law::centroid, tilt * kDegree, 0.0005, 4), 1, 0.01);
    EXPECT_GT(divided_over_undivided(Law::point, tilt * kDegree, 0.001, 4),
              20 * divided_over_undivided(Law::point, tilt * kDegree, 0, 4));
  }
}

// Figure 9b: by symmetry the force points straight up.
TEST(PaperExperiment, ForceOnARidgeOfLargeAndSmallTriangles) {
  EXPECT_LT(std::fabs(lean_on_ridge(Law::field)), 1e-11);
  EXPECT_LT(std::fabs(lean_on_ridge(Law::column)), 1e-11);
  EXPECT_NEAR(lean_on_ridge(Law::max_depth) / kDegree, 3.3, 0.5);  // towards the large triangles
  EXPECT_NEAR(lean_on_ridge(Law::centroid) / kDegree, 1.4, 0.5);
  EXPECT_LT(lean_on_ridge(Law::point) / kDegree, -10);  // towards the many
}

// Figure 11. "There was never a sudden change of force": true of the paper's law, within 2 % per 0.1 mm. "The
// variation of force was quite small": 2 to 17 %, about a force a quarter to nine tenths too high.
TEST(PaperExperiment, SlideOverAnIrregularFlatMesh) {
  struct Case {
    Slide slide;
    double bias_low, bias_high;  // of max-depth
  };
  for (const Case& c :
       {Case{{0, 0.0015}, 0.18, 0.30}, Case{{0, 0.025}, 0.45, 0.60}, Case{{25 * kDegree, 0.006}, 0.55, 0.80},
        Case{{90 * kDegree, 0.003}, 0.45, 0.65}, Case{{25 * kDegree, 0.006, 0.0003}, 0.75, 1.0}}) {
    const auto of = [&](Law law) { return evenness_of(slide(c.slide, law)); };
    const Evenness field = of(Law::field), column = of(Law::column), paper = of(Law::max_depth);
    const Evenness cheap = of(Law::centroid), point = of(Law::point);
    EXPECT_GT(field.most, field.least);
    EXPECT_LT(field.peak_to_peak, 1e-12);
    EXPECT_LT(column.peak_to_peak, 1e-12);
    EXPECT_GT(paper.bias, c.bias_low);
    EXPECT_LT(paper.bias, c.bias_high);
    EXPECT_GT(paper.peak_to_peak, 0.015);
    EXPECT_LT(paper.peak_to_peak, 0.20);
    EXPECT_LT(paper.largest_step, 0.02);
    EXPECT_GT(cheap.bias, 0);
    EXPECT_LT(cheap.bias, paper.bias);
    EXPECT_GT(point.peak_to_peak, 2 * paper.peak_to_peak);  // what areas are for
  }
}

// Figures 12 and 13: direction and magnitude change smoothly on the way onto a slope, whatever weighs by
// area.
TEST(PaperExperiment, SlidingOntoASlope) {
  for (const double angle : {30.0, -30.0}) {
    for (const Law law : {Law::field, Law::column, Law::max_depth, Law::centroid}) {
      const Series series = follow_slope(angle * kDegree, 0.006, law);
      const Evenness evenness = evenness_of(series);
      const auto direction = [](const Sample& sample) { return std::atan2(sample.force.x, sample.force.z); };
      EXPECT_NEAR(direction(series.front()), 0, 1e-9);
      EXPECT_NEAR(direction(series.back()) / kDegree, angle, 1e-6) << law_name(law);
      EXPECT_LT(evenness.largest_turn / kDegree, 0.8) << law_name(law);
      EXPECT_LT(evenness.largest_step, 0.04) << law_name(law);
      EXPECT_GT(evenness.most, evenness.least);
    }
    EXPECT_GT(evenness_of(follow_slope(angle * kDegree, 0.006, Law::point)).largest_turn / kDegree, 1);
  }
  // On either side of the edge, out of its reach, the exact laws feel the undivided plane.
  const Series series = follow_slope(30 * kDegree, 0.006, Law::field);
  EXPECT_NEAR(norm(series.back().force) / norm(series.front().force), 1, 0.05);
}

// Figure 14: many triangles, smooth force; only the exact laws also agree on it from mesh to mesh.
TEST(PaperExperiment, FingertipOverManyTriangles) {
  const auto of = [](std::uint32_t cells, Law law) { return evenness_of(sweep_fingertip(cells, law)); };
  const Evenness coarse = of(40, Law::field), fine = of(160, Law::field);
  EXPECT_GT(fine.least, 500u);
  EXPECT_NEAR(coarse.mean / fine.mean, 1, 3e-3);
  EXPECT_LT(fine.largest_jump, 0.01);
  const Evenness paper_coarse = of(40, Law::max_depth), paper_fine = of(160, Law::max_depth);
  EXPECT_GT(paper_coarse.mean / paper_fine.mean, 1.15);
  EXPECT_LT(paper_coarse.largest_jump, 0.02);
}

// Figure 15: pushed through the surface, an upright finger is held for good, a lying one only as deep as its
// axis.
TEST(PaperExperiment, PushedThroughTheSurface) {
  const Series upright = poke(90 * kDegree, 0.02, Law::field), lying = poke(0, 0.02, Law::field);
  const double full = 2e7 * kPi * kRadius * kRadius * kRadius / 3;
  for (std::size_t i = 1; i < upright.size(); ++i) {
    EXPECT_GE(norm(upright[i].force) * (1 + 1e-6), norm(upright[i - 1].force));
    EXPECT_LT(norm(upright[i].force - upright[i - 1].force), 0.021 * full);
  }
  EXPECT_NEAR(norm(upright.back().force) / full, 1, 1e-6);
  EXPECT_GT(norm(lying[80].force), norm(lying[120].force));  // the axis is at 8 mm: beyond it the force falls
  EXPECT_EQ(norm(lying[161].force), 0);                      // at 16 mm it is through
}

// Pulled into the side of a block the field law pulls back; the paper's depth lifts as much as it pulls, for
// it is the same volume of finger that is measured from the side and from above.
TEST(PaperExperiment, HookRoundA90DegreeEdge) {
  const Vec3 field = hook(Law::field), column = hook(Law::column), paper = hook(Law::max_depth);
  EXPECT_LT(field.z, 0.1 * field.x);
  EXPECT_NEAR(column.z / column.x, 1, 1e-9);
  EXPECT_NEAR(paper.z / paper.x, 0.85, 0.1);
}

}  // namespace
}  // namespace lumbrical::bench
