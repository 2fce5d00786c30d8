// The columns of an exported table: every number of a tick record, by a name that says what it is of.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "lumbrical/recording.h"
#include "tick/fields.h"

namespace lumbrical {

/// One number of a tick.
struct ExportColumn {
  enum class Source : std::uint8_t { tick, time, object, duration, input, output, stage_hash, state_hash };
  std::string name;  ///< "index_distal.force.x", "angle.index.flexion_1", "flags"
  std::string unit;  ///< "N"; empty where it has none
  NumberType type = NumberType::whole;
  Source source = Source::tick;
  std::size_t index = 0;   ///< in an object's numbers, input_fields, output_fields or stage_hash
  std::size_t object = 0;  ///< whose it is: TickRecord::object
  int segment = -1;        ///< whose it is; -1: no segment's
  std::size_t hand = 0;    ///< whose it is, of a session of two
  bool usual = false;      ///< is of those that are exported unless others are asked for
  bool force = false;      ///< may be left out of a recording
};

/// "index_distal.force.x [N]"
inline std::string column_title(const std::string& name, const std::string& unit) {
  return unit.empty() ? name : name + " [" + unit + ']';
}

/// What a session has columns of.
struct ExportedSession {
  std::vector<Side> hands;
  std::vector<std::string> objects;  ///< names of those that stand apart, in the order of TickRecord::object
};

/// All there are, each with a name of its own, in a fixed order: tick and time, objects,
/// "object.mug.position.x" (of an object's name letters, digits, "_", "." and "-" are kept), then hand by
/// hand what came in, what went out, and hashes. Of a session of two hands a side stands before the name of
/// what is a hand's, "left.index_distal.force.x".
std::vector<ExportColumn> export_columns(const ExportedSession& session);

/// Those that the options ask for: of the segments, and of the columns that a word of `columns` is in ("all":
/// every one); without such words the usual ones. An error names the word that is in none.
Status choose_columns(const ExportOptions& options, const ExportedSession& session,
                      std::vector<ExportColumn>& columns);

/// What became of a tick: the records of the hands that have one.
struct ExportRow {
  std::uint64_t tick = 0;
  std::array<const TickRecord*, kMostHands> record{};
  /// Whether it has this column's number.
  [[nodiscard]] bool has(const ExportColumn& column) const;
  /// What became of objects: with two hands it stands beside one of them.
  [[nodiscard]] std::span<const ObjectOutput> objects() const;
};

/// Their numbers as bits (bits_of; of times those of a double), column by column; 0 where it has none.
void column_bits(const ExportRow& row, double rate, const std::vector<ExportColumn>& columns,
                 std::vector<std::uint64_t>& bits);

}  // namespace lumbrical
