// Export of a recording as text: CSV for spreadsheets, JSON lines for scripts.
#include <array>
#include <cstdio>
#include <filesystem>
#include <new>
#include <string>
#include <string_view>
#include <system_error>
#include <type_traits>

#include "files/text_output.h"
#include "lumbrical/recording.h"
#include "recording/record_fields.h"

namespace lumbrical {
namespace {

std::string csv_header() {
  std::string line = "tick,duration_ns";
  for (int i = 1; i < kInputFieldCount; ++i) line += ",device." + input_field_name(i);
  for (int i = 0; i < kOutputFieldCount; ++i) line += ",output." + output_field_name(i);
  for (int i = 0; i < kStageCount; ++i) line += ",hash." + std::string(stage_name(static_cast<Stage>(i)));
  return line + ",hash.state";
}

std::string csv_line(const TickRecord& record) {
  const InputFields input = input_fields(record);
  const OutputFields output = output_fields(record.output);
  std::string line = std::to_string(record.output.tick) + ',' + std::to_string(record.duration_ns);
  for (int i = 1; i < kInputFieldCount; ++i) line += ',' + input_field_text(i, input[i]);
  for (int i = 0; i < kOutputFieldCount; ++i) {
    line += ',';
    if (record.has_forces || i < kFirstForce) line += output_field_text(i, output[i]);
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
  template <class Numbers>
  JsonLine& numbers(std::string_view key, const Numbers& values) {
    open(key, '[');
    for (const auto value : values) number("", value);
    return close(']');
  }
  JsonLine& vector(std::string_view key, Vec3 v) { return numbers(key, std::array{v.x, v.y, v.z}); }
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

void add_device(const DeviceFrame& device, JsonLine& json) {
  const Quat q = device.base.orientation;
  json.open("device", '{').open("base", '{').vector("position", device.base.position);
  json.numbers("orientation", std::array{q.w, q.x, q.y, q.z}).close('}');
  json.string("kind", device.kind == InputKind::joint_poses ? "joint_poses" : "joint_angles");
  json.number("flags", device.flags).number("valid", device.valid).open("joint", '[');
  for (const JointPose& joint : device.joint)
    json.open("", '{')
        .numbers("position", joint.position)
        .numbers("orientation", joint.orientation)
        .close('}');
  json.close(']').numbers("angle", device.angle).close('}');
}

void add_output(const TickRecord& record, JsonLine& json) {
  const ActuatorFrame& output = record.output;
  json.open("output", '{')
      .number("flags", output.flags)
      .number("contact_count", output.contact_count)
      .number("force_error", output.force_error);
  if (!record.has_forces) {
    json.null("segment").null("joint_torque").null("flexion_torque").close('}');
    return;
  }
  json.open("segment", '[');
  for (const Wrench& wrench : output.segment)
    json.open("", '{').vector("force", wrench.force).vector("torque", wrench.torque).close('}');
  json.close(']').open("joint_torque", '[');
  for (const Vec3 torque : output.joint_torque) json.vector("", torque);
  json.close(']').numbers("flexion_torque", output.flexion_torque).close('}');
}

std::string json_line(const TickRecord& record) {
  JsonLine json;
  json.open("", '{').number("tick", record.output.tick).number("duration_ns", record.duration_ns);
  add_device(record.device, json);
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
  std::error_code ignored;
  if (std::filesystem::equivalent(reader.info().path, output, ignored))
    return Status::error(output + ": is the recording itself; name another file to write to");
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
