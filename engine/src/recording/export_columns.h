// The columns of an exported table: every number of a tick record, by a name that says what it is of.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "lumbrical/recording.h"
#include "tick/fields.h"

namespace lumbrical {

/// One number of a tick.
struct ExportColumn {
  enum class Source : std::uint8_t { tick, time, duration, input, output, stage_hash, state_hash };
  std::string name;  ///< "index_distal.force.x", "angle.index.flexion_1", "flags"
  std::string unit;  ///< "N"; empty where it has none
  NumberType type = NumberType::whole;
  Source source = Source::tick;
  std::size_t index = 0;  ///< in input_fields, output_fields or stage_hash
  int segment = -1;       ///< whose it is; -1: no segment's
  bool usual = false;     ///< is of those that are exported unless others are asked for
  bool force = false;     ///< may be left out of a recording
};

/// All there are, in a fixed order: tick and time, then what came in, then what went out, then hashes.
const std::vector<ExportColumn>& export_columns();

/// Those that the options ask for: of the segments, and of the columns that a word of `columns` is in ("all":
/// every one); without such words the usual ones. An error names the word that is in none.
Status choose_columns(const ExportOptions& options, std::vector<ExportColumn>& columns);

/// Their numbers as bits (bits_of; of times those of a double), column by column.
void column_bits(const TickRecord& record, double rate, const std::vector<ExportColumn>& columns,
                 std::vector<std::uint64_t>& bits);

}  // namespace lumbrical
