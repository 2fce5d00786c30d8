// Encoding and checked decoding of the state attachment.
#include "recording/state_message.h"

#include <array>
#include <bit>
#include <cstring>

#include "recording/message_alignment.h"
#include "recording_generated.h"
#include "tick/field_lists.h"

namespace lumbrical {
namespace {

using ForceNumbers = std::array<double, kNumberCount<HandForces>>;

bool to_forces(const flatbuffers::Vector<double>* numbers, HandForces& forces) {
  if (numbers == nullptr || numbers->size() != ForceNumbers{}.size() || !is_aligned(numbers)) return false;
  std::uint32_t next = 0;
  bool finite = true;
  walk(forces, [&](const FieldName&, double& number) {
    number = numbers->Get(next++);
    finite = finite && is_finite(number);
  });
  return finite;
}

bool to_objects(const flatbuffers::Vector<double>* numbers, std::vector<ObjectState>& objects) {
  constexpr std::size_t kNumbers = kNumberCount<ObjectState>;
  objects.clear();
  if (numbers == nullptr) return true;
  if (numbers->size() % kNumbers != 0 || numbers->size() / kNumbers > kMostObjects || !is_aligned(numbers))
    return false;
  bool finite = true;
  std::uint32_t next = 0;
  objects.resize(numbers->size() / kNumbers);
  for (ObjectState& object : objects) {
    walk(object, [&](const FieldName&, double& number) {
      number = numbers->Get(next++);
      finite = finite && is_finite(number);
    });
  }
  return finite;
}

bool is_share(double value) { return value >= 0 && value <= 1; }

}  // namespace

std::vector<std::uint8_t> encode_state(const State& state) {
  flatbuffers::FlatBufferBuilder builder(8192);
  builder.ForceDefaults(true);  // a number left out because it equals its default might have been -0
  const auto put = [&builder](const HandForces& forces) {
    const auto numbers = std::bit_cast<ForceNumbers>(forces);
    return builder.CreateVector(numbers.data(), numbers.size());
  };
  const auto last = put(state.last), held = put(state.held);
  std::vector<double> numbers;
  for (const ObjectState& object : state.objects)
    walk(object, [&numbers](const FieldName&, double number) { numbers.push_back(number); });
  const auto objects = builder.CreateVector(numbers);
  builder.Finish(fb::CreateState(builder, state.tick, state.rise, state.fall, last, held, objects));
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
                    to_forces(message.last(), result.last) && to_forces(message.held(), result.held) &&
                    to_objects(message.objects(), result.objects);
  if (!good) return Status::error("the state message holds numbers out of range");
  state = result;
  return {};
}

}  // namespace lumbrical
