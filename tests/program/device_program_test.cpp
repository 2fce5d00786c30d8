// lumbrical run with a device in the loop, and lumbrical sim-device: what they print, how they end, and that
// the wearer's fingers are free again however the program dies.
#include <gtest/gtest.h>

#include <cmath>
#include <future>

#include "eventually.h"
#include "lumbrical/recording.h"
#include "program.h"
#include "shared_memory_device.h"
#include "terminals.h"

namespace lumbrical {
namespace {

using nlohmann::json;
using test::fresh_folder;
using test::kManyTicks;
using test::Outcome;
using test::shell;

// A shipped profile with time-outs for slow and busy machines.
void write_profile(const char* shipped, const std::filesystem::path& file) {
  json profile = json::parse(
      std::ifstream(std::string(LUMBRICAL_SOURCE_DIR) + "/examples/devices/" + shipped + ".json"));
  profile["rate"] = 100;
  profile["response_timeout"] = 1;
  profile["safety"] = {
      {"fade", 0.05}, {"soft_start", 0.1}, {"tick_hold", 1}, {"tick_timeout", 5}, {"answer_timeout", 2}};
  std::ofstream(file) << profile;
}

// Profiles, a grasp of three seconds, and a plane the fingers always touch.
void write_inputs(const std::filesystem::path& folder) {
  write_profile("exoskeleton", folder / "device.json");
  write_profile("shared_memory", folder / "plain.json");
  std::ofstream(folder / "scene.json") << R"({"objects": [{"mug": {}}], "settings": {"rate": 100},
      "motion": {"grasp": {"seconds": 4}}})";
}

// For shell(): waits until the text stands so often in a file.
std::string wait_for(const std::string& text, const std::string& file, int times = 1) {
  return test::wait_until("[ \"$(grep -c '" + text + "' " + file + " 2>/dev/null)\" -ge " +
                          std::to_string(times) + " ] 2>/dev/null");
}

// For shell(): waits until the device at $port has been told a torque of more than 2 N mm, which it is asked
// for by reading the registers of all fifteen.
const std::string kTorques =
    R"(bash -c "exec 3<>/dev/tcp/127.0.0.1/$port && printf )"
    R"('\0\7\0\0\0\6\1\3\0\2\0\17' >&3 && head -c 39 <&3 | tail -c 30" 2>/dev/null | )"
    R"(od -An -v -w2 -td2 --endian=big | )";
const std::string kWaitForForces =
    test::wait_until(kTorques + "awk '$1 * $1 > 400 { found = 1 } END { exit !found }'");
const std::string kWaitForNoForces =
    test::wait_until(kTorques + "awk '$1 != 0 { found = 1 } END { exit NR < 15 || found }'");

// Starts sim-device, waits for its address in $port or for its terminal, runs `body`, and ends it by SIGINT;
// its figures are in sim.json, its end in `wait`. Before, the device goes on for longer than its watchdog
// waits: by its own time, which does not stand still on a machine that is busy.
std::string with_device(const std::string& wire, const std::string& body) {
  return "lumbrical sim-device --profile device.json --scene scene.json --seconds 280 --json " + wire +
         " >sim.json 2>sim.err & sim=$!; " + wait_for("listening on", "sim.err") +
         "port=$(sed -n 's/.*listening on .*://p' sim.err); " + body +
         "; code=$?; sleep 0.6; kill -INT $sim; wait $sim; exit $code";
}

json sim_figures(const std::filesystem::path& folder) {
  return json::parse(test::read_file((folder / "sim.json").string()));
}

double largest(const json& figures, const char* key) {
  double most = 0;
  for (const json& joint : figures["joints"]) most = std::max(most, std::fabs(joint[key].get<double>()));
  return most;
}

const std::string kRun =
    "lumbrical run scene.json --rate 100 --sink \"modbus-tcp://127.0.0.1:$port?profile=device.json\" ";

