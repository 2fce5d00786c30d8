// See json_file.h.
#include "files/json_file.h"

#include <flatbuffers/idl.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <utility>

#include "base/whole_file.h"
#include "lumbrical/nearest_name.h"

namespace lumbrical {
namespace {

TextPlace place_of(std::string_view text, std::size_t offset) {
  TextPlace place;
  for (const char c : text.substr(0, offset)) {
    ++place.column;
    if (c == '\n') place = {place.line + 1, 1};
  }
  return place;
}

std::string prefix(const std::string& name, TextPlace place) {
  return name + ":" + std::to_string(place.line) + ":" + std::to_string(place.column) + ": ";
}

// Takes line and column off the parser's "12: 34: error: what".
TextPlace take_place(std::string_view& message) {
  TextPlace place;
  for (std::size_t* const target : {&place.line, &place.column}) {
    const auto result = std::from_chars(message.data(), message.data() + message.size(), *target);
    message.remove_prefix(static_cast<std::size_t>(result.ptr - message.data()));
    const std::size_t skipped = message.find_first_not_of(": ");
    message.remove_prefix(skipped == std::string_view::npos ? message.size() : skipped);
  }
  place.column = std::max<std::size_t>(place.column, 1);
  constexpr std::string_view kError = "error: ";
  if (message.starts_with(kError)) message.remove_prefix(kError.size());
  return place;
}

// Walks over JSON text without judging it.
class Walker {
 public:
  explicit Walker(std::string_view text) : text_(text) {}

  [[nodiscard]] std::size_t position() const { return position_; }

  // Steps to the value of a member or element of the value at hand; false, and the old position, if there is
  // none.
  bool enter(std::string_view key, std::size_t index) {
    const bool object = peek() == '{';
    return step([&](std::string_view name, std::size_t i) {
      return key.empty() ? !object && i == index : name == key;
    });
  }

  // Steps to the first value of a member or element for which `wanted` holds, or not at all.
  template <class Wanted>
  bool step(const Wanted& wanted) {
    const std::size_t start = position_;
    const bool object = peek() == '{';
    if (!object && peek() != '[') return false;
    ++position_;
    for (std::size_t i = 0; peek() != '}' && peek() != ']' && peek() != '\0'; ++i) {
      std::string_view name;
      if (object) {
        name = string();
        if (peek() == ':') ++position_;
        peek();
      }
      if (wanted(name, i)) return true;
      const std::size_t before = position_;
      skip_value();
      if (peek() == ',') ++position_;
      if (position_ == before) break;
    }
    position_ = start;
    return false;
  }

  // The value at hand, of a list or an object what it begins with; empty where that is no token of JSON.
  std::string_view token() {
    const std::size_t start = position_;
    if (peek() == '"') {
      string();
      const std::string_view quoted = text_.substr(start, std::exchange(position_, start) - start);
      return quoted.size() > 1 && quoted.ends_with('"') ? quoted : std::string_view();
    }
    if (peek() == '{' || peek() == '[') return text_.substr(start, 1);
    return text_.substr(start, text_.find_first_of(" \t\r\n,:]}/", start) - start);
  }

  // The next character after white space and comments; '\0' at the end.
  char peek() {
    while (position_ < text_.size()) {
      const std::string_view rest = text_.substr(position_);
      if (rest.starts_with("//")) {
        advance(rest.find('\n'), 1);
      } else if (rest.starts_with("/*")) {
        advance(rest.find("*/"), 2);
      } else if (rest.front() == ' ' || rest.front() == '\t' || rest.front() == '\n' ||
                 rest.front() == '\r') {
        ++position_;
      } else {
        return rest.front();
      }
    }
    return '\0';
  }

 private:
  void advance(std::size_t distance, std::size_t length) {
    position_ = distance == std::string_view::npos ? text_.size() : position_ + distance + length;
  }

  std::string_view string() {
    if (peek() != '"') return {};
    const std::size_t start = ++position_;
    while (position_ < text_.size() && text_[position_] != '"') position_ += text_[position_] == '\\' ? 2 : 1;
    if (position_ >= text_.size()) position_ = text_.size();
    const std::string_view content = text_.substr(start, position_ - start);
    if (position_ < text_.size()) ++position_;
    return content;
  }

  void skip_value() {
    std::size_t depth = 0;
    do {
      const char c = peek();
      if (c == '\0') return;
      if (c == '"') {
        string();
        continue;
      }
      if (c == '{' || c == '[') ++depth;
      if ((c == '}' || c == ']' || c == ',') && depth == 0) return;
      if (c == '}' || c == ']') --depth;
      ++position_;
    } while (depth > 0 || !at_delimiter());
  }

