// Tables of posed hands and contact points.
#include <array>
#include <charconv>
#include <new>
#include <string>
#include <vector>

#include "files/text_output.h"
#include "lumbrical/recording.h"
#include "recording/hand_views.h"

namespace lumbrical {
namespace {

struct ViewColumn {
  const char* name;
  const char* unit;
};

constexpr ViewColumn kPoseColumns[] = {{"x", "m"},
                                       {"y", "m"},
                                       {"z", "m"},
                                       {"orientation.w", ""},
                                       {"orientation.x", ""},
                                       {"orientation.y", ""},
                                       {"orientation.z", ""}};
constexpr ViewColumn kContactColumns[] = {{"x", "m"},       {"y", "m"},       {"z", "m"},
                                          {"force.x", "N"}, {"force.y", "N"}, {"force.z", "N"},
                                          {"depth", "m"},   {"area", "m^2"},  {"triangle", ""}};

std::string number(double value, bool exact) {
  std::array<char, 32> text;
  const auto result = exact ? std::to_chars(text.data(), text.data() + text.size(), value)
                            : std::to_chars(text.data(), text.data() + text.size(), value + 0.0,
                                            std::chars_format::general, 6);
  return {text.data(), result.ptr};
}

/// Lines of one message: what they are of (joint or segment), and their numbers.
class ViewTable {
 public:
  ViewTable(const RecordingReader& reader, MessageKind kind, const ExportOptions& options, TextOutput& out)
      : reader_(reader),
        options_(options),
        part_(kind == MessageKind::pose ? "joint" : "segment"),
        columns_(kind == MessageKind::pose ? std::span<const ViewColumn>(kPoseColumns)
                                           : std::span<const ViewColumn>(kContactColumns)),
        out_(out) {}

  Status head() {
    if (options_.format == ExportFormat::json) return {};
    std::string line = "tick,time [s],hand," + part_;
    for (const auto& [name, unit] : columns_)
      line += std::string(",") + name + (*unit != 0 ? std::string(" [") + unit + "]" : "");
    return out_.line(line);
  }

  Status line(const RecordedMessage& message, std::string_view part, std::span<const double> numbers) {
    const std::string time =
        number(static_cast<double>(message.tick) / reader_.scene().settings.rate, options_.exact);
    const std::string hand(side_name(reader_.info().hands[message.hand]));
    const bool json = options_.format == ExportFormat::json;
    const auto text = [json](std::string_view key, const std::string& value, bool quoted) {
      if (!json) return value;
      return '"' + std::string(key) + "\":" + (quoted ? '"' + value + '"' : value);
    };
    std::string line = text("tick", std::to_string(message.tick), false) + ',' + text("time", time, false) +
                       ',' + text("hand", hand, true) + ',' + text(part_, std::string(part), true);
    for (std::size_t i = 0; i < numbers.size(); ++i)
      line += ',' + text(columns_[i].name, number(numbers[i], options_.exact || json), false);
    return out_.line(json ? '{' + line + '}' : line);
  }

  Status lines(const RecordedMessage& message, const std::vector<Pose>& joints) {
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const auto& [p, q] = joints[j];
      const double numbers[] = {p.x, p.y, p.z, q.w, q.x, q.y, q.z};
      if (Status status = line(message, joint_name(static_cast<int>(j)), numbers); !status.ok())
        return status;
    }
    return {};
  }

  Status lines(const RecordedMessage& message, const std::vector<ContactPoint>& points) {
    for (const ContactPoint& c : points) {
      const double numbers[] = {c.centre.x, c.centre.y, c.centre.z,
                                c.force.x,  c.force.y,  c.force.z,
                                c.depth,    c.area,     static_cast<double>(c.triangle)};
      if (Status status = line(message, segment_name(static_cast<int>(c.segment)), numbers); !status.ok())
        return status;
    }
    return {};
  }

 private:
  const RecordingReader& reader_;
  const ExportOptions& options_;
  std::string part_;
  std::span<const ViewColumn> columns_;
  TextOutput& out_;
};

Status write_views(RecordingReader& reader, MessageKind kind, const ExportOptions& options, TextOutput& out) {
  ViewTable table(reader, kind, options, out);
  if (Status status = table.head(); !status.ok()) return status;
  if (Status status = reader.seek(options.first); !status.ok()) return status;
  std::vector<Pose> joints;
  std::vector<ContactPoint> points;
  while (out.wanted()) {
    RecordedMessage message;
    bool end = false;
    if (Status status = reader.next_message(message, end); !status.ok()) return status;
    if (end || message.tick > options.last) return {};
    if (message.kind != kind || (message.tick - options.first) % options.step != 0) continue;
    Status status = kind == MessageKind::pose ? decode_pose(message.bytes, joints)
                                              : decode_contacts(message.bytes, points);
    if (status.ok())
      status = kind == MessageKind::pose ? table.lines(message, joints) : table.lines(message, points);
    if (!status.ok()) return status;
  }
  return {};
}

}  // namespace

Status export_views(RecordingReader& reader, MessageKind kind, const ExportOptions& options,
                    const std::string& output) try {
  const bool poses = kind == MessageKind::pose;
  if (poses ? !reader.info().has_poses : !reader.info().has_contacts)
    return Status::error(reader.info().path + ": holds no " + (poses ? "posed hands" : "contact points") +
                         "; record them with lumbrical run " +
                         (poses ? "--record-poses" : "--record-contacts") + " RATE");
  if (options.format == ExportFormat::npz)
    return Status::error("posed hands and contact points are written as csv or json");
  TextOutput out;
  if (Status status = out.open(output); !status.ok()) return status;
  Status status = write_views(reader, kind, options, out);
  if (status.ok()) status = out.close();
  if (!status.ok()) out.discard();
  return status;
} catch (const std::bad_alloc&) {
  return Status::error(output + ": not enough memory to export the recording");
}

}  // namespace lumbrical
