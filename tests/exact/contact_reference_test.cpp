// Holds the engine's contacts against the reference (reference/contact.h), on random pairs of primitive and
// triangle of every shape, size, depth and angle. LUMBRICAL_REFERENCE_PAIRS sets the number of pairs per
// shape; with it, the measured errors are printed.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "borders/pair_contact.h"
#include "contact_pairs.h"
#include "exact/round_pairs.h"
#include "exact/through_lanes.h"
#include "largest.h"
#include "lumbrical/probe.h"

namespace lumbrical {
namespace {

using test::Form, test::Pair, test::describe, test::from_reference, test::to_reference;

constexpr double kStiffness = 2e7;
constexpr double kPointArea = 1e-4;

ProbeContact ask_engine(const Pair& pair, Law law) {
  const Mesh mesh{{pair.corners.begin(), pair.corners.end()}, {{0, 1, 2}}};
  std::vector<ProbeContact> contacts;
  const Status status = probe(mesh, {&pair.primitive, 1}, law, kStiffness, contacts);
  EXPECT_TRUE(status.ok()) << status.message();
  EXPECT_LE(contacts.size(), 1u);
  return contacts.empty() ? ProbeContact{} : contacts[0];
}

// Errors by name, each with the pair of its worst.
class Errors {
 public:
  void add(const std::string& name, double error, const std::string& pair) {
    std::vector<double>& errors = errors_[name];
    // A NaN is the largest error there is.
    errors.push_back(std::isnan(error) ? HUGE_VAL : error);
    if (errors.size() == 1 || errors.back() > worst_[name].first) worst_[name] = {errors.back(), pair};
  }
  [[nodiscard]] bool has(const std::string& name) const { return errors_.contains(name); }
  double at(const std::string& name, double fraction) {
    std::vector<double>& errors = errors_[name];
    std::sort(errors.begin(), errors.end());
    return errors[static_cast<std::size_t>(fraction * static_cast<double>(errors.size() - 1))];
  }
  [[nodiscard]] const std::string& worst_pair(const std::string& name) const {
    return worst_.at(name).second;
  }
  void print(const char* form) {
    std::printf("%-9s %-28s %6s %9s %9s %9s %9s\n", form, "error", "pairs", "median", "98 %", "99.9 %",
                "worst");
    for (const auto& [name, errors] : errors_) {
      std::printf("%-9s %-28s %6zu %9.1e %9.1e %9.1e %9.1e\n", form, name.c_str(), errors.size(),
                  at(name, 0.5), at(name, 0.98), at(name, 0.999), at(name, 1));
    }
  }