TEST(DeviceProgram, ClosesTheLoopAndRecordsIt) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  const Outcome outcome =
      shell(with_device("--tcp 0", kRun + "--ticks 300 --record session.mcap --json --threads 1"), folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const json run = outcome.json();
  EXPECT_EQ(run["ticks"], 300);
  EXPECT_TRUE(run.contains("wake_up_us") && run.contains("real_time") && run.contains("loop_us"));
  const json& device = run["device"];
  EXPECT_EQ(device["state"], "active");
  EXPECT_EQ(run["trouble"], json::array());
  EXPECT_EQ(device["safe_at_end"], true);
  EXPECT_GT(device["acknowledged"], 10);
  EXPECT_EQ(device["certificate"]["measured"], true);
  EXPECT_EQ(device["certificate"]["joints"].size(), 15u);
  EXPECT_NE(outcome.error.find("armed -> active"), std::string::npos) << outcome.error;

  const json sim = sim_figures(folder);
  EXPECT_GT(largest(sim, "peak_torque"), 0.001) << "the grasp should be felt";
  EXPECT_EQ(largest(sim, "torque"), 0);
  EXPECT_GT(std::fabs(sim["joints"][3]["angle"].get<double>()), 0.01) << "the human moved";

  RecordingReader reader;
  ASSERT_TRUE(reader.open((folder / "session.mcap").string()).ok());
  EXPECT_NE(reader.info().metadata.at("certificate").find("\"delay\""), std::string::npos);
  TickRecord record;
  bool end = false;
  int sent = 0, acknowledged = 0, moved = 0;
  std::uint64_t cycle = 0;
  while (reader.next(record, end).ok() && !end) {
    for (std::uint32_t i = 0; i < record.sent_count; ++i) {
      if (record.sent[i].sent == 0) continue;  // no command
      EXPECT_GT(record.sent[i].cycle, cycle);
      cycle = record.sent[i].cycle;
      ++sent;
      acknowledged += record.sent[i].acknowledged > record.sent[i].sent ? 1 : 0;
      moved += record.sent[i].value[3] != 0 ? 1 : 0;
    }
  }
  EXPECT_GT(acknowledged, 10);
  EXPECT_LE(acknowledged, sent);
  EXPECT_GT(moved, 0);
  EXPECT_EQ(shell("lumbrical replay session.mcap", folder).exit_code, 0);
  const json told = shell("lumbrical info session.mcap --json", folder).json()["device"];
  EXPECT_EQ(told["commands"], sent);
  EXPECT_EQ(told["acknowledged"], acknowledged);
  EXPECT_GT(told["delay"]["max"], 0);
  EXPECT_EQ(told["certificate"]["measured"], true);
  const std::string events = shell("lumbrical export session.mcap --events", folder).output;
  EXPECT_NE(events.find("state,\"armed -> active\""), std::string::npos) << events;
  EXPECT_NE(shell("lumbrical info session.mcap", folder).output.find("state: armed -> active"),
            std::string::npos);
}

// However late a busy machine lets the touch begin: the sensors break in it, and not before.
TEST(DeviceProgram, AnglesThatCannotBeLetForcesFadeAndAreFlaggedInTheRecording) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  const Outcome outcome = shell(with_device("--tcp 0 --sensor-fault out-of-range --fault-after 0.3",
                                            kRun + "--ticks 300 --record session.mcap --json"),
                                folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_NE(outcome.output.find("angles of the device were not believed in"), std::string::npos)
      << outcome.output;
  EXPECT_NE(outcome.error.find("angle of thumb metacarpal out of its range"), std::string::npos)
      << outcome.error;
  RecordingReader reader;
  ASSERT_TRUE(reader.open((folder / "session.mcap").string()).ok());
  TickRecord record;
  bool end = false, force_before = false, flagged = false;
  double last = -1;
  while (reader.next(record, end).ok() && !end) {
    flagged = (record.device.flags & kAngleOutOfRange) != 0;
    if (flagged) {
      EXPECT_NE(record.device.flags & kTrackingLost, 0u);
    }
    last = 0;
    for (const Wrench& wrench : record.output.segment) last += norm(wrench.force);
    force_before = force_before || (!flagged && last > 0);
  }
  EXPECT_TRUE(force_before && flagged);
  EXPECT_EQ(last, 0);
}

TEST(DeviceProgram, ADeviceThatReportsAFaultOrHangsInATouchLetsForcesFade) {
  for (const auto& [fault, told] :
       {std::pair("broken", "the device reports a fault"), std::pair("hung", "heartbeat not echoed")}) {
    const auto folder = fresh_folder();
    write_inputs(folder);
    const std::string body = kRun + kManyTicks + ">run.out 2>run.err & run=$!; " +
                             wait_for(std::string("active -> fault: .*") + told, "run.err") +
                             "kill -INT $run; wait $run";
    shell(with_device(std::string("--tcp 0 --fault-after 0 --device-fault ") + fault, body), folder);
    const std::string error = test::read_file((folder / "run.err").string());
    EXPECT_NE(error.find(told), std::string::npos) << error;
    const json sim = sim_figures(folder);
    EXPECT_GT(largest(sim, "peak_torque"), 0) << "it began with a touch";
    EXPECT_EQ(largest(sim, "torque"), 0);
  }
}

