// Export of a recording: tables for spreadsheets (CSV) and NumPy, JSON lines for scripts.
#include <array>
#include <bit>
#include <charconv>
#include <cmath>
#include <limits>
#include <new>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "files/text_output.h"
#include "lumbrical/recording.h"
#include "recording/export_columns.h"
#include "recording/npz_file.h"
#include "recording/record_fields.h"

namespace lumbrical {
namespace {

// Where ticks are to be exported from, and whether this one is.
bool chosen(const ExportOptions& options, std::uint64_t tick) {
  return tick >= options.first && tick <= options.last && (tick - options.first) % options.step == 0;
}

/// Every chosen record, front to back, until `take` fails or `out` is not wanted any more.
template <class Take>
Status for_each_record(RecordingReader& reader, const ExportOptions& options, Take&& take,
                       const TextOutput* out = nullptr) {
  if (Status status = reader.seek(options.first); !status.ok()) return status;
  for (;;) {
    TickRecord record;
    if (out != nullptr && !out->wanted()) return {};
    bool end = false;
    if (Status status = reader.next(record, end); !status.ok()) return status;
    if (end || record.output.tick > options.last) return {};
    if (!chosen(options, record.output.tick)) continue;
    if (Status status = take(record); !status.ok()) return status;
  }
}

// The chosen columns, and unless they were asked for by name only those that vary.
Status find_columns(RecordingReader& reader, const ExportOptions& options, std::vector<ExportColumn>& columns,
                    std::uint64_t& rows) {
  if (Status status = choose_columns(options, columns); !status.ok()) return status;
  std::vector<std::uint64_t> first, bits;
  std::vector<bool> varies(columns.size(), false);
  rows = 0;
  const double rate = reader.scene().settings.rate;
  Status status = for_each_record(reader, options, [&](const TickRecord& record) {
    column_bits(record, rate, columns, bits);
    if (rows++ == 0) first = bits;
    for (std::size_t i = 0; i < bits.size(); ++i)
      if (bits[i] != first[i] && (record.has_forces || !columns[i].force)) varies[i] = true;
    return Status{};
  });
  if (!status.ok() || !options.columns.empty()) return status;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < columns.size(); ++i)
    if (i < 2 || varies[i]) columns[kept++] = columns[i];  // tick and time come first, and always
  columns.resize(kept);
  return {};
}

// Six digits are more than any of these quantities is worth; `exact` are as many as it takes to read the
// same bits.
std::string cell_text(const ExportColumn& column, std::uint64_t bits, bool exact) {
  if (column.source == ExportColumn::Source::stage_hash || column.source == ExportColumn::Source::state_hash)
    return hash_text(bits);
  if (exact || !is_real(column.type)) return number_text(column.type, bits);
  const double value = column.type == NumberType::real
                           ? std::bit_cast<double>(bits)
                           : static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(bits)));
  if (std::isnan(value)) return "nan";
  std::array<char, 32> text;
  const auto [end, error] = std::to_chars(text.data(), text.data() + text.size(), value + 0.0,  // no -0
                                          std::chars_format::general, 6);
  return std::string(text.data(), end);
}

Status write_csv(RecordingReader& reader, const ExportOptions& options,
                 const std::vector<ExportColumn>& columns, TextOutput& out) {
  std::string line;
  for (const ExportColumn& column : columns)
    line += (line.empty() ? "" : ",") + column.name + (column.unit.empty() ? "" : " [" + column.unit + ']');
  if (Status status = out.line(line); !status.ok()) return status;
  std::vector<std::uint64_t> bits;
  return for_each_record(
      reader, options,
      [&](const TickRecord& record) {
        column_bits(record, reader.scene().settings.rate, columns, bits);
        line.clear();
        for (std::size_t i = 0; i < columns.size(); ++i) {
          if (i > 0) line += ',';
          if (record.has_forces || !columns[i].force) line += cell_text(columns[i], bits[i], options.exact);
        }
        return out.line(line);
      },
      &out);
}

// An array is written as a whole, so all of them are in memory.
constexpr std::uint64_t kMostNumbers = std::uint64_t{1} << 28;

Status write_npz(RecordingReader& reader, const ExportOptions& options,
                 const std::vector<ExportColumn>& columns, std::uint64_t rows, NpzFile& out) {
  if (rows * columns.size() > kMostNumbers)
    return Status::error("more than 268,435,456 numbers; export fewer with --ticks or --columns");
  std::vector<std::vector<std::uint64_t>> values(columns.size());
  for (std::vector<std::uint64_t>& column : values) column.reserve(rows);
  std::vector<std::uint64_t> bits;
  Status status = for_each_record(reader, options, [&](const TickRecord& record) {
    column_bits(record, reader.scene().settings.rate, columns, bits);
    for (std::size_t i = 0; i < columns.size(); ++i) {
      std::uint64_t value = bits[i];
      if (columns[i].type == NumberType::real32)
        value = bits_of(static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(value))));
      if (columns[i].force && !record.has_forces) value = bits_of(std::numeric_limits<double>::quiet_NaN());
      values[i].push_back(value);
    }
    return Status{};
  });
  std::vector<std::string> names, units;
  for (std::size_t i = 0; status.ok() && i < columns.size(); ++i) {
    status = out.add(columns[i].name, is_real(columns[i].type) ? "<f8" : "<u8", values[i]);
    values[i] = {};
    names.push_back(columns[i].name);
    units.push_back(columns[i].unit);
  }
  if (status.ok()) status = out.add("columns", names);
  return status.ok() ? out.add("units", units) : status;
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

Status write_json(RecordingReader& reader, const ExportOptions& options, TextOutput& out) {
  return for_each_record(
      reader, options, [&](const TickRecord& record) { return out.line(json_line(record)); }, &out);
}

Status export_text(RecordingReader& reader, const ExportOptions& options,
                   const std::vector<ExportColumn>& columns, const std::string& output) {
  TextOutput out;
  if (Status status = out.open(output); !status.ok()) return status;
  Status status = options.format == ExportFormat::csv ? write_csv(reader, options, columns, out)
                                                      : write_json(reader, options, out);
  if (status.ok()) status = out.close();
  if (!status.ok()) out.discard();
  return status;
}

Status export_npz(RecordingReader& reader, const ExportOptions& options,
                  const std::vector<ExportColumn>& columns, std::uint64_t rows, const std::string& output) {
  NpzFile out;
  if (output == "-") return Status::error("a NumPy archive needs a file; name one with --output");
  if (Status status = out.open(output); !status.ok()) return status;
  Status status = write_npz(reader, options, columns, rows, out);
  if (status.ok()) status = out.close();
  if (!status.ok()) out.discard();
  return status;
}

}  // namespace

Status export_recording(RecordingReader& reader, const ExportOptions& options,
                        const std::string& output) try {
  if (options.step == 0) return Status::error("ticks: a step of 0 leads nowhere; 1 is every tick");
  std::vector<ExportColumn> columns;
  std::uint64_t rows = 0;
  if (options.format != ExportFormat::json)
    if (Status status = find_columns(reader, options, columns, rows); !status.ok()) return status;
  return options.format == ExportFormat::npz ? export_npz(reader, options, columns, rows, output)
                                             : export_text(reader, options, columns, output);
} catch (const std::bad_alloc&) {
  return Status::error(output + ": not enough memory to export the recording");
}

}  // namespace lumbrical
