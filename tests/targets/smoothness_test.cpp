// Targets: a slide over a flat mesh changes nothing, and a finger that bends through its joints never makes
// the force step: docs/mechanics.md derives the bound.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "experiments.h"
#include "lumbrical/shapes.h"

namespace lumbrical::bench {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

TEST(Slide, OverAFlatMeshChangesNothingUnderTheExactLaws) {
  for (const Slide& plan :
       {Slide{0, 0.006}, Slide{25 * kDegree, 0.006}, Slide{25 * kDegree, 0.012},
        Slide{25 * kDegree, 0.006, 0.0003}, Slide{25 * kDegree, 0.006, 0.003}, Slide{90 * kDegree, 0.003}}) {
    for (const Law law : {Law::field, Law::column}) {
      const Evenness evenness = evenness_of(slide(plan, law));
      EXPECT_LT(evenness.peak_to_peak, 1e-12) << law_name(law) << ' ' << plan.tilt << ' ' << plan.edge;
      EXPECT_LT(std::fabs(evenness.bias), 1e-12);
      EXPECT_GT(evenness.most, evenness.least);
    }
  }
}

// From hyper-extended by 30 degrees through straight to bent by 110, 0.1 degrees per tick.
TEST(Bending, NeverStepsTheFieldForceByMoreThanItsBound) {
  const Mesh flat = graded_plane(0.24, 0.24, 0.006, 71), bumpy = make_height_field(0.24, 40, 0.001, 0.03);
  struct Case {
    const char* name;
    const Mesh& mesh;
    double roll, ratio;  // roll in degrees: 0 bends into the surface, 90 within it
  };
  for (const Case& c : {Case{"flat", flat, 0, 0}, Case{"flat", flat, 45, 1}, Case{"flat", flat, 90, 0.5},
                        Case{"bumpy", bumpy, 0, 1}, Case{"bumpy", bumpy, 90, 1}}) {
    Bend plan;
    plan.roll = c.roll * kDegree;
    plan.ratio = c.ratio;
    const BendResult result = bend(c.mesh, plan, Law::field);
    EXPECT_GT(result.largest_force, 10);
    EXPECT_LE(result.share_of_bound, 1)
        << c.name << ", roll " << c.roll << ", ratio " << c.ratio << ", at " << result.worst_at / kDegree;
  }
}

// The bound is no idle one: a finger that moves as a whole uses most of it.
TEST(Bending, BoundIsUsedByAFingerThatSinksIn) {
  Rig rig = make_rig(graded_plane(0.24, 0.24, 0.006, 71), one_phalanx(), Law::field);
  const auto felt_at = [&](double depth) { return feel(rig, {{0, 0, kRadius - depth}, leaning(0, 0.35)}); };
  const Felt before = felt_at(0.0020), after = felt_at(0.0021);
  const double bound = rig.model.settings.stiffness * after.area * 0.0001;
  const double step = norm(after.force - before.force);
  EXPECT_LT(step, bound);
  EXPECT_GT(step, 0.8 * bound);
}

}  // namespace
}  // namespace lumbrical::bench
