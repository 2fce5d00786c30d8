// Every broadphase finds the same candidates, and no contact is missing from them.
#include "stages/broadphase.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <filesystem>

#include "base/radix_sort.h"
#include "borders/pair_contact.h"
#include "index/sphere_grid.h"
#include "index/sphere_tree.h"
#include "model/corners.h"
#include "pressed_hand.h"
#include "random.h"
#include "session.h"

namespace lumbrical::test {
namespace {

using Candidates = std::vector<std::uint64_t>;

Candidates candidates_of(const Model& model, const Primitives& hand) {
  Scratch scratch = make_scratch(model);
  EXPECT_TRUE(find_candidates(model, hand, scratch));
  return {scratch.candidates.begin(), scratch.candidates.begin() + scratch.candidate_count};
}

std::vector<Execution> executions(double scale) {
  std::vector<Execution> all;
  for (const std::uint32_t leaf_size : {1u, 7u, 16u, 33u}) {
    for (const std::uint32_t levels : {0u, 1u, 2u}) {
      Execution tree;
      tree.leaf_size = leaf_size;
      tree.tree_levels = levels;
      all.push_back(tree);
    }
    Execution grid;
    grid.broadphase = Broadphase::grid;
    grid.leaf_size = leaf_size;
    grid.cell_size = clamp(scale * std::pow(4.0, static_cast<double>(leaf_size % 5) - 3), 1e-3, 1e6);
    all.push_back(grid);
    if (!available(Broadphase::voxel)) continue;
    Execution voxel;
    voxel.broadphase = Broadphase::voxel;
    voxel.leaf_size = leaf_size;
    voxel.voxel_size = leaf_size == 16 ? 0 : scale * std::pow(4.0, static_cast<double>(leaf_size % 5) - 4);
    all.push_back(voxel);
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    const Isa isas[] = {Isa::scalar, Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon};
    if (available(isas[i % 5])) all[i].isa = isas[i % 5];
  }
  return all;
}

// Triangles of all sizes about `centre`, some flat, some points.
Mesh soup(Random& random, Vec3 centre, double scale) {
  Mesh mesh;
  for (int i = 0; i < 400; ++i) {
    const Vec3 p = centre + random.in_box(scale);
    const double size = scale * std::pow(10.0, random.between(-4, 0.5));
    const Vec3 q = p + random.in_box(size), r = i % 10 == 0 ? q : p + random.in_box(size);
    const auto first = static_cast<std::uint32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), {p, q, r});
    mesh.triangles.push_back({first, first + 1, first + 2});
  }
  return mesh;
}

Primitive random_primitive(Random& random, Vec3 centre, double scale) {
  Primitive primitive;
  primitive.end1 = centre + random.in_box(scale);
  primitive.end2 = primitive.end1 + std::pow(10.0, random.between(-12, 0)) * random.in_box(scale);
  primitive.radius1 = random.between(0.01, 0.2) * scale;
  primitive.radius2 = random.between(0.5, 1) * primitive.radius1;
  for (; primitive.cut_count < 2 && random.between(0, 1) < 0.4; ++primitive.cut_count)
    primitive.cut[primitive.cut_count] = {random.direction(),
                                          primitive.end1 + random.in_box(primitive.radius1)};
  return primitive;
}

// A pair of which the general way computes more than rounding must be a candidate.
int count_contacts(const Model& model, const Primitives& hand, const Candidates& candidates) {
  int contacts = 0;
  for (std::uint64_t i = 0; i < hand.count; ++i) {
    for (std::uint32_t k = 0; k < model.triangles.size(); ++k) {
      const auto [a, b, c] = corners_of(model.triangles, k);
      Contact contact;
      Primitive primitive = hand.primitive[i];
      primitive.law = Law::max_depth;
      const double digits = 1e-12 * primitive.radius1 * primitive.radius1;
      if (!collide(primitive, {}, {a, b, c}, contact) || contact.area < digits) continue;
      ++contacts;
      EXPECT_TRUE(std::binary_search(candidates.begin(), candidates.end(), i << 32 | k))
          << "primitive " << i << ", triangle " << k << ", area " << contact.area;
    }
  }
  return contacts;
}

