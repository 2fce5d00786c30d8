// See tick_trace.h.
#include "tick/tick_trace.h"

#include <bit>
#include <cmath>
#include <utility>

#include "tick/field_lists.h"

namespace lumbrical {
namespace {

class Tracer {
 public:
  std::vector<TraceValue> values;

  void pair(std::uint32_t primitive, std::uint32_t triangle) {
    owner_.primitive = primitive;
    owner_.triangle = triangle;
  }
  void whole(const char* name, std::uint64_t value) { add(name, NumberType::whole, value); }
  template <class T>
  void fields(const T& value) {
    walk(value, [this]<class N>(const FieldName& at, const N& number) {
      if (at.unit != kOwner) add(at.text(), kNumberType<N>, bits_of(number));
    });
  }

 private:
  void add(std::string field, NumberType type, std::uint64_t bits) {
    TraceValue& value = values.emplace_back(owner_);
    value.field = std::move(field);
    value.type = type;
    value.bits = bits;
  }
  TraceValue owner_;
};

// Monotonic in the number: neighbours of a type are one apart.
template <class Real, class Bits>
std::optional<std::uint64_t> distance(std::uint64_t a, std::uint64_t b) {
  constexpr Bits kSign = Bits{1} << (8 * sizeof(Bits) - 1);
  const auto place = [](Bits bits) { return (bits & kSign) != 0 ? ~bits : bits | kSign; };
  const Bits bits_a = static_cast<Bits>(a), bits_b = static_cast<Bits>(b);
  if (std::isnan(std::bit_cast<Real>(bits_a)) || std::isnan(std::bit_cast<Real>(bits_b))) return std::nullopt;
  const Bits place_a = place(bits_a), place_b = place(bits_b);
  return place_a > place_b ? place_a - place_b : place_b - place_a;
}

}  // namespace

bool TraceValue::same_place(const TraceValue& other) const {
  return primitive == other.primitive && triangle == other.triangle && type == other.type &&
         field == other.field;
}

std::vector<TraceValue> trace_stage(const Scratch& scratch, const DeviceFrame& frame,
                                    std::span<const ObjectFrame> given, const ActuatorFrame& output,
                                    Stage stage) {
  Tracer to;
  const std::span<const Contact> contacts(scratch.contacts.data(), scratch.contact_count);
  switch (stage) {
    case Stage::input:
      to.fields(frame);
      for (const ObjectFrame& object : given) to.fields(object);
      break;
    case Stage::hand_pose:
      to.fields(*scratch.primitives);
      break;
    case Stage::broadphase:
      for (std::uint32_t i = 0; i < scratch.candidate_count; ++i) {
        const std::uint64_t pair = scratch.candidates[i];
        to.pair(static_cast<std::uint32_t>(pair >> 32), static_cast<std::uint32_t>(pair));
        to.whole("candidate", 1);
      }
      break;
    case Stage::narrowphase:
      to.fields(scratch.samples->forces);
      for (const Contact& contact : contacts) {
        to.pair(contact.primitive, contact.triangle);
        to.fields(contact);
      }
      break;
    case Stage::contact_force:
      to.fields(scratch.forces);
      break;
    case Stage::limits:
      to.fields(output);
      for (const ObjectOutput& object : scratch.object_output) to.fields(object);
      break;
  }
  return std::move(to.values);
}

std::vector<TraceValue> trace_state(const State& state) {
  Tracer to;
  to.fields(static_cast<const HandState&>(state));
  for (const ObjectState& object : state.objects) to.fields(object);
  if (state.proxy) to.fields(*state.proxy);
  if (state.motion) to.fields(*state.motion);
  return std::move(to.values);
}

std::optional<std::uint64_t> ulps_between(NumberType type, std::uint64_t a, std::uint64_t b) {
  if (type == NumberType::real) return distance<double, std::uint64_t>(a, b);
  if (type == NumberType::real32) return distance<float, std::uint32_t>(a, b);
  return std::nullopt;
}

}  // namespace lumbrical
