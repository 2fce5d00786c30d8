// Device profiles: what they give, what is refused and where, and that hostile files never do harm.
#include "lumbrical/device_profile.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <utility>

#include "files.h"
#include "lumbrical/passivity.h"
#include "random.h"

namespace lumbrical {
namespace {

namespace fs = std::filesystem;

const fs::path kShipped = fs::path(LUMBRICAL_SOURCE_DIR) / "examples/devices";

std::string write(const std::string& text) { return test::write_file("device.json", text); }

DeviceProfile load(const std::string& path) {
  DeviceProfile profile;
  const Status status = load_device_profile(path, profile);
  EXPECT_TRUE(status.ok()) << status.message();
  return profile;
}

// A profile with one motor; `more` are further fields of the device, `motor` of its actuator.
std::string profile_text(const std::string& motor, const std::string& more = "") {
  return "{\"name\": \"small\",\n \"actuators\": [\n  {\"name\": \"motor\", " + motor + "}]" + more + "}";
}
const char* const kMotor =
    R"("at": {"address": 5, "scale": 0.001}, "lower": -1, "upper": 1, "joints": [{"joint": "index proximal"}])";

std::string error_of(const std::string& text) {
  DeviceProfile profile;
  profile.name = "untouched";
  const Status status = load_device_profile(write(text), profile);
  EXPECT_FALSE(status.ok()) << text;
  EXPECT_EQ(profile.name, "untouched");
  return status.message();
}

TEST(DeviceProfile, ShippedProfilesLoadAndThirdPartiesAreUnverified) {
  int count = 0;
  for (const fs::directory_entry& entry : fs::directory_iterator(kShipped)) {
    const DeviceProfile profile = load(entry.path().string());
    EXPECT_FALSE(profile.verified) << entry.path() << ": no one has run it on hardware";
    EXPECT_FALSE(profile.source.empty()) << entry.path();
    EXPECT_TRUE(check_profile(profile).ok());
    EXPECT_FALSE(profile.unattended) << entry.path() << ": that is the user's to accept";
    ++count;
  }
  EXPECT_EQ(count, 6);
}

TEST(DeviceProfile, NeedsRegistersOnlyWhereTheyAreWhatCrosses) {
  const DeviceProfile profile = load((kShipped / "shared_memory.json").string());
  EXPECT_EQ(profile.transport.kind, TransportKind::memory);
  EXPECT_TRUE(check_attended(profile).ok()) << "each of its commands is numbered";
  DeviceProfile modbus = profile;
  modbus.transport.kind = TransportKind::tcp;
  EXPECT_FALSE(check_profile(modbus).ok()) << "all its fields lie in one register";
  EXPECT_FALSE(check_attended(modbus).ok());
}

TEST(DeviceProfile, TheExoskeletonTakesATorquePerJointInOneExchange) {
  const DeviceProfile profile = load((kShipped / "exoskeleton.json").string());
  ASSERT_EQ(profile.actuators.size(), 15u);
  ASSERT_EQ(profile.sensors.size(), 20u);
  for (std::size_t j = 0; j < 15; ++j) {
    EXPECT_EQ(profile.actuators[j].name, segment_name(static_cast<int>(j)));
    EXPECT_EQ(profile.actuators[j].arm[j], 1);
    EXPECT_EQ(profile.sensors[j].angle, static_cast<int>(4 * (j / 3) + 1 + j % 3));
  }
  const ExchangePlan plan = plan_exchange(profile);
  EXPECT_TRUE(plan.combined);
  EXPECT_EQ(plan.writes, (std::vector<RegisterBlock>{{1, 0, 17}}));
  EXPECT_EQ(plan.reads, (std::vector<RegisterBlock>{{1, 100, 22}}));
}

TEST(DeviceProfile, TheGlovePullsOnlyHasPreloadAndNoLittleFinger) {
  const DeviceProfile profile = load((kShipped / "wire_glove.json").string());
  ASSERT_EQ(profile.actuators.size(), 4u);
  for (const Actuator& wire : profile.actuators) {
    EXPECT_EQ(wire.drive, Drive::wire);
    EXPECT_EQ(wire.lower, 0);
    EXPECT_EQ(wire.upper, 3.5);
    EXPECT_EQ(wire.preload, 0.8);
    for (std::size_t j = 12; j < 15; ++j) EXPECT_EQ(wire.arm[j], 0);
  }
}

TEST(DeviceProfile, FillsInWhatIsLeftOut) {
  const DeviceProfile profile = load(write(profile_text(kMotor)));
  EXPECT_EQ(profile.transport.kind, TransportKind::tcp);
  EXPECT_EQ(profile.transport.port, 502);
  EXPECT_EQ(profile.actuators[0].slew, 2 / 0.02);
  EXPECT_EQ(profile.actuators[0].field.type, RegisterType::s16);
  EXPECT_EQ(profile.actuators[0].field.unit, 1);
  EXPECT_EQ(profile.rate, 100);
  EXPECT_FALSE(profile.verified);
}

TEST(DeviceProfile, UnitsOfTheirOwnMakeRequestsOfTheirOwn) {
  const std::string text =
      R"({"name": "servos", "command": "FC23", "transport": {"unit": 3}, "actuators": [
        {"name": "a", "at": {"address": 54}, "upper": 1600, "joints": [{"joint": "index proximal"}]},
        {"name": "b", "at": {"address": 54, "unit": 4}, "upper": 1600, "joints": [{"joint": "middle proximal"}]}],
        "sensors": [{"joint": "index proximal", "at": {"address": 55}},
                    {"joint": "middle proximal", "at": {"address": 55, "unit": 4}}]})";
  const ExchangePlan plan = plan_exchange(load(write(text)));
  EXPECT_FALSE(plan.combined);
  EXPECT_EQ(plan.writes, (std::vector<RegisterBlock>{{3, 54, 1}, {4, 54, 1}}));
  EXPECT_EQ(plan.reads, (std::vector<RegisterBlock>{{3, 55, 1}, {4, 55, 1}}));
}