void expect_equal(const Scene& scene, const Primitives& hand, double scale, const Candidates& expected) {
  for (const Execution& execution : executions(scale)) {
    const Candidates found = candidates_of(model_of(scene, execution), hand);
    EXPECT_EQ(found, expected) << broadphase_name(execution.broadphase) << ", leaves of "
                               << execution.leaf_size << ", " << execution.tree_levels << " levels, cells of "
                               << execution.cell_size << ", voxels of " << execution.voxel_size << ", "
                               << isa_name(execution.isa);
  }
}

TEST(Broadphase, ATreeIsChosenUpToOneKilometreAndAGridBeyond) {
  Scene scene;
  scene.settings.precision.fill(0);
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"here", make_height_field(0.3, 20, 0.002, 0.04)});
  scene.objects.push_back(scene.objects[0]);
  for (const Vec3 shift : {Vec3{}, {999, 0, 0}, {0, 1001, 0}, {0, 0, -1001}, {1e5, 1e5, 0}}) {
    for (std::size_t i = 0; i < scene.objects[0].mesh.vertices.size(); ++i) {
      const Vec3 p = scene.objects[0].mesh.vertices[i];
      scene.objects[1].mesh.vertices[i] = p + shift;
    }
    Model automatic, tree;
    ASSERT_TRUE(build_model(scene, {}, automatic).ok());
    const bool is_near = norm(shift) < 1000;
    EXPECT_EQ(automatic.execution.broadphase, is_near ? Broadphase::tree : Broadphase::grid) << norm(shift);
    EXPECT_EQ(automatic.grid.tree.empty(), is_near);
    Execution by_tree;
    by_tree.broadphase = Broadphase::tree;
    ASSERT_TRUE(build_model(scene, by_tree, tree).ok());
    State state_a, state_b;
    Scratch scratch_a = make_scratch(automatic), scratch_b = make_scratch(tree);
    const DeviceFrame frame = pressed_frame(scene.hand, 0.002, 0.3);
    tick(automatic, state_a, scratch_a, frame);
    tick(tree, state_b, scratch_b, frame);
    EXPECT_GT(scratch_a.contact_count, 20u);
    EXPECT_EQ(scratch_a.stage_hash, scratch_b.stage_hash);
  }
}

TEST(Broadphase, FindsTheCandidatesOfBruteForceInAnySceneAndLosesNoContact) {
  Random random(3);
  std::size_t candidates = 0;
  int contacts = 0;
  const char* const more = std::getenv("LUMBRICAL_BROADPHASE_SCENES");
  const int scenes = more == nullptr ? 25 : std::atoi(more);
  for (int i = 0; i < scenes; ++i) {
    SCOPED_TRACE(i);
    const double scale = std::pow(10.0, random.between(-3, 3));
    // Up to 1e8 m from the origin, where doubles are 15 nm apart.
    const double away = i % 5 == 0 ? 0.9e8 : scale * std::pow(10.0, random.between(-1, 3));
    const Vec3 centre = random.in_box(away);
    Scene scene;
    scene.settings.precision.fill(0);
    scene.hand = default_hand(Side::right);
    scene.objects.push_back({"soup", soup(random, centre, scale)});
    Primitives hand;
    for (hand.count = 0; hand.count < 10; ++hand.count)
      hand.primitive[hand.count] = random_primitive(random, centre, scale);
    Execution brute;
    brute.broadphase = Broadphase::brute;
    const Model model = model_of(scene, brute);
    const Candidates expected = candidates_of(model, hand);
    candidates += expected.size();
    if (i % 5 != 0) contacts += count_contacts(model, hand, expected);
    expect_equal(scene, hand, scale, expected);
  }
  EXPECT_GT(candidates, static_cast<std::size_t>(scenes) * 20);
  EXPECT_GT(contacts, scenes * 5);
}

