// lumbrical replay: a recording once more through the engine, every bit compared; "what if" with other
// switches.
#include <memory>
#include <optional>
#include <string>

#include "commands.h"
#include "divergence.h"
#include "lumbrical/recording.h"
#include "output.h"
#include "switches.h"

namespace lumbrical::tool {
namespace {

struct ReplaySwitches {
  std::string recording, law, broadphase, voxel_cache;
  std::optional<double> stiffness;
  std::string precision;
  std::uint32_t threads = 1;
  std::string isa = "auto";
  bool json = false;
};

ReplayOptions replay_options(const ReplaySwitches& switches) {
  ReplayOptions options;
  if (!switches.law.empty()) options.law = parse_law(switches.law);
  if (!switches.broadphase.empty()) options.execution.broadphase = *parse_broadphase(switches.broadphase);
  options.execution.voxel_cache = switches.voxel_cache;
  options.stiffness = switches.stiffness;
  if (!switches.precision.empty()) options.tolerance = parse_precision(switches.precision);
  options.execution.threads = switches.threads;
  options.execution.isa = *parse_isa(switches.isa);
  return options;
}

int replay_recording(const ReplaySwitches& switches) {
  RecordingReader reader;
  if (Status status = reader.open(switches.recording); !status.ok()) return fail(status);
  ReplayOptions options = replay_options(switches);
  ReplayResult result;
  Status status;
  {
    Progress progress("replaying");
    options.progress = [&progress](std::uint64_t done, std::uint64_t all) { progress.update(done, all); };
    status = replay(reader, options, result);
  }
  if (!status.ok()) return fail(status);

  Json json = divergence_json(result);
  json["complete"] = reader.info().complete;
  json["isa"] = isa_name(options.execution.isa == Isa::automatic ? widest_isa() : options.execution.isa);
  json["threads"] = options.execution.threads;
  json["broadphase"] = broadphase_name(options.execution.broadphase);
  json["recording"] = switches.recording;
  std::string text = divergence_text(result, "replayed");
  if (!reader.info().complete)
    text += "The recording has no end (its writer was killed): all whole ticks were replayed.\n";
  const int printed = switches.json ? print_json(json) : print_text(text);
  if (printed != kDone) return printed;
  return result.first_divergence ? kDiverged : kDone;
}

}  // namespace

void add_replay(CLI::App& app, int& exit_code) {
  const auto switches = std::make_shared<ReplaySwitches>();
  CLI::App* const command =
      app.add_subcommand("replay", "Run a recording again and compare every bit (exit code 3: they differ)");
  command->add_option("recording", switches->recording, "Recording to replay")
      ->required()
      ->type_name("REC.mcap");
  command->add_option("--law", switches->law, "What if: contact law of the whole hand")->check(is_law());
  command->add_option("--precision", switches->precision, std::string("What if: ") + kPrecisionHelp)
      ->check(is_precision());
  command->add_option("--stiffness", switches->stiffness, "What if: K_s [N/m^3]")
      ->check(number_in(1e-6, 1e15));
  command
      ->add_option("--broadphase", switches->broadphase,
                   "Search for candidate triangles; never changes a result")
      ->check(is_broadphase());
  command->add_option("--voxel-cache", switches->voxel_cache, kVoxelCacheHelp)->type_name("FOLDER");
  command->add_option("--isa", switches->isa, "Instruction set; never changes a result")->check(is_isa());
  command->add_option("--threads", switches->threads, "1 .. 64; never changes a result")
      ->check(number_in(1, 64));
  command->add_flag("--json", switches->json, "Print one JSON object");
  command->callback([switches, &exit_code] { exit_code = replay_recording(*switches); });
}

}  // namespace lumbrical::tool
