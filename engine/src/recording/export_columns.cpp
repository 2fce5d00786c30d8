// See export_columns.h.
#include "recording/export_columns.h"

#include <algorithm>
#include <charconv>
#include <set>

#include "recording/record_fields.h"

namespace lumbrical {
namespace {

using Source = ExportColumn::Source;

std::string underscored(std::string_view text) {
  std::string name(text);
  std::replace(name.begin(), name.end(), ' ', '_');
  return name;
}

bool is_plain(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '.' ||
         c == '-';
}

// What neither a CSV header nor an archive's file name stumbles over. Of a character beyond ASCII one
// underscore is left.
std::string plain(std::string_view text) {
  constexpr std::size_t kLongest = 64;
  std::string name;
  for (const char c : text) {
    const bool goes_on = (static_cast<unsigned char>(c) & 0xc0u) == 0x80u;  // in UTF-8
    if (name.size() < kLongest && !goes_on) name += is_plain(c) ? c : '_';
  }
  return name;
}

// By number where it has no name; a name that another has already is told apart by the number.
std::vector<std::string> names_of_objects(const std::vector<std::string>& given) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (std::size_t i = 0; i < given.size(); ++i) {
    const std::string number = std::to_string(i);
    std::string name = given[i].empty() ? number : plain(given[i]);
    while (!taken.insert(name).second) name += '_' + number;
    names.push_back(std::move(name));
  }
  return names;
}

std::string angle_name(std::size_t angle) {
  const std::string finger(finger_name(static_cast<int>(angle / 4)));
  return finger + (angle % 4 == 0 ? ".abduction" : ".flexion_" + std::to_string(angle % 4));
}

// "segment[3].force.x" -> "index_proximal.force.x" and segment 3, "joint[7].position[1]" ->
// "joint.index_proximal.position.y", "angle[5]" -> "angle.index.flexion_1"
void name_column(const std::string& field, ExportColumn& column) {
  const std::size_t open = field.find('[');
  if (open == field.npos) {
    column.name = field;
    return;
  }
  const std::size_t close = field.find(']', open);
  std::size_t index = 0;
  std::from_chars(field.data() + open + 1, field.data() + close, index);
  const std::string list = field.substr(0, open);
  std::string rest = field.substr(close + 1);
  if (!rest.empty() && rest.back() == ']') {  // a float vector's component
    const char axis = "xyzw"[rest[rest.size() - 2] - '0'];
    rest = rest.substr(0, rest.size() - 3) + '.' + axis;
  }
  if (list == "joint") {
    column.name = "joint." + underscored(joint_name(static_cast<int>(index))) + rest;
  } else if (list == "angle") {
    column.name = "angle." + angle_name(index);
  } else {
    column.segment = static_cast<int>(index);
    column.name = underscored(segment_name(column.segment)) + (list == "segment" ? "" : "." + list) + rest;
  }
}

bool is_usual(const ExportColumn& column) {
  if (column.segment >= 0)
    return column.name.find(".force.") != column.name.npos || column.name.ends_with(".flexion_torque");
  return column.name.starts_with("base.") || column.name == "flags" || column.name == "contact_count" ||
         column.name == "device_flags";
}

template <class T>
void add_fields(Source source, std::vector<ExportColumn>& columns) {
  const std::vector<NumberField>& fields = fields_of<T>();
  for (std::size_t i = 1; i < fields.size(); ++i) {  // the first is the tick's number
    ExportColumn column;
    column.unit = fields[i].unit;
    column.type = fields[i].type;
    column.source = source;
    column.index = i;
    column.force = source == Source::output && i >= kFirstForce;
    name_column(fields[i].name, column);
    if (source == Source::input && column.name == "flags") column.name = "device_flags";
    column.usual = is_usual(column);
    columns.push_back(std::move(column));
  }
}

void add_hand(std::vector<ExportColumn>& columns) {
  columns.push_back({"duration", "ns", NumberType::whole, Source::duration});
  add_fields<TickInput>(Source::input, columns);
  add_fields<ActuatorFrame>(Source::output, columns);
  for (std::size_t i = 0; i < kStageCount; ++i)
    columns.push_back({"hash." + std::string(stage_name(static_cast<Stage>(i))), "", NumberType::whole,
                       Source::stage_hash, i});
  columns.push_back({"hash.state", "", NumberType::whole, Source::state_hash});
}

// "object.mug.position.x"; where it is and goes is usual, what it feels is not.
void add_object(std::size_t object, const std::string& name, std::vector<ExportColumn>& columns) {
  const std::vector<NumberField>& fields = fields_of<ObjectOutput>();
  for (std::size_t i = 0; i < fields.size(); ++i) {
    ExportColumn column;
    const bool is_place = fields[i].name.starts_with("pose.");
    column.name = "object." + name + "." + (is_place ? fields[i].name.substr(5) : fields[i].name);
    column.unit = fields[i].unit;
    column.type = fields[i].type;
    column.source = Source::object;
    column.index = i;
    column.object = object;
    column.usual = !fields[i].name.starts_with("wrench.");
    columns.push_back(std::move(column));
  }
}

bool is_common(const ExportColumn& column) {
  return column.source == Source::tick || column.source == Source::time;
}

// A word may be an object's name as it is.
bool holds(const ExportColumn& column, const std::string& word) {
  const std::string sought = column.source == Source::object ? plain(word) : underscored(word);
  return word == "all" || column.name.find(sought) != sought.npos;
}

bool of_segments(const ExportColumn& column, const std::vector<int>& segments) {
  return column.segment < 0 || segments.empty() ||
         std::find(segments.begin(), segments.end(), column.segment) != segments.end();
}

}  // namespace

