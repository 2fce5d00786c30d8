// Export of a recording as text: CSV for spreadsheets, JSON lines for scripts.
#include <cstdio>
#include <new>
#include <string>
#include <string_view>
#include <type_traits>

#include "files/text_output.h"
#include "lumbrical/recording.h"
#include "recording/record_fields.h"

namespace lumbrical {
namespace {

// Columns of a struct's numbers but the first, which is the tick's: "device.base.position.x [m]".
template <class T>
std::string csv_names(const char* owner) {
  std::string names;
  const std::vector<NumberField>& fields = fields_of<T>();
  for (std::size_t i = 1; i < fields.size(); ++i) {
    names += std::string(",") + owner + '.' + fields[i].name;
    if (!fields[i].unit.empty()) names += " [" + std::string(fields[i].unit) + ']';
  }
  return names;
}

std::string csv_header() {
  std::string line = "tick,duration_ns" + csv_names<TickInput>("device") + csv_names<ActuatorFrame>("output");
  for (int i = 0; i < kStageCount; ++i) line += ",hash." + std::string(stage_name(static_cast<Stage>(i)));
  return line + ",hash.state";
}

std::string csv_line(const TickRecord& record) {
  const InputFields input = input_fields(record);
  const OutputFields output = output_fields(record.output);
  std::string line = std::to_string(record.output.tick) + ',' + std::to_string(record.duration_ns);
  for (std::size_t i = 1; i < input.size(); ++i)
    line += ',' + number_text(fields_of<TickInput>()[i].type, input[i]);
  for (std::size_t i = 1; i < output.size(); ++i) {
    line += ',';
    if (record.has_forces || i < kFirstForce)
      line += number_text(fields_of<ActuatorFrame>()[i].type, output[i]);
  }
  for (const std::uint64_t hash : record.stage_hash) line += ',' + hash_text(hash);
  return line + ',' + hash_text(record.state_hash);
}

/// One line of JSON, written front to back.
class JsonLine {
 public:
  JsonLine& open(std::string_view key, char bracket) {
    name(key);
    text_ += bracket;
    return *this;
  }
  JsonLine& close(char bracket) {
    text_ += bracket;
    return *this;
  }
  /// Numbers that JSON has not (infinities, NaNs) become strings.
  template <class Number>
  JsonLine& number(std::string_view key, Number value) {
    std::string text;
    if constexpr (std::is_integral_v<Number>)
      text = std::to_string(value);
    else
      text = exact_text(value);
    const bool in_json = text.find_first_of("in") == std::string::npos;  // of "inf" and "nan"
    return in_json ? raw(key, text) : string(key, text);
  }
  JsonLine& string(std::string_view key, std::string_view value) {
    return raw(key, '"' + std::string(value) + '"');
  }
  JsonLine& null(std::string_view key) { return raw(key, "null"); }
  /// Numbers, arrays and structs by the lists of their fields; vectors and rotations as arrays.
  template <class T>
  JsonLine& value(std::string_view key, const T& value) {
    if constexpr (std::is_same_v<T, InputKind>) {
      return string(key, kind_name(value));
    } else if constexpr (Number<T>) {
      return number(key, value);
    } else if constexpr (Array<T>) {
      open(key, '[');
      for (const auto& element : value) this->value("", element);
      return close(']');
    } else {
      constexpr bool kNamed = !std::is_same_v<T, Vec3> && !std::is_same_v<T, Quat>;
      open(key, kNamed ? '{' : '[');
      list_fields(value, [this](const char* name, const char*, const auto& field) {
        this->value(kNamed ? name : "", field);
      });
      return close(kNamed ? '}' : ']');
    }
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  JsonLine& raw(std::string_view key, std::string_view value) {
    name(key);
    text_ += value;
    return *this;
  }
  void name(std::string_view key) {
    if (!text_.empty() && text_.back() != '{' && text_.back() != '[') text_ += ',';
    if (!key.empty()) text_ += '"' + std::string(key) + "\":";
  }

  std::string text_;
};

void add_output(const TickRecord& record, JsonLine& json) {
  json.open("output", '{');
  list_fields(record.output, [&](const char* name, const char*, const auto& field) {
    const bool force = Array<decltype(field)>;
    force && !record.has_forces ? json.null(name) : json.value(name, field);
  });
  json.close('}');
}

std::string json_line(const TickRecord& record) {
  JsonLine json;
  json.open("", '{').number("tick", record.output.tick).number("duration_ns", record.duration_ns);
  json.value("device", record.device);
  add_output(record, json);
  json.open("stage_hash", '{');
  for (int i = 0; i < kStageCount; ++i)
    json.string(stage_name(static_cast<Stage>(i)), hash_text(record.stage_hash[i]));
  json.close('}').string("state_hash", hash_text(record.state_hash)).close('}');
  return json.text();
}

Status write_lines(RecordingReader& reader, ExportFormat format, TextOutput& out) {
  if (Status status = reader.seek(0); !status.ok()) return status;
  if (format == ExportFormat::csv)
    if (Status status = out.line(csv_header()); !status.ok()) return status;
  for (;;) {
    TickRecord record;
    bool end = false;
    if (Status status = reader.next(record, end); !status.ok()) return status;
    if (end) return {};
    const std::string line = format == ExportFormat::csv ? csv_line(record) : json_line(record);
    if (Status status = out.line(line); !status.ok()) return status;
  }
}

}  // namespace

Status export_recording(RecordingReader& reader, ExportFormat format, const std::string& output) try {
  TextOutput out;
  if (Status status = out.open(output); !status.ok()) return status;
  Status status = write_lines(reader, format, out);
  if (status.ok()) status = out.close();
  if (!status.ok()) out.discard();
  return status;
} catch (const std::bad_alloc&) {
  return Status::error(output + ": not enough memory to export the recording");
}

}  // namespace lumbrical
