// The numbers of a tick record in their order, and the check over those that come in.
#include <span>

#include "recording/record_fields.h"

namespace lumbrical {

InputFields input_fields(const TickRecord& record) {
  return numbers_of(TickInput{record.output.tick, record.device});
}

OutputFields output_fields(const ActuatorFrame& frame) { return numbers_of(frame); }

InputCheck make_input_check(const InputFields& fields, std::span<const ObjectFrame> given) {
  InputCheck check;
  for (std::size_t i = 0; i < fields.size(); ++i) {
    const std::uint64_t low = fields[i] & 0xffffffffu, high = fields[i] >> 32;
    check.low_sum += low;
    check.low_moment += (i + 1) * low;
    check.high_sum += high;
    check.high_moment += (i + 1) * high;
  }
  check.hash = with_objects(hash_rows(std::span<const std::uint64_t>(fields)), given);
  return check;
}

InputCheck input_check_of(const TickRecord& record) {
  return make_input_check(input_fields(record), given_of(record));
}

}  // namespace lumbrical
