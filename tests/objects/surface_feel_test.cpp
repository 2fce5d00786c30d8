// Surfaces that are felt as something round, bumpy, or rough in places.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <string>
#include <vector>

#include "largest.h"
#include "pads.h"
#include "session.h"

namespace lumbrical {
namespace {

using test::largest;
using test::Session;

constexpr double kPi = 3.141592653589793, kRadius = 0.04;

double degrees_between(Vec3 a, Vec3 b) { return std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / kPi; }

// Facets round the z axis from -length / 2 to length / 2, closed, in rings.
Mesh faceted_cylinder(std::uint32_t facets, double length, std::uint32_t rings) {
  Mesh mesh;
  for (std::uint32_t k = 0; k <= rings; ++k) {
    for (std::uint32_t i = 0; i < facets; ++i) {
      const double angle = 2 * kPi * i / facets;
      mesh.vertices.push_back(
          {kRadius * std::cos(angle), kRadius * std::sin(angle), length * (1.0 * k / rings - 0.5)});
    }
  }
  const auto below = static_cast<std::uint32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), {{0, 0, -0.5 * length}, {0, 0, 0.5 * length}});
  for (std::uint32_t i = 0; i < facets; ++i) {
    const std::uint32_t next = (i + 1) % facets, top = rings * facets;
    mesh.triangles.insert(mesh.triangles.end(), {{next, i, below}, {top + i, top + next, below + 1}});
    for (std::uint32_t k = 0; k < top; k += facets) {
      mesh.triangles.push_back({k + i, k + next, k + facets + next});
      mesh.triangles.push_back({k + i, k + facets + next, k + facets + i});
    }
  }
  return mesh;
}

// The same in one ring without ends. Facets have a corner more in the middle of their right edge, `off` [m]
// it, and a triangle of next to no area fills what is between it and the next facet's edge; or two, where
// that has a corner as well, a third of the way up.
Mesh filled_cylinder(std::uint32_t facets, double length, double off, bool on_both_sides) {
  enum : std::uint32_t { low, high, middle, third };
  Mesh mesh;
  for (std::uint32_t i = 0; i < facets; ++i) {
    const double angle = 2 * kPi * i / facets;
    const Vec3 out{std::cos(angle), std::sin(angle), 0}, up{0, 0, length}, at = kRadius * out;
    mesh.vertices.insert(mesh.vertices.end(),
                         {at - 0.5 * up, at + 0.5 * up, at + off * out, at - up / 6 + off * out});
  }
  for (std::uint32_t i = 0; i < facets; ++i) {
    const std::uint32_t left = 4 * i, right = 4 * ((i + 1) % facets);
    const auto add = [&](const Triangle& t) { mesh.triangles.push_back(t); };
    add({right + low, right + high, right + middle});
    add({right + middle, right + high, left + high});
    if (on_both_sides) {
      add({right + high, right + low, right + third});
      add({left + third, left + low, right + low});
    }
    const std::uint32_t corner = left + (on_both_sides ? third : low);
    add({corner, right + low, right + middle});
    add({corner, right + middle, left + high});
  }
  return mesh;
}

Scene scene_with(Mesh mesh, const Surface& surface, const Material& material = {}) {
  Scene scene = test::pad_scene();
  scene.objects.push_back(test::object_of("object", std::move(mesh), {}, material));
  scene.objects[0].surface = surface;
  // Apart with and without a surface.
  if (!rubs(material)) scene.objects[0].mechanism.mobility = Mobility::given;
  return scene;
}

void feel_at_rest(Session& run, const DeviceFrame& frame) {
  const ObjectFrame stays{};
  const bool told = run.model.apart[0].mechanism.mobility == Mobility::given;
  run.step(frame, {&stays, told ? 1u : 0u});
}

Vec3 press(Session& run, Vec3 tip, Vec3 away) {
  feel_at_rest(run, test::frame_of({{tip, away}}));
  return test::hand_force(run.output);
}

// Of a fingertip each.
std::array<Vec3, 2> press_both(Session& run, const std::array<Vec3, 2>& tip, Vec3 away) {
  feel_at_rest(run, test::frame_of({{tip[0], away}, {tip[1], away}}));
  return {run.output.segment[2].force, run.output.segment[5].force};
}

Surface smooth() {
  Surface surface;
  surface.crease_angle = 0.7;
  return surface;
}

