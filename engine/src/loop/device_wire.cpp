// See lumbrical/device_wire.h.
#include "lumbrical/device_wire.h"

#include "lumbrical/math.h"

namespace lumbrical {

LocalModel local_model_of(const WireCommand& command, std::size_t i) {
  const auto finite_or_zero = [](double value) { return is_finite(value) ? value : 0; };
  const DeviceCommand& from = command.made_of;
  LocalModel local;
  local.angle = finite_or_zero(from.angle[i]);
  if (command.output.command[i] != from.wanted[i] || !is_finite(from.angle[i])) return local;
  local.stiffness = finite_or_zero(from.stiffness[i]);
  local.radius = finite_or_zero(from.radius[i]);
  return local;
}

}  // namespace lumbrical
