// The messages of a recording: every bit of a tick and of a session comes back, and damage is an error.
#include <gtest/gtest.h>

#include "recording_fixture.h"
#include "recording_generated.h"

namespace lumbrical {
namespace {

using test::expect_same;
using test::small_scene;

TEST(TickMessage, BringsEveryBitOfAnyRecordBack) {
  test::RandomBits random(7);
  flatbuffers::FlatBufferBuilder builder;
  for (std::uint64_t i = 0; i < 3000; ++i) {
    const TickRecord record = test::random_record(random, random.word());
    const InputCheck check = input_check_of(record);
    encode_tick(record, true, check, builder);
    TickRecord decoded;
    InputCheck decoded_check;
    const Status status =
        decode_tick({builder.GetBufferPointer(), builder.GetSize()}, decoded, decoded_check);
    ASSERT_TRUE(status.ok()) << status.message();
    expect_same(record, decoded);
    EXPECT_EQ(check, decoded_check);
    if (::testing::Test::HasFailure()) break;
  }
}

TEST(InputCheck, OfAHostileFileIsNoMoreThanAnAlteredInput) {
  test::RandomBits random(11);
  const TickRecord record = test::random_record(random, 5);
  const std::uint64_t least = std::uint64_t{1} << 63;
  // The change of a sum by -1 and of its moment by the least number there is has no quotient.
  for (const std::uint64_t sum_change : {~std::uint64_t{0}, std::uint64_t{1}, least}) {
    for (const std::uint64_t moment_change : {least, least + 1, least - 1, std::uint64_t{0}}) {
      InputCheck check = input_check_of(record);
      check.hash ^= 1;
      check.low_sum -= sum_change;
      check.low_moment -= moment_change;
      check.high_sum -= sum_change;
      check.high_moment -= moment_change;
      const std::optional<Divergence> altered = find_altered_input(record, check);
      ASSERT_TRUE(altered.has_value());
      EXPECT_EQ(altered->field, "several");
    }
  }
}

#if !defined(NDEBUG) && !defined(__SANITIZE_THREAD__)
TEST(TickRecordDeathTest, TakesNoMorePosesThanThereMayBeObjects) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  TickRecord record;
  const std::vector<ObjectFrame> given(kMostObjects + 1);
  take_input({}, std::span(given).first(kMostObjects), record);
  EXPECT_EQ(record.given_count, kMostObjects);
  EXPECT_DEATH(take_input({}, given, record), "kMostObjects");
}
#endif

TEST(TickMessage, LeavesOutWhatIsNotThere) {
  flatbuffers::FlatBufferBuilder builder;
  TickRecord record;
  record.device.kind = InputKind::joint_angles;
  encode_tick(record, false, {}, builder);
  const std::size_t nothing = builder.GetSize();
  EXPECT_LT(nothing, 300u);
  record.device.angle[3] = 0.5f;
  encode_tick(record, false, {}, builder);
  EXPECT_LT(builder.GetSize(), nothing + 80 + 40);
}

TEST(TickMessage, HoldsAllSegmentsInTheirOrder) {
  flatbuffers::FlatBufferBuilder builder;
  TickRecord record;
  for (const double force : {0.0, 1.0}) {
    record.output.segment[4].force.z = force;
    encode_tick(record, true, {}, builder);
    const auto* const tick = flatbuffers::GetRoot<fb::Tick>(builder.GetBufferPointer());
    ASSERT_NE(tick->segments(), nullptr);
    ASSERT_EQ(tick->segments()->size(), kSegmentCount);
    for (std::uint32_t s = 0; s < kSegmentCount; ++s) EXPECT_EQ(tick->segments()->Get(s)->segment(), s);
    EXPECT_EQ(tick->segments()->Get(4)->force().z(), force);
  }
}

TEST(TickMessage, SurvivesAnyDamage) {
  test::RandomBits random(3);
  flatbuffers::FlatBufferBuilder builder;
  encode_tick(test::random_record(random, 5), true, {}, builder);
  const std::vector<std::uint8_t> good(builder.GetBufferPointer(),
                                       builder.GetBufferPointer() + builder.GetSize());
  TickRecord record;
  InputCheck check;
  for (std::size_t size = 0; size < good.size(); ++size)
    (void)decode_tick(std::span(good).first(size), record, check).ok();
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::vector<std::uint8_t> damaged = good;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    if (decode_tick(damaged, record, check).ok()) {
      EXPECT_LE(record.device.kind, InputKind::joint_angles);
    }
  }
}

