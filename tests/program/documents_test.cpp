// README and docs, command by command: every block of commands runs as it is printed, every scene in them
// runs, and every switch they name is there.
#include <algorithm>
#include <fstream>
#include <regex>
#include <string>
#include <vector>

#include "program.h"
#include "reserved_port.h"

namespace lumbrical::test {
namespace {

namespace fs = std::filesystem;

const fs::path kRoot = LUMBRICAL_SOURCE_DIR;

struct Block {
  std::string document, language, text;
  std::size_t line = 0;
  [[nodiscard]] std::string place() const { return document + ":" + std::to_string(line); }
};

// README first: its commands make what others use.
std::vector<fs::path> documents() {
  std::vector<fs::path> paths;
  for (const auto& entry : fs::directory_iterator(kRoot / "docs"))
    if (entry.path().extension() == ".md") paths.push_back(entry.path());
  std::sort(paths.begin(), paths.end());
  paths.insert(paths.begin(), kRoot / "README.md");
  return paths;
}

std::vector<Block> blocks() {
  std::vector<Block> found;
  for (const fs::path& path : documents()) {
    std::istringstream lines(read_file(path));
    bool inside = false;
    std::size_t number = 0;
    for (std::string line; std::getline(lines, line);) {
      ++number;
      if (line.starts_with("```")) {
        inside = !inside;
        if (inside) found.push_back({path.filename().string(), line.substr(3), "", number});
      } else if (inside) {
        found.back().text += line + "\n";
      }
    }
  }
  return found;
}

// A source tree with the program where README says it is.
fs::path tree() {
  const fs::path folder = fresh_folder();
  for (const char* const part : {"examples", "recordings"})
    fs::copy(kRoot / part, folder / part, fs::copy_options::recursive);
  for (const auto& entry : fs::directory_iterator(folder / "recordings"))
    if (!entry.path().filename().string().starts_with("sample.")) fs::remove(entry);  // the user's own
  fs::create_directories(folder / "bench");
  fs::create_directory_symlink(kRoot / "bench" / "results", folder / "bench" / "results");
  fs::create_directories(folder / "build/release/tools");
  fs::create_symlink(LUMBRICAL_PROGRAM, folder / "build/release/tools/lumbrical");
  return folder;
}

// What a line is to exit with: 0, unless it says so.
std::string expected_code(const std::string& line) {
  static const std::regex pattern(R"(\(exit code (\d+)\))");
  std::smatch match;
  return std::regex_search(line, match, pattern) ? match[1].str() : "0";
}

// The block's lines as they are printed; behind each its exit code is looked at. The port alone is another,
// since others on this machine may run the same test.
std::string script_of(const Block& block, const std::string& port) {
  std::string script =
      "trap 'kill $(jobs -p) 2>/dev/null; wait' EXIT\n"
      "check() { [ $1 = $2 ] || printf 'exit code %s in the place of %s: %s\\n' \"$@\" >>failures; }\n"
      // A busy machine may be so late that forces are let go of in the end, which is what it should do. That
      // they never reached the device is no excuse: the exit code is the same, what the summary says is not.
      "let_go_at_last() { [ $1 = 4 ] && grep -q '^trouble  *forces no longer reached the device: ' told; }\n";
  std::istringstream lines(block.text);
  for (std::string line; std::getline(lines, line);) {
    std::string quoted_line;
    for (const char c : line) quoted_line += c == '\'' ? std::string("'\\''") : std::string(1, c);
    const std::string command = std::regex_replace(line, std::regex("1502"), port);
    if (line.find("--sink") == line.npos) {
      script += command + "\ncode=$?\n";
    } else {
      script += "{\n" + command + "\n} >told\ncode=$?\ncat told\nlet_go_at_last $code && code=0\n";
    }
    script += "check $code " + expected_code(line) + " '" + quoted_line + "'\n";
  }
  return script;
}

TEST(Documents, EveryCommandRunsAsPrintedInItsOrder) {
  const fs::path folder = tree();
  const ReservedPort reserved;
  const std::string port = std::to_string(reserved.number());
  std::size_t commands = 0;
  for (const Block& block : blocks()) {
    const bool names_program = std::regex_search(block.text, std::regex("(^|\n)lumbrical "));
    // What takes longer than a test may, or names what nobody has, is marked as text and read only.
    EXPECT_TRUE(!names_program || block.language == "sh" || block.language == "text") << block.place();
    if (block.language != "sh") continue;
    SCOPED_TRACE(block.place());
    fs::remove(folder / "failures");
    std::ofstream(folder / "block.sh") << script_of(block, port);
    const Outcome outcome =
        shell("PATH=\"$PWD/build/release/tools:$PATH\" timeout 250 bash block.sh", folder);
    EXPECT_EQ(read_file(folder / "failures"), "") << outcome.output << outcome.error;
    EXPECT_NE(outcome.exit_code, 124) << "it takes too long";
    commands += static_cast<std::size_t>(std::count(block.text.begin(), block.text.end(), '\n'));
  }
  EXPECT_GT(commands, 20u);
  EXPECT_GT(fs::file_size(folder / "recordings/part.csv"), 1000u);
}

TEST(Documents, EverySceneInThemRuns) {
  const fs::path folder = tree();
  std::size_t scenes = 0;
  for (const Block& block : blocks()) {
    if (block.language != "json" || block.text.find("\"objects\"") == std::string::npos) continue;
    std::ofstream(folder / "examples/printed.json") << block.text;
    const Outcome run = shell("lumbrical run examples/printed.json --ticks 20 --json", folder);
    EXPECT_EQ(run.exit_code, 0) << block.place() << "\n" << run.error;
    ++scenes;
  }
  EXPECT_GE(scenes, 2u);
}

// Those files are built and run (examples.* in tests/CMakeLists.txt).
TEST(Documents, EveryProgramInThemIsAPartOfAnExample) {
  std::vector<std::string> examples;
  for (const auto& entry : fs::recursive_directory_iterator(kRoot / "examples"))
    if (entry.is_regular_file()) examples.push_back(read_file(entry.path()));
  std::size_t programs = 0;
  for (const Block& block : blocks()) {
    if (block.language != "cpp" && block.language != "c" && block.language != "python") continue;
    const bool found = std::any_of(examples.begin(), examples.end(), [&](const std::string& text) {
      return text.find(block.text) != std::string::npos;
    });
    EXPECT_TRUE(found) << block.place() << "\n" << block.text;
    ++programs;
  }
  EXPECT_GE(programs, 3u);
}

TEST(Documents, EverySwitchTheyNameIsThere) {
  const fs::path folder = fresh_folder();
  static const std::regex command("`lumbrical ([a-z-]+)([^`]*)`");
  static const std::regex name("--[a-z][a-z-]*");
  std::size_t found = 0;
  for (const fs::path& path : documents()) {
    const std::string text = read_file(path);
    for (std::sregex_iterator it(text.begin(), text.end(), command), end; it != end; ++it) {
      const std::string verb = (*it)[1], rest = (*it)[2];
      if (verb.starts_with("-")) continue;
      const Outcome help = shell("lumbrical " + verb + " --help", folder);
      EXPECT_EQ(help.exit_code, 0) << path << ": " << it->str();
      for (std::sregex_iterator option(rest.begin(), rest.end(), name); option != end; ++option, ++found)
        EXPECT_NE(help.output.find(option->str()), std::string::npos) << path << ": " << it->str();
    }
  }
  EXPECT_GT(found, 3u);
}

TEST(Samples, AreWhatTheirProgramWrites) {
  const fs::path folder = fresh_folder();
  ASSERT_EQ(shell(std::string("'") + LUMBRICAL_MAKE_SAMPLES + "' .", folder).exit_code, 0);
  std::size_t files = 0;
  for (const auto& entry : fs::directory_iterator(folder)) {
    const std::string name = entry.path().filename().string();
    if (name == "stdout" || name == "stderr") continue;
    EXPECT_EQ(read_file(entry.path()), read_file(kRoot / "examples" / name)) << name;
    ++files;
  }
  EXPECT_EQ(files, 12u);
}

TEST(Samples, AreTouchedByTheirMotions) {
  for (const char* const scene : {"cup", "stone"}) {
    const Outcome run =
        shell("lumbrical run '" + (kRoot / "examples" / scene).string() + ".json' --json", fresh_folder());
    ASSERT_EQ(run.exit_code, 0) << run.error;
    EXPECT_GT(run.json()["peak_force"]["index"], 0.1) << scene;
    EXPECT_LT(run.json()["peak_force"]["index"], 10) << scene;
  }
}

}  // namespace
}  // namespace lumbrical::test
