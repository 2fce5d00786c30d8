// JSON files read through a FlatBuffers schema. The schema's parser refuses what is not JSON, unknown fields
// and wrong types; what it can't know (ranges, names, lengths) FieldReader checks. All messages name file,
// line and column.
#pragma once

#include <flatbuffers/flatbuffers.h>

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "base/text_cursor.h"
#include "lumbrical/math.h"
#include "lumbrical/status.h"
#include "model/ranges.h"

namespace lumbrical {

struct JsonFile {
  std::string name;  ///< as the caller spelled it
  std::string text;
  std::vector<std::uint8_t> buffer;  ///< the same as a FlatBuffer; empty before it is parsed
};

/// What a file is held against.
struct JsonSchema {
  const char* file;  ///< its source in schemas/, which messages name
  std::span<const std::uint8_t> bytes;
  const char* root;  ///< the table
};

/// Of a field that may be absent: empty then.
inline std::string_view text_of(const flatbuffers::String* text) {
  return text != nullptr ? text->string_view() : std::string_view();
}

/// Reads a file of at most 16 MiB and parses it as the root of the schema.
Status read_json_file(const std::string& path, const JsonSchema& schema, JsonFile& file);

/// Where the value at `path` ("objects[1].fit.size") starts in a JSON text, or the innermost part of the path
/// that is there. Never fails: text that is not JSON gives some place inside it.
TextPlace find_json_value(std::string_view text, std::string_view path);

/// Copies fields out of a parsed file, one call per field. Absent fields leave their target alone, and so do
/// bad ones. The first error is kept, so that a reader can read on and ask once.
class FieldReader {
 public:
  explicit FieldReader(const JsonFile& file) : file_(file) {}

  void number(flatbuffers::Optional<double> value, const std::string& path, Range range, double& target);
  /// Or 0, which lies outside the range.
  void zero_or_number(flatbuffers::Optional<double> value, const std::string& path, Range range,
                      double& target);
  void count(flatbuffers::Optional<std::uint32_t> value, const std::string& path, Range range,
             std::uint32_t& target);
  /// Exactly target.size() numbers within the range.
  void numbers(const flatbuffers::Vector<double>* values, const std::string& path, Range range,
               std::span<double> target);
  void vector(const flatbuffers::Vector<double>* values, const std::string& path, Range range, Vec3& target);
  /// Position [m] and orientation [w, x, y, z], which is normalised.
  void pose(const flatbuffers::Vector<double>* position, const std::string& position_path,
            const flatbuffers::Vector<double>* orientation, const std::string& orientation_path,
            Pose& target);

  void error(const std::string& path, const std::string& what);
  /// What no single value tells; an error begins with the path of its value.
  void check(const Status& checked);
  /// What is wrong with a file that the value at `path` names: with that value's place, unless the file's own
  /// reader tells a line in it.
  [[nodiscard]] Status of_file(const std::string& path, const std::string& file, const Status& status) const;
  [[nodiscard]] bool ok() const { return status_.ok(); }
  [[nodiscard]] const Status& status() const { return status_; }

 private:
  const JsonFile& file_;
  Status status_;
};

}  // namespace lumbrical
