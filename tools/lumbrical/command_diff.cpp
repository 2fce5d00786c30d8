// lumbrical diff: where two recordings part, without running the engine.
#include <memory>
#include <string>

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
  RecordingReader a, b;
  if (Status status = a.open(options.a); !status.ok()) return fail(status);
  if (Status status = b.open(options.b); !status.ok()) return fail(status);
  ReplayResult result;
  if (Status status = diff_recordings(a, b, result); !status.ok()) return fail(status);
  const int printed =
      options.json ? print_json(divergence_json(result)) : print_text(divergence_text(result, "compared"));
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
