// The names that scene files, options and messages use.
#include <optional>
#include <string_view>

#include "base/named.h"
#include "lumbrical/model.h"

namespace lumbrical {
namespace {

constexpr Named<Law> kLawNames[] = {
    {"field", Law::field},       {"column", Law::column}, {"max-depth", Law::max_depth},
    {"centroid", Law::centroid}, {"point", Law::point},
};
constexpr Named<FeltOnce> kFeltOnceNames[] = {
    {"never", FeltOnce::never},
    {"by-samples", FeltOnce::by_samples},
    {"always", FeltOnce::always},
};
constexpr Named<Broadphase> kBroadphaseNames[] = {
    {"auto", Broadphase::automatic}, {"tree", Broadphase::tree},   {"grid", Broadphase::grid},
    {"voxel", Broadphase::voxel},    {"brute", Broadphase::brute},
};
constexpr Named<Winding> kWindingNames[] = {
    {"auto", Winding::automatic},
    {"as is", Winding::as_is},
    {"flip", Winding::flip},
};
constexpr Named<Mobility> kMobilityNames[] = {
    {"fixed", Mobility::fixed}, {"given", Mobility::given},   {"free", Mobility::free},
    {"hinge", Mobility::hinge}, {"slider", Mobility::slider}, {"ball", Mobility::ball},
};
constexpr Named<Isa> kIsaNames[] = {
    {"auto", Isa::automatic}, {"scalar", Isa::scalar}, {"sse2", Isa::sse2},       {"avx2", Isa::avx2},
    {"avx512", Isa::avx512},  {"neon", Isa::neon},     {"simd128", Isa::simd128},
};

// Of what the engine knows by number.
template <class Name>
std::optional<int> number_named(std::string_view text, int count, const Name& name) {
  for (int number = 0; number < count; ++number) {
    if (name(number) == text) return number;
  }
  return std::nullopt;
}

}  // namespace

std::optional<int> parse_joint(std::string_view text) { return number_named(text, kJointCount, joint_name); }
std::optional<int> parse_segment(std::string_view text) {
  return number_named(text, kSegmentCount, segment_name);
}
std::optional<int> parse_finger(std::string_view text) {
  return number_named(text, kFingerCount, finger_name);
}
std::optional<Law> parse_law(std::string_view text) { return value_named(kLawNames, text); }
std::optional<FeltOnce> parse_felt_once(std::string_view text) { return value_named(kFeltOnceNames, text); }
std::optional<Broadphase> parse_broadphase(std::string_view text) {
  return value_named(kBroadphaseNames, text);
}
std::optional<Winding> parse_winding(std::string_view text) { return value_named(kWindingNames, text); }
std::optional<Mobility> parse_mobility(std::string_view text) { return value_named(kMobilityNames, text); }
std::string_view mobility_name(Mobility mobility) { return name_valued(kMobilityNames, mobility); }
std::optional<Isa> parse_isa(std::string_view text) { return value_named(kIsaNames, text); }
std::string_view winding_name(Winding winding) { return name_valued(kWindingNames, winding); }
std::string_view isa_name(Isa isa) { return name_valued(kIsaNames, isa); }
std::string_view law_name(Law law) { return name_valued(kLawNames, law); }
std::string_view felt_once_name(FeltOnce felt_once) { return name_valued(kFeltOnceNames, felt_once); }
std::string_view broadphase_name(Broadphase broadphase) { return name_valued(kBroadphaseNames, broadphase); }

}  // namespace lumbrical