// What the sink's URI may leave out is left out.
TEST(DeviceProgram, GoesWithoutForcesOrWithoutAHeartbeatFeedbackAndProtectionsIfTold) {
  const auto run = [](const std::string& parameters, const std::filesystem::path& folder) {
    const Outcome outcome = shell(with_device("--tcp 0",
                                              "lumbrical run scene.json --rate 100 --ticks 250 --json --sink "
                                              "\"modbus-tcp://127.0.0.1:$port?profile=device.json&" +
                                                  parameters + "\""),
                                  folder);
    EXPECT_EQ(outcome.exit_code, 0) << outcome.error;
    EXPECT_GT(outcome.json()["device"]["acknowledged"], 10);
    return largest(sim_figures(folder), "peak_torque");
  };
  const auto folder = fresh_folder();
  write_inputs(folder);
  EXPECT_EQ(run("dry-run=on", folder), 0);
  json mute = json::parse(test::read_file((folder / "device.json").string()));
  mute.erase("heartbeat");
  std::ofstream(folder / "device.json") << mute;
  const std::string all = "unattended=accepted&network=any&feedback=off&limiter=off&observer=off&local=off";
  EXPECT_GT(run(all, folder), 0.001);
}

// A device that tells no angles has a delay that no one knows, which is not 0.
TEST(DeviceProgram, DoesNotTellAsZeroWhatWasNotMeasured) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  json mute = json::parse(test::read_file((folder / "device.json").string()));
  mute.erase("sensors");
  std::ofstream(folder / "device.json") << mute;
  const std::string run =
      "lumbrical run scene.json --rate 100 --ticks 150 --sink "
      "\"modbus-tcp://127.0.0.1:$port?profile=device.json&limiter=off\" ";
  const Outcome outcome = shell(with_device("--tcp 0", run + "--json >run.json && " + run), folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  const json device = json::parse(test::read_file((folder / "run.json").string()))["device"];
  EXPECT_EQ(device["state"], "active");
  EXPECT_EQ(device["loop_delay_us"]["p50"], nullptr);
  EXPECT_EQ(device["loop_delay_us"]["max"], nullptr);
  EXPECT_GT(device["oldest_command_ms"], 0) << "its commands are acknowledged all the same";
  EXPECT_EQ(device["certificate"]["measured"], false);
  for (const char* const told : {"not measured: the device told no angles", "none: no delay was measured",
                                 "energy accounts         not kept"})
    EXPECT_NE(outcome.output.find(told), std::string::npos) << outcome.output;
}

// Its last state is "active" still: a device that does not answer is lost after answer_timeout only.
TEST(DeviceProgram, ASessionThatCouldNotLetGoOfItsDeviceHasFailed) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  json profile = json::parse(test::read_file((folder / "device.json").string()));
  profile["response_timeout"] = profile["safety"]["answer_timeout"] = 3;
  std::ofstream(folder / "device.json") << profile;
  const Outcome outcome = shell(
      with_device("--tcp 0", kRun + "--ticks 300 --json >run.json 2>run.err & run=$!; " + kWaitForForces +
                                 "kill -STOP $sim; wait $run; code=$?; kill -CONT $sim; (exit $code)"),
      folder);
  const json run = json::parse(test::read_file((folder / "run.json").string()));
  EXPECT_EQ(run["device"]["state"], "active");
  EXPECT_EQ(run["device"]["safe_at_end"], false);
  EXPECT_EQ(outcome.exit_code, 4);
}

// Friction is 0 where a profile does not say it, and encoders need some to be passive.
TEST(DeviceProgram, SaysThatStepsWithoutFrictionLeaveNoForce) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  json profile = json::parse(test::read_file((folder / "device.json").string()));
  profile["dynamics"] = {{{"damping", 0.01}, {"encoder_step", 3e-4}}};
  std::ofstream(folder / "device.json") << profile;
  const Outcome outcome = shell(with_device("--tcp 0", kRun + "--ticks 100 --json"), folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(largest(sim_figures(folder), "peak_torque"), 0);
  EXPECT_NE(std::string(outcome.json()["trouble"].at(0)).find("an encoder step and no friction"),
            std::string::npos)
      << outcome.output;
}

