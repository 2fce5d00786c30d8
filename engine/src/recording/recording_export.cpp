// Export of a recording: tables for spreadsheets (CSV) and NumPy, JSON lines for scripts.
#include <array>
#include <bit>
#include <cassert>
#include <limits>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/check_stop.h"
#include "files/text_output.h"
#include "lumbrical/recording.h"
#include "recording/chosen_ticks.h"
#include "recording/export_columns.h"
#include "recording/json_line.h"
#include "recording/npz_file.h"
#include "recording/record_fields.h"

namespace lumbrical {
namespace {

using Readers = std::span<RecordingReader>;

double rate_of(Readers readers) { return readers[0].scene().settings.rate; }

ExportedSession session_of(Readers readers) {
  ExportedSession session;
  for (const RecordingReader& reader : readers) session.hands.push_back(reader.scene().hand.side);
  for (const SceneObject& object : readers[0].scene().objects)
    if (is_apart(object)) session.objects.push_back(object.name);
  return session;
}

/// Every chosen tick, front to back, until `take` fails or `out` is not wanted any more. Of two hands a
/// tick's records come together; where one is missing, the other's alone.
template <class Take>
Status for_each_row(Readers readers, const ExportOptions& options, Take&& take,
                    const TextOutput* out = nullptr) {
  std::array<TickRecord, kMostHands> records;
  std::array<bool, kMostHands> ended{true, true};
  const auto advance = [&](std::size_t hand) {
    bool& end = ended[hand];
    do {
      if (Status status = check_stop(options.stop); !status.ok()) return status;
      if (Status status = readers[hand].next(records[hand], end); !status.ok()) return status;
      end = end || records[hand].output.tick > options.last;
    } while (!end && !is_chosen(options, records[hand].output.tick));
    return Status{};
  };
  for (std::size_t hand = 0; hand < readers.size(); ++hand) {
    if (Status status = readers[hand].seek(options.first); !status.ok()) return status;
    if (Status status = advance(hand); !status.ok()) return status;
  }
  while (!(ended[0] && ended[1]) && (out == nullptr || out->wanted())) {
    ExportRow row;
    const bool second_first = ended[0] || (!ended[1] && records[1].output.tick < records[0].output.tick);
    row.tick = records[second_first ? 1 : 0].output.tick;
    for (std::size_t hand = 0; hand < readers.size(); ++hand)
      if (!ended[hand] && records[hand].output.tick == row.tick) row.record[hand] = &records[hand];
    if (Status status = take(row); !status.ok()) return status;
    for (std::size_t hand = 0; hand < readers.size(); ++hand)
      if (row.record[hand] != nullptr)
        if (Status status = advance(hand); !status.ok()) return status;
  }
  return {};
}

// The chosen columns, and unless they were asked for by name only those that vary. A single row can't: of it
// those that are not zero.
Status find_columns(Readers readers, const ExportOptions& options, std::vector<ExportColumn>& columns,
                    std::uint64_t& rows) {
  if (Status status = choose_columns(options, session_of(readers), columns); !status.ok()) return status;
  std::vector<std::uint64_t> first, bits;
  std::vector<bool> known(columns.size(), false), varies(columns.size(), false);
  rows = 0;
  first.resize(columns.size());
  Status status = for_each_row(readers, options, [&](const ExportRow& row) {
    column_bits(row, rate_of(readers), columns, bits);
    ++rows;
    for (std::size_t i = 0; i < bits.size(); ++i) {
      if (!row.has(columns[i])) continue;
      if (!known[i]) first[i] = bits[i];
      known[i] = true;
      varies[i] = varies[i] || bits[i] != first[i];
    }
    return Status{};
  });
  if (status.ok()) status = check_choice(readers[0].info(), rows);
  if (!status.ok()) return status;
  if (!options.columns.empty()) return {};
  if (rows == 1)
    for (std::size_t i = 0; i < columns.size(); ++i) varies[i] = known[i] && first[i] != 0;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (i < 2 || varies[i]) columns[kept++] = columns[i];  // tick and time come first, and always
  columns.resize(kept);
  return {};
}

std::string cell_text(const ExportColumn& column, std::uint64_t bits, bool exact) {
  if (column.source == ExportColumn::Source::stage_hash || column.source == ExportColumn::Source::state_hash)
    return hash_text(bits);
  if (exact || !is_real(column.type)) return number_text(column.type, bits);
  return rounded_text(column.type == NumberType::real
                          ? std::bit_cast<double>(bits)
                          : static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits))));
}

Status write_csv(Readers readers, const ExportOptions& options, const std::vector<ExportColumn>& columns,
                 TextOutput& out) {
  std::string line;
  for (const ExportColumn& column : columns)
    line += (line.empty() ? "" : ",") + column_title(column.name, column.unit);
  if (Status status = out.line(line); !status.ok()) return status;
  std::vector<std::uint64_t> bits;
  return for_each_row(
      readers, options,
      [&](const ExportRow& row) {
        column_bits(row, rate_of(readers), columns, bits);
        line.clear();
        for (std::size_t i = 0; i < columns.size(); ++i) {
          if (i > 0) line += ',';
          if (row.has(columns[i])) line += cell_text(columns[i], bits[i], options.exact);
        }
        return out.line(line);
      },
      &out);
}

