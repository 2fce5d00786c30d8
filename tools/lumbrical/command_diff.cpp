// lumbrical diff: where two recordings part, without running the engine.
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "divergence.h"
#include "hand_force.h"
#include "lumbrical/recording.h"
#include "output.h"

namespace lumbrical::tool {

namespace {

struct DiffOptions {
  std::string a, b;
  bool json = false;
};

// By how much the hand's force differs, over the ticks that both have with their forces.
struct ForceDifference {
  std::uint64_t ticks = 0, max_tick = 0;
  double max = 0;  // [N]
  std::string side;
};

Status compare_forces(RecordingReader& a, RecordingReader& b, ForceDifference& difference) {
  for (RecordingReader* const reader : {&a, &b})
    if (Status status = reader->seek(reader->info().first_tick); !status.ok()) return status;
  TickRecord one, other;
  bool end = false;
  // What cannot be read to its end is told where the recordings part.
  const auto next = [&end](RecordingReader& reader, TickRecord& record) {
    return reader.next(record, end).ok() && !end;
  };
  bool more = next(a, one) && next(b, other);
  while (more) {
    if (one.output.tick != other.output.tick) {
      const bool behind = one.output.tick < other.output.tick;
      more = behind ? next(a, one) : next(b, other);
      continue;
    }
    if (one.has_forces && other.has_forces) {
      ++difference.ticks;
      const double newtons = norm(hand_force(one.output) - hand_force(other.output));
      if (newtons > difference.max) {
        difference.max = newtons;
        difference.max_tick = one.output.tick;
        difference.side = side_name(a.scene().hand.side);
      }
    }
    more = next(a, one) && next(b, other);
  }
  return {};
}

Json force_json(const ForceDifference& difference) {
  if (difference.ticks == 0) return nullptr;
  return {{"ticks", difference.ticks},
          {"max", difference.max},
          {"max_tick", difference.max_tick},
          {"side", difference.max > 0 ? Json(difference.side) : Json(nullptr)}};
}

std::string force_text(const ForceDifference& difference) {
  if (difference.ticks == 0) return "No tick has its forces in both.\n";
  const std::string compared =
      difference.ticks == 1 ? "the tick" : "the " + grouped(difference.ticks) + " ticks";
  if (!(difference.max > 0)) return "The hand's force is the same in " + compared + " that both have.\n";
  return "The hand's force differs by up to " + brief(difference.max) + " N, in tick " +
         grouped(difference.max_tick) + ", over " + compared + " that both have.\n";
}

int diff(const DiffOptions& options) {
  std::vector<RecordingReader> a, b;
  if (Status status = open_hands(options.a, a); !status.ok()) return fail(status);
  if (Status status = open_hands(options.b, b); !status.ok()) return fail(status);
  if (a.size() != b.size())
    return fail((a.size() > 1 ? options.a : options.b) + " is of two hands and the other of one");
  ReplayResult result;
  std::string side;  // of two hands, whose ticks differ
  for (std::size_t hand = 0; hand < a.size() && !result.first_divergence; ++hand) {
    ReplayResult one;
    if (Status status = diff_recordings(a[hand], b[hand], one); !status.ok()) return fail(status);
    one.ticks += result.ticks;
    result = std::move(one);
    if (a.size() > 1 && result.first_divergence) side = side_name(a[hand].scene().hand.side);
  }
  Json json = divergence_json(result);
  if (!side.empty()) json["first_divergence"]["side"] = side;
  std::string text =
      (side.empty() ? "" : "The " + side + " hand:\n") + divergence_text(result, "compared", a.size() > 1);
  json["force_difference"] = nullptr;
  if (result.first_divergence) {
    ForceDifference forces;
    for (std::size_t hand = 0; hand < a.size(); ++hand)
      if (Status status = compare_forces(a[hand], b[hand], forces); !status.ok()) return fail(status);
    json["force_difference"] = force_json(forces);
    text += force_text(forces);
  }
  const int printed = options.json ? print_json(json) : print_text(text);
  if (printed != kDone) return printed;
  return result.first_divergence ? kDiverged : kDone;
}

}  // namespace

void add_diff(Command& app, int& exit_code) {
  const auto options = std::make_shared<DiffOptions>();
  Command* const command =
      app.add_subcommand("diff", "Compare two recordings tick by tick (exit code 3: they differ)");
  command->add_option("a", options->a, "Recording")->required()->type_name("A.mcap");
  command->add_option("b", options->b, "Recording to compare with it")->required()->type_name("B.mcap");
  command->add_flag("--json", options->json, "Print one JSON object");
  command->callback([options, &exit_code] { exit_code = diff(*options); });
}

}  // namespace lumbrical::tool