std::vector<ExportColumn> export_columns(const ExportedSession& session) {
  const std::vector<Side>& hands = session.hands;
  std::vector<ExportColumn> columns;
  columns.push_back({"tick", "", NumberType::whole, Source::tick});
  columns.push_back({"time", "s", NumberType::real, Source::time});
  const std::vector<std::string> objects = names_of_objects(session.objects);
  for (std::size_t i = 0; i < objects.size(); ++i) add_object(i, objects[i], columns);
  for (std::size_t hand = 0; hand < hands.size(); ++hand) {
    const std::size_t begin = columns.size();
    add_hand(columns);
    for (std::size_t i = begin; i < columns.size(); ++i) {
      columns[i].hand = hand;
      if (hands.size() > 1) columns[i].name.insert(0, std::string(side_name(hands[hand])) + ".");
    }
  }
  return columns;
}

Status choose_columns(const ExportOptions& options, const ExportedSession& session,
                      std::vector<ExportColumn>& columns) {
  const std::vector<ExportColumn> all = export_columns(session);
  for (const std::string& word : options.columns) {
    const bool known = std::any_of(all.begin(), all.end(),
                                   [&word](const ExportColumn& column) { return holds(column, word); });
    if (!known)
      return Status::error("no column has \"" + word +
                           "\" in its name; \"all\" exports every one, with its name");
  }
  columns.clear();
  for (const ExportColumn& column : all) {
    const auto asked = [&column](const std::string& word) { return holds(column, word); };
    const bool chosen = options.columns.empty()
                            ? column.usual
                            : std::any_of(options.columns.begin(), options.columns.end(), asked);
    if (is_common(column) || (chosen && of_segments(column, options.segments))) columns.push_back(column);
  }
  return {};
}

std::span<const ObjectOutput> ExportRow::objects() const {
  for (const TickRecord* const of_hand : record)
    if (of_hand != nullptr && of_hand->object_count > 0) return objects_of(*of_hand);
  return {};
}

bool ExportRow::has(const ExportColumn& column) const {
  if (column.source == Source::object) return column.object < objects().size();
  const TickRecord* const of_hand = record[column.hand];
  return is_common(column) || (of_hand != nullptr && (of_hand->has_forces || !column.force));
}

void column_bits(const ExportRow& row, double rate, const std::vector<ExportColumn>& columns,
                 std::vector<std::uint64_t>& bits) {
  std::array<InputFields, kMostHands> input{};
  std::array<OutputFields, kMostHands> output{};
  for (std::size_t hand = 0; hand < kMostHands; ++hand) {
    if (row.record[hand] == nullptr) continue;
    input[hand] = input_fields(*row.record[hand]);
    output[hand] = output_fields(row.record[hand]->output);
  }
  std::vector<Numbers<ObjectOutput>> objects;
  for (const ObjectOutput& object : row.objects()) objects.push_back(numbers_of(object));
  const auto number = [&](const ExportColumn& column) -> std::uint64_t {
    if (column.source == Source::tick) return row.tick;
    if (column.source == Source::time) return bits_of(static_cast<double>(row.tick) / rate);
    if (column.source == Source::object)
      return column.object < objects.size() ? objects[column.object][column.index] : 0;
    const TickRecord* const record = row.record[column.hand];
    if (record == nullptr) return 0;
    if (column.source == Source::duration) return record->duration_ns;
    if (column.source == Source::input) return input[column.hand][column.index];
    if (column.source == Source::output) return output[column.hand][column.index];
    return column.source == Source::stage_hash ? record->stage_hash[column.index] : record->state_hash;
  };
  bits.clear();
  for (const ExportColumn& column : columns) bits.push_back(number(column));
}

}  // namespace lumbrical