TEST(DeviceProgram, RunsOverATerminal) {
  if (!test::have_terminals()) GTEST_SKIP() << test::kNoTerminals;
  const auto folder = fresh_folder();
  write_inputs(folder);
  const Outcome outcome = shell(with_device("--rtu line",
                                            "lumbrical run scene.json --rate 100 --ticks 150 --json --sink "
                                            "\"modbus-rtu://$PWD/line?profile=device.json&baud=115200\""),
                                folder);
  ASSERT_EQ(outcome.exit_code, 0) << outcome.error;
  EXPECT_EQ(outcome.json()["device"]["safe_at_end"], true);
  EXPECT_GT(sim_figures(folder)["requests"], 10);
  EXPECT_FALSE(std::filesystem::is_symlink(folder / "line")) << "the link is taken away again";
}

// Waits for forces to flow, kills the program by a signal, waits until `told` stands in what it told, and
// lets the device go on for a while; what was told.
std::string kill_by(const std::string& signal, const std::filesystem::path& folder,
                    const std::string& uri_end = "", const std::string& told = "",
                    const std::string& watchdog = "0.3") {
  write_inputs(folder);
  const std::string body =
      "lumbrical run scene.json --rate 100 --sink \"modbus-tcp://127.0.0.1:$port?profile=device.json" +
      uri_end + "\" " + kManyTicks + ">run.out 2>run.err & run=$!; " +
      wait_for("armed -> active", "run.err") + kWaitForForces + "kill -" + signal + " $run; wait $run; " +
      wait_for(told, "run.err") + "true";
  shell(with_device("--tcp 0 --watchdog " + watchdog, body), folder);
  const std::string error = test::read_file((folder / "run.err").string());
  EXPECT_NE(error.find("armed -> active"), std::string::npos) << error;
  const json sim = sim_figures(folder);
  EXPECT_GT(largest(sim, "peak_torque"), 0.001) << "there was something to fade";
  EXPECT_EQ(largest(sim, "torque"), 0);
  return error;
}

const std::string kClosed = "closed: the device has acknowledged safe values";

TEST(DeviceProgram, InterruptsHangUpsAndQuitsFadeAndSaySo) {
  for (const char* const signal : {"INT", "HUP", "QUIT", "TERM"}) {
    const std::string error = kill_by(signal, fresh_folder(), "&guard=off");
    EXPECT_NE(error.find(kClosed), std::string::npos) << signal << ": " << error;
  }
}

TEST(DeviceProgram, ACrashOfTheTickingThreadFadesToo) {
  kill_by("SEGV", fresh_folder(), "&guard=off", "", "100");
}

TEST(DeviceProgram, KilledOutrightItsGuardLetsGoOfADeviceThatHasNoWatchdog) {
  const std::string error = kill_by("KILL", fresh_folder(), "", "guard: closed", "100");
  EXPECT_NE(error.find("guard: the session has ended without letting go"), std::string::npos) << error;
  EXPECT_NE(error.find("guard: " + kClosed), std::string::npos) << error;
}

// Whom the session's terminal has left.
TEST(DeviceProgram, TheGuardLetsGoThoughNobodyReadsWhatItSays) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  const std::string body =
      "lumbrical run scene.json --rate 100 --sink "
      "\"modbus-tcp://127.0.0.1:$port?profile=device.json&guard=off\" " +
      kManyTicks + ">run.out 2>run.err & run=$!; " + kWaitForForces + "kill -KILL $run; wait $run; " +
      "mkfifo full; exec 9<>full; dd if=/dev/zero of=full oflag=nonblock bs=4096 count=100 2>/dev/null; "
      "lumbrical guard \"modbus-tcp://127.0.0.1:$port?profile=device.json\" </dev/null 2>full & guard=$!; " +
      kWaitForNoForces + "kill -KILL $guard; wait $guard; true";
  shell(with_device("--tcp 0 --watchdog 100", body), folder);
  const json sim = sim_figures(folder);
  EXPECT_GT(largest(sim, "peak_torque"), 0.001) << "there was something to fade";
  EXPECT_EQ(largest(sim, "torque"), 0);
}

