// lumbrical diff: where two recordings part, without running the engine.
#include <memory>
#include <string>
#include <vector>

#include "commands.h"
#include "divergence.h"
#include "lumbrical/recording.h"
#include "output.h"

namespace lumbrical::tool {

namespace {

struct DiffOptions {
  std::string a, b;
  bool json = false;
};

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
  const std::string text =
      (side.empty() ? "" : "The " + side + " hand:\n") + divergence_text(result, "compared", a.size() > 1);
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