// A factor of friction of 0.25 at x < 0 and 1 beyond.
Surface half_rough(const Mesh& plane) {
  Surface half;
  for (const Triangle& t : plane.triangles) {
    const Vec3 middle = (plane.vertices[t[0]] + plane.vertices[t[1]] + plane.vertices[t[2]]) / 3;
    half.friction_factor.push_back(middle.x < 0 ? 0.25 : 1);
  }
  return half;
}

// White crests of cosine across x, black between.
Texture ridges(double period, double height) {
  Texture texture;
  texture.image = {32, 1, {}};
  for (int i = 0; i < 32; ++i)
    texture.image.grey.push_back(
        static_cast<std::uint16_t>(std::lround(32767.5 * (1 + std::cos(kPi * (i + 0.5) / 16)))));
  texture.period = period;
  texture.white = height;
  return texture;
}

/// How a force follows the true normal of what facets stand for.
struct Stroke {
  double worst = 0, plain = 0, largest_step = 0;  // [degrees] with and without
  double worst_magnitude = 0;                     // share by which shading changes it
};

Stroke stroke_round(const Mesh& mesh, std::uint32_t facets, double precision, const Pad& pad = {},
                    double crease_angle = 0.7) {
  Scene plain = scene_with(mesh, {});
  plain.settings.precision.fill(precision);
  plain.settings.pad = pad;
  Scene shaded = plain;
  shaded.objects[0].surface.crease_angle = crease_angle;
  Session with(shaded), without(plain);
  Stroke stroke;
  Vec3 last;
  for (int i = 0; i <= 400; ++i) {
    const double angle = 0.3 + 4 * kPi / facets * i / 400;  // over two facets
    const Vec3 out{std::cos(angle), std::sin(angle), 0}, tip = (kRadius + 0.0068) * out + Vec3{0, 0, 0.003};
    const Vec3 force = press(with, tip, out), flat = press(without, tip, out);
    stroke.worst = largest(stroke.worst, degrees_between(force, out));
    stroke.plain = largest(stroke.plain, degrees_between(flat, out));
    if (i > 0) stroke.largest_step = largest(stroke.largest_step, degrees_between(force, last));
    stroke.worst_magnitude = largest(stroke.worst_magnitude, std::fabs(norm(force) / norm(flat) - 1));
    last = force;
  }
  return stroke;
}

Stroke stroke_round(std::uint32_t facets, double precision, const Pad& pad = {}) {
  return stroke_round(faceted_cylinder(facets, 0.06, 15), facets, precision, pad);
}

TEST(SurfaceFeel, ForceOnAFacetedCylinderFollowsTheNormalOfARoundOneAndStaysAsLarge) {
  for (const double precision : {0.0, 1e-4}) {
    const Stroke coarse = stroke_round(16, precision), fine = stroke_round(48, precision);
    EXPECT_GT(coarse.plain, 5);
    EXPECT_LT(coarse.worst, 1.5);
    EXPECT_LT(fine.worst, 0.1);
    EXPECT_LT(coarse.largest_step, 0.2);  // the finger turns by 0.1125
    EXPECT_LT(fine.largest_step, 0.08);
    EXPECT_LT(coarse.worst_magnitude, 1e-12);
    EXPECT_LT(fine.worst_magnitude, 1e-12);
  }
}

TEST(SurfaceFeel, TrianglesOfNoAreaThatFillTJunctionsLeaveACylinderRound) {
  for (const double crease_angle : {0.7, kPi}) {
    for (const double off : {0.0, 1e-8}) {  // as files keep it in single precision
      for (const bool on_both_sides : {false, true}) {
        const Stroke stroke =
            stroke_round(filled_cylinder(16, 0.06, off, on_both_sides), 16, 0, {}, crease_angle);
        EXPECT_GT(stroke.plain, 5);
        EXPECT_LT(stroke.worst, 1.5) << crease_angle << " " << off << " " << on_both_sides;
        EXPECT_LT(stroke.largest_step, 0.2);
        EXPECT_LT(stroke.worst_magnitude, 1e-12);
      }
    }
  }
}