// Commands to a device whose numbers lie where a processor may not read them, as a fuzzer once made them.
TEST(TickMessage, RefusesMisplacedNumbers) {
  bool misplaced = false;
  for (const bool shifted : {false, true}) {
    flatbuffers::FlatBufferBuilder builder;
    if (shifted) builder.PushElement<std::uint32_t>(0);
    builder.StartVector(2, sizeof(std::uint32_t));  // room for a double, aligned for half of one
    builder.PushElement<std::uint32_t>(0);
    builder.PushElement<std::uint32_t>(0);
    const flatbuffers::Offset<flatbuffers::Vector<double>> values(builder.EndVector(1));
    const auto sent = fb::CreateSent(builder, 0, 0, 0, 0, 0, 0, 0, values);
    const auto list = builder.CreateVector(&sent, 1);
    const fb::Pose base(fb::Vec3(0, 0, 0), fb::Quat(1, 0, 0, 0));
    fb::TickBuilder tick(builder);
    tick.add_base(&base);
    tick.add_sent(list);
    builder.Finish(tick.Finish());
    const fb::Tick* const made = flatbuffers::GetRoot<fb::Tick>(builder.GetBufferPointer());
    const auto place = made->sent()->Get(0)->values()->Data() - builder.GetBufferPointer();
    if (place % 8 == 0) continue;
    misplaced = true;
    TickRecord record;
    InputCheck check;
    const Status status =
        decode_tick(std::span(builder.GetBufferPointer(), builder.GetSize()), record, check);
    EXPECT_EQ(status.message(), "the tick message has a command to the device that can't be one");
  }
  EXPECT_TRUE(misplaced);
}

TEST(SessionMessage, BringsTheSceneBackBitForBit) {
  Scene scene = small_scene();
  scene.hand.side = Side::left;
  scene.hand.finger[2].limit[1].lower = -0.0;
  scene.hand.palm_joint.position.x = -0.0;
  scene.settings.law[5] = Law::point;
  scene.settings.fade_time = -0.0;
  scene.objects.push_back({"sphere", make_sphere(0.04, 8)});
  scene.objects.push_back({"", {}});
  std::vector<std::uint8_t> bytes, again;
  ASSERT_TRUE(encode_session(scene, bytes).ok());
  Scene decoded;
  const Status status = decode_session(bytes, decoded);
  ASSERT_TRUE(status.ok()) << status.message();
  ASSERT_TRUE(encode_session(decoded, again).ok());
  EXPECT_EQ(bytes, again);
  ASSERT_EQ(decoded.objects.size(), 3u);
  EXPECT_EQ(decoded.objects[1].name, "sphere");
  EXPECT_EQ(decoded.objects[1].mesh.vertices, scene.objects[1].mesh.vertices);
  EXPECT_EQ(decoded.objects[1].mesh.triangles, scene.objects[1].mesh.triangles);
  EXPECT_EQ(decoded.hand.radius, scene.hand.radius);
  EXPECT_TRUE(std::signbit(decoded.settings.fade_time));
  EXPECT_TRUE(std::signbit(decoded.hand.finger[2].limit[1].lower));
}

TEST(SessionMessage, BringsObjectsWithoutTrianglesBack) {
  Scene scene = small_scene(), decoded;
  scene.objects.assign(kMostSceneObjects, {});
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(encode_session(scene, bytes).ok());
  const Status status = decode_session(bytes, decoded);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(decoded.objects.size(), kMostSceneObjects);
}

TEST(SessionMessage, BringsEverySettingBack) {
  Scene scene = small_scene(), decoded;
  int next = 3;
  walk(scene.settings, [&next]<class N>(const FieldName&, N& number) {
    if constexpr (std::is_same_v<N, Law>) {
      number = static_cast<Law>(++next % 5);
    } else if constexpr (std::is_same_v<N, FeltOnce>) {
      number = FeltOnce::always;
    } else {
      number = static_cast<N>(++next);
    }
  });
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(encode_session(scene, bytes).ok());
  const Status status = decode_session(bytes, decoded);
  ASSERT_TRUE(status.ok()) << status.message();
  EXPECT_EQ(numbers_of(scene.settings), numbers_of(decoded.settings));
}

TEST(SessionMessage, SurvivesAnyDamage) {
  std::vector<std::uint8_t> good;
  ASSERT_TRUE(encode_session(small_scene(), good).ok());
  Scene scene;
  constexpr std::size_t kPadding = 8;  // of the last string, at the end
  for (std::size_t size = 0; size + kPadding <= good.size(); ++size)
    EXPECT_FALSE(decode_session(std::span(good).first(size), scene).ok()) << size;
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::vector<std::uint8_t> damaged = good;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1u << (bit % 8));
    Scene decoded;
    if (!decode_session(damaged, decoded).ok()) continue;
    for (const Law law : decoded.settings.law) EXPECT_LE(law, Law::point);
    EXPECT_TRUE(check_hand(decoded.hand).ok());
  }
}

TEST(SessionMessage, OfAnotherVersionIsRefused) {
  std::vector<std::uint8_t> bytes;
  ASSERT_TRUE(encode_session(small_scene(), bytes).ok());
  constexpr flatbuffers::voffset_t kVersionField = 4;  // the first of the table
  auto* const session = flatbuffers::GetMutableRoot<flatbuffers::Table>(bytes.data());
  ASSERT_EQ(session->GetField<std::uint32_t>(kVersionField, 0), kVersion);
  for (const std::uint32_t other : {kVersion - 1, kVersion + 1}) {
    ASSERT_TRUE(session->SetField(kVersionField, other, 0u));
    Scene scene;
    EXPECT_NE(decode_session(bytes, scene).message().find("reads version"), std::string::npos) << other;
  }
}

}  // namespace
}  // namespace lumbrical
