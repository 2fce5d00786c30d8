// Encoding and checked decoding of the state attachment.
#include "recording/state_message.h"

#include <algorithm>
#include <cstring>

#include "recording/message_alignment.h"
#include "recording_generated.h"

namespace lumbrical {
namespace {

constexpr std::size_t kNumbers = sizeof(HandForces) / sizeof(double);
static_assert(kNumbers == 10 * kSegmentCount && sizeof(State) == 3 * sizeof(double) + 2 * sizeof(HandForces));
using Numbers = std::array<double, kNumbers>;

// Ten numbers per segment, as in a tick's message.
Numbers numbers_of(const HandForces& forces) {
  Numbers numbers;
  auto next = numbers.begin();
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    for (const Vec3 v : {forces.segment[s].force, forces.segment[s].torque, forces.joint_torque[s]})
      for (const double value : {v.x, v.y, v.z}) *next++ = value;
    *next++ = forces.flexion_torque[s];
  }
  return numbers;
}

bool to_forces(const flatbuffers::Vector<double>* numbers, HandForces& forces) {
  if (numbers == nullptr || numbers->size() != kNumbers || !is_aligned(numbers)) return false;
  std::uint32_t next = 0;
  bool finite = true;
  const auto take = [&] {
    const double value = numbers->Get(next++);
    finite = finite && is_finite(value);
    return value;
  };
  const auto take_vector = [&] {
    const double x = take(), y = take(), z = take();
    return Vec3{x, y, z};
  };
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    forces.segment[s].force = take_vector();
    forces.segment[s].torque = take_vector();
    forces.joint_torque[s] = take_vector();
    forces.flexion_torque[s] = take();
  }
  return finite;
}

bool is_share(double value) { return value >= 0 && value <= 1; }

}  // namespace

std::vector<std::uint8_t> encode_state(const State& state) {
  flatbuffers::FlatBufferBuilder builder(8192);
  builder.ForceDefaults(true);  // a number left out because it equals its default might have been -0
  const Numbers last = numbers_of(state.last), held = numbers_of(state.held);
  const auto last_numbers = builder.CreateVector(last.data(), last.size());
  const auto held_numbers = builder.CreateVector(held.data(), held.size());
  builder.Finish(fb::CreateState(builder, state.tick, state.rise, state.fall, last_numbers, held_numbers));
  return {builder.GetBufferPointer(), builder.GetBufferPointer() + builder.GetSize()};
}

Status decode_state(std::span<const std::uint8_t> bytes, State& state) {
  std::vector<std::uint64_t> aligned((bytes.size() + 7) / 8);
  if (!bytes.empty()) std::memcpy(aligned.data(), bytes.data(), bytes.size());
  const auto* const data = reinterpret_cast<const std::uint8_t*>(aligned.data());
  flatbuffers::Verifier verifier(data, bytes.size());
  if (!verifier.VerifyBuffer<fb::State>(nullptr))
    return Status::error("the state message does not fit its schema");
  const fb::State& message = *flatbuffers::GetRoot<fb::State>(data);
  State result;
  result.tick = message.tick();
  result.rise = message.rise();
  result.fall = message.fall();
  const bool good = is_share(result.rise) && is_share(result.fall) &&
                    to_forces(message.last(), result.last) && to_forces(message.held(), result.held);
  if (!good) return Status::error("the state message holds numbers out of range");
  state = result;
  return {};
}

}  // namespace lumbrical