// Which it can read no second time.
TEST(DeviceProgram, ASessionWhoseGuardCannotReadTheProfileDoesNotBegin) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  const Outcome refused = shell(
      "lumbrical run scene.json --rate 100 --ticks 20 --sink 'modbus-tcp://127.0.0.1:1?profile=/dev/stdin' "
      "<device.json",
      folder);
  EXPECT_EQ(refused.exit_code, 2) << refused.output;
  EXPECT_NE(refused.error.find("ended before it stood guard"), std::string::npos) << refused.error;
  EXPECT_NE(refused.error.find("guard=off goes without"), std::string::npos) << refused.error;
}

const std::string kShippedProfile = LUMBRICAL_SOURCE_DIR "/examples/devices/shared_memory.json";

// Of a device without registers.
std::string sink_at(const std::string& place, const std::string& profile = kShippedProfile) {
  return "--sink \"" + place + "?unattended=accepted&profile=" + profile + "\" ";
}

TEST(DeviceProgram, KilledOutrightItsGuardLetsGoOfADeviceInSharedMemory) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  const std::string region = test::own_region("guarded");
  const test::SharedDevice device(region);
  std::future<Outcome> session = std::async(std::launch::async, [&] {
    return shell("lumbrical run scene.json --rate 100 " + kManyTicks +
                     sink_at("memory://" + region, "plain.json&feedback=off&limiter=off&observer=off") +
                     ">run.out 2>run.err & run=$!; " + test::wait_until("[ -e felt ]") +
                     "kill -KILL $run; wait $run; " + wait_for("guard: closed", "run.err") + "true",
                 folder);
  });
  EXPECT_TRUE(test::eventually([&] { return std::fabs(device.value) > 0.002; }));
  std::ofstream(folder / "felt").close();
  session.wait();
  const std::string error = test::read_file((folder / "run.err").string());
  EXPECT_NE(error.find("guard: " + kClosed), std::string::npos) << error;
  EXPECT_EQ(device.value, 0);
}

TEST(DeviceProgram, KilledOutrightWithoutAGuardItLeavesTheFadingToTheDevicesWatchdog) {
  kill_by("KILL", fresh_folder(), "&guard=off");
}

TEST(DeviceProgram, ASessionThatEndsWellLeavesNoGuardBehind) {
  const auto folder = fresh_folder();
  const std::string error = kill_by("INT", folder);
  EXPECT_EQ(error.find("guard"), std::string::npos) << error;
}

TEST(DeviceProgram, StopsAndArmsAgainBySignals) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  const std::string body = kRun + kManyTicks + ">run.out 2>run.err & run=$!; " +
                           wait_for("armed -> active", "run.err") + "kill -USR2 $run; " +
                           wait_for("active -> fault: emergency stop", "run.err") + "kill -USR1 $run; " +
                           wait_for("armed -> active", "run.err", 2) + "kill -INT $run; wait $run";
  shell(with_device("--tcp 0", body), folder);
  const std::string error = test::read_file((folder / "run.err").string());
  const std::size_t stop = error.find("active -> fault: emergency stop");
  ASSERT_NE(stop, std::string::npos) << error;
  EXPECT_NE(error.find("fault -> idle", stop), std::string::npos) << error;
  EXPECT_NE(error.find("armed -> active", stop), std::string::npos) << error;
  EXPECT_NE(error.find("closed: the device has acknowledged safe values"), std::string::npos) << error;
}

TEST(DeviceProgram, AnotherMasterEndsTheSession) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  const std::string body = kRun + kManyTicks + "--json 2>run.err & run=$!; " +
                           wait_for("armed -> active", "run.err") + kRun +
                           "--ticks 300 >other.out 2>other.err; wait $run";
  const Outcome outcome = shell(with_device("--tcp 0", body), folder);
  EXPECT_EQ(outcome.exit_code, 4);
  const json run = outcome.json();
  EXPECT_LT(run["ticks"], 25000);
  EXPECT_NE(std::string(run["trouble"].at(0)).find("another master writes to the device"), std::string::npos)
      << run["trouble"];
}

Outcome lose_device(const std::string& choice, int ticks, const std::filesystem::path& folder) {
  write_inputs(folder);
  const std::string body =
      "{ " + wait_for("armed -> active", "run.err") +
      "kill -KILL $sim; } & lumbrical run scene.json --rate 100 --ticks " + std::to_string(ticks) +
      " --json --sink \"modbus-tcp://127.0.0.1:$port?profile=device.json&on-loss=" + choice + "\" 2>run.err";
  Outcome outcome = shell(with_device("--tcp 0", body), folder);
  EXPECT_EQ(outcome.exit_code, 4) << outcome.error;
  EXPECT_NE(test::read_file((folder / "run.err").string()).find("active -> disconnected"), std::string::npos);
  return outcome;
}

