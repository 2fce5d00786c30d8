// Target: the force of an exact law on a plane does not depend on how the plane is cut into triangles, 1 or a
// million, nor where in the world it stands.
//
// LUMBRICAL_TARGET_TRIANGLES sets the largest number of triangles (100000 unless set); with it, what was
// measured is printed.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <numbers>

#include "experiments.h"
#include "largest.h"
#include "lumbrical/probe.h"
#include "pressed_hand.h"
#include "random.h"

namespace lumbrical::bench {

inline const char* cut_name(Cut cut) {
  constexpr const char* names[] = {"whole", "grid", "graded", "slivers", "shards", "t_junctions"};
  return names[static_cast<std::size_t>(cut)];
}
inline void PrintTo(Cut cut, std::ostream* out) { *out << cut_name(cut); }

namespace {

constexpr Cut kCuts[] = {Cut::grid, Cut::graded, Cut::slivers, Cut::shards, Cut::t_junctions};
constexpr double kDegree = std::numbers::pi / 180;
constexpr double kExtent = 0.16;  // [m] of the planes; no finger reaches their edge

struct Posed {
  PosedFinger finger;
  Pose X_WF;
};

Posed lean(double tilt, double depth) {
  return {one_phalanx(), {{0.003, -0.002, kRadius - depth}, leaning(tilt * kDegree, 0.35)}};
}

std::vector<Posed> even_fingers() {
  return {lean(90, 0.002), lean(25, 0.002), lean(25, 0.0003), lean(0, 0.002), lean(3, 0.011)};
}

// All three phalanges, tapered as a real finger is, lying obliquely on the plane.
std::vector<Posed> tapered_fingers() {
  PosedFinger finger = bent_finger(20 * kDegree, 25 * kDegree);
  finger.radius = {0.0105, 0.0085, 0.0076, 0.0066};
  return {{finger, {{-0.035, 0.004, 0.016}, leaning(80 * kDegree, 0.5)}}};
}

std::size_t largest_count() {
  const char* asked = std::getenv("LUMBRICAL_TARGET_TRIANGLES");
  return asked != nullptr ? static_cast<std::size_t>(std::atoll(asked)) : 100000;
}

// The column law takes its time over needles that cross the whole plane.
std::size_t largest_count(Cut cut, Law law) {
  return cut == Cut::slivers && law == Law::column && std::getenv("LUMBRICAL_TARGET_TRIANGLES") == nullptr
             ? 12500
             : largest_count();
}

bool wanted_in_print() { return std::getenv("LUMBRICAL_TARGET_TRIANGLES") != nullptr; }

Mesh moved(Mesh mesh, const Pose& X) {
  for (Vec3& p : mesh.vertices) p = transform(X, p);
  return mesh;
}

// What is felt in the frame the plane is z = 0 in.
Felt feel_at(Rig& rig, const Posed& posed, const Pose& X) {
  set_joints(posed.finger, rig);
  Felt felt = feel(rig, X * posed.X_WF);
  const Quat back = conjugate(X.orientation);
  felt.force = rotate(back, felt.force);
  felt.torque = rotate(back, felt.torque);
  return felt;
}

struct Spread {
  double force = 0, torque = 0, area = 0;  // relative; torque against force times 10 mm
  double here = 0, area_here = 0;          // where the plane is z = 0 exactly: of force and area
  // The corners of a plane moved elsewhere are rounded to doubles, which tilts a strip of width w by 1e-16 m
  // / w.
  double input = 0;
};

Spread spread_over(Cut cut, Law law, const std::vector<Posed>& fingers) {
  std::vector<Felt> expected;
  for (const Posed& posed : fingers) {
    Rig rig = make_rig(cut_plane(kExtent, 1, Cut::whole, 0), posed.finger, law);
    expected.push_back(feel_at(rig, posed, {}));
  }
  test::Random random(17);
  Spread spread;
  std::size_t most = 0;
  const std::size_t largest = largest_count(cut, law);
  for (std::size_t count = 2; count <= largest; count = count < 10 ? 20 : count * 5) {
    if (count * 5 > largest) count = largest;
    const Mesh mesh = cut_plane(kExtent, count, cut, 100 + count);
    const bool only_here = cut == Cut::slivers && count > 20000;
    for (const Pose& X : {Pose{}, random.pose(0.5)}) {
      if (only_here && !(X == Pose{})) continue;
      if (cut == Cut::slivers && !(X == Pose{}))
        spread.input = 2e-16 / (2 * kExtent / static_cast<double>(count));
      Rig rig = make_rig(moved(mesh, X), fingers[0].finger, law);
      for (std::size_t i = 0; i < fingers.size(); ++i) {
        const Felt felt = feel_at(rig, fingers[i], X);
        EXPECT_EQ(felt.flags & (kForceLimited | kCandidateOverflow), 0u);
        most = std::max<std::size_t>(most, felt.contacts);
        const double force = norm(expected[i].force);
        EXPECT_GT(force, 0.01);
        const double change = norm(felt.force - expected[i].force) / force;
        spread.force = test::largest(spread.force, change);
        if (X == Pose{}) spread.here = test::largest(spread.here, change);
        spread.torque = test::largest(spread.torque, norm(felt.torque - expected[i].torque) / (0.01 * force));
        const double area_change = std::fabs(felt.area / expected[i].area - 1);
        if (X == Pose{}) spread.area_here = test::largest(spread.area_here, area_change);
        spread.area = test::largest(spread.area, area_change);
      }
    }
  }
  if (wanted_in_print()) {
    std::printf(
        "%-12s %-7s up to %zu triangles, %zu contacts: force %.1e (moved: %.1e) torque %.1e area %.1e\n",
        cut_name(cut), law_name(law).data(), largest_count(), most, spread.here, spread.force, spread.torque,
        spread.area);
  }
  return spread;
}

// Beyond 100000 triangles the rounding of so many contacts adds up where they are needles 160 mm long and
// less than a micrometre wide.
void expect_within_target(const Spread& spread, Cut cut) {
  const double many = cut == Cut::slivers ? 1e-17 * static_cast<double>(largest_count()) : 0;
  const double most = std::max(1e-12, many);
  EXPECT_LT(spread.here, most);
  EXPECT_LT(spread.force, std::max(most, spread.input));
  EXPECT_LT(spread.torque, 10 * most);
  EXPECT_LT(spread.area_here, most);
  EXPECT_LT(spread.area, std::max(most, spread.input));
}

TEST(PalmOnAPlane, FeelsTheSameOfTwoTrianglesAsOfTwoMillion) {
  const double most = wanted_in_print() ? static_cast<double>(largest_count()) : 2e6;
  Wrench few;
  for (const double count : {2.0, most}) {
    Scene scene;
    scene.hand = default_hand(Side::right);
    scene.settings.precision.fill(0);
    scene.settings.fade_time = 0;
    scene.settings.max_force = 1000;  // what the palm feels is far below
    scene.objects.push_back({"plane", make_plane(1, static_cast<std::uint32_t>(std::sqrt(count / 2)))});
    Model model;
    ASSERT_TRUE(build_model(scene, {}, model).ok());
    State state;
    Scratch scratch = make_scratch(model);
    const ActuatorFrame out = tick(model, state, scratch, test::pressed_frame(scene.hand, 0.0005, 0.1));
    const Wrench& palm = out.segment[kPalmSegment];
    if (count == 2) few = palm;
    EXPECT_GT(norm(palm.force), 3);
    EXPECT_EQ(out.flags & (kForceLimited | kCandidateOverflow), 0u);
    EXPECT_LT(norm(palm.force - few.force), 1e-6 * norm(few.force)) << count;
    EXPECT_LT(norm(palm.torque - few.torque), 1e-6 * norm(few.torque)) << count;
  }
}

class MeshIndependence : public testing::TestWithParam<Cut> {};

TEST_P(MeshIndependence, OfFieldAndColumnIsExact) {
  for (const Law law : {Law::field, Law::column}) {
    for (const auto& fingers : {even_fingers(), tapered_fingers()})
      expect_within_target(spread_over(GetParam(), law, fingers), GetParam());
  }
}

INSTANTIATE_TEST_SUITE_P(Cuts, MeshIndependence, testing::ValuesIn(kCuts), testing::PrintToStringParamName());

// Single primitives as `probe` poses them, the flat cylinder among them.
TEST(MeshIndependence, HoldsForEverySinglePrimitive) {
  const double r = kRadius;
  const auto axis = [](double tilt) { return Vec3{std::cos(tilt), 0.2, std::sin(tilt)}; };
  std::vector<ProbePrimitive> primitives = {{ProbeShape::sphere, {0.001, 0.002, 0.006}, {}, r, 0}};
  for (const double tilt : {0.0, 1e-9, 0.3, 1.2}) {
    const Vec3 low{-0.004, 0.002, 0.006};
    primitives.push_back({ProbeShape::capsule, low, low + 0.025 * axis(tilt), r, r});
    primitives.push_back({ProbeShape::capsule, low, low + 0.025 * axis(tilt), r, 0.7 * r});
    primitives.push_back({ProbeShape::cylinder, low - 0.01 * axis(tilt), low + 0.025 * axis(tilt), r, r});
  }
  test::Random random(18);
  double worst = 0;
  for (const Cut cut : kCuts) {
    for (const std::size_t count : {2u, 30u, 400u, 5000u}) {
      const Mesh mesh = cut_plane(0.12, count, cut, 200 + count);
      const Pose X = random.pose(0.5);
      const Mesh there = moved(mesh, X);
      for (ProbePrimitive primitive : primitives) {
        const auto volume_of = [&](const Mesh& plane) {
          std::vector<ProbeContact> contacts;
          EXPECT_TRUE(probe(plane, std::span(&primitive, 1), Law::field, 1, contacts).ok());
          double volume = 0;
          for (const ProbeContact& contact : contacts) volume += contact.volume;
          return volume;
        };
        const double whole = volume_of(cut_plane(0.12, 1, Cut::whole, 0)), here = volume_of(mesh);
        primitive.end1 = transform(X, primitive.end1);
        primitive.end2 = transform(X, primitive.end2);
        worst = std::max({worst, std::fabs(here / whole - 1), std::fabs(volume_of(there) / whole - 1)});
        EXPECT_LT(std::fabs(here / whole - 1), 1e-12)
            << cut_name(cut) << ' ' << count << " shape " << static_cast<int>(primitive.shape);
        EXPECT_LT(std::fabs(volume_of(there) / whole - 1), 1e-12) << cut_name(cut) << ' ' << count;
      }
    }
  }
  if (wanted_in_print()) std::printf("single primitives: %.1e\n", worst);
}

}  // namespace
}  // namespace lumbrical::bench