TEST(DeviceProfile, NeverWritesARegisterNoOneNamedAndNeverTooMany) {
  std::string text = R"({"name": "wide", "actuators": [)";
  for (int i = 0; i < 32; ++i) {
    const std::string at = std::to_string(8 * i);
    const auto part = [&](int k) {
      return R"({"address": )" + std::to_string(8 * i + 2 * k) + R"(, "type": "f32"})";
    };
    text += (i > 0 ? ", " : "") + std::string(R"({"name": "m", "at": )") + part(0) +
            R"(, "upper": 1, "joints": [{"joint": "index distal"}], "local": {"angle": )" + part(1) +
            R"(, "stiffness": )" + part(2) + R"(, "radius": )" + part(3) + "}}";
  }
  const ExchangePlan plan = plan_exchange(load(write(text + "]}")));
  int total = 0;
  for (const RegisterBlock& block : plan.writes) {
    EXPECT_LE(block.count, kMaxWriteRegisters);
    total += block.count;
  }
  EXPECT_EQ(total, 256);
  EXPECT_EQ(plan.writes.size(), 3u);
  for (const RegisterBlock& block : plan.writes)
    EXPECT_EQ(block.count % 2, 0) << "both words of a number go in one request";

  const std::string gap = profile_text(kMotor, R"(, "control": {"address": 7})");
  EXPECT_EQ(plan_exchange(load(write(gap))).writes, (std::vector<RegisterBlock>{{1, 5, 1}, {1, 7, 1}}));
}

struct Mistake {
  std::string text, place, words;
};

