// The lumbrical program: one subcommand per file, put together here.
#include <csignal>
#include <exception>

#include "commands.h"
#include "output.h"

int main(int argc, char** argv) {
  using namespace lumbrical::tool;
  // A closed pipe or a file-size limit is then an error that write() reports, not the end of the process: the
  // recording is closed properly and the exit code tells.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);

  CLI::App app("Computes what a whole human hand feels when it touches a polygonal world.", "lumbrical");
  app.set_version_flag("--version", "lumbrical " LUMBRICAL_VERSION);
  app.require_subcommand(0, 1);  // none is refused below: so a misspelt one is named
  app.footer(
      "Every subcommand has its own --help. Exit codes: 0 done, 2 bad input or usage, 3 replay diverged.");
  int exit_code = kDone;
  try {
    add_run(app, exit_code);
    add_replay(app, exit_code);
    add_diff(app, exit_code);
    add_info(app, exit_code);
    add_verify(app, exit_code);
    add_recover(app, exit_code);
    add_export(app, exit_code);
    add_trim(app, exit_code);
    add_split(app, exit_code);
    add_merge(app, exit_code);
    add_compress(app, exit_code);
    add_probe(app, exit_code);
    add_inspect(app, exit_code);
    add_world(app, exit_code);
    add_sim_device(app, exit_code);
    add_report(app, exit_code);
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) throw CLI::RequiredError("A subcommand");
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? kDone : kUnreadable;
  } catch (const std::exception& error) {
    return fail(std::string("lumbrical: ") + error.what());
  }
  return exit_code;
}