TEST(DeviceProgram, StopsWhenTheDeviceIsLostIfTold) {
  const json run = lose_device("stop", 2000, fresh_folder()).json();
  EXPECT_LT(run["ticks"], 2000);
  EXPECT_EQ(std::string(run["trouble"].at(0)).find("forces no longer reached the device: "), 0u)
      << run["trouble"];
  EXPECT_EQ(run["trouble"].at(1), "1 loss of the device");
}

TEST(DeviceProgram, GoesOnWhenTheDeviceIsLostIfTold) {
  const json run = lose_device("continue", 600, fresh_folder()).json();
  EXPECT_EQ(run["ticks"], 600);
  EXPECT_EQ(run["device"]["state"], "disconnected");
}

TEST(DeviceProgram, ADeviceThatIsNotThereIsTheFirstThingSaidWithItsCause) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  json profile = json::parse(test::read_file((folder / "device.json").string()));
  profile["response_timeout"] = 0.1;
  profile["safety"]["answer_timeout"] = 0.2;
  std::ofstream(folder / "device.json") << profile;
  const std::string run =
      "lumbrical run scene.json --rate 100 --sink 'modbus-tcp://127.0.0.1:1?profile=device.json";
  const Outcome told = shell(run + "' --ticks 20 --json", folder);
  EXPECT_EQ(told.exit_code, 4) << told.error;
  EXPECT_EQ(told.output.find("\"trouble\""), told.output.find('"')) << "the first key";
  const std::string trouble = told.json()["trouble"].at(0);
  EXPECT_EQ(trouble.find("no force ever reached the device: not connected: 127.0.0.1:1: connection refused"),
            0u)
      << trouble;
  EXPECT_EQ(told.json()["trouble"].at(1), "nothing was felt: in no tick was it known where the hand is");
  EXPECT_FALSE(told.json().contains("clearance")) << "it is no motion that passes by";
  const Outcome text = shell(run + "' --ticks 20", folder);
  EXPECT_EQ(text.exit_code, 4);
  EXPECT_EQ(text.output.substr(0, text.output.find('\n')).find("trouble"), 0u) << text.output;
  EXPECT_EQ(text.output.find("the motion has ended"), std::string::npos) << text.output;
  EXPECT_NE(text.output.find("angles of the device missing"), std::string::npos) << text.output;

  const Outcome stopped = shell(run + "&on-loss=stop' --json " + kManyTicks, folder);
  EXPECT_EQ(stopped.exit_code, 4);
  EXPECT_LT(stopped.json()["ticks"], 25000);
}

TEST(DeviceProgram, ARecordingWhoseNameIsTakenIsToldBeforeTheDeviceIsSpokenTo) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  std::ofstream(folder / "session.mcap") << "mine";
  const std::string run =
      "lumbrical run scene.json --rate 100 --sink 'modbus-tcp://127.0.0.1:1?profile=device.json' --ticks 20 ";
  const Outcome taken = shell(run + "--record session.mcap", folder);
  EXPECT_EQ(taken.exit_code, 2) << taken.error;
  EXPECT_NE(taken.error.find("is there already"), std::string::npos) << taken.error;
  EXPECT_EQ(taken.error.find("not connected"), std::string::npos) << taken.error;
  EXPECT_EQ(shell(run + "--record other.mcap", folder).exit_code, 4);
  EXPECT_TRUE(std::filesystem::exists(folder / "other.mcap"));
}

TEST(DeviceProgram, TicksThatComeFarTooSeldomAreATrouble) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  const Outcome run =
      shell("lumbrical run scene.json --rate 100000 --precision exact --ticks 60000 --json", folder);
  const std::string trouble = run.json()["trouble"].dump();
  EXPECT_NE(trouble.find("Hz of 100,000: everything took longer than it was to; lower --rate"),
            std::string::npos)
      << trouble;
}

