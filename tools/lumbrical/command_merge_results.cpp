// lumbrical merge-results: what shards of `replay --results` and `run --results` have found, as one list and
// in one sentence.
#include <filesystem>
#include <memory>
#include <set>
#include <string>
#include <vector>

#include "commands.h"
#include "output.h"
#include "replace_file.h"
#include "result_lines.h"
#include "switches.h"
#include "work_list.h"

namespace lumbrical::tool {
namespace {

struct MergeSwitches {
  std::vector<std::string> files;
  std::string list, output;
  bool json = false;
};

// Where a file is there already, it holds results and nothing else.
Status write_lines(const std::vector<Json>& results, const std::string& path) {
  std::vector<Json> before;
  if (std::filesystem::exists(path))
    if (Status status = read_results({path}, before); !status.ok()) return status;
  std::string lines;
  for (const Json& result : results) lines += result.dump() + '\n';
  return replace_own_file(path, lines);
}

// Of the list, those without a result: what is to be run again.
std::vector<std::string> missing_of(const std::vector<std::string>& list, const std::vector<Json>& results) {
  std::set<std::string> there;
  for (const Json& result : results) there.insert(entry_of(result));
  std::vector<std::string> missing;
  for (const std::string& path : list)
    if (!there.contains(told_entry(path))) missing.push_back(path);
  return missing;
}

// Of all hands. A what-if goes on where the comparison of bits has ended, at the first difference.
std::uint64_t ticks_of(const Json& result) {
  if (result.contains("hands") && !result.contains("scene")) {
    std::uint64_t ticks = 0;
    for (const Json& hand : result["hands"]) ticks += ticks_of(hand);
    return ticks;
  }
  const Json& of =
      result.contains("what_if") && result["what_if"].contains("ticks") ? result["what_if"] : result;
  return of.value("ticks", std::uint64_t{0});
}

int merge_results(const MergeSwitches& switches) {
  if (Status status = check_apart({switches.output, switches.list == "-" ? "" : switches.list}); !status.ok())
    return fail(status);
  std::vector<Json> results;
  std::vector<std::string> list;
  if (Status status = read_results(switches.files, results); !status.ok()) return fail(status);
  if (!switches.list.empty())
    if (Status status = read_list(switches.list, list); !status.ok()) return fail(status);
  if (!switches.output.empty())
    if (Status status = write_lines(results, switches.output); !status.ok()) return fail(status);
  const std::vector<std::string> missing = missing_of(list, results);
  std::size_t sessions = 0, identical = 0, diverged = 0, changed = 0, failed = 0;
  std::uint64_t ticks = 0;
  for (const Json& result : results) {
    const Verdict verdict = verdict_of(result);
    const bool session = result.contains("scene");
    sessions += session ? 1 : 0;
    if (verdict.failed)
      ++failed;
    else if (!session)
      ++(verdict.diverged ? diverged : result.value("identical", false) ? identical : changed);
    if (!verdict.failed) ticks += ticks_of(result);
  }
  const Json json = {{"recordings", results.size() - sessions},
                     {"sessions", sessions},
                     {"identical", identical},
                     {"diverged", diverged},
                     {"changed", changed},
                     {"failed", failed},
                     {"ticks", ticks},
                     {"missing", missing}};
  if (const int printed = print_json(json); printed != kDone) return printed;
  return diverged > 0 ? kDiverged : failed > 0 || !missing.empty() ? kUnreadable : kDone;
}

}  // namespace

void add_merge_results(Command& app, int& exit_code) {
  const auto switches = std::make_shared<MergeSwitches>();
  Command* const command = app.add_subcommand(
      "merge-results", "Put the results of shards of replay or run together, and tell what is missing");
  command->add_option("results", switches->files, "Files of replay --results or run --results")
      ->required()
      ->type_name("RESULTS.jsonl");
  command->add_option("--list", switches->list, "The list that the shards are of, to tell what is missing")
      ->check(is_path())
      ->type_name("LIST");
  command
      ->add_option(
          "--output,-o", switches->output,
          "All of them, the newest of each recording or scene, by name; in the place of a file that is there")
      ->check(is_file())
      ->type_name("ALL.jsonl");
  command->add_flag("--json", switches->json, "Print one JSON object, as without it");
  command->callback([switches, &exit_code] { exit_code = merge_results(*switches); });
}

}  // namespace lumbrical::tool