  bool at_delimiter() {
    const char c = peek();
    return c == ',' || c == '}' || c == ']' || c == '\0';
  }

  std::string_view text_;
  std::size_t position_ = 0;
};

std::size_t offset_of(std::string_view text, TextPlace place) {
  std::size_t start = 0;
  for (std::size_t line = 1; line < place.line; ++line)
    start = std::min(text.find('\n', start), text.size() - 1) + 1;
  return start + place.column;
}

template <class Number>
bool is_number(std::string_view text) {
  Number number{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size();
}

bool is_truth(std::string_view value) { return value == "true" || value == "false"; }

// What a value has to be that is not of its field's type; null where it is.
const char* wanted_for(const flatbuffers::Type& type, std::string_view value) {
  const char first = value.front();
  if (value == "null") return nullptr;
  if (type.base_type == flatbuffers::BASE_TYPE_STRUCT) return first == '{' ? nullptr : "an object, {...}";
  if (flatbuffers::IsVector(type)) return first == '[' ? nullptr : "a list, [...]";
  if (flatbuffers::IsString(type)) return first == '"' ? nullptr : "text, in quotes";
  if (flatbuffers::IsBool(type.base_type)) return is_truth(value) ? nullptr : "true or false";
  const bool quoted = first == '"';
  if (flatbuffers::IsFloat(type.base_type)) {
    if (!quoted && is_number<double>(value)) return nullptr;
    return value == "\"exact\"" ? "a number; 0 is exact" : "a number, without quotes";
  }
  if (!quoted && is_number<std::uint32_t>(value)) return nullptr;  // our schemas have no other whole numbers
  const bool digits = value.find_first_not_of("0123456789") == std::string_view::npos;
  return digits ? "far smaller" : "a whole number, in digits only";
}

// The same of what the parser takes for a number and is none: one in quotes, true and false.
const char* wanted_for_no_number(const flatbuffers::Type& type, std::string_view value) {
  const bool is_none = value.front() == '"' || is_truth(value);
  return is_none && flatbuffers::IsScalar(type.base_type) ? wanted_for(type, value) : nullptr;
}

using flatbuffers::StructDef;

const StructDef* table_in(const flatbuffers::Type& type) {
  const flatbuffers::Type inner = flatbuffers::IsVector(type) ? type.VectorType() : type;
  return inner.base_type == flatbuffers::BASE_TYPE_STRUCT ? inner.struct_def : nullptr;
}

// The table of the first object within the value at hand that has a member which is none of its fields; null
// where there is none.
const StructDef* table_without_field(Walker& walker, const StructDef& table) {
  const StructDef* found = nullptr;
  const bool list = walker.peek() == '[';
  walker.step([&](std::string_view key, std::size_t) {
    const flatbuffers::FieldDef* const field = list ? nullptr : table.fields.Lookup(std::string(key));
    const StructDef* const inner = list ? &table : field != nullptr ? table_in(field->value.type) : nullptr;
    if (!list && field == nullptr)
      found = &table;
    else if (inner != nullptr)
      found = table_without_field(walker, *inner);
    return found != nullptr;
  });
  return found;
}

// "; did you mean NAME?", "; it belongs to ..." where another table of the file has it, or all of the
// table's.
std::string fields_near(const std::string& name, const StructDef& table, const StructDef& root) {
  if (&table != &root && root.fields.Lookup(name) != nullptr)
    return "; it belongs to the " + lower_case(root.name) + " itself";
  std::vector<std::string> names;
  for (const flatbuffers::FieldDef* const field : table.fields.vec) names.push_back(field->name);
  std::sort(names.begin(), names.end());
  if (std::string meant = did_you_mean(name, names); !meant.empty()) return meant;
  for (const flatbuffers::FieldDef* const field : root.fields.vec) {
    const StructDef* const inner =
        flatbuffers::IsVector(field->value.type) ? nullptr : table_in(field->value.type);
    if (inner != nullptr && inner->fields.Lookup(name) != nullptr)
      return "; it belongs into \"" + field->name + '"';
  }
  std::string all = "; fields here are ";
  for (const std::string& field : names) all += (&field == names.data() ? "" : ", ") + field;
  return all;
}

std::string remedy_of(std::string_view message, const JsonFile& file, const StructDef& root,
                      const JsonSchema& schema) {
  constexpr std::string_view kUnknown = "unknown field: ";
  if (!message.starts_with(kUnknown)) return "";
  Walker walker(file.text);
  const StructDef* const table = table_without_field(walker, root);
  const std::string name(message.substr(kUnknown.size()));
  const std::string near = table == nullptr ? "" : fields_near(name, *table, root);
  return near + (near.ends_with('?') ? " " : "; ") + "schemas/" + schema.file + " lists the fields";
}

using WantedFor = const char* (*)(const flatbuffers::Type& type, std::string_view value);

// Steps to the first value before `end` that is not of its field's type, adds the way there to `path`, and
// tells what it has to be; null, and nothing has changed, if there is none.
const char* find_wrong_kind(Walker& walker, const flatbuffers::Type& type, WantedFor wanted_of,
                            std::size_t end, std::string& path) {
  const char* wanted = nullptr;
  walker.step([&](std::string_view key, std::size_t index) {
    const std::size_t length = path.size();
    const std::string_view value = walker.token();
    if (walker.position() >= end || value.empty()) return false;
    flatbuffers::Type inner;
    if (flatbuffers::IsVector(type)) {
      inner = type.VectorType();
      path += "[" + std::to_string(index) + "]";
    } else {
      const flatbuffers::FieldDef* const field = type.struct_def->fields.Lookup(std::string(key));
      if (field == nullptr) return false;
      inner = field->value.type;
      path.append(path.empty() ? "" : ".").append(key);
    }
    wanted = wanted_of(inner, value);
    if (wanted == nullptr && (value == "{" || value == "["))
      wanted = find_wrong_kind(walker, inner, wanted_of, end, path);
    if (wanted == nullptr) path.resize(length);
    return wanted != nullptr;
  });
  return wanted;
}

// "name:12:34: rate is ... but must be ...", of the first value before `end` that is; empty: none is.
std::string wrong_kind_of(const JsonFile& file, const flatbuffers::Parser& parser, WantedFor wanted_of,
                          std::size_t end) {
  const flatbuffers::Type root(flatbuffers::BASE_TYPE_STRUCT, parser.root_struct_def_);
  Walker walker(file.text);
  std::string path;
  const char* const wanted = find_wrong_kind(walker, root, wanted_of, end, path);
  if (wanted == nullptr) return {};
  const std::string_view value = walker.token();
  const std::string_view shown = value == "{" ? "an object" : value == "[" ? "a list" : value;
  return prefix(file.name, place_of(file.text, walker.position())) + path + " is " + std::string(shown) +
         " but must be " + wanted;
}

// People's editors understand "name:12:34: what". The parser looks at numbers once it has read the table that
// they are in: a value of a wrong kind is somewhere before the place that it tells.
std::string error_of(const JsonFile& file, const flatbuffers::Parser& parser, const JsonSchema& schema) {
  std::string_view message = parser.error_;
  const TextPlace place = take_place(message);
  std::string wrong = wrong_kind_of(file, parser, wanted_for, offset_of(file.text, place));
  if (!wrong.empty()) return wrong;
  return prefix(file.name, place) +
         std::string(message).append(remedy_of(message, file, *parser.root_struct_def_, schema));
}

std::string interval(const Range& range) {
  return text_of(range.low) + " .. " + text_of(range.high) + range.unit;
}

}  // namespace

TextPlace find_json_value(std::string_view text, std::string_view path) {
  Walker walker(text);
  walker.peek();
  while (!path.empty()) {
    std::size_t end = 0;
    bool found = false;
    if (path.front() == '[') {
      std::size_t index = 0;
      std::from_chars(path.data() + 1, path.data() + path.size(), index);
      end = path.find(']') == std::string_view::npos ? path.size() : path.find(']') + 1;
      found = walker.enter({}, index);
    } else {
      end = std::min(path.find_first_of(".["), path.size());
      found = walker.enter(path.substr(0, end), 0);
    }
    if (!found) break;
    path.remove_prefix(end);
    if (!path.empty() && path.front() == '.') path.remove_prefix(1);
  }
  return place_of(text, walker.position());
}

Status read_json_file(const std::string& path, const JsonSchema& schema, JsonFile& file) {
  file.name = shown_name(path);
  if (Status status = read_whole_file(path, kSmallFile, "a JSON file", file.text); !status.ok())
    return status;
  if (const std::size_t zero = file.text.find('\0'); zero != std::string::npos) {
    return Status::error(prefix(file.name, place_of(file.text, zero)) +
                         "holds a zero byte, so it is not a JSON text");
  }
  flatbuffers::IDLOptions options;
  options.strict_json = true;
  flatbuffers::Parser parser(options);
  const std::vector<std::uint8_t> aligned(schema.bytes.begin(), schema.bytes.end());
  if (!parser.Deserialize(aligned.data(), aligned.size()) || !parser.SetRootType(schema.root)) {
    return Status::error(std::string("the built-in schema of ") + schema.root +
                         " is damaged; rebuild the program");
  }
  if (!parser.ParseJson(file.text.c_str())) return Status::error(error_of(file, parser, schema));
  if (std::string wrong = wrong_kind_of(file, parser, wanted_for_no_number, file.text.size()); !wrong.empty())
    return Status::error(std::move(wrong));
  const std::uint8_t* const data = parser.builder_.GetBufferPointer();
  file.buffer.assign(data, data + parser.builder_.GetSize());
  return {};
}

void FieldReader::error(const std::string& path, const std::string& what) {
  if (!status_.ok()) return;
  const std::string subject = path.empty() ? std::string() : path + " ";
  status_ = Status::error(prefix(file_.name, find_json_value(file_.text, path)) + subject + what);
}

Status FieldReader::of_file(const std::string& path, const std::string& file, const Status& status) const {
  const std::string name = file + ":";
  const std::string& message = status.message();
  const bool placed = message.starts_with(name) && message[name.size()] != ' ';
  if (status.ok() || placed) return status;
  return Status::error(prefix(file_.name, find_json_value(file_.text, path)) + path + ": " + message);
}

void FieldReader::check(const Status& checked) {
  if (!status_.ok() || checked.ok()) return;
  const std::string_view message = checked.message();
  const std::string_view path = message.substr(0, message.find_first_of(" :"));
  status_ = Status::error(prefix(file_.name, find_json_value(file_.text, path)) + checked.message());
}

void FieldReader::number(flatbuffers::Optional<double> value, const std::string& path, Range range,
                         double& target) {
  if (!value.has_value()) return;
  if (range.holds(*value)) {
    target = *value;
  } else {
    error(path, "is " + text_of(*value) + " but must lie in " + interval(range));
  }
}

void FieldReader::zero_or_number(flatbuffers::Optional<double> value, const std::string& path, Range range,
                                 double& target) {
  if (!value.has_value()) return;
  if (*value == 0) {
    target = 0;
  } else if (range.holds(*value)) {
    target = *value;
  } else {
    error(path, "is " + text_of(*value) + " but must be 0 or lie in " + interval(range));
  }
}

void FieldReader::count(flatbuffers::Optional<std::uint32_t> value, const std::string& path, Range range,
                        std::uint32_t& target) {
  if (!value.has_value()) return;
  double number = target;
  this->number(flatbuffers::Optional<double>(*value), path, range, number);
  target = static_cast<std::uint32_t>(number);
}

void FieldReader::numbers(const flatbuffers::Vector<double>* values, const std::string& path, Range range,
                          std::span<double> target) {
  if (values == nullptr) return;
  if (values->size() != target.size()) {
    return error(path, "holds " + std::to_string(values->size()) + " numbers but needs " +
                           std::to_string(target.size()));
  }
  for (std::size_t i = 0; i < target.size(); ++i) {
    number(flatbuffers::Optional<double>(values->Get(static_cast<flatbuffers::uoffset_t>(i))),
           path + "[" + std::to_string(i) + "]", range, target[i]);
  }
}

void FieldReader::vector(const flatbuffers::Vector<double>* values, const std::string& path, Range range,
                         Vec3& target) {
  std::array<double, 3> v = {target.x, target.y, target.z};
  numbers(values, path, range, v);
  target = {v[0], v[1], v[2]};
}

void FieldReader::pose(const flatbuffers::Vector<double>* position, const std::string& position_path,
                       const flatbuffers::Vector<double>* orientation, const std::string& orientation_path,
                       Pose& target) {
  vector(position, position_path, {-1e6, 1e6}, target.position);
  if (orientation == nullptr) return;
  std::array<double, 4> q = {1, 0, 0, 0};
  numbers(orientation, orientation_path, {-1e6, 1e6}, q);
  if (q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3] < 1e-12) {
    return error(orientation_path, "is zero and so no rotation; write [1, 0, 0, 0] for none");
  }
  target.orientation = normalized({q[0], q[1], q[2], q[3]});
}

}  // namespace lumbrical