// The next file that is opened would take their numbers, and what is told stand in it.
TEST(DeviceProgram, ClosedStandardStreamsLeaveTheRecordingWhole) {
  for (const std::string closed : {"2>&-", ">&-", "<&-"}) {
    const auto folder = fresh_folder();
    write_inputs(folder);
    const Outcome run = shell("lumbrical run scene.json --rate 1000 --ticks 200 --record a.mcap " +
                                  sink_at("udp://127.0.0.1:9") + closed,
                              folder);
    EXPECT_EQ(run.exit_code, closed == ">&-" ? 2 : 4) << closed << run.error;
    const Outcome verify = shell("lumbrical verify a.mcap", folder);
    EXPECT_EQ(verify.exit_code, 0) << closed << verify.error;
  }
}

// A machine of our own names, where the system lets us have one.
TEST(DeviceProgram, ADeviceIsLookedForAtEveryAddressOfItsName) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  std::ofstream(folder / "hosts") << "::1 device\n127.0.0.1 device\n";
  const std::string names = "unshare -Urm sh -c 'mount --bind hosts /etc/hosts && ";
  if (shell(names + "getent ahosts device'", folder).output.find("::1") != 0)
    GTEST_SKIP() << "no permission to name hosts";
  const Outcome run = shell(
      names + "lumbrical run scene.json --rate 1000 --ticks 1000 " + sink_at("udp://device:9") + "'", folder);
  for (const char* const address : {"(::1)", "(127.0.0.1)"})
    EXPECT_NE(run.error.find(std::string("nothing listens at device:9 ") + address), std::string::npos)
        << run.error;
}

TEST(DeviceProgram, SaysWhatIsWrongWithASink) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  json mute = json::parse(test::read_file((folder / "device.json").string()));
  mute.erase("heartbeat");
  std::ofstream(folder / "mute.json") << mute;
  write_profile("shared_memory", folder / "memory.json");
  const std::pair<std::string, std::string> cases[] = {
      {"usb://x", "is no sink"},
      {"modbus-tcp://h:70000?profile=device.json", "names no host and port"},
      {"modbus-rtu://ttyUSB0?profile=device.json", "names no line"},
      {"modbus-tcp://h", "names no device profile"},
      {"modbus-tcp://h?profile=device.json&speed=3", "is no parameter"},
      {"modbus-tcp://h?profile=device.json&side=up", "side is left or right"},
      {"modbus-tcp://h?profile=device.json&rate=0", "rate is 0.1 to 20000 [Hz]"},
      {"modbus-tcp://h?profile=memory.json", "made for a transport without registers"},
      {"modbus-tcp://::1?profile=device.json", "names no host and port"},
      {"modbus-tcp://[::1]x?profile=device.json", "names no host and port"},
      {"modbus-tcp://8.8.8.8?profile=device.json", "8.8.8.8: lies outside loopback"},
      {"modbus-tcp://[2001:db8::1]:502?profile=device.json", "2001:db8::1: lies outside"},
      {"modbus-tcp://h?profile=nothing.json", "nothing.json: there is no such file"},
      {"modbus-tcp://h?profile=scene.json", "scene.json:1:"},
      {"modbus-tcp://127.0.0.1:1?profile=mute.json", "has no heartbeat"}};
  for (const auto& [uri, told] : cases) {
    const Outcome outcome = shell("lumbrical run scene.json --rate 100 --sink '" + uri + "'", folder);
    EXPECT_EQ(outcome.exit_code, 2) << uri;
    EXPECT_NE(outcome.error.find(told), std::string::npos) << uri << "\n" << outcome.error;
  }
  EXPECT_EQ(shell("lumbrical sim-device --profile device.json", folder).exit_code, 2) << "no wire";
  EXPECT_EQ(shell("lumbrical sim-device --profile device.json --tcp x", folder).exit_code, 2);
  const Outcome outcome = shell("lumbrical sim-device --profile memory.json --tcp 0 --seconds 0.01", folder);
  EXPECT_EQ(outcome.exit_code, 2);
  EXPECT_NE(outcome.error.find("made for a transport without registers"), std::string::npos) << outcome.error;
}

TEST(DeviceProgram, TheSimulatedDeviceWarnsWhereOthersMayCommandIt) {
  const auto folder = fresh_folder();
  write_inputs(folder);
  const std::string end = " --profile device.json --seconds 0.01";
  EXPECT_EQ(shell("lumbrical sim-device --tcp 0" + end, folder).error.find("warning"), std::string::npos);
  EXPECT_NE(shell("lumbrical sim-device --tcp 0.0.0.0:0" + end, folder)
                .error.find("warning: whoever reaches 0.0.0.0"),
            std::string::npos);
}

}  // namespace
}  // namespace lumbrical