// Slivers take sides with one facet only, and are not turned themselves.
TEST(SurfaceFeel, TrianglesOfNoAreaLeaveCreasesSharp) {
  const Mesh mesh = filled_cylinder(16, 0.06, 0, true);  // whose edges turn by 0.39
  Surface surface;
  surface.crease_angle = 0.3;
  Session with(scene_with(mesh, surface)), without(scene_with(mesh, {}));
  for (int i = 0; i < 100; ++i) {
    const Vec3 out{std::cos(0.01 * i), std::sin(0.01 * i), 0}, tip = (kRadius + 0.0068) * out;
    const Vec3 force = press(with, tip, out);
    EXPECT_GT(norm(force), 0);
    EXPECT_EQ(force, press(without, tip, out));
  }
}

// What overlapping fingertips hold is felt once, so the normals under it count once.
TEST(SurfaceFeel, FingertipsThatOverlapAreTurnedByWhatEachOfThemFeels) {
  struct Case {
    double precision;
    FeltOnce once;
  };
  for (const auto& [precision, once] :
       {Case{0, FeltOnce::never}, Case{0, FeltOnce::by_samples}, Case{0, FeltOnce::always},
        Case{1e-4, FeltOnce::never}, Case{1e-4, FeltOnce::by_samples}, Case{1e-4, FeltOnce::always}}) {
    Scene scene = scene_with(faceted_cylinder(16, 0.06, 1), smooth());
    scene.settings.precision.fill(precision);
    scene.settings.felt_once = once;
    Session run(scene);
    double worst = 0;
    for (int i = 0; i <= 200; ++i) {
      const double angle = 0.3 + kPi / 8 * i / 200;  // over a facet
      const Vec3 out{std::cos(angle), std::sin(angle), 0}, up{0, 0, 0.001}, tip = (kRadius + 0.0068) * out;
      for (const Vec3 force : press_both(run, {tip + up, tip - up}, out)) {
        EXPECT_GT(norm(force), 0.05);
        worst = largest(worst, degrees_between(force, out));
      }
    }
    EXPECT_LT(worst, 1.5) << precision << " " << felt_once_name(once);
  }
}

TEST(SurfaceFeel, PadsThatHardenAreTurnedAsTheFieldIs) {
  const Pad pad{{{{0.05, 3}}}, 0.5};
  const Stroke stroke = stroke_round(16, 1e-4, pad);
  EXPECT_GT(stroke.plain, 5);
  EXPECT_LT(stroke.worst, 1.5);
  EXPECT_LT(stroke.largest_step, 0.2);
  EXPECT_LT(stroke.worst_magnitude, 1e-12);
}

TEST(SurfaceFeel, SharpEdgesAndFlatFacesKeepTheirBits) {
  const Mesh box = make_box({0.06, 0.06, 0.06}, 4);
  Session with(scene_with(box, smooth())), without(scene_with(box, {}));
  int felt = 0;
  for (int i = 0; i < 200; ++i) {  // off the edge and down
    const Vec3 tip{0.02 + 1e-4 * i, 0.003, 0.037 - 5e-5 * i};
    const Vec3 force = press(with, tip, {0, 0, 1});
    EXPECT_EQ(force, press(without, tip, {0, 0, 1}));
    felt += norm(force) > 0.1 ? 1 : 0;
  }
  EXPECT_GT(felt, 100);
  EXPECT_EQ(hash_state(with.state), hash_state(without.state));
  // The flat end of a cylinder, whose facets are turned, and their rim.
  Session end(scene_with(faceted_cylinder(16, 0.05, 2), smooth()));
  const Vec3 force = press(end, {0.01, 0.005, 0.025 + 0.007}, {0, 0, 1});
  EXPECT_GT(force.z, 0.1);
  EXPECT_EQ(force.x, 0);
}