// An array is written as a whole, so all of them are in memory.
constexpr std::uint64_t kMostNumbers = std::uint64_t{1} << 28;

Status write_npz(Readers readers, const ExportOptions& options, const std::vector<ExportColumn>& columns,
                 std::uint64_t rows, NpzFile& out) {
  if (rows * columns.size() > kMostNumbers)
    return Status::error("more than 268,435,456 numbers; export fewer with --ticks or --columns");
  std::vector<std::vector<std::uint64_t>> values(columns.size());
  for (std::vector<std::uint64_t>& column : values) column.reserve(rows);
  std::vector<std::uint64_t> bits;
  Status status = for_each_row(readers, options, [&](const ExportRow& row) {
    column_bits(row, rate_of(readers), columns, bits);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      std::uint64_t value = bits[i];
      if (columns[i].type == NumberType::real32)
        value = bits_of(static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(value))));
      if (is_real(columns[i].type) && !row.has(columns[i]))
        value = bits_of(std::numeric_limits<double>::quiet_NaN());
      values[i].push_back(value);
    }
    return Status{};
  });
  std::vector<std::string> names, units;
  for (std::size_t i = 0; status.ok() && i < columns.size(); ++i) {
    status = check_stop(options.stop);
    if (status.ok()) status = out.add(columns[i].name, is_real(columns[i].type) ? "<f8" : "<u8", values[i]);
    values[i] = {};
    names.push_back(columns[i].name);
    units.push_back(columns[i].unit);
  }
  if (status.ok()) status = out.add("columns", names);
  return status.ok() ? out.add("units", units) : status;
}

void add_output(const TickRecord& record, JsonLine& json) {
  json.open("output", '{');
  list_fields(record.output, [&](const char* name, const char*, const auto& field) {
    const bool force = Array<decltype(field)>;
    force && !record.has_forces ? json.null(name) : json.value(name, field);
  });
  json.close('}');
}

// Told and felt objects, where there are any.
template <class Row>
void add_rows(std::string_view key, std::span<const Row> rows, JsonLine& json) {
  if (rows.empty()) return;
  json.open(key, '[');
  for (const Row& row : rows) json.value("", row);
  json.close(']');
}

std::string json_line(const TickRecord& record, std::optional<Side> side) {
  JsonLine json;
  json.open("", '{').number("tick", record.output.tick);
  if (side) json.string("hand", side_name(*side));
  json.number("duration_ns", record.duration_ns);
  json.value("device", record.device);
  add_rows("given", given_of(record), json);
  add_output(record, json);
  add_rows("objects", objects_of(record), json);
  json.open("stage_hash", '{');
  for (int i = 0; i < kStageCount; ++i)
    json.string(stage_name(static_cast<Stage>(i)), hash_text(record.stage_hash[i]));
  json.close('}').string("state_hash", hash_text(record.state_hash)).close('}');
  return json.text();
}

// Of two hands each has its line.
Status write_json(Readers readers, const ExportOptions& options, TextOutput& out) {
  std::uint64_t rows = 0;
  const auto lines = [&](const ExportRow& row) {
    ++rows;
    for (std::size_t hand = 0; hand < readers.size(); ++hand) {
      if (row.record[hand] == nullptr) continue;
      std::optional<Side> side;
      if (readers.size() > 1) side = readers[hand].scene().hand.side;
      if (Status status = out.line(json_line(*row.record[hand], side)); !status.ok()) return status;
    }
    return Status{};
  };
  const Status status = for_each_row(readers, options, lines, &out);
  return status.ok() ? check_choice(readers[0].info(), rows) : status;
}

}  // namespace

Status export_recording(std::span<RecordingReader> readers, const ExportOptions& options,
                        const std::string& output) try {
  assert(!readers.empty() && readers.size() <= kMostHands);
  if (Status status = check_step(options); !status.ok()) return status;
  std::vector<ExportColumn> columns;
  std::uint64_t rows = 0;
  if (options.format != ExportFormat::json)
    if (Status status = find_columns(readers, options, columns, rows); !status.ok()) return status;
  if (options.format == ExportFormat::npz)
    return write_whole<NpzFile>(
        output, [&](NpzFile& out) { return write_npz(readers, options, columns, rows, out); });
  return write_whole<TextOutput>(output, [&](TextOutput& out) {
    return options.format == ExportFormat::csv ? write_csv(readers, options, columns, out)
                                               : write_json(readers, options, out);
  });
} catch (const std::bad_alloc&) {
  return Status::error(output + ": not enough memory to export the recording");
}

}  // namespace lumbrical
