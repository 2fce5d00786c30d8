// Symmetric quadrature over a triangle, weights positive and nodes inside: the three midpoints, Radon's seven
// points, and rules of higher degree: roots of the moment equations of symmetric polynomials, found by
// Levenberg-Marquardt from random nodes (degree 17: from more nodes, leaving out one orbit after another) and
// carried to forty digits by Newton's method.
#pragma once

#include <cstddef>

namespace lumbrical {

/// Three nodes, one towards each corner: centroid + at (corner - centroid).
struct CornerOrbit {
  double at, weight;
};
/// Six nodes, one for every two corners in either order: centroid + first (one - centroid) + second (other -
/// centroid).
struct PairOrbit {
  double first, second, weight;
};
/// Weights are those of one node, in units of the area. What is not set has no weight.
struct TriangleRule {
  int degree;     ///< polynomials up to which are integrated exactly
  double centre;  ///< weight of the centroid
  std::size_t corner_count, pair_count;
  CornerOrbit corner[6];
  PairOrbit pair[7];
};

// In ascending order of degree and of price: 3, 7, 16, 28, 42 and 60 points.
inline constexpr TriangleRule kTriangleRules[] = {
    {2, 0, 1, 0, {{-0.5, 1.0 / 3}}, {}},
    // (1 +- sqrt 15) / 7, (155 -+ sqrt 15) / 1200.
    {5,
     0.225,
     2,
     0,
     {{0.696140478029630983597, 0.12593918054482715260}, {-0.410426192315345269311, 0.13239415278850618074}},
     {}},
    {8,
     0.144315607677787168251,
     3,
     1,
     {{0.848358315048907073625, 0.0324584976231980803109},
      {0.488292076744719380133, 0.103217370534718250282},
      {-0.377877764878169468086, 0.0950916342672846247939}},
     {{0.465379563320766167819, -0.254718052224680508085, 0.0272303141744349942648}}},
    {11,
     0.0799782196685290490842,
     5,
     2,
     {{0.906101824924401903969, 0.0126223856537248945401},
      {0.653164926836215788908, 0.0406047572349964125404},
      {0.353445989212010170864, 0.0670844689653317480650},
      {-0.307182333958983214355, 0.0616409785129174048287},
      {-0.499832925673366299317, 0.0111442216328338339710}},
     {{0.661249736976584261922, -0.145804850096695331626, 0.0156047421021348758461},
      {0.318496511210685858807, -0.268639789551205526960, 0.0411838152865414690006}}},
    {14,
     0,
     6,
     4,
     {{0.941827116253896855465, 0.00492340360240008168183},
      {0.814600350727382196198, 0.0144336996697766676017},
      {0.468383402762369689130, 0.0421625887369930175382},
      {0.179567415073484020735, 0.0517741045072915863148},
      {-0.252934158021361767528, 0.0327883535441253506413},
      {-0.466891731086535916032, 0.0218835813694288906408}},
     {{0.760782673673214284116, -0.117706166764084820311, 0.00501022883850067176986},
      {0.598341866953640904214, -0.115141930417707639340, 0.0246657532125636739629},
      {0.388607285671830084388, -0.283725932080603343300, 0.0144363081135338404961},
      {0.233360831050338171754, -0.243945210439373176986, 0.0385715107870606832285}}},
    {17,
     0,
     6,
     7,
     {{0.950996692245276034268, 0.00346441567554308331662},
      {0.466422016043922740042, 0.0235662818220924827802},
      {0.142928333708323692633, 0.0375462619617752716435},
      {-0.249433855302585574068, 0.0283945664080620344886},
      {-0.392414125495505883521, 0.0244943923704799058751},
      {-0.478321184978613752256, 0.0114802064940499490882}},
     {{0.821289008104011081391, -0.0718960438631693042287, 0.00545614175799960741259},
      {0.778188397283026902801, -0.0281802419377196016797, 0.00742467081463426001057},
      {0.594298272988116126584, -0.180048867437833018092, 0.0100678479139924738602},
      {0.577793608336996105561, -0.0924245718532302919371, 0.0203797233483451470305},
      {0.313140742149219058014, -0.246286311359337645441, 0.0222685628427216846412},
      {0.310424103417441379789, -0.326955161584860874925, 0.00935531563916946207864},
      {0.256869495789900874360, -0.135558636129069787076, 0.0272413419838026680369}}},
};
inline constexpr std::size_t kTriangleRuleCount = sizeof kTriangleRules / sizeof kTriangleRules[0];

/// What a rule of that degree is off over a triangle by at most, in units of area times d t^(degree + 1) / (1
/// - t): see point_rules.h.
constexpr double remainder_of(int degree) {
  const int n = degree + 1;
  double middle = 1;  // |P_k(0)| of Legendre's polynomial, k the even one of n and n - 1
  for (int i = 1; i <= n / 2; ++i) middle *= (2 * i - 1) / (2.0 * i);
  return 2 * middle / (n - 1);
}
// No std::array: a kernel must not leave one of its functions behind (kernels_test.cpp).
struct Remainders {
  double of[kTriangleRuleCount];
};
inline constexpr Remainders kRemainders = [] {
  Remainders remainders{};
  for (std::size_t k = 0; k < kTriangleRuleCount; ++k)
    remainders.of[k] = remainder_of(kTriangleRules[k].degree);
  return remainders;
}();
// So that the power in the bound grows by t^3 from rule to rule.
static_assert([] {
  for (std::size_t k = 0; k < kTriangleRuleCount; ++k)
    if (kTriangleRules[k].degree + 1 != 3 * (static_cast<int>(k) + 1)) return false;
  return true;
}());

}  // namespace lumbrical
