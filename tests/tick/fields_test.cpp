// The lists of fields: names, units, and that whatever they name is hashed and traced.
#include "tick/field_lists.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>

#include "session.h"
#include "tick/tick_trace.h"

namespace lumbrical {
namespace {

struct Padded {
  std::uint32_t a = 0;
  double b = 0;
};
constexpr void list_fields(Is<Padded> auto& padded, auto&& field) {
  field("a", "", padded.a);
  field("b", "m", padded.b);
}
struct Forgetful {
  double a = 0, b = 0;
};
constexpr void list_fields(Is<Forgetful> auto& forgetful, auto&& field) { field("a", "", forgetful.a); }

TEST(Fields, AreNamedFromTheOutermostStructInwards) {
  const std::vector<NumberField>& device = fields_of<DeviceFrame>();
  ASSERT_EQ(device.size(), kNumberCount<DeviceFrame>);
  EXPECT_EQ(device[0].name, "base.position.x");
  EXPECT_EQ(device[0].unit, "m");
  EXPECT_EQ(device[3].name, "base.orientation.w");
  EXPECT_EQ(device[3].unit, "");
  EXPECT_EQ(device[10 + 7 * 7 + 1].name, "joint[7].position[1]");
  EXPECT_EQ(device[10 + 7 * 7 + 1].type, NumberType::real32);
  EXPECT_EQ(device.back().name, "angle[19]");
  EXPECT_EQ(device.back().unit, "rad");
  const std::vector<NumberField>& state = fields_of<HandState>();
  EXPECT_EQ(state[0].type, NumberType::whole);
  EXPECT_EQ(state.back().name, "held.flexion_torque[15]");
  EXPECT_EQ(state.back().unit, "N m");
  EXPECT_EQ(state[4].name, "ends[0].x");
  EXPECT_EQ(state[4].unit, "m");
  EXPECT_EQ(state[22].name, "last.segment[0].force.x");
  EXPECT_EQ(state[22].unit, "N");
}

TEST(Fields, AreHashedAsTheyStandOnlyWhereNothingElseLiesBetween) {
  EXPECT_FALSE(kIsRow<Padded>);
  EXPECT_FALSE(kIsRow<Forgetful>);
  EXPECT_TRUE(kIsRow<Vec3>);
  Padded one, other;
  one.b = other.b = 3;
  auto* const bytes = reinterpret_cast<unsigned char*>(&other);
  bytes[5] = 1;  // padding
  EXPECT_EQ(hash_fields(one), hash_fields(other));
  other.a = 1;
  EXPECT_NE(hash_fields(one), hash_fields(other));
}

std::vector<std::pair<std::string, std::uint64_t>> values_of(const Primitives& hand) {
  std::vector<std::pair<std::string, std::uint64_t>> values;
  walk(hand,
       [&values](const FieldName& at, auto number) { values.emplace_back(at.text(), bits_of(number)); });
  return values;
}

// What the narrowphase goes by: a difference in it must not be blamed on the narrowphase.
TEST(Fields, OfAPosedHandArePrimitivesPalmBordersAndFolding) {
  const Scene scene = test::mug_scene(Law::field);
  const Model model = test::model_of(scene);
  State state;
  Scratch scratch = make_scratch(model);
  const DeviceFrame frame = test::grasp_frames(scene.hand, 2)[1];
  tick(model, state, scratch, frame);
  const Primitives& hand = *scratch.primitives;
  ASSERT_TRUE(hand.border[1].shared);
  EXPECT_EQ(hash_fields(hand), scratch.stage_hash[static_cast<std::size_t>(Stage::hand_pose)]);
  EXPECT_EQ(trace_stage(scratch, frame, {}, {}, Stage::hand_pose).size(), values_of(hand).size());
  const auto raise = [](double& number) { number = std::nextafter(number, 1e9); };
  const std::pair<const char*, std::function<void(Primitives&)>> edits[] = {
      {"primitive[2].radius2", [&](Primitives& h) { raise(h.primitive[2].radius2); }},
      {"primitive[1].cut[0].normal.z", [&](Primitives& h) { raise(h.primitive[1].cut[0].normal.z); }},
      {"primitive[1].overhang[0]", [&](Primitives& h) { raise(h.primitive[1].overhang[0]); }},
      {"primitive[15].law", [](Primitives& h) { h.primitive[15].law = Law::point; }},
      {"palm.corner[3].y", [&](Primitives& h) { raise(h.palm.corner[3].y); }},
      {"border[1].slab", [&](Primitives& h) { raise(h.border[1].slab); }},
      {"border[2].shared", [](Primitives& h) { h.border[2].shared = true; }},
      {"folded[3]", [](Primitives& h) { h.folded[3] = !h.folded[3]; }},
      {"base_joint[15].x", [&](Primitives& h) { raise(h.base_joint[15].x); }},
      {"flags", [](Primitives& h) { h.flags ^= kAngleClamped; }}};
  for (const auto& [name, edit] : edits) {
    Primitives other = hand;
    edit(other);
    EXPECT_NE(hash_fields(other), hash_fields(hand)) << name;
    const auto values = values_of(hand), changed = values_of(other);
    std::size_t at = 0;
    while (at < values.size() && values[at] == changed[at]) ++at;
    ASSERT_LT(at, values.size()) << name;
    EXPECT_EQ(changed[at].first, name);
  }
}

template <class T>
void add_numbers(const T& value, std::vector<std::uint64_t>& bits) {
  walk(value, [&bits](const FieldName& at, auto number) {
    if (at.unit != kOwner) bits.push_back(bits_of(number));
  });
}

// Whatever of a state makes replays part can be named.
TEST(Fields, OfAStateAreTracedAsTheyAreHashed) {
  Scene scene = test::mug_scene(Law::field);
  scene.settings.pad.damping = 0.01;
  scene.settings.proxy_stiffness = 100;
  scene.objects[0].mechanism.mobility = Mobility::given;
  const Model model = test::model_of(scene);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  const std::vector<ObjectFrame> given(1);
  for (const DeviceFrame& frame : test::grasp_frames(scene.hand, 2))
    tick(model, state, scratch, frame, given);
  ASSERT_TRUE(state.proxy && state.motion);
  std::vector<std::uint64_t> wanted, traced;
  add_numbers(static_cast<const HandState&>(state), wanted);
  for (const ObjectState& object : state.objects) add_numbers(object, wanted);
  add_numbers(*state.proxy, wanted);
  add_numbers(*state.motion, wanted);
  for (const TraceValue& value : trace_state(state)) traced.push_back(value.bits);
  EXPECT_EQ(traced, wanted);
}

// Pads, layers and objects add to what the contacts give, and objects stand in input and output too.
TEST(Fields, OfAStageAreTracedAsTheyAreHashed) {
  Scene scene = test::mug_scene(Law::field);
  scene.settings.pad.damping = 0.01;
  scene.objects[0].mechanism.mobility = Mobility::given;
  const Model model = test::model_of(scene);
  State state = make_state(model);
  Scratch scratch = make_scratch(model);
  DeviceFrame frame;
  ActuatorFrame output;
  const std::vector<ObjectFrame> given(1);
  for (const DeviceFrame& next : test::grasp_frames(scene.hand, 20)) {
    frame = next;
    output = tick(model, state, scratch, frame, given);
    if (norm(scratch.forces.segment[5].force) > 0.1) break;
  }
  ASSERT_GT(norm(scratch.forces.segment[5].force), 0.1);
  const auto expect_traced = [&](Stage stage, const auto& whole, const auto& objects) {
    std::vector<std::uint64_t> wanted, traced;
    add_numbers(whole, wanted);
    for (const auto& object : objects) add_numbers(object, wanted);
    for (const TraceValue& value : trace_stage(scratch, frame, given, output, stage))
      traced.push_back(value.bits);
    EXPECT_EQ(traced, wanted) << stage_name(stage);
  };
  expect_traced(Stage::input, frame, given);
  expect_traced(Stage::contact_force, scratch.forces, std::vector<ObjectOutput>());
  expect_traced(Stage::limits, output, scratch.object_output);
  EXPECT_EQ(hash_fields(scratch.forces), scratch.stage_hash[static_cast<std::size_t>(Stage::contact_force)]);
}

}  // namespace
}  // namespace lumbrical
