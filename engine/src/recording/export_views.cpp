// Tables of posed hands and contact points.
#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <new>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/check_stop.h"
#include "files/text_output.h"
#include "lumbrical/recording.h"
#include "recording/chosen_ticks.h"
#include "recording/export_columns.h"
#include "recording/hand_views.h"
#include "recording/json_line.h"
#include "recording/npz_file.h"

namespace lumbrical {
namespace {

struct ViewColumn {
  const char* name;
  const char* unit;
  bool whole = false;
};

constexpr ViewColumn kPoseColumns[] = {{"x", "m"},
                                       {"y", "m"},
                                       {"z", "m"},
                                       {"orientation.w", ""},
                                       {"orientation.x", ""},
                                       {"orientation.y", ""},
                                       {"orientation.z", ""}};
constexpr ViewColumn kContactColumns[] = {
    {"x", "m"},       {"y", "m"},     {"z", "m"},      {"force.x", "N"},     {"force.y", "N"},
    {"force.z", "N"}, {"depth", "m"}, {"area", "m^2"}, {"object", "", true}, {"triangle", "", true}};

std::span<const ViewColumn> columns_of(MessageKind kind) {
  if (kind == MessageKind::pose) return kPoseColumns;
  return kContactColumns;
}
/// What the lines of a message are of.
const char* part_of(MessageKind kind) { return kind == MessageKind::pose ? "joint" : "segment"; }

/// One joint of a posed hand, or one contact point.
struct ViewRow {
  std::uint64_t tick = 0;
  double time = 0;  // [s]
  std::string_view hand, part;
  std::vector<double> numbers;  // of columns_of
};

bool has_segment(const ExportOptions& options, int segment) {
  const std::vector<int>& asked = options.segments;
  return asked.empty() || std::find(asked.begin(), asked.end(), segment) != asked.end();
}

using Readers = std::span<RecordingReader>;

/// `take(row)` for every row of the chosen ticks, front to back, until it fails or is `wanted()` no more.
template <class Take, class Wanted>
Status for_each_row(Readers readers, MessageKind kind, const ExportOptions& options, Take&& take,
                    Wanted&& wanted) {
  RecordingReader& reader = readers[0];  // it hands out the messages of all hands
  const auto is_asked_for = [readers](Side side) {
    for (const RecordingReader& asked : readers)
      if (asked.scene().hand.side == side) return true;
    return false;
  };
  if (Status status = reader.seek(options.first); !status.ok()) return status;
  std::vector<Pose> joints;
  std::vector<ContactPoint> points;
  ViewRow row;
  std::uint64_t found = 0;
  while (wanted()) {
    RecordedMessage message;
    bool end = false;
    if (Status status = check_stop(options.stop); !status.ok()) return status;
    if (Status status = reader.next_message(message, end); !status.ok()) return status;
    if (end || message.tick > options.last) return check_choice(reader.info(), found);
    const Side side = reader.info().hands[message.hand];
    if (!is_chosen(options, message.tick) || !is_asked_for(side)) continue;
    ++found;
    if (message.kind != kind) continue;
    joints.clear();
    points.clear();
    if (Status status = kind == MessageKind::pose ? decode_pose(message.bytes, joints)
                                                  : decode_contacts(message.bytes, points);
        !status.ok())
      return Status::error(reader.info().path + ": tick " + std::to_string(message.tick) + ": " +
                           status.message());
    row.tick = message.tick;
    row.time = static_cast<double>(message.tick) / reader.scene().settings.rate;
    row.hand = side_name(side);
    for (std::size_t j = 0; j < joints.size(); ++j) {
      const auto& [p, q] = joints[j];
      row.part = joint_name(static_cast<int>(j));
      row.numbers = {p.x, p.y, p.z, q.w, q.x, q.y, q.z};
      if (Status status = take(row); !status.ok()) return status;
    }
    for (const ContactPoint& c : points) {
      if (!has_segment(options, static_cast<int>(c.segment))) continue;
      row.part = segment_name(static_cast<int>(c.segment));
      row.numbers = {c.centre.x, c.centre.y, c.centre.z, c.force.x, c.force.y, c.force.z, c.depth, c.area};
      for (const std::uint32_t number : {c.object, c.triangle}) row.numbers.push_back(number);
      if (Status status = take(row); !status.ok()) return status;
    }
  }
  return {};
}

std::string csv_head(MessageKind kind) {
  std::string line = std::string("tick,time [s],hand,") + part_of(kind);
  for (const ViewColumn& column : columns_of(kind)) line += ',' + column_title(column.name, column.unit);
  return line;
}

std::string csv_line(const ViewRow& row, bool exact) {
  const auto number = [exact](double value) { return exact ? exact_text(value) : rounded_text(value); };
  std::string line = std::to_string(row.tick) + ',' + number(row.time);
  for (const std::string_view text : {row.hand, row.part}) line += ',' + std::string(text);
  for (const double value : row.numbers) line += ',' + number(value);
  return line;
}

std::string json_line(const ViewRow& row, MessageKind kind) {
  JsonLine json;
  json.open("", '{').number("tick", row.tick).number("time", row.time);
  json.string("hand", row.hand).string(part_of(kind), row.part);
  for (std::size_t i = 0; i < row.numbers.size(); ++i) json.number(columns_of(kind)[i].name, row.numbers[i]);
  return json.close('}').text();
}

Status write_text(Readers readers, MessageKind kind, const ExportOptions& options, TextOutput& out) {
  const bool json = options.format == ExportFormat::json;
  if (!json)
    if (Status status = out.line(csv_head(kind)); !status.ok()) return status;
  return for_each_row(
      readers, kind, options,
      [&](const ViewRow& row) {
        return out.line(json ? json_line(row, kind) : csv_line(row, options.exact));
      },
      [&] { return out.wanted(); });
}

// A row of an archive in memory, before its names are texts: so many fit.
struct PackedRow {
  std::uint64_t tick = 0, time = 0;
  std::string_view hand, part;
  std::array<std::uint64_t, std::size(kContactColumns)> number{};
};
constexpr std::size_t kMostRows = std::size_t{1} << 24;

Status write_rows(MessageKind kind, const std::vector<PackedRow>& rows, NpzFile& out) {
  Status status;
  std::vector<std::string> names, units;
  const auto add = [&](const char* name, const char* unit, const char* type, auto&& value_of) {
    std::vector<std::uint64_t> values;
    values.reserve(rows.size());
    for (const PackedRow& row : rows) values.push_back(value_of(row));
    if (status.ok()) status = out.add(name, type, values);
    names.emplace_back(name);
    units.emplace_back(unit);
  };
  const auto add_texts = [&](const char* name, auto&& text_of) {
    std::vector<std::string> texts;
    texts.reserve(rows.size());
    for (const PackedRow& row : rows) texts.emplace_back(text_of(row));
    if (status.ok()) status = out.add(name, texts);
    names.emplace_back(name);
    units.emplace_back();
  };
  add("tick", "", "<u8", [](const PackedRow& row) { return row.tick; });
  add("time", "s", "<f8", [](const PackedRow& row) { return row.time; });
  add_texts("hand", [](const PackedRow& row) { return row.hand; });
  add_texts(part_of(kind), [](const PackedRow& row) { return row.part; });
  const std::span<const ViewColumn> columns = columns_of(kind);
  for (std::size_t i = 0; i < columns.size(); ++i)
    add(columns[i].name, columns[i].unit, columns[i].whole ? "<u8" : "<f8",
        [i](const PackedRow& row) { return row.number[i]; });
  if (status.ok()) status = out.add("columns", names);
  return status.ok() ? out.add("units", units) : status;
}

Status write_npz(Readers readers, MessageKind kind, const ExportOptions& options, NpzFile& out) {
  std::vector<PackedRow> rows;
  Status status = for_each_row(
      readers, kind, options,
      [&](const ViewRow& row) {
        if (rows.size() == kMostRows)
          return Status::error("more than 16,777,216 lines; export fewer with --ticks");
        PackedRow& packed = rows.emplace_back();
        packed.tick = row.tick;
        packed.time = std::bit_cast<std::uint64_t>(row.time);
        packed.hand = row.hand;
        packed.part = row.part;
        for (std::size_t i = 0; i < row.numbers.size(); ++i)
          packed.number[i] = columns_of(kind)[i].whole ? static_cast<std::uint64_t>(row.numbers[i])
                                                       : std::bit_cast<std::uint64_t>(row.numbers[i]);
        return Status{};
      },
      [] { return true; });
  return status.ok() ? write_rows(kind, rows, out) : status;
}

}  // namespace

Status export_views(Readers readers, MessageKind kind, const ExportOptions& options,
                    const std::string& output) try {
  assert(!readers.empty());
  const bool poses = kind == MessageKind::pose;
  const RecordingInfo& info = readers[0].info();
  if (Status status = check_step(options); !status.ok()) return status;
  if (!options.columns.empty() || (poses && !options.segments.empty()))
    return Status::error(std::string("columns can't be chosen of ") +
                         (poses ? "posed hands, nor segments" : "contact points"));
  if (poses ? !info.has_poses : !info.has_contacts)
    return Status::error(info.path + ": holds no " + (poses ? "posed hands" : "contact points") +
                         "; record them with lumbrical run " +
                         (poses ? "--record-poses" : "--record-contacts") + " RATE");
  if (options.format == ExportFormat::npz)
    return write_whole<NpzFile>(output, [&](NpzFile& out) { return write_npz(readers, kind, options, out); });
  return write_whole<TextOutput>(output,
                                 [&](TextOutput& out) { return write_text(readers, kind, options, out); });
} catch (const std::bad_alloc&) {
  return Status::error(output + ": not enough memory to export the recording");
}

}  // namespace lumbrical
