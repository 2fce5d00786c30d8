#include "model/json_text.h"

#include <nlohmann/json.hpp>

namespace lumbrical {
namespace {

using nlohmann::json;

// Byte of the first bracket nested too deeply, or npos: behind one that closes none it is no JSON any more.
std::size_t find_too_deep(std::string_view text, int deepest) {
  int depth = 0;
  bool in_string = false;
  for (std::size_t i = 0; i < text.size(); ++i) {
    const char c = text[i];
    if (in_string) {
      if (c == '\\') ++i;
      if (c == '"') in_string = false;
    } else if (c == '"') {
      in_string = true;
    } else if (c == '{' || c == '[') {
      if (++depth > deepest) return i;
    } else if (c == '}' || c == ']') {
      if (--depth < 0) return std::string_view::npos;
    }
  }
  return std::string_view::npos;
}

// Takes the events of the parser and keeps only where and why it stopped: what it throws doesn't tell where a
// number is too large.
struct ErrorFinder {
  JsonFault fault{};

  bool null() { return true; }
  bool boolean(bool) { return true; }
  bool number_integer(json::number_integer_t) { return true; }
  bool number_unsigned(json::number_unsigned_t) { return true; }
  bool number_float(json::number_float_t, const json::string_t&) { return true; }
  bool string(json::string_t&) { return true; }
  bool binary(json::binary_t&) { return true; }
  bool start_object(std::size_t) { return true; }
  bool key(json::string_t&) { return true; }
  bool end_object() { return true; }
  bool start_array(std::size_t) { return true; }
  bool end_array() { return true; }
  bool parse_error(std::size_t position, const std::string&, const json::exception& error) {
    const std::string_view text = error.what();
    const std::size_t dash = text.rfind(" - "), bracket = text.find("] ");
    const std::string_view reason = dash != text.npos      ? text.substr(dash + 3)
                                    : bracket != text.npos ? text.substr(bracket + 2)
                                                           : text;
    // It counts the characters read.
    fault = {position == 0 ? 0 : position - 1, "not valid JSON (" + std::string(reason) + ")"};
    return false;
  }
};

}  // namespace

JsonFault parse_json_text(std::string_view text, int deepest, json& root) {
  const std::size_t too_deep = find_too_deep(text, deepest);
  if (too_deep != text.npos)
    return {too_deep, "brackets are nested more than " + std::to_string(deepest) + " deep"};
  ErrorFinder finder;
  if (json::sax_parse(text, &finder)) root = json::parse(text, nullptr, false);
  return finder.fault;
}

}  // namespace lumbrical
