// Quadrature over triangles: what the rules integrate exactly, and the bound of what they leave of a
// distance.
#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <vector>

#include "borders/pair_contact.h"
#include "contact_pairs.h"
#include "largest.h"
#include "random.h"

#define LUMBRICAL_ISA scalar
#include "exact/point_rules.h"

namespace lumbrical::test {
namespace {

struct Node {
  double at[3], weight;  // barycentric
};

std::vector<Node> nodes_of(const TriangleRule& rule) {
  const double third = 1.0 / 3;
  std::vector<Node> nodes;
  if (rule.centre != 0) nodes.push_back({{third, third, third}, rule.centre});
  for (std::size_t k = 0; k < rule.corner_count; ++k) {
    for (int i = 0; i < 3; ++i) {
      const double at = rule.corner[k].at, rest = (1 - at) / 3;
      Node node{{rest, rest, rest}, rule.corner[k].weight};
      node.at[i] += at;
      nodes.push_back(node);
    }
  }
  for (std::size_t k = 0; k < rule.pair_count; ++k) {
    for (int i = 0; i < 3; ++i) {
      for (int j = 0; j < 3; ++j) {
        if (i == j) continue;
        const double rest = (1 - rule.pair[k].first - rule.pair[k].second) / 3;
        Node node{{rest, rest, rest}, rule.pair[k].weight};
        node.at[i] += rule.pair[k].first;
        node.at[j] += rule.pair[k].second;
        nodes.push_back(node);
      }
    }
  }
  return nodes;
}

double factorial(int n) { return n < 2 ? 1 : n * factorial(n - 1); }

// The largest error of the mean of a^i b^j over the triangle, i + j = degree.
double monomial_error(const TriangleRule& rule, int degree) {
  double worst = 0;
  for (int i = 0; i <= degree; ++i) {
    const double exact = 2 * factorial(i) * factorial(degree - i) / factorial(degree + 2);
    double sum = 0;
    for (const Node& node : nodes_of(rule))
      sum += node.weight * std::pow(node.at[0], i) * std::pow(node.at[1], degree - i);
    worst = largest(worst, std::fabs(sum - exact));
  }
  return worst;
}

TEST(PointRules, IntegrateEveryMonomialUpToTheirDegreeAndNoFurther) {
  const std::size_t points[] = {3, 7, 16, 28, 42, 60};
  for (std::size_t k = 0; k < kTriangleRuleCount; ++k) {
    const TriangleRule& rule = kTriangleRules[k];
    EXPECT_EQ(nodes_of(rule).size(), points[k]);
    for (int degree = 0; degree <= rule.degree; ++degree)
      EXPECT_LT(monomial_error(rule, degree), 1e-15) << "rule " << k << ", degree " << degree;
    EXPECT_GT(monomial_error(rule, rule.degree + 1), 1e-12) << "rule " << k;
  }
}

TEST(PointRules, HavePositiveWeightsAndNodesInside) {
  for (const TriangleRule& rule : kTriangleRules) {
    for (const Node& node : nodes_of(rule)) {
      EXPECT_GT(node.weight, 0);
      for (const double at : node.at) EXPECT_GE(at, 0);
    }
  }
}

// Terms of the distance's expansion, f_n = (P_(n - 2) - P_n) / (2n - 1).
TEST(PointRules, BoundEveryTermOfTheExpansionTheyLeave) {
  for (const TriangleRule& rule : kTriangleRules) {
    double largest = 0;
    for (double z = -1; z <= 1; z += 1e-3) {
      std::vector<double> p = {1, z};
      for (int n = 2; n <= rule.degree + 40; ++n) {
        const auto at = static_cast<std::size_t>(n);
        p.push_back(((2 * n - 1) * z * p[at - 1] - (n - 1) * p[at - 2]) / n);
        if (n > rule.degree) largest = std::max(largest, std::fabs(p[at - 2] - p[at]) / (2 * n - 1));
      }
    }
    EXPECT_LE(2 * largest, remainder_of(rule.degree));
    EXPECT_GT(2 * largest, 0.7 * remainder_of(rule.degree));
  }
}

// A triangle about its centroid, the centroid from the foot of a distance, and the height over the plane.
struct Distances {
  scalar::Wide2<double> corner[3], foot;
  double height, reach, distance;
};

Distances random_distances(Random& random) {
  Distances d{};
  const double turn = random.between(0, 7), tilt = random.between(0, 7);
  d.foot = {std::cos(tilt) * std::cos(turn), std::cos(tilt) * std::sin(turn)};
  d.height = std::sin(tilt);
  const double size = std::pow(10.0, random.between(-3, -0.1));
  for (auto& corner : d.corner) corner = {random.between(-1, 1), random.between(-1, 1)};
  const auto middle = (1.0 / 3) * (d.corner[0] + d.corner[1] + d.corner[2]);
  for (auto& corner : d.corner) {
    corner = size * (corner - middle);
    d.reach = std::max(d.reach, std::sqrt(dot(corner, corner)));
  }
  d.distance = std::sqrt(dot(d.foot, d.foot) + d.height * d.height);
  return d;
}

// The mean of the distance over the triangle, and its moments by corner, by many nodes in long double on the
// sixteen parts that halving every edge twice makes.
struct LongMean {
  long double mean = 0, x = 0, y = 0;
};
LongMean long_mean(const Distances& d) {
  using Gauss = boost::math::quadrature::gauss<long double, 20>;
  struct Place {
    long double x, y;
  };
  LongMean sum;
  const auto place = [&](long double a, long double b) {
    const auto at = [&](double p, double q, double r) { return r + a * (p - r) + b * (q - r); };
    return Place{at(d.corner[0].x, d.corner[1].x, d.corner[2].x),
                 at(d.corner[0].y, d.corner[1].y, d.corner[2].y)};
  };
  const auto each = [&](auto&& f) {
    for (std::size_t k = 0; k < Gauss::abscissa().size(); ++k) {
      const long double x = Gauss::abscissa()[k], w = Gauss::weights()[k] / 2;
      f((1 - x) / 2, w);
      f((1 + x) / 2, w);
    }
  };
  const auto add = [&](long double a, long double b, long double side) {
    each([&](long double u, long double weight_u) {
      each([&](long double v, long double weight_v) {
        const Place p = place(a + side * u, b + side * (1 - u) * v);
        const long double ex = d.foot.x + p.x, ey = d.foot.y + p.y;
        const long double w = std::sqrt(ex * ex + ey * ey + static_cast<long double>(d.height) * d.height);
        const long double share = 2 * weight_u * weight_v * (1 - u) * (side * side) * w;
        sum.mean += share;
        sum.x += share * p.x;
        sum.y += share * p.y;
      });
    });
  };
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; i + j < 4; ++j) {
      add(i / 4.0L, j / 4.0L, 0.25L);
      if (i + j < 3) add((i + 1) / 4.0L, (j + 1) / 4.0L, -0.25L);
    }
  }
  return sum;
}

