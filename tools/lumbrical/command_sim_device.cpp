// lumbrical sim-device: a simulated exoskeleton that speaks Modbus, with a human hand in it.
#include <algorithm>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <memory>
#include <optional>

#include "commands.h"
#include "lumbrical/modbus_server.h"
#include "lumbrical/motion.h"
#include "lumbrical/real_time.h"
#include "lumbrical/scene_file.h"
#include "output.h"
#include "sink_uri.h"
#include "switches.h"

namespace lumbrical::tool {
namespace {

struct SimOptions {
  std::string profile, tcp, rtu, line, scene;
  std::uint32_t baud = 115200;
  double seconds = 0, delay = 0, jitter = 0;
  std::optional<double> fault_after;  // [s] of touch; none: from the start
  std::string sensor_fault = "none", device_fault = "none";
  SimulationOptions simulation;
  bool json = false;
};

volatile std::sig_atomic_t ending = 0;
extern "C" void end_simulation(int) { ending = 1; }

// The joints as the scene's hand means to move them, from the moment the device is switched on.
Status intend_scene(const std::string& path, SimulationOptions& simulation) {
  SceneFile scene;
  if (Status status = load_scene_file(path, scene); !status.ok()) return status;
  if (scene.motion.samples[0].frame.kind != InputKind::joint_angles) {
    return Status::error(path + ": its motion has no joint angles; use a grasp or an angles file");
  }
  simulation.intention = [motion = scene.motion](double time, JointArray& target) {
    const DeviceFrame frame = resample(motion, std::min(time, duration(motion)));
    for (std::size_t j = 0; j < kPhalanxCount; ++j) {
      target[j] = static_cast<double>(frame.angle[flexion_angle(j)]);
    }
  };
  return {};
}

// "[HOST:]PORT"
Status listen(const std::string& text, ModbusServer& server) {
  std::string host = "127.0.0.1";
  std::string_view digits;
  int port = -1;
  const bool parted = split_host(text, true, host, digits);
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), port);
  if (!parted || error != std::errc() || end != digits.data() + digits.size() || port < 0 || port > 65535) {
    return Status::error("--tcp: \"" + text + "\" is no port; write 1502, 127.0.0.1:1502 or [::1]:1502");
  }
  return server.listen(host, static_cast<std::uint16_t>(port));
}

SensorFault sensor_fault_of(const std::string& name) {
  return name == "stuck"     ? SensorFault::stuck
         : name == "jumping" ? SensorFault::jumping
         : name == "none"    ? SensorFault::none
                             : SensorFault::out_of_range;
}

Status open_wire(const SimOptions& options, ModbusServer& server) {
  if (!options.tcp.empty()) return listen(options.tcp, server);
  if (!options.rtu.empty()) return server.open_terminal(options.rtu);
  return server.open_line(options.line, options.baud);
}

// Below the priority of what drives it: a device of its own would not be in the way either.
constexpr int kPriority = 70;
Json felt_json(const SimulatedDevice& device, const ModbusServer& server, const WornDevice& worn) {
  Json json;
  json["address"] = server.name();
  json["seconds"] = device.time();
  json["requests"] = server.requests();
  json["largest_torque_change"] = worn.largest_change;
  json["energy_taken"] = worn.taken;
  json["energy_given"] = worn.given;
  json["shakes"] = shakes_of(worn);
  json["joints"] = Json::array();
  for (std::size_t j = 0; j < kPhalanxCount; ++j) {
    json["joints"].push_back({{"joint", segment_name(static_cast<int>(j))},
                              {"angle", worn.angle[j]},
                              {"torque", worn.torque[j]},
                              {"peak_torque", worn.peak[j]}});
  }
  return json;
}

std::string felt_text(const SimulatedDevice& device, const ModbusServer& server, const WornDevice& worn) {
  Table table;
  table.add("simulated", brief(device.time()) + " s, " + grouped(server.requests()) + " requests");
  std::string peaks;
  for (std::size_t f = 0; f < kFingerCount; ++f) {
    peaks += (f > 0 ? "   " : "") + std::string(finger_name(static_cast<int>(f))) + " " +
             brief(1e3 * worn.peak[3 * f]);
  }
  table.add("peak torque [N mm]", peaks + " (first joints)");
  table.add("largest change", brief(1e3 * worn.largest_change) + " N mm between two looks");
  table.add("shakes", grouped(shakes_of(worn)) + " turns of more than 2 mrad within 0.1 s");
  table.add("energy", brief(1e3 * worn.taken) + " mJ taken by the actuators, " + brief(1e3 * worn.given) +
                          " mJ given to the hand beyond what the device took");
  double left = 0;
  for (const double torque : worn.torque) left = std::max(left, std::fabs(torque));
  table.add("at the end", left == 0 ? "no torque" : "torques up to " + brief(1e3 * left) + " N mm");
  return table.text();
}

