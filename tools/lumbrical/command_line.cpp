// See command_line.h.
#include "command_line.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cerrno>
#include <cstdint>
#include <iostream>
#include <optional>
#include <utility>

#include "lumbrical/nearest_name.h"

namespace lumbrical::tool {

Check one_of(std::initializer_list<std::string> values) {
  const std::vector<std::string> names(values);
  std::string form;
  for (const std::string& name : names) form += (form.empty() ? "" : "|") + name;
  return {[names, form](std::string& text) -> std::string {
            if (std::find(names.begin(), names.end(), text) != names.end()) return {};
            return '"' + text + "\" is none of " + form + did_you_mean(text, names);
          },
          form};
}

Option* Option::required() {
  option_->required();
  return this;
}

Option* Option::check(const Check& check) {
  option_->transform(CLI::Validator(check.fault, ""));  // a check of CLI11's rewrites nothing
  option_->type_name(check.form);
  return this;
}

Option* Option::type_name(const std::string& name) {
  option_->type_name(name);
  return this;
}

Option* Option::needs(const std::string& other) {
  option_->needs(other);
  return this;
}

Option* Option::excludes(const std::string& other) {
  option_->excludes(other);
  return this;
}

Option* Option::expected(int count) {
  option_->expected(count);
  return this;
}

Option* Option::repeatable() {
  option_->expected(1)->allow_extra_args(false)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
  return this;
}

Option* Option::list() {
  repeatable();
  option_->delimiter(',');
  return this;
}

Option* Option::capture_default_str() {
  option_->capture_default_str();
  return this;
}

Command* Command::add_subcommand(const std::string& name, const std::string& help) {
  return &commands_.emplace_back(app_->add_subcommand(name, help));
}

Command* Command::add_option_group(const std::string& name, const std::string& help) {
  return &commands_.emplace_back(app_->add_option_group(name, help));
}

template <class Value>
Option* Command::add_option(const std::string& name, Value& value, const std::string& help) {
  return &options_.emplace_back(app_->add_option(name, value, help));
}

template Option* Command::add_option(const std::string&, std::string&, const std::string&);
template Option* Command::add_option(const std::string&, double&, const std::string&);
template Option* Command::add_option(const std::string&, std::uint32_t&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::uint32_t>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::uint64_t>&, const std::string&);

void Command::add_flag(const std::string& name, bool& value, const std::string& help) {
  app_->add_flag(name, value, help);
}

void Command::require_option(int count) { app_->require_option(count); }

void Command::allow_extras() { app_->allow_extras(); }

void Command::callback(std::function<void()> run) { app_->callback(std::move(run)); }

std::vector<std::string> Command::given() const {
  std::vector<std::string> names;
  for (const CLI::Option* const option : app_->parse_order()) names.push_back(option->get_name());
  return names;
}

void refuse_option(const std::string& name, const std::string& message) {
  throw CLI::ValidationError(name, message);
}

void demand_option(const std::string& what) { throw CLI::RequiredError(what); }

namespace {

// What the command line says that nothing here has, and the nearest there is.
std::string unexpected(const CLI::App& app) {
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  const CLI::App& command = chosen.empty() ? app : *chosen.front();
  std::vector<std::string> names;
  if (chosen.empty()) {
    for (const CLI::App* const subcommand : app.get_subcommands(nullptr))
      names.push_back(subcommand->get_name());
  }
  for (const CLI::Option* const option : command.get_options())
    for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  for (const CLI::App* const group : command.get_subcommands(nullptr)) {
    if (!group->get_name().empty()) continue;  // a group of options has no name
    for (const CLI::Option* const option : group->get_options())
      for (const std::string& name : option->get_lnames()) names.push_back("--" + name);
  }
  const std::vector<std::string> extra = app.remaining(true);
  if (extra.empty()) return "There is more on the command line than expected";
  const std::string word = extra.front().substr(0, extra.front().find('='));
  return "The following argument was not expected: " + word + did_you_mean(word, names);
}

// What --help and --version ask for.
std::string print_answer(const CLI::App& app, const CLI::ParseError& question) {
  app.exit(question);
  std::cout.flush();
  return std::cout || errno == EPIPE ? "" : "standard output: can't write the result; is the disk full?";
}

}  // namespace

std::string run_command_line(const Program& program, int argc, char** argv,
                             const std::function<void(Command&)>& add_commands) {
  CLI::App app(program.help, program.name);
  app.set_version_flag("--version", program.version);
  app.require_subcommand(0, 1);  // none is refused below: so a misspelt one is named
  app.footer(program.footer);
  Command root(&app);
  add_commands(root);
  std::string fault;
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) demand_option("A subcommand");
    return {};
  } catch (const CLI::ParseError& error) {
    if (error.get_exit_code() == 0) return print_answer(app, error);
    // What is missing may be there under a misspelt name, and what is too much be the value of such a one.
    fault = app.remaining(true).empty() ? error.what() : unexpected(app);
  }
  const std::vector<CLI::App*> chosen = app.get_subcommands();
  return fault + "; " + program.name + (chosen.empty() ? "" : " " + chosen.front()->get_name()) +
         " --help lists all there is";
}

std::string parse_line(const std::string& line, const std::function<void(Command&)>& add_options) {
  CLI::App app;
  app.set_help_flag();
  Command command(&app);
  add_options(command);
  try {
    app.parse(line);
    return {};
  } catch (const CLI::ExtrasError&) {
    return unexpected(app);
  } catch (const CLI::ParseError& error) {
    return error.what();
  }
}

}  // namespace lumbrical::tool
