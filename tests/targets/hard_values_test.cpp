// The hard cases with their physical values: closed forms worked out by hand, or the brute-force reference of
// reference/contact.h. tests/hard_cases_test.cpp asks of more of them that they stay finite.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "contact_pairs.h"
#include "lumbrical/probe.h"
#include "lumbrical/shapes.h"
#include "scenes.h"

namespace lumbrical {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr Law kLaws[] = {Law::field, Law::column, Law::max_depth, Law::centroid, Law::point};

// Radius, height over the plane and radius of the section of a sphere: 5, 3, 4, all exact.
constexpr double kR = 5.0 / 1024, kH = 3.0 / 1024, kRho = 4.0 / 1024;
constexpr double kLong = 16.0 / 1024;  // [m] of phalanges

struct Seen {
  double area = 0, volume = 0, depth = 0;
  Vec3 force;
  std::size_t contacts = 0;
};

Seen see(const Mesh& mesh, const ProbePrimitive& primitive, Law law) {
  std::vector<ProbeContact> contacts;
  const Status status = probe(mesh, std::span(&primitive, 1), law, 1, contacts);
  EXPECT_TRUE(status.ok()) << status.message();
  Seen seen;
  for (const ProbeContact& contact : contacts) {
    EXPECT_TRUE(is_finite(contact.volume) && is_finite(contact.centre) && is_finite(contact.depth));
    seen.area += contact.area;
    seen.volume += contact.volume;
    seen.depth = std::max(seen.depth, contact.depth);
    seen.force += contact.force;
  }
  seen.contacts = contacts.size();
  return seen;
}

reference::Contact<long double> in_reference(const ProbePrimitive& primitive, Vec3 a, Vec3 b, Vec3 c) {
  return reference::contact<long double>(test::to_reference(primitive),
                                         test::to_reference(std::array<Vec3, 3>{a, b, c}));
}

Mesh triangle(Vec3 a, Vec3 b, Vec3 c) { return {{a, b, c}, {{0, 1, 2}}}; }
Mesh big_triangle(double size = 1) {
  return triangle({-size, -size, 0}, {3 * size, -size, 0}, {-size, 3 * size, 0});
}

ProbePrimitive sphere(double h = kH) { return {ProbeShape::sphere, {0, 0, h}, {}, kR, kR}; }
ProbePrimitive capsule(Vec3 from, Vec3 to, double r1 = kR, double r2 = kR) {
  return {ProbeShape::capsule, from, to, r1, r2};
}

// What a disc cuts out of a sphere whose centre is h (of either sign) over it.
double sphere_field(double r, double h) {
  const double a = std::fabs(h);
  return kPi * (r - a) * (r - a) * (r + 2 * a) / 3;
}

// Integral over |y| <= a of r - sqrt(h^2 + y^2), a^2 = r^2 - h^2: a lying cylinder, per length.
double lying_field(double r, double h) {
  const double a = std::sqrt((r - h) * (r + h));
  return a * r - h * h * std::asinh(a / h);
}

TEST(HardValue, SliversFeelTheFieldAlongTheirLength) {
  // Width w in the middle, none at the ends +-rho / 2: integral of phi(x, 0) w (1 - 2 |x| / rho).
  const double b = 0.5 * kRho, r = std::sqrt(kH * kH + b * b);
  const double root = 0.5 * (b * r + kH * kH * std::asinh(b / kH));  // of sqrt(h^2 + x^2), 0 to b
  const double first = (r * r * r - kH * kH * kH) / 3;               // of x sqrt(h^2 + x^2)
  const double per_width = 2 * (kR * b / 2 - (root - first / b));
  for (const double w : {1e-5, 1e-6, 1e-9, 1e-12}) {
    const Seen seen = see(triangle({-b, 0, 0}, {b, 0, 0}, {0, w, 0}), sphere(), Law::field);
    EXPECT_NEAR(seen.area / (b * w), 1, 1e-9) << w;
    EXPECT_NEAR(seen.volume / (w * per_width), 1, 1e-9 + w / kR) << w;  // it also reaches w / 3 aside
  }
}

TEST(HardValue, TrianglesOfAMicrometreFeelTheFieldWhereTheyAre) {
  for (const double size : {1e-5, 1e-6, 1e-8}) {
    for (const Vec3 at : {Vec3{0, 0, 0}, Vec3{0.002, -0.001, 0}, Vec3{kRho - 2e-5, 0, 0}}) {
      const Mesh mesh = triangle(at, at + Vec3{size, 0, 0}, at + Vec3{0, size, 0});
      const Vec3 centre = at + Vec3{size / 3, size / 3, 0};
      for (const ProbePrimitive& p : {sphere(), capsule({0, 0, kH}, {kLong, 0, 2 * kH})}) {
        const double phi = static_cast<double>(
            reference::field_at<long double>(test::to_reference(p), test::to_reference(centre)));
        const Seen seen = see(mesh, p, Law::field);
        const auto& v = mesh.vertices;  // as rounded
        EXPECT_NEAR(seen.area / (0.5 * norm(cross(v[1] - v[0], v[2] - v[0]))), 1, 1e-12);
        // The field bends by less than 1 / h: size^2 / (18 h) off at most.
        EXPECT_NEAR(seen.volume / seen.area, phi, size * size / (18 * kH) + 1e-9 * phi);
      }
    }
  }
}

TEST(HardValue, TrianglesOfAHundredMetresWithAnEdgeThroughTheSectionFeelHalf) {
  const double disc = kPi * kRho * kRho, half_width = std::sqrt((kR - kH) * (kR + kH));
  for (const double size : {1.0, 100.0, 10000.0}) {
    const Mesh half = triangle({-size, 0, 0}, {size, 0, 0}, {0, size, 0});
    const Seen ball = see(half, sphere(), Law::field);
    EXPECT_NEAR(ball.area / (disc / 2), 1, 1e-12) << size;
    EXPECT_NEAR(ball.volume / (sphere_field(kR, kH) / 2), 1, 1e-11) << size;
    const Seen lying = see(half, capsule({-kLong / 2, 0, kH}, {kLong / 2, 0, kH}), Law::field);
    EXPECT_NEAR(lying.area / (kLong * half_width + disc / 2), 1, 1e-12) << size;
    EXPECT_NEAR(lying.volume / ((kLong * lying_field(kR, kH) + sphere_field(kR, kH)) / 2), 1, 1e-11) << size;
  }
}

TEST(HardValue, TangencyOfALyingCapsuleDownToATrillionthOfItsRadius) {
  for (const double depth : {1e-3, 1e-6, 1e-9, 1e-12}) {
    const double height = 1 - depth, seen_depth = 1 - height;  // what the doubles leave of it
    const Seen seen = see(big_triangle(9), capsule({-1, 0, height}, {1, 0, height}, 1, 1), Law::field);
    const double half_width = std::sqrt(seen_depth * (2 - seen_depth)), disc = kPi * half_width * half_width;
    EXPECT_NEAR(seen.area / (4 * half_width + disc), 1, 1e-11) << depth;
    EXPECT_NEAR(seen.depth / seen_depth, 1, 1e-12) << depth;
    // 4/3 a d per length to first order in d; the field's slope adds d / 5 of that.
    const double volume = 2 * 4.0 / 3 * half_width * seen_depth + sphere_field(1, height);
    EXPECT_NEAR(seen.volume / volume, 1, 1e-9 + seen_depth) << depth;
  }
}

TEST(HardValue, AxesParallelAndPerpendicularToThePlaneToWithinATrillionth) {
  const double half_width = kRho, disc = kPi * kRho * kRho;
  const double cap = kPi * (kR - kH) * (kR - kH) * (2 * kR + kH) / 3;
  const double segment = kR * kR * std::acos(kH / kR) - kH * kRho;  // of the circle of a lying cylinder
  for (const double tilt : {0.0, 1e-15, -1e-15, 1e-13, 1e-12, -1e-12}) {
    const Vec3 along{std::cos(tilt), 0, std::sin(tilt)};
    const ProbePrimitive lying = capsule({0, 0, kH}, Vec3{0, 0, kH} + kLong * along);
    const Seen field = see(big_triangle(), lying, Law::field),
               column = see(big_triangle(), lying, Law::column);
    EXPECT_NEAR(field.area / (2 * half_width * kLong + disc), 1, 1e-11) << tilt;
    EXPECT_NEAR(field.volume / (kLong * lying_field(kR, kH) + sphere_field(kR, kH)), 1, 1e-11) << tilt;
    EXPECT_NEAR(column.volume / (kLong * segment + cap), 1, 1e-11) << tilt;
    EXPECT_NEAR(column.depth / (kR - kH), 1, 1e-11) << tilt;

    // Upright, the plane in the middle of the phalanx: a disc of the full radius.
    const Vec3 up{std::sin(tilt), 0, std::cos(tilt)}, low{0, 0, -kLong / 2};
    const ProbePrimitive upright = capsule(low, low + kLong * up);
    const Seen through = see(big_triangle(), upright, Law::field);
    EXPECT_NEAR(through.area / (kPi * kR * kR), 1, 1e-11) << tilt;
    EXPECT_NEAR(through.volume / (kPi * kR * kR * kR / 3), 1, 1e-11) << tilt;
    const double below = kPi * kR * kR * (kLong / 2 + 2 * kR / 3);
    EXPECT_NEAR(see(big_triangle(), upright, Law::column).volume / below, 1, 1e-9) << tilt;
  }
}

TEST(HardValue, EdgesThroughTheCentreVerticesOnTheBoundaryAndTangentEdges) {
  const double disc = kPi * kRho * kRho, volume = sphere_field(kR, kH), far = 1;
  struct Case {
    const char* name;
    Mesh mesh;
    double area, volume;  // volume 0: from the reference
  };
  const Vec3 centre{0, 0, 0};
  const Case cases[] = {
      {"edge through the centre", triangle({-far, 0, 0}, {far, 0, 0}, {0, far, 0}), disc / 2, volume / 2},
      {"vertex in the centre", triangle(centre, {far, 0, 0}, {0, far, 0}), disc / 4, volume / 4},
      {"inscribed", triangle({kRho, 0, 0}, {0, kRho, 0}, {-kRho, 0, 0}), kRho * kRho, 0},
      {"two tangent edges", triangle({-kRho, -kRho, 0}, {far, -kRho, 0}, {-kRho, far, 0}), disc, volume},
      {"beyond a tangent edge", triangle({kRho, -far, 0}, {far, 0, 0}, {kRho, far, 0}), 0, 0},
      {"touching with a vertex", triangle({kRho, 0, 0}, {far, -far, 0}, {far, far, 0}), 0, 0},
  };
  for (const Case& c : cases) {
    const Seen seen = see(c.mesh, sphere(), Law::field);
    EXPECT_NEAR(seen.area, c.area, 1e-12 * disc) << c.name;
    const auto& v = c.mesh.vertices;
    const double expected = c.volume > 0 ? c.volume
                            : c.area > 0
                                ? static_cast<double>(in_reference(sphere(), v[0], v[1], v[2]).field.amount)
                                : 0;
    EXPECT_NEAR(seen.volume, expected, 1e-12 * volume) << c.name;
  }
  // A whole turn of triangles round the centre, at any number of them and any start.
  for (const int count : {3, 4, 7, 60}) {
    Mesh fan{{centre}, {}};
    for (int i = 0; i < count; ++i) {
      const double angle = 2 * kPi * i / count;
      fan.vertices.push_back({0.1 * std::cos(angle), 0.1 * std::sin(angle), 0});
      const auto here = static_cast<std::uint32_t>(i + 1);
      fan.triangles.push_back({0, here, static_cast<std::uint32_t>((i + 1) % count + 1)});
    }
    const Seen seen = see(fan, sphere(), Law::field);
    EXPECT_NEAR(seen.area / disc, 1, 1e-13);
    EXPECT_NEAR(seen.volume / volume, 1, 1e-12);
  }
}

// A cylinder with flat ends that stands alone is a closed solid: at its very base it touches with the whole
// disc, the next double below it doesn't. (A capsule's force has no such jump.)
TEST(HardValue, ATriangleInTheBaseOfACylinderTouchesAllOfIt) {
  const double disc = kPi * kR * kR;
  const Mesh up = big_triangle(), down = triangle({-1, -1, 0}, {-1, 3, 0}, {3, -1, 0});
  for (const Mesh* const mesh : {&up, &down}) {
    const ProbePrimitive standing{ProbeShape::cylinder, {0, 0, 0}, {0, 0, kLong}, kR, kR};
    const Seen field = see(*mesh, standing, Law::field);
    EXPECT_NEAR(field.area / disc, 1, 1e-13);
    EXPECT_NEAR(field.volume / (disc * kR / 3), 1, 1e-11);
    ProbePrimitive above = standing;
    above.end1.z = 1e-18;
    above.end2.z = kLong + 1e-18;
    EXPECT_EQ(see(*mesh, above, Law::field).contacts, 0u);
  }
  // Along -n the way out of the solid is nothing for a floor, all of it for a ceiling.
  EXPECT_NEAR(see(up, {ProbeShape::cylinder, {0, 0, 0}, {0, 0, kLong}, kR, kR}, Law::column).volume, 0,
              1e-15 * disc);
  EXPECT_NEAR(see(down, {ProbeShape::cylinder, {0, 0, 0}, {0, 0, kLong}, kR, kR}, Law::column).volume /
                  (disc * kLong),
              1, 1e-12);
}

TEST(HardValue, OnceTheAxisHasPassedThePlaneTheFieldFallsAndTheColumnGrows) {
  for (const double h : {0.0, -1.0 / 1024, -kH, -0.999 * kR}) {
    const double disc = kPi * (kR - h) * (kR + h), below = std::fabs(h);
    const double cap = kPi * (kR - below) * (kR - below) * (2 * kR + below) / 3;
    EXPECT_NEAR(see(big_triangle(), sphere(h), Law::field).volume / sphere_field(kR, h), 1, 1e-11) << h;
    EXPECT_NEAR(see(big_triangle(), sphere(h), Law::column).volume / (cap + 2 * below * disc), 1, 1e-11) << h;
  }
  EXPECT_EQ(see(big_triangle(), sphere(-1.001 * kR), Law::field).contacts, 0u);
}

TEST(HardValue, AFingerWhollyInsideASolidTouchesNothing) {
  const Mesh box = make_box({0.1, 0.1, 0.1}, 6);
  for (const Law law : kLaws) {
    EXPECT_EQ(see(box, capsule({-0.01, 0, 0}, {0.01, 0.005, 0.001}), law).contacts, 0u) << law_name(law);
  }
}

TEST(HardValue, CoincidentTrianglesAddUpAndOppositeOnesCancel) {
  Mesh mesh = triangle({-0.02, -0.01, 0}, {0.015, -0.012, 0}, {0.001, 0.02, 0});
  for (const ProbePrimitive& p : {sphere(), capsule({0, 0, kH}, {kLong, 0, 2 * kH}, kR, 0.7 * kR)}) {
    for (const Law law : kLaws) {
      mesh.triangles = {{0, 1, 2}};
      const Vec3 once = see(mesh, p, law).force;
      EXPECT_GT(once.z, 0);
      mesh.triangles = {{0, 1, 2}, {0, 1, 2}, {1, 2, 0}};
      const Seen thrice = see(mesh, p, law);
      EXPECT_EQ(thrice.contacts, 3u);
      EXPECT_LT(norm(thrice.force - 3 * once), 1e-9 * once.z) << law_name(law);
      mesh.triangles = {{0, 1, 2}, {0, 2, 1}};
      // The field knows no side; the paper's depth is measured the other way for the other side.
      const Seen sheet = see(mesh, p, law);
      EXPECT_EQ(sheet.contacts, 2u);
      const bool sideless = law == Law::field;
      EXPECT_TRUE(!sideless || norm(sheet.force) < 1e-13 * once.z) << norm(sheet.force);
    }
  }
  const MeshReport report = inspect_mesh({mesh.vertices, {{0, 1, 2}, {0, 1, 2}, {1, 2, 0}}});
  EXPECT_EQ(report.duplicate, 2u);  // flagged before anything is felt
}

TEST(HardValue, ATJunctionChangesNothing) {
  const Vec3 a{-0.02, -0.01, 0}, b{0.02, -0.012, 0.004}, c{0.001, 0.02, -0.002};
  const Vec3 on_edge = 0.5 * (a + b);
  const Mesh whole = triangle(a, b, c), cut{{a, b, c, on_edge}, {{0, 3, 2}, {3, 1, 2}}};
  for (const ProbePrimitive& p : {sphere(), capsule({0, 0, kH}, {kLong, 0, 2 * kH}, kR, 0.7 * kR)}) {
    const Seen one = see(whole, p, Law::field), two = see(cut, p, Law::field);
    EXPECT_NEAR(two.volume / one.volume, 1, 1e-13);
    EXPECT_LT(norm(two.force - one.force), 1e-12 * norm(one.force));
  }
}

// A solid cone of `sides` triangles, its apex in the origin, pressed by a finger: by symmetry straight up,
// and by as much as the reference says.
TEST(HardValue, ApexOfAConeOfTheMesh) {
  for (const int sides : {4, 16, 64}) {
    Mesh cone{{{0, 0, 0}}, {}};
    for (int i = 0; i < sides; ++i) {
      const double angle = 2 * kPi * i / sides;
      cone.vertices.push_back({0.03 * std::cos(angle), 0.03 * std::sin(angle), -0.04});
      cone.triangles.push_back(
          {0, static_cast<std::uint32_t>(i + 1), static_cast<std::uint32_t>((i + 1) % sides + 1)});
    }
    for (const ProbePrimitive& p : {sphere(), capsule({0, 0, kH}, {0, 0, kH + kLong})}) {
      const Seen seen = see(cone, p, Law::field);
      EXPECT_EQ(seen.contacts, static_cast<std::size_t>(sides));
      double expected = 0;  // all sides are alike
      const auto& v = cone.vertices;
      const auto one = in_reference(p, v[0], v[1], v[2]);
      expected = sides * static_cast<double>(one.field.amount);
      EXPECT_NEAR(seen.volume / expected, 1, 1e-10) << sides;
      EXPECT_NEAR(seen.force.z / (expected * static_cast<double>(one.normal.z)), 1, 1e-10);
      EXPECT_LT(std::hypot(seen.force.x, seen.force.y), 1e-12 * seen.force.z);
    }
  }
}

// A rounded cone that ends in next to a point, which lies in the plane and below.
TEST(HardValue, ApexOfAConeOfTheFinger) {
  const double tip_radius = 1e-15;
  for (const double deep : {0.0, 1e-12, 1e-9, 1e-6, 0.001, 0.004}) {
    // Upright: a disc of radius deep tan(alpha), phi falls from its middle by cos(alpha) per length.
    const Vec3 tip{0.0005, 0.0003, -deep};
    const Seen seen = see(big_triangle(), capsule(tip + Vec3{0, 0, kLong}, tip, kR, tip_radius), Law::field);
    const double sine = (kR - tip_radius) / kLong, cosine = std::sqrt(1 - sine * sine);
    const double rho = (deep * sine + tip_radius) / cosine;
    // Of a section of a nanometre in a finger of millimetres an absolute accuracy is left: areas below 1e-13
    // R^2 are taken for rounding.
    EXPECT_NEAR(seen.area, kPi * rho * rho, 1e-13 * kR * kR) << deep;
    EXPECT_NEAR(seen.volume, kPi * rho * rho * rho * cosine / 3, 1e-14 * kR * kR * kR) << deep;
  }
  const Mesh plane = triangle({-0.01, -0.013, 0}, {0.012, -0.011, 0}, {0.002, 0.019, 0});
  const auto& v = plane.vertices;
  const Vec3 tip{0.0005, 0.0003, -0.001};
  const ProbePrimitive oblique = capsule(tip + kLong * Vec3{0.8, 0.36, 0.48}, tip, kR, 1e-9);
  const auto expected = in_reference(oblique, v[0], v[1], v[2]);
  const Seen seen = see(plane, oblique, Law::field);
  EXPECT_NEAR(seen.area, static_cast<double>(expected.area.amount), 1e-12 * kR * kR);
  EXPECT_NEAR(seen.volume, static_cast<double>(expected.field.amount), 1e-11 * kR * kR * kR);
}

TEST(HardValue, NumbersThatAreNotFiniteAreRefusedOrFlagged) {
  const double nan = std::numeric_limits<double>::quiet_NaN(), inf = std::numeric_limits<double>::infinity();
  for (const double bad : {nan, inf, -inf}) {
    std::vector<ProbeContact> contacts;
    const auto refuses = [&](const Mesh& mesh, const ProbePrimitive& p) {
      return !probe(mesh, std::span(&p, 1), Law::field, 1, contacts).ok();
    };
    EXPECT_TRUE(refuses(triangle({bad, 0, 0}, {1, 0, 0}, {0, 1, 0}), sphere()));
    EXPECT_TRUE(refuses(big_triangle(), sphere(bad)));
    EXPECT_TRUE(refuses(big_triangle(), capsule({0, 0, kH}, {0, bad, kH})));
    EXPECT_TRUE(refuses(big_triangle(), capsule({0, 0, kH}, {0, 0.01, kH}, bad, kR)));
    EXPECT_TRUE(refuses(big_triangle(), capsule({0, 0, kH}, {0, 0.01, kH}, kR, bad)));
    Scene scene;
    scene.settings.precision.fill(0);
    scene.hand = default_hand(Side::right);
    Model model;
    scene.objects = {{"plane", triangle({0, bad, 0}, {1, 0, 0}, {0, 1, 0})}};
    EXPECT_FALSE(build_model(scene, {}, model).ok());
    scene.objects = {{"plane", big_triangle()}};
    ASSERT_TRUE(build_model(scene, {}, model).ok());
    scene.hand.radius[kIndexTip] = bad;
    EXPECT_FALSE(build_model(scene, {}, model).ok());
    bench::Rig rig = bench::make_rig(big_triangle(), bench::one_phalanx(), Law::field);
    const bench::Felt base = bench::feel(rig, {{bad, 0, 0.006}, {}});
    EXPECT_EQ(base.flags & kInputNotFinite, std::uint32_t{kInputNotFinite});
    EXPECT_EQ(norm(base.force), 0);
    rig.frame.joint[kIndexTip].position[1] = static_cast<float>(bad);
    const bench::Felt joint = bench::feel(rig, {{0, 0, 0.006}, {}});
    EXPECT_EQ(joint.flags & kInputNotFinite, std::uint32_t{kInputNotFinite});
    EXPECT_EQ(norm(joint.force), 0);
  }
}

}  // namespace
}  // namespace lumbrical
