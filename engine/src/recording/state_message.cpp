// Encoding and checked decoding of the state attachment.
#include "recording/state_message.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "base/message_alignment.h"
#include "recording_generated.h"
#include "tick/field_lists.h"

namespace lumbrical {
namespace {

// A struct or array of nothing but doubles.
template <class Numbers>
bool to_numbers(const flatbuffers::Vector<double>* numbers, Numbers& to) {
  using Doubles = std::array<double, sizeof(Numbers) / sizeof(double)>;
  Doubles from;
  if (numbers == nullptr || numbers->size() != from.size() || !is_aligned(numbers)) return false;
  std::copy(numbers->begin(), numbers->end(), from.begin());
  to = std::bit_cast<Numbers>(from);
  return std::all_of(from.begin(), from.end(), [](double number) { return is_finite(number); });
}

// Structs of nothing but doubles, number by number.
template <class Row>
bool to_rows(const flatbuffers::Vector<double>* numbers, std::size_t most, std::vector<Row>& rows) {
  constexpr std::size_t kNumbers = kNumberCount<Row>;
  rows.clear();
  if (numbers == nullptr) return true;
  if (numbers->size() % kNumbers != 0 || numbers->size() / kNumbers > most || !is_aligned(numbers))
    return false;
  bool finite = true;
  std::uint32_t next = 0;
  rows.resize(numbers->size() / kNumbers);
  for (Row& row : rows) {
    walk(row, [&](const FieldName&, double& number) {
      number = numbers->Get(next++);
      finite = finite && is_finite(number);
    });
  }
  return finite;
}

bool is_share(double value) { return value >= 0 && value <= 1; }

// A whole number with a bit for each joint.
bool are_joints(double value) {
  return value >= 0 && value < 1u << kJointCount && value == std::floor(value);
}

}  // namespace

std::vector<std::uint8_t> encode_state(const State& state) {
  flatbuffers::FlatBufferBuilder builder(8192);
  builder.ForceDefaults(true);  // a number left out because it equals its default might have been -0
  const auto put = [&builder](const auto& from) {
    const auto numbers = std::bit_cast<std::array<double, sizeof from / sizeof(double)>>(from);
    return builder.CreateVector(numbers.data(), numbers.size());
  };
  const auto last = put(state.last), held = put(state.held), ends = put(state.ends);
  const auto put_rows = [&builder](auto rows) {
    std::vector<double> numbers;
    for (const auto& row : rows)
      walk(row, [&numbers](const FieldName&, double number) { numbers.push_back(number); });
    return builder.CreateVector(numbers);
  };
  const auto objects = put_rows(std::span(state.objects));
  const auto proxy = put_rows(state.proxy ? std::span(&*state.proxy, 1) : std::span<const ProxyState>());
  const auto motion = put_rows(state.motion ? std::span(&*state.motion, 1) : std::span<const MotionState>());
  builder.Finish(fb::CreateState(builder, state.tick, state.rise, state.fall, last, held, objects, proxy,
                                 motion, static_cast<std::uint32_t>(state.joints), ends));
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

Status decode_state(std::span<const std::uint8_t> bytes, State& state) {
  std::vector<std::uint64_t> aligned;
  const fb::State* const found = verified<fb::State>(bytes, aligned);
  if (found == nullptr) return Status::error("the state message does not fit its schema");
  const fb::State& message = *found;
  State result;
  std::vector<ProxyState> proxy;
  std::vector<MotionState> motion;
  result.tick = message.tick();
  result.rise = message.rise();
  result.fall = message.fall();
  result.joints = message.joints();
  const bool good = is_share(result.rise) && is_share(result.fall) && result.joints >> kJointCount == 0 &&
                    to_numbers(message.last(), result.last) && to_numbers(message.held(), result.held) &&
                    to_numbers(message.ends(), result.ends) &&
                    to_rows(message.objects(), kMostObjects, result.objects) &&
                    to_rows(message.proxy(), 1, proxy) && to_rows(message.motion(), 1, motion);
  if (!good || (!proxy.empty() && !(are_joints(proxy[0].valid) && is_share(proxy[0].balanced))) ||
      (!motion.empty() && !are_joints(motion[0].valid)))
    return Status::error("the state message holds numbers out of range");
  if (!proxy.empty()) result.proxy = proxy[0];
  if (!motion.empty()) result.motion = motion[0];
  state = result;
  return {};
}

}  // namespace lumbrical
