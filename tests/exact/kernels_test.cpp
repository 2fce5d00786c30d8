// The SIMD kernels as such: what they discard has no contact, and their object files keep to themselves.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <regex>
#include <string>

#include "borders/pair_contact.h"
#include "exact/exact_kernels.h"
#include "random.h"

namespace lumbrical::test {
namespace {

void set_corner(double (&corner)[3][MissTerms::kCapacity], std::size_t k, Vec3 p) {
  corner[0][k] = p.x;
  corner[1][k] = p.y;
  corner[2][k] = p.z;
}

// Triangles whose nearest corner, edge or plane is about R away from the axis, where verdicts are hardest.
TEST(Kernels, WhatTheyCallACertainMissHasNoContact) {
  Random random(5);
  int misses = 0, touches = 0;
  for (int round = 0; round < 300; ++round) {
    Primitive p;
    p.law = Law::max_depth;  // the general way, which shares nothing with the kernels
    p.radius1 = 0.008;
    p.radius2 = random.between(0.6, 1) * 0.008;
    p.end1 = random.in_box(round % 3 == 0 ? 100 : 0.1);
    p.end2 = p.end1 + random.between(0, 0.03) * random.direction();
    MissTerms terms;
    terms.count = MissTerms::kCapacity;
    terms.end1 = p.end1;
    terms.length = norm(p.end2 - p.end1);
    terms.axis = terms.length > 0 ? (p.end2 - p.end1) / terms.length : Vec3{};
    terms.radius1 = p.radius1;
    terms.radius2 = p.radius2;
    terms.most = max(p.radius1, p.radius2);
    std::array<std::array<Vec3, 3>, MissTerms::kCapacity> corners;
    for (std::size_t k = 0; k < terms.count; ++k) {
      const Vec3 out = random.direction();
      const Vec3 at =
          p.end1 + random.between(0, 1) * (p.end2 - p.end1) + random.between(0.9, 1.02) * 0.008 * out;
      const double size = 0.008 * std::pow(10.0, random.between(-2, 2));
      for (Vec3& corner : corners[k]) {
        const Vec3 away = random.direction();
        corner = at + size * (random.between(0, 1) < 0.8 ? away - min(0, dot(away, out)) * out : away);
      }
      set_corner(terms.a, k, corners[k][0]);
      set_corner(terms.b, k, corners[k][1]);
      set_corner(terms.c, k, corners[k][2]);
    }
    exact_kernels(Isa::scalar).certain_misses(terms);
    for (std::size_t k = 0; k < terms.count; ++k) {
      Contact contact;
      const bool touching = collide(p, {}, {corners[k][0], corners[k][1], corners[k][2]}, contact);
      touches += touching ? 1 : 0;
      if (terms.miss[k] == 0) continue;
      ++misses;
      EXPECT_TRUE(!touching || contact.area < 1e-13 * 0.008 * 0.008) << contact.area;
    }
  }
  EXPECT_GT(misses, 2000);
  EXPECT_GT(touches, 2000);
}

// A weak symbol of an object compiled for AVX may become the copy the linker keeps for the whole program,
// which then needs AVX everywhere.
TEST(Kernels, LeaveNoFunctionBehindThatOthersCouldPickUp) {
  const std::string command =
      std::string("nm -A --defined-only '") + LUMBRICAL_CORE_ARCHIVE + "' 2>/dev/null";
  const std::unique_ptr<FILE, int (*)(FILE*)> pipe(popen(command.c_str(), "r"), pclose);
  ASSERT_NE(pipe, nullptr);
  // A symbol that carries its instruction set in its name is nobody else's.
  const std::regex own("[^0-9](6scalar|4sse2|4avx2|6avx512|4neon|5xsimd)");
  int exact_symbols = 0, sample_symbols = 0;
  char line[4096];
  while (std::fgets(line, sizeof line, pipe.get()) != nullptr) {
    const std::string text = line;
    const bool of_exact = text.find("exact_kernels_") != std::string::npos;
    const bool of_samples = text.find("samples_kernels_") != std::string::npos;
    exact_symbols += of_exact ? 1 : 0;
    sample_symbols += of_samples ? 1 : 0;
    // The samples' scalar kernels are compiled as everything else is, and may share functions with it.
    if ((!of_exact && !of_samples) || text.find("samples_kernels_scalar") != std::string::npos) continue;
    const bool weak = text.find(" W ") != std::string::npos;  // functions; constants do no harm
    EXPECT_TRUE(!weak || std::regex_search(text, own)) << text;
  }
  EXPECT_GT(exact_symbols, 0);
  EXPECT_GT(sample_symbols, 0);
}

}  // namespace
}  // namespace lumbrical::test
