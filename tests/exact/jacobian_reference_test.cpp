// Holds the contact's Jacobian against central differences of the definition: in 34 digits for some touches,
// in long double for many. LUMBRICAL_REFERENCE_PAIRS sets their number per shape; with it, the measured
// differences are printed.
#include "jacobian_reference.h"

#include <gtest/gtest.h>

#include <boost/multiprecision/cpp_bin_float.hpp>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "matrix6.h"
#include "random_touch.h"
#include "section/contact_jacobian.h"

namespace lumbrical {
namespace {

using test::TouchForm;

struct Differences {
  std::vector<double> sorted;
  int doubtful = 0;  // the reference does not agree with itself
  [[nodiscard]] double at(double share) const {
    return sorted[static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1))];
  }
};

template <class Real>
Matrix6 reference(const test::RandomTouch& touch, const Real& step, int nodes) {
  return test::reference_jacobian<Real>(touch.primitive, touch.joint, touch.corner, touch.contact.centroid,
                                        step, nodes);
}

// Differences to `measure`, of the touches where the reference agrees with itself: its rays don't like
// slivers and axes that graze the plane.
template <class Measure>
Differences compare(TouchForm form, int pairs, double doubt, std::uint64_t seed, Measure measure) {
  test::Random random(seed + static_cast<std::uint64_t>(form));
  Differences result;
  for (int i = 0; static_cast<int>(result.sorted.size()) < pairs && result.doubtful <= pairs; ++i) {
    const test::RandomTouch touch = test::random_touch(form, i % 3, random);
    const Matrix6 fine = reference<long double>(touch, 1e-7L, 25);
    if (!(test::difference(fine, reference<long double>(touch, 1e-7L, 15), touch.radius) < doubt)) {
      ++result.doubtful;
      continue;
    }
    Matrix6 ours{};
    EXPECT_TRUE(add_contact_jacobian(touch.primitive, touch.contact, touch.joint,
                                     {touch.corner[0], touch.corner[1], touch.corner[2]}, ours));
    result.sorted.push_back(test::difference(ours, measure(touch, fine), touch.radius));
  }
  std::sort(result.sorted.begin(), result.sorted.end());
  return result;
}

int pair_count(int otherwise) {
  const char* const pairs = std::getenv("LUMBRICAL_REFERENCE_PAIRS");
  return pairs == nullptr ? otherwise : std::max(3, std::atoi(pairs));
}

void report(const char* what, TouchForm form, const Differences& differences) {
  if (std::getenv("LUMBRICAL_REFERENCE_PAIRS") == nullptr) return;
  std::printf("%s, %s: median %.1e, 98 %% %.1e, worst %.1e of %zu, %d left out\n", what,
              test::kTouchFormNames[static_cast<int>(form)], differences.at(0.5), differences.at(0.98),
              differences.at(1), differences.sorted.size(), differences.doubtful);
}

class JacobianReference : public testing::TestWithParam<TouchForm> {};

TEST_P(JacobianReference, AgreesWithDifferencesInLongDouble) {
  const int pairs = pair_count(40);
  const Differences differences =
      compare(GetParam(), pairs, 1e-9, 71, [](const auto&, const Matrix6& fine) { return fine; });
  report("long double", GetParam(), differences);
  EXPECT_LT(differences.doubtful, 0.5 * pairs);
  // What differences of long doubles can see.
  EXPECT_LT(differences.at(0.5), 2e-11);
  EXPECT_LT(differences.at(1), 5e-9);
}

TEST_P(JacobianReference, AgreesWithDifferencesInThirtyFourDigits) {
  using Real = boost::multiprecision::cpp_bin_float_quad;
  const Differences differences = compare(
      GetParam(), (pair_count(40) + 19) / 20, 2e-11, 81,
      [](const test::RandomTouch& touch, const Matrix6&) { return reference<Real>(touch, 1e-11L, 25); });
  report("34 digits", GetParam(), differences);
  EXPECT_LT(differences.at(0.5), 1e-12);
  EXPECT_LT(differences.at(1), 1e-9);
}

INSTANTIATE_TEST_SUITE_P(Shapes, JacobianReference,
                         testing::Values(TouchForm::sphere, TouchForm::capsule, TouchForm::cone),
                         testing::PrintToStringParamName());

}  // namespace
}  // namespace lumbrical