TEST(SurfaceFeel, RidgesPushAsideWithTheirPeriodAndNoHarder) {
  const double period = 0.006;
  Surface ridged;
  ridged.bumps = ridges(period, 0.0006);
  const Mesh plane = make_plane(0.2, 7);
  Session with(scene_with(plane, ridged)), without(scene_with(plane, {}));
  std::vector<double> crossings;
  double most = 0, largest_step = 0, last = 0, magnitude = 0;
  for (int i = 0; i < 4000; ++i) {
    const double x = -0.02 + 1e-5 * i;
    const Vec3 force = press(with, {x, 0.011, 0.007}, {0, 0, 1}),
               flat = press(without, {x, 0.011, 0.007}, {0, 0, 1});
    magnitude = largest(magnitude, std::fabs(norm(force) / norm(flat) - 1));
    EXPECT_NEAR(force.y, 0, 1e-9);
    most = largest(most, force.x / norm(force));
    if (i > 0) largest_step = largest(largest_step, std::fabs(force.x - last) / norm(force));
    if (i > 0 && last < 0 && force.x >= 0) crossings.push_back(x);
    last = force.x;
  }
  ASSERT_EQ(crossings.size(), 7u);  // of the crests at multiples of 6 mm from -18 to 18
  for (std::size_t i = 0; i < crossings.size(); ++i) {
    // Downhill on either side of a crest pushes away from it: here it changes from left to right.
    const double from_crest = crossings[i] / period - std::floor(crossings[i] / period + 0.5);
    EXPECT_NEAR(from_crest, 0, 0.02);
    if (i > 0) {
      EXPECT_NEAR(crossings[i] - crossings[i - 1], period, 0.02 * period);
    }
  }
  const double steepest = 0.0006 * kPi / period;  // of the ridges themselves
  EXPECT_GT(most, 0.15 * steepest);               // a fingertip smooths them
  EXPECT_LT(most, steepest);
  EXPECT_LT(largest_step, 0.01);
  EXPECT_LT(magnitude, 1e-12);
}

TEST(SurfaceFeel, RidgesFinerThanAFingertipAreNotFelt) {
  Surface fine;
  fine.bumps = ridges(0.0003, 0.0001);  // as steep as one to one
  Session run(scene_with(make_plane(0.2, 7), fine));
  double most = 0;
  for (int i = 0; i < 300; ++i) {
    const Vec3 force = press(run, {-0.02 + 7e-6 * i, 0.011, 0.007}, {0, 0, 1});
    most = largest(most, std::fabs(force.x) / force.z);
  }
  EXPECT_LT(most, 0.02);
}

TEST(SurfaceFeel, BumpsHoweverSteepTiltByLessThan45Degrees) {
  Surface steep;
  steep.bumps = ridges(0.02, 1);
  Session run(scene_with(make_plane(0.2, 7), steep));
  double most = 0;
  for (int i = 0; i < 200; ++i)
    most = largest(most, degrees_between(press(run, {1e-4 * i, 0.011, 0.007}, {0, 0, 1}), {0, 0, 1}));
  EXPECT_GT(most, 44);
  EXPECT_LT(most, 45);
}

TEST(SurfaceFeel, FrictionChangesFromTriangleToTriangleWithThePressureOnThem) {
  const Mesh plane = make_plane(0.2, 10);
  const Material material{0.8, 0.8, 0, 5000};
  Surface half = half_rough(plane);
  Texture& grip = half.grip;  // and once more by half everywhere
  grip = {{1, 1, {32768}}, 0.01, 0, 1};
  Session run(scene_with(plane, half, material));
  std::vector<double> ratio;
  for (int i = 0; i < 3000; ++i) {
    const Vec3 force = press(run, {-0.03 + 2e-5 * i, 0.011, 0.007}, {0, 0, 1});
    ratio.push_back(-force.x / force.z);
  }
  EXPECT_NEAR(ratio[800], 0.1, 1e-4);
  EXPECT_NEAR(ratio[2999], 0.4, 1e-4);
  for (std::size_t i = 801; i < ratio.size(); ++i) {
    EXPECT_GE(ratio[i], ratio[i - 1] - 1e-9);
    EXPECT_LT(ratio[i] - ratio[i - 1], 0.004);  // over a patch, not over an edge
  }
}

// Both slide along the border between two factors, half of each on either: mu is 0.8 times their mean, 0.625.
TEST(SurfaceFeel, FingertipsThatOverlapRubByWhatEachOfThemFeels) {
  const Mesh plane = make_plane(0.2, 10);
  for (const double precision : {0.0, 1e-4}) {
    Scene scene = scene_with(plane, half_rough(plane), {0.8, 0.8, 0, 5000});
    scene.settings.precision.fill(precision);
    scene.settings.felt_once = FeltOnce::always;
    Session run(scene);
    for (int i = 0; i < 1000; ++i) {
      const double y = -0.01 + 2e-5 * i;
      for (const Vec3 force :
           press_both(run, {Vec3{0, y + 0.001, 0.007}, {0, y - 0.001, 0.007}}, {0, 0, 1})) {
        if (i < 800) continue;  // not sliding yet
        EXPECT_NEAR(-force.y / force.z, 0.5, 1e-3) << precision;
      }
    }
  }
}

