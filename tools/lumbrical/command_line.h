// Subcommands and their options as the commands declare them. CLI11 parses them in command_line.cpp and is
// seen by no other file: compiled into each command it took most of the program's build.
#pragma once

#include <deque>
#include <functional>
#include <initializer_list>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace lumbrical::tool {

/// What a value must be: `fault` says what is wrong with it, nothing if it is right, and may rewrite it;
/// `form` stands for it in --help.
struct Check {
  std::function<std::string(std::string&)> fault;
  std::string form;
};

Check one_of(std::initializer_list<std::string> values);

/// A switch or a positional argument. Everything returns the option itself, so that calls can be chained.
class Option {
 public:
  explicit Option(CLI::Option* option) : option_(option) {}
  Option* required();
  Option* check(const Check& check);
  Option* type_name(const std::string& name);  ///< of its value in --help
  Option* needs(const std::string& other);
  Option* excludes(const std::string& other);
  Option* expected(int count);    ///< values; -1: any number, but one at least
  Option* repeatable();           ///< one value each time
  Option* list();                 ///< values with commas between them
  Option* capture_default_str();  ///< --help shows the value that the variable has now

 private:
  CLI::Option* option_;
};

/// A command, or a group of its options.
class Command {
 public:
  explicit Command(CLI::App* app) : app_(app) {}
  Command* add_subcommand(const std::string& name, const std::string& help);
  Command* add_option_group(const std::string& name, const std::string& help);
  /// `value` is std::string, double, std::uint32_t, bool with add_flag, std::vector<std::string>, or
  /// std::optional of double, std::uint32_t, std::uint64_t; it lives until the command has run.
  template <class Value>
  Option* add_option(const std::string& name, Value& value, const std::string& help);
  void add_flag(const std::string& name, bool& value, const std::string& help);
  void require_option(int count);  ///< of the group's
  void allow_extras();             ///< takes arguments that no option names
  void callback(std::function<void()> run);
  /// Options given, in the order of the command line; a repeatable one as often as it was given.
  [[nodiscard]] std::vector<std::string> given() const;

 private:
  CLI::App* app_;
  std::deque<Option> options_;  // callers hold pointers into them
  std::deque<Command> commands_;
};

/// Ends a command's callback with a message about one option, or about one that is missing.
[[noreturn]] void refuse_option(const std::string& name, const std::string& message);
[[noreturn]] void demand_option(const std::string& what);

struct Program {
  std::string name, version, help, footer;
};

/// Parses and runs. What is wrong with the command line, and the name that may have been meant; empty where
/// nothing is, and after --help and --version, which are printed.
std::string run_command_line(const Program& program, int argc, char** argv,
                             const std::function<void(Command&)>& add_commands);

/// Parses a line of a file as if its words stood on the command line; quotes hold a word with blanks
/// together. What is wrong with it, as above.
std::string parse_line(const std::string& line, const std::function<void(Command&)>& add_options);

}  // namespace lumbrical::tool