TEST(PointRules, LeaveNoMoreOfADistanceThanTheirBound) {
  Random random(7);
  int near[kTriangleRuleCount] = {};  // triangles on which a rule leaves much of its bound
  for (int i = 0; i < 300; ++i) {
    const Distances d = random_distances(random);
    const double t = d.reach / d.distance;
    if (t > 0.8) continue;
    const LongMean exact = long_mean(d);
    const scalar::FieldAbout<double> about{0, 0, d.height * d.height, {1, 1}, d.foot, d.distance, 1};
    for (std::size_t k = 0; k < kTriangleRuleCount; ++k) {
      scalar::RuleChoice<double> rules{};
      rules.takes[k] = true;
      rules.taken[rules.taken_count++] = k;
      const scalar::MeanField<double> got = scalar::mean_field(about, d.corner, rules);
      const int degree = kTriangleRules[k].degree;
      const double bound = remainder_of(degree) * d.distance * std::pow(t, degree + 1) / (1 - t);
      const double off = std::fabs(static_cast<double>(-got.mean - exact.mean));
      EXPECT_LE(off, bound + 4e-16) << "rule " << k << ", ratio " << t;
      near[k] += off > 0.01 * bound ? 1 : 0;
      // Moments have a degree less, and a lever.
      const double lesser = remainder_of(degree - 1) * d.distance * std::pow(t, degree) / (1 - t) * d.reach;
      double x = 0, y = 0;
      for (int corner = 0; corner < 3; ++corner) {
        x -= got.corner[corner] * d.corner[corner].x;
        y -= got.corner[corner] * d.corner[corner].y;
      }
      EXPECT_LE(std::fabs(static_cast<double>(x - exact.x)), lesser + 4e-16 * d.reach) << "rule " << k;
      EXPECT_LE(std::fabs(static_cast<double>(y - exact.y)), lesser + 4e-16 * d.reach) << "rule " << k;
    }
  }
  for (std::size_t k = 0; k < kTriangleRuleCount; ++k) EXPECT_GT(near[k], 5) << "rule " << k;
}

// Sizes of 1e-4 to 1 R, so that rules and the closed form have their share.
TEST(PointRules, OfTrianglesWhollyInsideStateErrorsThatHold) {
  Random random(9);
  int inside = 0, by_rules = 0, usual = 0;
  for (int i = 0; i < 600; ++i) {
    Primitive p;
    p.law = Law::field;
    p.radius1 = 0.008;
    p.radius2 = i % 3 == 2 ? random.between(0.6, 1) * 0.008 : 0.008;
    p.end1 = random.in_box(0.1);
    p.end2 = p.end1 + (i % 3 == 0 ? 0 : random.between(0.5, 4) * 0.008) * random.direction();
    const double size = 0.008 * std::pow(10.0, random.between(-4, 0));
    const Vec3 on_axis = p.end1 + random.between(0, 1) * (p.end2 - p.end1);
    const Vec3 near = on_axis + random.between(0, 1) * 0.008 * random.direction();
    const std::array<Vec3, 3> corner = {near + size * random.direction(), near + size * random.direction(),
                                        near + size * random.direction()};
    const reference::Solid solid{false, to_reference(p.end1), to_reference(p.end2), p.radius1, p.radius2};
    const auto wanted = reference::contact<long double>(solid, to_reference(corner));
    const double area = norm(cross(corner[1] - corner[0], corner[2] - corner[0])) / 2;
    if (wanted.area.amount < 0.999999 * area) continue;
    ++inside;
    const ContactQuery query{1e-4, nullptr, exact_kernels(Isa::scalar)};
    Contact contact;
    ASSERT_TRUE(collide(p, query, {corner[0], corner[1], corner[2]}, contact));
    const double off = std::fabs(static_cast<double>(contact.volume - wanted.field.amount));
    const auto most = [&](double share) { return most_stated(share, p.radius1, p.end1, corner, area); };
    EXPECT_LE(off, contact.error) << "pair " << i << ", size " << size / 0.008 << ", area " << area;
    EXPECT_LE(contact.error, most(kMostStated)) << "pair " << i;
    usual += contact.error <= most(kMostOfDiscs) ? 1 : 0;
    by_rules += contact.error <= 1e-14 * size * 0.008 * 0.008 ? 1 : 0;  // what rounding leaves
  }
  EXPECT_GT(inside, 300);
  EXPECT_GT(usual, 0.98 * inside);
  EXPECT_GT(by_rules, 0.5 * inside);
}

}  // namespace
}  // namespace lumbrical::test