TEST(DeviceProfile, TellsEveryMistakeWithLineAndColumn) {
  const std::string at = R"("at": {"address": 5, "scale": 0.001}, )";
  const std::string joints = R"("joints": [{"joint": "index proximal"}])";
  const auto local_at = [](const char* scale) {
    return R"(, "local": {"angle": {"address": 6, "scale": )" + std::string(scale) +
           R"(}, "stiffness": {"address": 7}, "radius": {"address": 8}})";
  };
  const std::string sensor = R"(, "sensors": [{"joint": "index proximal", "at": {"address": 9}}])";
  const Mistake mistakes[] = {
      {"{}", ":1:1:", "name is missing"},
      {R"({"name": "x"})", ":1:", "actuators must be 1 to 32"},
      {R"({"name": "x", "speed": 3})", ":1:", "unknown field: speed; fields here are actuators, "},
      {profile_text(R"("upper": 1, )" + joints), ":3:", "at is missing"},
      {profile_text(at + joints), ":3:", "upper is missing"},
      {profile_text(at + R"("upper": 1)"), ":3:", "ties the actuator to no joint"},
      {profile_text(at + R"("upper": 1, "joints": [{"joint": "index toe"}])"),
       ":3:", "must be a finger joint"},
      {profile_text(at + R"("upper": 1, "joints": [{"joint": "index distal", "ratio": 0}])"),
       ":3:", "must not be 0"},
      {profile_text(at + R"("upper": 100, )" + joints), ":3:", "too little for the limits"},
      {profile_text(at + R"("upper": 1, "safe": -0.5, )" + joints), ":3:", "lies outside lower .. upper"},
      {profile_text(R"("at": {"address": 5}, "lower": 0.3, "upper": 0.5, "safe": 0.4, )" + joints),
       ":3:", "no count of it lies within lower .. upper"},
      {profile_text(at + R"("upper": 1, "lower": -1, "drive": "wire", )" + joints),
       ":3:", "must not be negative"},
      {profile_text(at + R"("upper": 1, "preload": 0.1, )" + joints), ":3:", "is for wires only"},
      {profile_text(at + R"("upper": 1, "drive": "spring", )" + joints), ":3:", "must be one of"},
      {profile_text(at + R"("upper": 1, "slew": 0, )" + joints), ":3:", "must lie in"},
      {profile_text(at + R"("upper": 1, "delay": 2, )" + joints), ":3:", "must lie in 0 .. 1"},
      {profile_text(R"("at": {"address": 70000}, "upper": 1, )" + joints), ":3:", "must lie in 0 .. 65535"},
      {profile_text(R"("at": {"address": 65535, "type": "f32"}, "upper": 1, )" + joints),
       ":3:", "leaves no room"},
      {profile_text(R"("at": {"address": 5, "scale": 0}, "upper": 1, )" + joints), ":3:", "not 0"},
      {profile_text(R"("at": {"address": 5, "unit": 248}, "upper": 1, )" + joints), ":3:", "must lie in"},
      {profile_text(kMotor + local_at("0.00005")), ":3:", "too little for the limits"},
      {profile_text(kMotor + local_at("0.00007"), sensor), ":3:",
       "local.angle holds -2.29376 .. 2.29369, too little for lower .. upper of the joint's sensor, -0.8 .. "
       "2.5"},
      {profile_text(kMotor, ",\n \"control\": {\"address\": 5}"), ":4:", "overlaps actuators[0].at"},
      {profile_text(kMotor, ",\n \"rate\": 0"), ":4:10:", "must lie in"},
      {profile_text(kMotor, ",\n \"rate\": 10"), ":4:10:", "would count as lost"},
      {profile_text(kMotor, ",\n \"rate\": 1e999"), ":4:", ""},
      {profile_text(kMotor, ",\n \"command\": \"FC23\", \"feedback\": \"FC4\""), ":4:", "FC3"},
      {profile_text(kMotor, ",\n \"expected\": [{\"address\": 1, \"mask\": 1, \"value\": 2}]"),
       ":4:", "outside the mask"},
      {profile_text(kMotor, ",\n \"first_retry\": 5"), ":4:", "must not exceed last_retry"},
      {profile_text(kMotor,
                    ",\n \"sensors\": [{\"joint\": \"index distal\", \"motion\": \"abduction\", \"at\": "
                    "{\"address\": 1}}]"),
       ":4:", "first joint only"},
      {profile_text(kMotor,
                    ",\n \"sensors\": [{\"joint\": \"index distal\", \"at\": {\"address\": 1}},"
                    "{\"joint\": \"index distal\", \"at\": {\"address\": 2}}]"),
       ":4:", "measured twice"},
      {profile_text(kMotor,
                    ",\n \"sensors\": [{\"joint\": \"index distal\", \"upper\": 1, \"at\": "
                    "{\"address\": 1, \"type\": \"u16\", \"offset\": 2}}]"),
       ":4:", "nothing of which lies within lower .. upper"},
      {profile_text(kMotor, ",\n \"response_timeout\": 0.2"), ":4:", "must not exceed safety.answer_timeout"},
  };
  for (const Mistake& mistake : mistakes) {
    const std::string message = error_of(mistake.text);
    EXPECT_NE(message.find("device.json" + mistake.place), std::string::npos) << message << "\n"
                                                                              << mistake.text;
    EXPECT_NE(message.find(mistake.words), std::string::npos) << message << "\n" << mistake.text;
  }
}

