// Patches by one edge of the palm go through a kernel that knows of no other: is no other nearer?
#include <gtest/gtest.h>

#include <cmath>

#include "lumbrical/shapes.h"
#include "patch_points.h"
#include "sampled_hand.h"
#include "samples/sampled_forces.h"

namespace lumbrical::test {
namespace {

constexpr int kSteps = 12;

// By how much the polygon is farther from any point of a patch than from what is beyond one of its edges'
// lines, for the edge that does best [m].
double error_by_one_edge(const PatchShape& patch, const PalmBody& palm) {
  double best = 1;
  for (std::size_t k = 0; k < palm.corner_count; ++k) {
    double worst = 0;
    for (int i = 0; i <= kSteps; ++i) {
      for (int j = 0; i + j <= kSteps; ++j) {
        const Vec3 p = point_on(patch, i / double{kSteps}, j / double{kSteps}) - palm.origin;
        const double x = dot(p, vec3_of(palm.axis[0])), y = dot(p, vec3_of(palm.axis[1])),
                     z = dot(p, vec3_of(palm.axis[2]));
        const double beyond = palm.out_x[k] * (x - palm.x[k]) + palm.out_y[k] * (y - palm.y[k]);
        worst = max(worst, std::abs(distance_to_palm(p, palm) - std::hypot(max(beyond, 0), z)));
      }
    }
    best = min(best, worst);
  }
  return best;
}

// What the palm feels of patches by its edges, by the kernel that asks one edge or by the one that asks all.
template <class Kernel>
Wrench felt_by(const Kernel& kernel, const Patches& patches, const SampleMemory& memory) {
  const Bodies& bodies = memory.bodies;
  BodySums sums;
  sums.force_quantum = 0x1p-60;
  sums.moment_quantum = 0x1p-66;
  for (std::size_t patch_class = 0; patch_class < kPatchClasses; ++patch_class) {
    const auto listed = memory.near.of_kinds(kind::kPalmEdge, kind::kPalmEdge, patch_class);
    const PatchList list{patches.shape.data(), listed.data(), listed.size(), bodies.origin.data()};
    if (list.count > 0) kernel(list, bodies.palm, 4, sums);
  }
  double total[6] = {};
  for (std::size_t k = 0; k < 6; ++k) {
    for (const double lane : sums.lane[k]) total[k] += lane;
  }
  return {{total[0], total[1], total[2]}, {total[3], total[4], total[5]}};
}

TEST(PalmEdges, ArePatchesToWhichNoOtherEdgeIsNearer) {
  int found = 0, others = 0;
  for (const int cells : {3, 12, 60}) {
    const Scene scene = sampled_scene(default_hand(Side::right),
                                      {{"field", make_plane(0.3, static_cast<std::uint32_t>(cells), 1, 3)}});
    const Model model = model_at(scene, 1e-4);
    Scratch scratch = make_scratch(model);
    Random random(37);
    for (int i = 0; i < 200; ++i) {
      const DeviceFrame frame =
          dropped_hand(scene.hand, random, -0.3, 0.1, 0.4, random.between(0.005, 0.03), 0.03);
      State state;
      tick(model, state, scratch, frame);
      const SampleMemory& memory = *scratch.samples;
      for (std::size_t patch_class = 0; patch_class < kPatchClasses; ++patch_class) {
        for (const ListedPatch& at : memory.near.of_kinds(kind::kPalmEdge, kind::kPalmEdge, patch_class)) {
          ++found;
          ASSERT_LT(error_by_one_edge(model.patches->shape[at.place], memory.bodies.palm), 1e-7);
        }
        others += static_cast<int>(memory.near.of_kinds(kind::kPalm, kind::kPalm, patch_class).size());
      }
      const Wrench one = felt_by(scalar::kSampleKernels.palm_edge_lattice, *model.patches, memory),
                   all = felt_by(scalar::kSampleKernels.palm_lattice, *model.patches, memory);
      EXPECT_LE(norm(one.force - all.force), 1e-5 * norm(all.force) + 1e-13);
      EXPECT_LE(norm(one.torque - all.torque), 1e-5 * norm(all.torque) + 1e-14);
    }
  }
  EXPECT_GT(found, 1000);
  EXPECT_GT(others, 1000) << "corners were never near";
}

}  // namespace
}  // namespace lumbrical::test
