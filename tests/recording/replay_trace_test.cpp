// What replay tells of a result that differs: pair, field, distance, and a text that two machines can
// compare.
#include <gtest/gtest.h>

#include <cmath>
#include <fstream>
#include <limits>
#include <map>

#include "tick/tick_trace.h"
#include "touch_session.h"

namespace lumbrical::test {
namespace {

class ReplayTrace : public TouchReplay {};
INSTANTIATE_TEST_SUITE_P(Inputs, ReplayTrace,
                         ::testing::Values(InputKind::joint_poses, InputKind::joint_angles),
                         testing::PrintToStringParamName());

std::string without_comments(const std::string& path) {
  std::ifstream in(path);
  std::string text;
  for (std::string line; std::getline(in, line);)
    if (!line.starts_with('#')) text += line + '\n';
  return text;
}

// What a difference is about is told to the number where this machine can still compute what was recorded.
TEST_P(ReplayTrace, NamesPairFieldAndDistanceOfAResultThatDiffers) {
  Scene moved = touch_scene();
  for (Vec3& p : moved.objects[0].mesh.vertices) p.z += 1e-9;  // the same pairs, other contacts
  ReplayOptions other;
  other.mesh[moved.objects[0].name] = moved.objects[0].mesh;
  ReplayResult result;
  ASSERT_TRUE(replay_file(path_, result, other).ok());
  ASSERT_TRUE(result.first_divergence.has_value());
  const Divergence& first = *result.first_divergence;
  EXPECT_EQ(first.stage, "narrowphase");
  ASSERT_TRUE(first.primitive && first.triangle && first.ulp);
  EXPECT_LT(*first.triangle, touch_scene().objects[0].mesh.triangles.size());
  EXPECT_GT(*first.ulp, 0u);
  EXPECT_NE(first.recorded, first.replayed);
  EXPECT_EQ(first.recorded_build, build_text());
  EXPECT_EQ(first.replayed_build, build_text());

  // The same tick by hand.
  const auto contact_of = [&](const Scene& scene) {
    Model model;
    EXPECT_TRUE(build_model(scene, {}, model).ok());
    State state;
    Scratch scratch = make_scratch(model);
    tick(model, state, scratch, touch_frame(first.tick, GetParam(), scene.hand));
    for (std::uint32_t i = 0; i < scratch.contact_count; ++i) {
      const Contact& contact = scratch.contacts[i];
      if (contact.primitive == *first.primitive && contact.triangle == *first.triangle) return contact;
    }
    ADD_FAILURE() << "no such contact";
    return Contact{};
  };
  const Contact exact = contact_of(touch_scene()), rough = contact_of(moved);
  const std::map<std::string, double Contact::*> fields = {{"depth", &Contact::depth},
                                                           {"area", &Contact::area},
                                                           {"volume", &Contact::volume},
                                                           {"error", &Contact::error}};
  ASSERT_TRUE(fields.contains(first.field)) << first.field;
  EXPECT_EQ(first.recorded, exact_text(exact.*fields.at(first.field)));
  EXPECT_EQ(first.replayed, exact_text(rough.*fields.at(first.field)));
}

// Another law shapes the hand otherwise: that is where the runs part, not where contacts differ in
// consequence.
TEST_P(ReplayTrace, NamesWhatOfTheHandDiffers) {
  ReplayOptions options;
  options.law = Law::column;
  ReplayResult result;
  ASSERT_TRUE(replay_file(path_, result, options).ok());
  ASSERT_TRUE(result.first_divergence.has_value());
  const Divergence& first = *result.first_divergence;
  expect_divergence(first, first.tick, "hand_pose", "primitive[0].law");
  EXPECT_EQ(first.recorded, "field");
  EXPECT_EQ(first.replayed, "column");
  EXPECT_FALSE(first.primitive);
}

TEST(UlpDistance, CountsTheNumbersInBetween) {
  using Type = NumberType;
  const auto between = [](double a, double b) {
    return ulps_between(Type::real, std::bit_cast<std::uint64_t>(a), std::bit_cast<std::uint64_t>(b));
  };
  const double next = std::nextafter(1.5, 2.0), tiny = std::numeric_limits<double>::denorm_min();
  EXPECT_EQ(between(1.5, next), 1u);
  EXPECT_EQ(between(next, 1.5), 1u);
  EXPECT_EQ(between(1.0, 2.0), std::uint64_t{1} << 52);
  EXPECT_EQ(between(-0.0, 0.0), 1u);
  EXPECT_EQ(between(-tiny, tiny), 3u);
  EXPECT_EQ(between(2.0, 2.0), 0u);
  EXPECT_FALSE(between(NAN, 1.0).has_value());
  EXPECT_EQ(ulps_between(Type::real32, std::bit_cast<std::uint32_t>(1.0f),
                         std::bit_cast<std::uint32_t>(std::nextafter(1.0f, 2.0f))),
            1u);
  EXPECT_FALSE(ulps_between(Type::whole, 1, 2).has_value());
}

TEST_P(ReplayTrace, TracesTheSameTextHoweverItIsComputed) {
  const std::string a = temporary_path("a.txt"), b = temporary_path("b.txt"), c = temporary_path("c.txt");
  ReplayOptions options;
  options.trace_tick = 330;
  ReplayResult result;
  options.trace = a;
  ASSERT_TRUE(replay_file(path_, result, options).ok());
  options.trace = b;
  options.execution = {.broadphase = Broadphase::brute, .threads = 2, .isa = Isa::scalar};
  ASSERT_TRUE(replay_file(path_, result, options).ok());
  const std::string text = without_comments(a);
  EXPECT_EQ(text, without_comments(b));
  for (const char* const part :
       {"330 input base.position.x ", "330 hand_pose primitive[0].end1.x ", "330 hand_pose palm.corner[0].x ",
        "330 broadphase primitive ", " triangle ", "330 narrowphase primitive ",
        "330 contact_force segment[0].force.x ", "330 limits flags ", "330 state tick 331\n",
        "330 state held.segment[15].force.z "})
    EXPECT_NE(text.find(part), std::string::npos) << part;

  // Of a divergence, the stage that differs.
  ReplayOptions stiffer;
  stiffer.stiffness = 3e7;
  stiffer.trace = c;
  ASSERT_TRUE(replay_file(path_, result, stiffer).ok());
  ASSERT_TRUE(result.first_divergence.has_value());
  EXPECT_EQ(result.first_divergence->stage, "contact_force");
  const std::string tick = std::to_string(result.first_divergence->tick);
  EXPECT_EQ(without_comments(c).find(tick + " contact_force segment[0].force.x "), 0u);
  EXPECT_EQ(without_comments(c).find("narrowphase"), std::string::npos);

  options.trace_tick = kTicks;
  const Status status = replay_file(path_, result, options);
  EXPECT_NE(status.message().find("nothing was traced"), std::string::npos) << status.message();
}

// All that this machine computes there; what was recorded is compared up to the difference.
TEST_P(ReplayTrace, TracesATickBehindTheFirstDifferenceToo) {
  ReplayOptions options;
  options.stiffness = 3e7;
  ReplayResult result;
  ASSERT_TRUE(replay_file(path_, result, options).ok());
  ASSERT_TRUE(result.first_divergence.has_value());
  const std::uint64_t parted = result.first_divergence->tick;
  options.trace = temporary_path("later.txt");
  options.trace_tick = parted + 20;
  ASSERT_TRUE(replay_file(path_, result, options).ok());
  ASSERT_TRUE(result.first_divergence.has_value());
  EXPECT_EQ(result.first_divergence->tick, parted);
  EXPECT_EQ(result.ticks, parted + 1);
  const std::string text = without_comments(options.trace), tick = std::to_string(parted + 20);
  for (const char* const part : {" input base.position.x ", " limits flags ", " state tick "})
    EXPECT_NE(text.find(tick + part), std::string::npos) << part;

  options.trace_tick = kTicks;
  ASSERT_TRUE(replay_file(path_, result, options).ok());
  EXPECT_TRUE(result.first_divergence.has_value()) << "which stands, whatever can't be traced";
  EXPECT_NE(result.not_traced.find("is not behind it"), std::string::npos) << result.not_traced;
}

}  // namespace
}  // namespace lumbrical::test