TEST(DeviceProfile, ARegisterNeedNotHoldAStraightFinger) {
  const DeviceProfile profile = load(write(profile_text(kMotor, R"(, "sensors": [{"joint": "index proximal",
    "at": {"address": 9, "type": "u16", "scale": 0.001, "offset": 0.2}, "lower": 0.2, "upper": 2}])")));
  ASSERT_EQ(profile.sensors.size(), 1u);
  EXPECT_EQ(profile.sensors[0].lower, 0.2);
}

TEST(DeviceProfile, AnEncoderIsNoFinerThanTheRegisterThatTellsOfIt) {
  const std::string sensor =
      R"(, "sensors": [{"joint": "index proximal", "at": {"address": 9, "scale": -0.01%}}],
    "dynamics": [{"damping": 0.01, "friction": 0.004, "encoder_step": 0.0001}])";
  const auto with = [&sensor](const std::string& type) {
    std::string more = sensor;
    more.replace(more.find('%'), 1, type);
    return load(write(profile_text(kMotor, more)));
  };
  DeviceProfile profile = with("");
  EXPECT_EQ(profile.dynamics[3].encoder_step, 0.01);
  EXPECT_EQ(make_certificate(profile, {}).joint[3].friction, 2 * 0.004 / 0.01);
  EXPECT_EQ(profile.dynamics[4].encoder_step, 0.0001) << "no sensor looks at it";
  EXPECT_EQ(with(R"(, "type": "f32")").dynamics[3].encoder_step, 0.0001) << "a float has no counts";
  EXPECT_EQ(
      load(write(profile_text(kMotor, R"(, "sensors": [{"joint": "index proximal", "at": {"address": 9}}],
    "dynamics": [{"damping": 0.01}])")))
          .dynamics[3]
          .encoder_step,
      0)
      << "nothing is said of it";
  profile.dynamics[3].encoder_step = 0.0001;  // as a program might
  EXPECT_NE(check_profile(profile).message().find(
                "encoder_step of index proximal is finer than a count of the sensor's register"),
            std::string::npos);
}

// A profile made by a program has seen no reader.
TEST(DeviceProfile, MadeInAProgramIsHeldToTheRangesOfAFile) {
  const DeviceProfile whole = load((kShipped / "exoskeleton.json").string());
  const double nan = std::nan("");
  const auto error = [&whole](const auto& spoil) {
    DeviceProfile profile = whole;
    spoil(profile);
    return check_profile(profile).message();
  };
  EXPECT_EQ(error([](DeviceProfile&) {}), "");
  const std::pair<std::string, std::string> told[] = {
      {error([&](DeviceProfile& p) { p.rate = nan; }), "rate must be 0.1 to 20000 Hz"},
      {error([](DeviceProfile& p) { p.rate = 1e6; }), "rate must be"},
      {error([&](DeviceProfile& p) { p.response_timeout = nan; }), "response_timeout must be"},
      {error([&](DeviceProfile& p) { p.first_retry = nan; }), "first_retry must be"},
      {error([](DeviceProfile& p) { p.last_retry = 1e9; }), "last_retry must be"},
      {error([](DeviceProfile& p) { p.read_back = 1e-9; }), "read_back must be 0, or 0.01 to 10 s"},
      {error([](DeviceProfile& p) { p.safety.fade = 0; }), "safety.fade must be"},
      {error([&](DeviceProfile& p) { p.safety.soft_start = nan; }), "safety.soft_start must be"},
      {error([&](DeviceProfile& p) { p.safety.tick_hold = nan; }), "safety.tick_hold must be"},
      {error([](DeviceProfile& p) { p.safety.tick_timeout = 1e9; }), "safety.tick_timeout must be"},
      {error([](DeviceProfile& p) { p.safety.answer_timeout = 1e9; }), "safety.answer_timeout must be"},
      {error([](DeviceProfile& p) { p.dynamics[4].inertia = -1; }),
       "dynamics.inertia of index intermediate must be 0 to 1 kg m^2"},
      {error([&](DeviceProfile& p) { p.dynamics[0].encoder_step = nan; }), "dynamics.encoder_step of"},
      {error([](DeviceProfile& p) { p.sensors[3].angle = kAngleCount; }), "sensors[3].joint is no angle"},
      {error([](DeviceProfile& p) { p.sensors[3].angle = p.sensors[1].angle; }), "measured twice"},
      {error([](DeviceProfile& p) { p.sensors[3].upper = 1e9; }), "sensors[3].upper must be -7 to 7 rad"},
      {error([](DeviceProfile& p) { p.sensors[3].delay = -1; }), "sensors[3].delay must be 0 to 1 s"},
      {error([&](DeviceProfile& p) { p.actuators[2].delay = nan; }), "actuators[2].delay must be 0 to 1 s"},
      {error([](DeviceProfile& p) { p.read_function = 5; }), "feedback must be"},
      {error([](DeviceProfile& p) {
         p.transport.kind = TransportKind::memory;
         p.read_function = 4;
       }),
       "feedback must be \"FC3\" where"},
      {error([](DeviceProfile& p) { p.transport.stop_bits = 3; }), "transport.stop_bits must be 1 to 2"},
      {error([](DeviceProfile& p) {
         p.expected.push_back({1, 0, 1, 2});
       }),
       "outside the mask"},
      {error([](DeviceProfile& p) { p.handshake.resize(65); }), "at most 64 writes"},
  };
  for (const auto& [message, words] : told)
    EXPECT_NE(message.find(words), std::string::npos) << words << ": " << message;
}

TEST(DeviceProfile, SurvivesTruncationAndDamageAtEveryByte) {
  const std::string whole = test::read_file(kShipped / "robotiq_2f.json");
  test::Random random(66);
  for (std::size_t i = 0; i < whole.size(); i += 7) {
    for (const std::string& text : {whole.substr(0, i), [&] {
                                      std::string damaged = whole;
                                      damaged[i] = static_cast<char>(random.bits());
                                      return damaged;
                                    }()}) {
      DeviceProfile profile;
      const Status status = load_device_profile(write(text), profile);
      EXPECT_EQ(status.ok(), !profile.name.empty());
      EXPECT_EQ(check_profile(profile).ok(), status.ok());
      EXPECT_EQ(status.message().find("device.json") != std::string::npos, !status.ok());
    }
  }
}

}  // namespace
}  // namespace lumbrical
