// The lumbrical program: its subcommands (command_*.cpp), put together here.
#include <fcntl.h>
#include <unistd.h>

#include <csignal>
#include <exception>
#include <string>
#include <string_view>

#include "commands.h"
#include "lumbrical/ways_out.h"
#include "lumbrical/world.h"
#include "output.h"
#include "version.h"

namespace {

using namespace lumbrical::tool;

const Program kProgram = {
    "lumbrical", version_text(), "Computes what a whole human hand feels when it touches a polygonal world.",
    "Every subcommand has its own --help. A scene, motion or mesh named - is read from standard input. Exit "
    "codes: 0 done, 2 bad input or usage, 3 replay diverged, 4 no forces reached the device, 5 ticks are "
    "missing, 130 stopped by a signal."};

void add_commands(Command& root, int& exit_code) {
  add_run(root, exit_code);
  add_replay(root, exit_code);
  add_diff(root, exit_code);
  add_info(root, exit_code);
  add_verify(root, exit_code);
  add_recover(root, exit_code);
  add_export(root, exit_code);
  add_trim(root, exit_code);
  add_split(root, exit_code);
  add_merge(root, exit_code);
  add_merge_results(root, exit_code);
  add_compress(root, exit_code);
  add_probe(root, exit_code);
  add_inspect(root, exit_code);
  add_world(root, exit_code);
  add_sim_device(root, exit_code);
  add_guard(root, exit_code);
  add_report(root, exit_code);
  add_view(root, exit_code);
}

// Where one is closed the next file that is opened, a recording or a device's connection, would take its
// number, and what is told would go there. The wrong way round: using a closed one stays an error.
void fill_standard_streams() {
  for (int file = STDIN_FILENO; file <= STDERR_FILENO; ++file) {
    if (fcntl(file, F_GETFD) >= 0) continue;
    if (open("/dev/null", file == STDIN_FILENO ? O_WRONLY : O_RDONLY) < 0) return;
  }
}

}  // namespace

int main(int argc, char** argv) {
  fill_standard_streams();
  // A closed pipe or a file-size limit is then an error that write() reports, not the end of the process: the
  // recording is closed properly and the exit code tells.
  std::signal(SIGPIPE, SIG_IGN);
  std::signal(SIGXFSZ, SIG_IGN);
  for (int i = 1; i < argc; ++i)
    if (std::string_view(argv[i]) == "--json") failures_as_json();
  lumbrical::mend_bus_errors(lumbrical::replace_lost_page);
  int exit_code = kDone;
  try {
    const auto add = [&exit_code](Command& root) { add_commands(root, exit_code); };
    const std::string fault = run_command_line(kProgram, argc, argv, add);
    if (!fault.empty()) exit_code = fail(fault);
  } catch (const std::exception& error) {
    exit_code = fail(std::string("lumbrical: ") + error.what());
  }
  if (exit_code != kUnreadable && lumbrical::any_page_lost()) {
    exit_code =
        fail("lumbrical: a world file was shortened while it was read: nothing said above can be trusted");
  }
  return finish(exit_code);
}