int simulate(SimOptions options) {
  DeviceProfile profile;
  if (Status status = load_device_profile(options.profile, profile); !status.ok()) return fail(status);
  const TransportKind kind = options.tcp.empty() ? TransportKind::rtu : TransportKind::tcp;
  if (Status status = move_to_transport(kind, profile); !status.ok()) return fail(status);
  if (!options.scene.empty()) {
    if (Status status = intend_scene(options.scene, options.simulation); !status.ok()) return fail(status);
  }
  ModbusServer server;
  if (Status status = open_wire(options, server); !status.ok()) return fail(status);
  SimulatedDevice device(profile, options.simulation);
  ServerFaults faults;
  faults.delay = options.delay;
  faults.jitter = options.jitter;
  ending = 0;
  std::signal(SIGINT, end_simulation);
  std::signal(SIGTERM, end_simulation);
  std::fprintf(stderr, "%s: listening on %s\n", printable(profile.name).c_str(), server.name().c_str());
  if (server.is_open_to_others()) {
    std::fprintf(stderr,
                 "warning: whoever reaches %s may command the device; 127.0.0.1 is for this machine only\n",
                 server.name().c_str());
  }
  const RealTime real_time = enter_real_time(kPriority, Pinning::none);
  WornDevice worn;
  const SensorFault fault = sensor_fault_of(options.sensor_fault);
  std::optional<double> fault_at;  // [s] of the device
  if (!options.fault_after) fault_at = 0;
  server.serve(
      device, faults,
      [&] { return ending != 0 || (options.seconds > 0 && device.time() >= options.seconds); },
      [&](SimulatedDevice& now) {
        look(now, worn);
        const bool felt = worn.torque != JointArray{};
        if (felt && !fault_at) fault_at = now.time() + *options.fault_after;
        if (!fault_at || now.time() < *fault_at) return;
        now.break_sensors(fault);
        now.break_down(options.device_fault == "broken");
        now.hang(options.device_fault == "hung");
      });
  leave_real_time(real_time);
  server.close();
  return options.json ? print_json(felt_json(device, server, worn))
                      : print_text(felt_text(device, server, worn));
}

}  // namespace

void add_sim_device(Command& app, int& exit_code) {
  const auto options = std::make_shared<SimOptions>();
  Command* const command =
      app.add_subcommand("sim-device", "A simulated exoskeleton that speaks Modbus, with a human hand in it");
  command
      ->add_option(
          "--profile", options->profile,
          "Device profile (JSON; schemas/device.fbs, installed in share/lumbrical, lists its fields)")
      ->required();
  Command* const wire = command->add_option_group("wire", "Where it listens; one of");
  wire->add_option("--tcp", options->tcp, "TCP; port 0 takes a free one")->type_name("[HOST:]PORT");
  wire->add_option("--rtu", options->rtu, "A pseudo-terminal with a symbolic link of this name")
      ->type_name("LINK");
  wire->add_option("--line", options->line, "An existing serial line")->type_name("DEVICE");
  wire->require_option(1);
  command->add_option("--baud", options->baud, "Of --line")
      ->check(whole_number_in(300, 10000000))
      ->capture_default_str();
  command->add_option("--scene", options->scene, "Scene whose hand motion (joint angles) the human intends")
      ->type_name("FILE");
  command->add_option("--seconds", options->seconds, "End after this time; 0: on a signal")
      ->check(number_in(0, 1e9));
  command->add_option("--delay", options->delay, "Of every reply [s]")->check(number_in(0, 10));
  command->add_option("--jitter", options->jitter, "Of every reply, up to this much more [s]")
      ->check(number_in(0, 10));
  SimulationOptions& simulation = options->simulation;
  command->add_option("--watchdog", simulation.watchdog, "Without commands for longer, torques fade [s]")
      ->check(number_in(0.001, 100))
      ->capture_default_str();
  command->add_option("--human-stiffness", simulation.human.stiffness, "Of the hand in it [N m/rad]")
      ->check(number_in(0, 100))
      ->capture_default_str();
  command->add_option("--human-damping", simulation.human.damping, "Of the hand in it [N m s/rad]")
      ->check(number_in(0, 10))
      ->capture_default_str();
  command
      ->add_option("--sensor-fault", options->sensor_fault, "What its angles say in the place of the truth")
      ->check(one_of({"none", "stuck", "jumping", "out-of-range"}))
      ->capture_default_str();
  command
      ->add_option("--device-fault", options->device_fault,
                   "What ails it: broken says so and lets go; hung answers, but its program stands still")
      ->check(one_of({"none", "broken", "hung"}))
      ->capture_default_str();
  command
      ->add_option("--fault-after", options->fault_after,
                   "When these begin: after the first torque [s]; without, from the start")
      ->check(number_in(0, 1e9));
  command->add_flag("--json", options->json, "Print one JSON object at the end");
  command->callback([options, &exit_code] { exit_code = simulate(*options); });
}

}  // namespace lumbrical::tool
