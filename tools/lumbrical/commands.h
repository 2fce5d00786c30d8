// The subcommands of the lumbrical program, one file each; main.cpp puts them together.
#pragma once

#include <CLI/CLI.hpp>

namespace lumbrical::tool {

/// Exit codes of the command-line contract.
enum ExitCode : int { kDone = 0, kFailed = 1, kUnreadable = 2, kDiverged = 3 };

/// Each adds its subcommand to the app and stores the exit code of its run in `exit_code`.
void add_run(CLI::App& app, int& exit_code);
void add_replay(CLI::App& app, int& exit_code);
void add_diff(CLI::App& app, int& exit_code);
void add_info(CLI::App& app, int& exit_code);
void add_verify(CLI::App& app, int& exit_code);
void add_recover(CLI::App& app, int& exit_code);
void add_export(CLI::App& app, int& exit_code);
void add_trim(CLI::App& app, int& exit_code);
void add_split(CLI::App& app, int& exit_code);
void add_merge(CLI::App& app, int& exit_code);
void add_compress(CLI::App& app, int& exit_code);
void add_probe(CLI::App& app, int& exit_code);
void add_inspect(CLI::App& app, int& exit_code);
void add_sim_device(CLI::App& app, int& exit_code);
void add_report(CLI::App& app, int& exit_code);
void add_world(CLI::App& app, int& exit_code);

}  // namespace lumbrical::tool