TEST(Broadphase, FindsTheSameInPlacedRealMeshes) {
  const char* const data = std::getenv("LUMBRICAL_DATA");
  if (data == nullptr) GTEST_SKIP() << "set LUMBRICAL_DATA to a folder with meshes/";
  Random random(8);
  int meshes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(std::filesystem::path(data) / "meshes")) {
    Mesh mesh;
    if (std::filesystem::file_size(entry) > 8'000'000 ||
        !load_mesh(entry.path().string(), Unit::metre, mesh).ok() || mesh.triangles.empty())
      continue;
    ++meshes;
    Box box;
    for (const Vec3 p : mesh.vertices) box.add(p);
    const Vec3 middle = box.middle();
    const double size = norm(box.upper - box.lower), scale = std::pow(10.0, random.between(-3, 3));
    const Pose place = random.pose(100 * scale);
    for (Vec3& p : mesh.vertices) p = transform(place, (scale / size) * (p - middle));
    Primitives hand;
    for (hand.count = 0; hand.count < 6; ++hand.count) {
      const Vec3 at = mesh.vertices[random.bits() % mesh.vertices.size()];
      hand.primitive[hand.count] = random_primitive(random, at, 0.1 * scale);
    }
    Scene scene;
    scene.settings.precision.fill(0);
    scene.hand = default_hand(Side::right);
    scene.objects.push_back({"mesh", mesh});
    Execution brute, grid;
    brute.broadphase = Broadphase::brute;
    grid.broadphase = Broadphase::grid;
    grid.cell_size = clamp(0.07 * scale, 1e-3, 1e6);
    const Candidates expected = candidates_of(model_of(scene, brute), hand);
    EXPECT_EQ(candidates_of(model_of(scene), hand), expected) << entry.path();
    EXPECT_EQ(candidates_of(model_of(scene, grid), hand), expected) << entry.path();
    if (!available(Broadphase::voxel)) continue;
    Execution voxel;
    voxel.broadphase = Broadphase::voxel;
    EXPECT_EQ(candidates_of(model_of(scene, voxel), hand), expected) << entry.path();
  }
  EXPECT_GT(meshes, 0);
}

TEST(Broadphase, CandidatesOfAPressedHandAreLittleMoreThanItsContacts) {
  const Scene scene = pressed_scene(kWidthA, 69);
  const Model model = model_of(scene);
  State state;
  Scratch scratch = make_scratch(model);
  const ActuatorFrame output = tick(model, state, scratch, pressed_frame(scene.hand, 0.002, 0));
  EXPECT_GT(output.contact_count, 1000u);
  EXPECT_LT(scratch.candidate_count, 1.5 * output.contact_count);
}

TEST(Broadphase, SearchStructuresTakeLittleMemory) {
  const Scene scene = pressed_scene(kWidthA, 100);
  Execution execution;
  const Model tree = model_of(scene, execution);
  execution.broadphase = Broadphase::grid;
  const Model grid = model_of(scene, execution);
  // 16 bytes of sphere, 4 of index, a fifteenth of a leaf's spheres.
  EXPECT_LT(static_cast<double>(byte_count(tree.tree)) / 20000, 21.5);
  EXPECT_LT(static_cast<double>(byte_count(grid.grid)) / 20000, 23);
}

TEST(Broadphase, SortsKeysLikeTheLibrary) {
  Random random(1);
  for (std::size_t size = 0; size < 2000; size = size * 3 / 2 + 1) {
    Candidates keys(size), other(size);
    for (std::uint64_t& key : keys) key = random.bits() >> (random.bits() % 64);
    Candidates expected = keys;
    std::sort(expected.begin(), expected.end());
    radix_sort(keys, other);
    EXPECT_EQ(keys, expected);
  }
}

}  // namespace
}  // namespace lumbrical::test