// Whatever a surface is made of, a small step changes the force by little, also across facets, edges, walls
// and the handle; and the object feels what the hand does.
TEST(SurfaceFeel, NeverJumpsAndActsOnTheObjectAsOnTheHand) {
  Surface surface = smooth();
  surface.bumps = ridges(0.004, 0.0005);
  MugShape shape;
  shape.segments = 10;
  Scene scene = scene_with(make_mug(shape), surface);
  scene.settings.precision.fill(1e-4);
  Session run(scene);
  double roughest = 0, uneven = 0;
  for (const double height : {0.002, 0.05, 0.094}) {
    Vec3 last;
    for (int i = 0; i < 3000; ++i) {
      const double angle = 0.3 * i / 3000 - 0.1, depth = 0.0085 - 0.002 * std::sin(0.004 * i);
      const Vec3 out{std::cos(angle), std::sin(angle), 0};
      const Vec3 force = press(run, (shape.radius + 0.016 - depth) * out + Vec3{0, 0, height}, out);
      if (i > 0) roughest = largest(roughest, norm(force - last));
      last = force;
      uneven = largest(uneven, norm(force + run.scratch.object_output[0].wrench.force));
    }
  }
  EXPECT_GT(roughest, 0);
  EXPECT_LT(roughest, 0.05);  // [N] at steps of 9 um or less; 0.02 come from the depth alone
  EXPECT_LT(uneven, 1e-10);
}

TEST(SurfaceFeel, IsTheSameForAHandThatSharesTheWorld) {
  Scene scene;
  scene.hand = default_hand(Side::right);
  scene.objects.push_back({"mug", make_mug({}), Winding::as_is, {}, {0.5, 0.5}, {}, smooth()});
  Scene other = scene;
  other.hand = default_hand(Side::left);
  Model shared;
  ASSERT_TRUE(share_world(test::model_of(scene), other.hand, shared).ok());
  const auto frames = test::grasp_frames(other.hand, 40);
  Scene rough = other;
  rough.objects[0].surface = {};
  EXPECT_NE(test::hash_run(test::model_of(rough), frames), test::hash_run(test::model_of(other), frames));
  EXPECT_EQ(test::hash_run(shared, frames), test::hash_run(test::model_of(other), frames));
}

TEST(SurfaceFeel, RefusesWhatMakesNoSense) {
  const auto refusal = [](const auto& change) {
    Scene scene = scene_with(make_plane(0.1, 2), {}, {0.5, 0.5});
    change(scene.objects[0]);
    Model model;
    return build_model(scene, {}, model).message();
  };
  const auto names = [](const std::string& message, const char* field) {
    return message.find("object \"object\"") != std::string::npos && message.find(field) != std::string::npos;
  };
  EXPECT_TRUE(names(refusal([](SceneObject& o) { o.surface.crease_angle = std::nan(""); }), "crease_angle"));
  EXPECT_TRUE(names(refusal([](SceneObject& o) { o.surface.crease_angle = -0.1; }), "crease_angle"));
  EXPECT_TRUE(names(refusal([](SceneObject& o) { o.surface.friction_factor = {1, 1}; }), "friction factors"));
  EXPECT_TRUE(
      names(refusal([](SceneObject& o) { o.surface.friction_factor.assign(8, -1); }), "friction factor"));
  EXPECT_TRUE(names(refusal([](SceneObject& o) {
                      o.surface.bumps = {{4, 4, {1}}, 0.01, 0, 1};
                    }),
                    "bumps.image"));
  EXPECT_TRUE(names(refusal([](SceneObject& o) {
                      o.surface.bumps = {{1, 1, {1}}, 0, 0, 1};
                    }),
                    "bumps.period"));
  EXPECT_TRUE(names(refusal([](SceneObject& o) {
                      o.surface.grip = {{1, 1, {1}}, 0.01, 0, 11};
                    }),
                    "grip.white"));
  EXPECT_TRUE(names(refusal([](SceneObject& o) {
                      o.material = {};
                      o.surface.friction_factor.assign(8, 2);
                    }),
                    "the friction is out of range: give more than 0"));
  EXPECT_EQ(refusal([](SceneObject& o) { o.surface.friction_factor.assign(8, 2); }), "");
}

}  // namespace
}  // namespace lumbrical
