// The subcommands of the lumbrical program, in the files command_*.cpp; main.cpp puts them together.
#pragma once

#include "command_line.h"

namespace lumbrical::tool {

/// Exit codes of the command-line contract; README.md has the same table.
enum ExitCode : int {
  kDone = 0,
  kUnreadable = 2,     ///< bad input or usage, or a file that can't be read or written
  kDiverged = 3,       ///< replay or diff found a difference, report --fail-on-slower a slower benchmark
  kNoForces = 4,       ///< run: a device was to be driven, and forces never or no longer reached it
  kTicksMissing = 5,   ///< verify: whole, but not all ticks are there; recover: not all could be kept
  kInterrupted = 130,  ///< a signal ended it early: run with everything written, others with no file
};

/// Each adds its subcommand to the app and stores the exit code of its run in `exit_code`.
void add_run(Command& app, int& exit_code);
void add_replay(Command& app, int& exit_code);
void add_diff(Command& app, int& exit_code);
void add_info(Command& app, int& exit_code);
void add_verify(Command& app, int& exit_code);
void add_recover(Command& app, int& exit_code);
void add_export(Command& app, int& exit_code);
void add_trim(Command& app, int& exit_code);
void add_split(Command& app, int& exit_code);
void add_merge(Command& app, int& exit_code);
void add_compress(Command& app, int& exit_code);
void add_merge_results(Command& app, int& exit_code);
void add_probe(Command& app, int& exit_code);
void add_inspect(Command& app, int& exit_code);
void add_sim_device(Command& app, int& exit_code);
void add_guard(Command& app, int& exit_code);
void add_report(Command& app, int& exit_code);
void add_world(Command& app, int& exit_code);
void add_view(Command& app, int& exit_code);

}  // namespace lumbrical::tool
