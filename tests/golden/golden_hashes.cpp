// Runs the golden sessions in every way this machine can and holds the bits against golden_hashes.h; needs
// nothing but the core, so that it can be cross-built and run under an emulator.
//
//   golden_hashes            checks a selection of the ways to run; exit code 1 where any bit differs
//   golden_hashes all        checks all of them
//   golden_hashes widest     checks the widest instruction set only (under an emulator or sanitizer)
//   golden_hashes print      prints golden_hashes.h, regenerated
#include <cmath>
#include <cstdio>
#include <cstring>
#include <string>
#include <vector>

#include "golden_sessions.h"
#include "random.h"
#include "simd/wide.h"

namespace lumbrical::test {
namespace {

constexpr Isa kIsas[] = {Isa::scalar, Isa::sse2, Isa::avx2, Isa::avx512, Isa::neon, Isa::simd128};
constexpr Broadphase kBroadphases[] = {Broadphase::tree, Broadphase::grid, Broadphase::brute};
constexpr std::uint32_t kThreads[] = {1, 2, 4, 8};

std::string name_of(const Execution& execution) {
  return std::string(isa_name(execution.isa)) + ", " + std::string(broadphase_name(execution.broadphase)) +
         ", " + std::to_string(execution.threads) + " threads";
}

/// Every instruction set; the other choices take turns from one to the next, unless all are wanted.
std::vector<Execution> ways_to_run(const std::string& which) {
  const bool all = which == "all";
  std::vector<Execution> ways;
  std::size_t turn = 0;
  for (const Isa isa : kIsas) {
    if (!available(isa) || (which == "widest" && isa != widest_isa())) continue;
    for (std::size_t b = 0; b < std::size(kBroadphases); ++b) {
      for (std::size_t t = 0; t < std::size(kThreads); ++t) {
        if (!all && (t != turn % std::size(kThreads) || b != turn % std::size(kBroadphases))) continue;
        Execution way;
        way.isa = isa;
        way.broadphase = kBroadphases[b];
        way.threads = kThreads[t];
        ways.push_back(way);
      }
    }
    ++turn;
  }
  return ways;
}

int mistakes = 0;

void expect(const std::string& what, const std::string& way, std::uint64_t expected, std::uint64_t hash) {
  if (hash == expected) return;
  ++mistakes;
  std::printf("%s (%s): 0x%016llx instead of 0x%016llx\n", what.c_str(), way.c_str(),
              static_cast<unsigned long long>(hash), static_cast<unsigned long long>(expected));
}

template <class T>
bool same_bits(T a, T b) {
  return std::memcmp(&a, &b, sizeof(T)) == 0;
}

template <class T>
T any_number(Random& random) {
  const std::uint64_t bits = random.bits();
  if (bits % 16 == 0) return static_cast<T>(bits % 3 == 0 ? -0.0 : 0.0);
  if (bits % 2 == 0) return static_cast<T>(random.between(-3, 3));
  std::conditional_t<sizeof(T) == 4, std::uint32_t, std::uint64_t> pattern{};
  std::memcpy(&pattern, &bits, sizeof pattern);
  T value;
  std::memcpy(&value, &pattern, sizeof value);
  return std::isfinite(value) ? value : T(1);
}

/// The words of wide.h on the lanes that this program is compiled for against the same words on one number,
/// on ordinary, tiny (denormal) and huge ones.
template <class V>
void check_words(const char* name) {
  using T = typename wide::Lanes<V>::Number;
  constexpr std::size_t kLanes = wide::Lanes<V>::kCount;
  Random random(23);
  int wrong = 0;
  for (int round = 0; round < 20000; ++round) {
    alignas(64) T a[kLanes], b[kLanes], c[kLanes];
    for (std::size_t k = 0; k < kLanes; ++k) {
      a[k] = any_number<T>(random);
      b[k] = any_number<T>(random);
    }
    const V va = wide::get(a, V{}), vb = wide::get(b, V{});
    const auto compare = [&](V result, auto&& one) {
      wide::put(c, result);
      for (std::size_t k = 0; k < kLanes; ++k) {
        const T wanted = one(a[k], b[k]);
        wrong += std::isnan(wanted) ? !std::isnan(c[k]) : !same_bits(c[k], wanted);
      }
    };
    compare(va + vb, [](T x, T y) { return x + y; });
    compare(va - vb, [](T x, T y) { return x - y; });
    compare(va * vb, [](T x, T y) { return x * y; });
    compare(wide::divide(va, vb), [](T x, T y) { return x / y; });
    compare(wide::sqrt(wide::abs(va)), [](T x, T) { return std::sqrt(std::fabs(x)); });
    compare(wide::abs(va), [](T x, T) { return std::fabs(x); });
    compare(wide::min(va, vb), [](T x, T y) { return wide::min(x, y); });
    compare(wide::max(va, vb), [](T x, T y) { return wide::max(x, y); });
    compare(wide::select(va < vb, va, vb), [](T x, T y) { return x < y ? x : y; });
    compare(wide::select(va == vb, va, vb), [](T x, T y) { return x == y ? x : y; });
  }
  if (wrong == 0) return;
  ++mistakes;
  std::printf("%s: %d words of wide.h give other bits than one number does\n", name, wrong);
}

void check_words() {
  check_words<double>("one double");
  check_words<float>("one float");
#ifdef LUMBRICAL_XSIMD
  check_words<xsimd::batch<double>>("a batch of doubles");
  check_words<xsimd::batch<float>>("a batch of floats");
#endif
}

/// What stands in golden_hashes.h, computed in the plainest way.
void print() {
  std::puts(
      "// Golden hashes: the bits of golden_sessions.h on every machine. Regenerate, on purpose and in a "
      "commit\n"
      "// that says why, with\n"
      "//   build/dev/tests/golden/golden_hashes print >golden && mv golden tests/golden/golden_hashes.h\n"
      "#pragma once\n\n"
      "#include <cstdint>\n\n"
      "namespace lumbrical::test {\n\n"
      "struct GoldenHash {\n"
      "  const char* name;\n"
      "  std::uint64_t hash;\n"
      "};\n\n"
      "// clang-format off\n"
      "inline constexpr GoldenHash kGolden[] = {");
  const auto line = [](const std::string& name, std::uint64_t hash) {
    std::printf("    {\"%s\", 0x%016llx},\n", name.c_str(), static_cast<unsigned long long>(hash));
  };
  Execution plain;
  plain.isa = Isa::scalar;
  for (const GoldenSession& session : golden_sessions())
    line(session.name, hash_run(model_of(session.scene, plain), session.frames));
  line("jacobians", hash_jacobians(plain));
  line("pairs", hash_pairs(Isa::scalar));
  std::puts("};\n// clang-format on\n\n}  // namespace lumbrical::test");
}

void check(const std::string& which) {
  check_words();
  const std::vector<Execution> ways = ways_to_run(which);
  const std::vector<GoldenSession> sessions = golden_sessions();
  for (const Execution& way : ways) {
    const std::string name = name_of(way);
    for (const GoldenSession& session : sessions)
      expect(session.name, name, golden_hash(session.name),
             hash_run(model_of(session.scene, way), session.frames));
    expect("jacobians", name, golden_hash("jacobians"), hash_jacobians(way));
    expect("pairs", name, golden_hash("pairs"), hash_pairs(way.isa));
    std::printf("checked: %s\n", name.c_str());
    std::fflush(stdout);
  }
  std::printf("%zu sessions, %zu ways to run, %d differ\n", sessions.size(), ways.size(), mistakes);
}

}  // namespace
}  // namespace lumbrical::test

int main(int argc, char** argv) {
  const std::string command = argc > 1 ? argv[1] : "";
  if (command == "print") {
    lumbrical::test::print();
    return 0;
  }
  if (command != "" && command != "all" && command != "widest") {
    std::fputs("golden_hashes [all|widest|print]\n", stderr);
    return 2;
  }
  lumbrical::test::check(command);
  return lumbrical::test::mistakes == 0 ? 0 : 1;
}
