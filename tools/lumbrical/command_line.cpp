// See command_line.h.
#include "command_line.h"

#include <CLI/CLI.hpp>
#include <cstdint>
#include <optional>
#include <utility>

namespace lumbrical::tool {

Check one_of(std::initializer_list<std::string> values) {
  const CLI::Validator member = CLI::IsMember(std::vector<std::string>(values));
  return {[member](std::string& text) { return member(text); }, member.get_description()};
}

Option* Option::required() {
  option_->required();
  return this;
}

Option* Option::check(const Check& check) {
  option_->check(CLI::Validator(check.fault, check.form));
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
  option_->expected(1)->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
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

bool run_command_line(const Program& program, int argc, char** argv,
                      const std::function<void(Command&)>& add_commands, int& exit_code) {
  CLI::App app(program.help, program.name);
  app.set_version_flag("--version", program.version);
  app.require_subcommand(0, 1);  // none is refused below: so a misspelt one is named
  app.footer(program.footer);
  Command root(&app);
  add_commands(root);
  try {
    app.parse(argc, argv);
    if (app.get_subcommands().empty()) demand_option("A subcommand");
  } catch (const CLI::ParseError& error) {
    exit_code = app.exit(error);
    return false;
  }
  return true;
}

}  // namespace lumbrical::tool