 private:
  std::map<std::string, std::vector<double>> errors_;
  std::map<std::string, std::pair<double, std::string>> worst_;
};

// How far p is from the plane of the triangle, or outside one of its edges.
double distance_outside(const Pair& pair, Vec3 normal, Vec3 p) {
  double distance = std::fabs(dot(normal, p - pair.corners[0]));
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 from = pair.corners[i], edge = pair.corners[(i + 1) % 3] - from;
    distance = std::max(distance, dot(cross(edge, normal), p - from) / norm(edge));
  }
  return distance;
}

// Lengths over R, areas over R^2, volumes over R^3; centres weighted by what acts there, as torques feel
// them.
void compare(const Pair& pair, const reference::Contact<long double>& seen, Errors& errors) {
  const double r = pair.radius, r2 = r * r, r3 = r2 * r;
  const std::string text = describe(pair);
  const auto add = [&](const char* name, double error) { errors.add(name, std::fabs(error), text); };
  const auto share = [](const auto& load) {
    return load.amount > 0 ? static_cast<double>(load.error / load.amount) : 0;
  };
  add("reference area", share(seen.area));
  add("reference field", share(seen.field));
  add("reference column", share(seen.column));
  const double area = static_cast<double>(seen.area.amount), volume = static_cast<double>(seen.field.amount),
               column_volume = static_cast<double>(seen.column.amount),
               deepest = static_cast<double>(seen.deepest);
  const Vec3 normal = from_reference(seen.normal), centroid = from_reference(seen.area.centre);

  const ProbeContact field = ask_engine(pair, Law::field);
  add("area", (field.area - area) / r2);
  if (area > 1e-11 * r2) {
    add("normal", norm(field.normal - normal));
    add("centroid x area", norm(field.centroid - centroid) * area / r3);
  }
  add("field volume", (field.volume - volume) / r3);
  if (volume > 0) {
    add("field centre x volume", norm(field.centre - from_reference(seen.field.centre)) * volume / (r3 * r));
  }
  add("field force", norm(field.force - kStiffness * volume * normal) / (kStiffness * r3));
  if (!seen.touches || area < 1e-11 * r2) return;
  add("field relative", field.volume / volume - 1);

  const ProbeContact column = ask_engine(pair, Law::column);
  add("column volume", (column.volume - column_volume) / r3);
  add("column relative", column.volume / column_volume - 1);
  add("column centre x volume",
      norm(column.centre - from_reference(seen.column.centre)) * column_volume / (r3 * r));

  const ProbeContact max_depth = ask_engine(pair, Law::max_depth);
  add("depth", (max_depth.depth - deepest) / r);
  add("max-depth volume", (max_depth.volume - area * deepest) / r3);
  add("max-depth centre", norm(max_depth.centre - max_depth.centroid) / r);

  const ProbeContact at_centroid = ask_engine(pair, Law::centroid);
  add("centroid volume", (at_centroid.volume - area * static_cast<double>(seen.at_centroid)) / r3);

  const ProbeContact point = ask_engine(pair, Law::point);
  add("point volume", (point.volume / kPointArea - deepest) / r);
  // Several points may be deepest; the one named must be one of them, and of the triangle. A flat base ends
  // at a cliff that rounding may step over, hence the look a little way in.
  const Vec3 at = point.centre + 1e-7 * (centroid - point.centre);
  const long double depth_there = reference::depth_at<long double>(
      to_reference(pair.primitive), to_reference(normal), test::to_reference(at));
  add("point not deepest", test::largest(0, deepest - static_cast<double>(depth_there)) / r);
  add("point off the triangle", distance_outside(pair, normal, point.centre) / r);
}

struct Bound {
  const char* name;
  double most, worst;  // of 98 % of the pairs, of all
};

void expect_within(Errors& errors, const std::vector<Bound>& bounds) {
  for (const Bound& bound : bounds) {
    if (!errors.has(bound.name)) {
      ADD_FAILURE() << "nothing measured for " << bound.name;
      continue;
    }
    EXPECT_LE(errors.at(bound.name, 0.98), bound.most) << bound.name << ", 98 % of the pairs";
    EXPECT_LE(errors.at(bound.name, 1), bound.worst)
        << bound.name << ", worst: " << errors.worst_pair(bound.name);
  }
}

class ContactAgainstReference : public testing::TestWithParam<Form> {};

TEST_P(ContactAgainstReference, AgreesOnRandomPairs) {
  const char* asked = std::getenv("LUMBRICAL_REFERENCE_PAIRS");
  const int pair_count = asked != nullptr ? std::atoi(asked) : 100;
  test::Random random(2024 + static_cast<std::uint64_t>(GetParam()));
  Errors errors;
  for (int touching = 0; touching < pair_count;) {
    const Pair pair = test::random_pair(GetParam(), random);
    const reference::Contact<long double> seen = test::ask_reference(pair);
    compare(pair, seen, errors);
    if (seen.touches) ++touching;
  }
  if (asked != nullptr) errors.print(test::kFormNames[static_cast<int>(GetParam())]);
  expect_within(errors, {{"reference area", 1e-14, 1e-13},
                         {"reference field", 1e-14, 1e-13},
                         {"reference column", 1e-14, 1e-13},
                         {"area", 1e-13, 1e-12},
                         {"normal", 1e-14, 1e-12},
                         {"centroid x area", 1e-13, 1e-12},
                         {"field volume", 1e-11, 1e-8},
                         {"field force", 1e-11, 1e-8},
                         {"field centre x volume", 1e-11, 1e-8},
                         {"field relative", 1e-8, 1e-5},
                         {"column volume", 1e-11, 1e-8},
                         {"column centre x volume", 1e-11, 1e-8},
                         {"depth", 1e-13, 1e-12},
                         {"point volume", 1e-13, 1e-12},
                         {"point not deepest", 1e-6, 1e-6},
                         {"point off the triangle", 1e-12, 1e-10},
                         {"max-depth volume", 1e-12, 1e-11},
                         {"max-depth centre", 1e-14, 1e-14},
                         {"centroid volume", 1e-12, 1e-11}});
}

// The deepest point of this contact lies next to the base, which is all but upright: where the depth falls
// off a cliff.
TEST(Contact, DepthOfANearlyLyingCylinderDoesNotJumpWithTheLastDigitOfItsTilt) {
  Pair pair;
  pair.primitive = {ProbeShape::cylinder,
                    {0, 0, 0.00474955264278204},
                    {0.0044360322994343154, -0.0008491605256931218, 0},
                    0.009596143673306072,
                    0.009596143673306072};
  pair.corners = {Vec3{-0.0028988010330932672, -0.0054760419451611985, 0},
                  {0.0015376466630020477, -0.0099201023325784336, 0},
                  {0.0037672743372176853, -0.0076424876386621404, 0}};
  const double r = pair.primitive.radius1;
  for (const double tilt : {0.0, 1e-16, 1.2e-15, -1.2e-15, 1e-13, 1e-11, 1e-9, 1e-7, 1e-5}) {
    pair.primitive.end2.z = pair.primitive.end1.z + tilt;
    const double expected = static_cast<double>(test::ask_reference(pair).deepest);
    EXPECT_NEAR(ask_engine(pair, Law::max_depth).depth, expected, 1e-12 * r) << tilt;
  }
}

// Phalanges share out space with half-spaces that cut the contacted area, not the depth below it.
TEST_P(ContactAgainstReference, AgreesWhereHalfSpacesCut) {
  test::Random random(77 + static_cast<std::uint64_t>(GetParam()));
  int cut_through = 0;
  for (int i = 0; i < 100; ++i) {
    const Pair pair = test::random_pair(GetParam(), random);
    reference::Solid solid = to_reference(pair.primitive);
    const double whole = static_cast<double>(test::ask_reference(pair).area.amount);
    Primitive primitive;
    primitive.shape = solid.flat ? Shape::flat : Shape::round;
    primitive.end1 = pair.primitive.end1;
    primitive.end2 = GetParam() == Form::sphere ? primitive.end1 : pair.primitive.end2;
    primitive.radius1 = solid.radius1, primitive.radius2 = solid.radius2;
    for (int k = 0; k < 1 + i % 3; ++k) {
      const Vec3 middle = (1.0 / 3) * (pair.corners[0] + pair.corners[1] + pair.corners[2]);
      const HalfSpace cut{random.direction(), middle + 0.1 * (pair.corners[1] - pair.corners[0])};
      primitive.cut[primitive.cut_count++] = cut;
      solid.cuts.push_back({to_reference(cut.normal), to_reference(cut.point)});
    }
    const auto expected = reference::contact<long double>(solid, to_reference(pair.corners));
    if (expected.area.amount > 0 && expected.area.amount < 0.999L * whole) ++cut_through;
    const double r = pair.radius;
    for (const Law law : {Law::field, Law::column}) {
      SCOPED_TRACE(describe(pair));
      const auto& load = law == Law::field ? expected.field : expected.column;
      primitive.law = law;
      Contact contact;
      const bool touches =
          collide(primitive, {kPointArea}, {pair.corners[0], pair.corners[1], pair.corners[2]}, contact);
      if (!touches) contact = {};
      EXPECT_NEAR(contact.area, static_cast<double>(expected.area.amount), 1e-12 * r * r);
      const double bound = law == Law::field ? 1e-9 : GetParam() == Form::cone ? 1e-2 : 1e-6;
      EXPECT_NEAR(contact.volume, static_cast<double>(load.amount), bound * r * r * r);
      if (expected.area.amount < 1e-11L * r * r) continue;
      EXPECT_NEAR(contact.depth, static_cast<double>(expected.deepest), 1e-12 * r);
      EXPECT_LT(norm(contact.centre - from_reference(load.centre)) * contact.volume, bound * r * r * r * r);
    }
  }
  EXPECT_GT(cut_through, 10);
}

// A cone, and a triangle whose plane passes by the centre of an end; every other one next to it, or nearly
// along the axis.
Pair pair_by_an_end(test::Random& random) {
  Pair pair;
  ProbePrimitive& cone = pair.primitive;
  cone.shape = ProbeShape::capsule;
  pair.radius = cone.radius1 = 0.008;
  const double length = random.between(0.5, 4) * pair.radius;
  cone.radius2 = max(0.001, pair.radius - random.between(0.02, 0.35) * length);
  const Vec3 axis = random.direction(), raw = random.direction();
  cone.end1 = random.in_box(0.1);
  cone.end2 = cone.end1 + length * axis;
  const Vec3 leaning = random.bits() % 2 == 0 ? raw : raw - 0.95 * dot(raw, axis) * axis;
  const Vec3 n = leaning / norm(leaning), across = cross(n, random.direction());
  const Vec3 u = across / norm(across), v = cross(n, u);
  const double sign = random.bits() % 2 == 0 ? 1 : -1;
  const double off = random.bits() % 2 == 0 ? random.between(0, 1) : test::power_of_ten(random, -5, -0.5);
  const Vec3 foot = (random.bits() % 2 == 0 ? cone.end1 : cone.end2) + sign * off * pair.radius * n;
  const Vec3 middle = foot + pair.radius * (random.between(-1, 1) * u + random.between(-1, 1) * v);
  const double size = pair.radius * test::power_of_ten(random, -1.3, 0.7), first = random.between(0, 6);
  for (const double turn : {0.0, random.between(0.3, 2.9), random.between(3.3, 6)}) {
    const auto k = static_cast<std::size_t>(turn == 0 ? 0 : turn < 3 ? 1 : 2);
    pair.corners[k] =
        middle + size * random.between(0.3, 1) * (std::cos(first + turn) * u + std::sin(first + turn) * v);
  }
  return pair;
}

// The slivers' kernel by itself: of the polygons that may reach into one, how many it leaves, and to how many
// digits the rest are.
TEST(ConeSlivers, NextToTheAxisAgreeWithTheReference) {
  test::Random random(31);
  const ExactKernels& kernels = exact_kernels(Isa::scalar);
  const auto terms = std::make_unique<RoundTerms>();
  int added = 0, moved = 0, left = 0;
  for (int i = 0; i < 2000; ++i) {
    const Pair pair = pair_by_an_end(random);
    Primitive cone;
    cone.law = Law::field;
    cone.end1 = pair.primitive.end1, cone.end2 = pair.primitive.end2;
    cone.radius1 = pair.primitive.radius1, cone.radius2 = pair.primitive.radius2;
    Contact contact;
    const RoundHull hull = round_hull(cone);
    const Corners at = seen_from(hull.origin, Corners{pair.corners[0], pair.corners[1], pair.corners[2]});
    set_kind(kind_of(kernels, hull, at), 0, *terms);
    const auto through = [&](void (*kernel)(RoundTerms&)) {
      const auto gather = [&](const Corners& corners, std::size_t k, RoundTerms& to) {
        put_pair(hull, corners, {}, k, to);
      };
      double status = kNoContact;
      through_lanes(std::span(&at, 1), *terms, kernel, gather,
                    [&](const Corners&, std::size_t k, const RoundTerms& from) { status = from.status[k]; });
      return status;
    };
    if (through(kernels.round_contacts) != kSlivers) continue;
    read_contact(*terms, 0, hull.origin, contact);
    const double r3 = pair.radius * pair.radius * pair.radius, before = contact.volume;
    terms->patient = true;
    if (through(kernels.cone_slivers) != kContact) {
      ++left;
      continue;
    }
    add_sliver(*terms, 0, hull.origin, contact);
    ++added;
    if (std::fabs(contact.volume - before) > 1e-9 * r3) ++moved;
    SCOPED_TRACE(describe(pair));
    const auto expected = reference::contact<long double>(to_reference(pair.primitive),
                                                          to_reference(pair.corners), {true, false, false})
                              .field;
    EXPECT_NEAR(contact.volume, static_cast<double>(expected.amount), 5e-12 * r3);
    EXPECT_LT(norm(contact.centre - from_reference(expected.centre)) * contact.volume,
              2e-11 * r3 * pair.radius);
  }
  EXPECT_GT(added, 400);
  EXPECT_GT(moved, 300);
  EXPECT_LT(left, 50);
}

INSTANTIATE_TEST_SUITE_P(Forms, ContactAgainstReference,
                         testing::Values(Form::sphere, Form::cylinder, Form::capsule, Form::cone),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace lumbrical
