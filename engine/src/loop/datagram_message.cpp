// See datagram_message.h and lumbrical/datagram_wire.h. Whatever comes from outside is verified, then copied.
#include "loop/datagram_message.h"

#include <algorithm>
#include <cstring>

#include "base/message_alignment.h"
#include "datagram_generated.h"
#include "lumbrical/math.h"

namespace lumbrical {
namespace {

namespace fb = datagram;

// Verified, and aligned as FlatBuffers want it; nullptr if it can't be.
class Received {
 public:
  explicit Received(std::span<const std::byte> bytes) {
    if (bytes.empty() || bytes.size() > storage_.size() * sizeof(std::uint64_t)) return;
    std::memcpy(storage_.data(), bytes.data(), bytes.size());
    const auto* const data = reinterpret_cast<const std::uint8_t*>(storage_.data());
    flatbuffers::Verifier verifier(data, bytes.size());
    if (fb::VerifyDatagramBuffer(verifier)) root_ = fb::GetDatagram(data);
  }
  [[nodiscard]] const fb::Datagram* operator->() const { return root_; }
  explicit operator bool() const { return root_ != nullptr; }

 private:
  std::array<std::uint64_t, kMostDatagram / sizeof(std::uint64_t)> storage_;
  const fb::Datagram* root_ = nullptr;
};

void finish(flatbuffers::FlatBufferBuilder& builder, fb::Message kind, flatbuffers::Offset<void> message,
            std::vector<std::byte>& datagram) {
  fb::FinishDatagramBuffer(builder, fb::CreateDatagram(builder, kind, message));
  const auto* const first = reinterpret_cast<const std::byte*>(builder.GetBufferPointer());
  datagram.assign(first, first + builder.GetSize());
}

// Another number of them, or one that is none, is no list.
template <class Take>
bool take_numbers(const flatbuffers::Vector<double>* numbers, std::size_t count, Take&& take) {
  if (numbers == nullptr || numbers->size() != count || !is_aligned(numbers)) return false;
  for (std::size_t i = 0; i < count; ++i) {
    const double number = numbers->Get(static_cast<flatbuffers::uoffset_t>(i));
    if (!is_finite(number)) return false;
    take(i, number);
  }
  return true;
}

}  // namespace

void write_command(std::uint64_t session, const WireCommand& command, std::size_t actuator_count,
                   std::vector<std::byte>& datagram) {
  std::array<double, kMaxActuators> angle{}, stiffness{}, radius{};
  for (std::size_t i = 0; i < actuator_count; ++i) {
    const LocalModel local = local_model_of(command, i);
    angle[i] = local.angle;
    stiffness[i] = local.stiffness;
    radius[i] = local.radius;
  }
  flatbuffers::FlatBufferBuilder builder(kMostDatagram);
  const auto list = [&](const double* numbers) { return builder.CreateVector(numbers, actuator_count); };
  const auto value = list(command.output.command.data());
  const auto angles = list(angle.data()), stiffnesses = list(stiffness.data()), radii = list(radius.data());
  const auto message = fb::CreateCommand(builder, session, command.cycle, command.output.device_on, value,
                                         angles, stiffnesses, radii);
  finish(builder, fb::Message::Command, message.Union(), datagram);
}

bool read_command(std::span<const std::byte> datagram, std::size_t actuator_count, CommandDatagram& command) {
  const Received received(datagram);
  if (!received || actuator_count > kMaxActuators) return false;
  const fb::Command* const from = received->message_as_Command();
  if (from == nullptr) return false;
  CommandDatagram result;
  result.session = from->session();
  result.cycle = from->cycle();
  result.active = from->active();
  const bool whole =
      take_numbers(from->value(), actuator_count, [&](auto i, double x) { result.value[i] = x; }) &&
      take_numbers(from->angle(), actuator_count, [&](auto i, double x) { result.local[i].angle = x; }) &&
      take_numbers(from->stiffness(), actuator_count,
                   [&](auto i, double x) { result.local[i].stiffness = x; }) &&
      take_numbers(from->radius(), actuator_count, [&](auto i, double x) { result.local[i].radius = x; });
  if (whole) command = result;
  return whole;
}

void write_feedback(const CommandDatagram& command, const DeviceStatus& status,
                    std::span<const float, kAngleCount> angle, std::uint32_t valid,
                    std::vector<std::byte>& datagram) {
  flatbuffers::FlatBufferBuilder builder(kMostDatagram);
  const auto angles = builder.CreateVector(angle.data(), angle.size());
  flatbuffers::Offset<flatbuffers::String> dead_man;
  if (status.has_dead_man) dead_man = builder.CreateString(status.dead_man ? "held" : "released");
  const auto message = fb::CreateFeedback(builder, command.session, command.cycle, status.ready, status.fault,
                                          status.stop, dead_man, angles, valid, status.boot);
  finish(builder, fb::Message::Feedback, message.Union(), datagram);
}

bool read_feedback(std::span<const std::byte> datagram, std::uint64_t session, std::uint64_t& cycle,
                   WireAnswer& answer) {
  const Received received(datagram);
  if (!received) return false;
  const fb::Feedback* const from = received->message_as_Feedback();
  if (from == nullptr || from->session() != session) return false;
  cycle = from->cycle();
  answer.status = {};
  answer.status.ready = from->ready();
  answer.status.fault = from->fault();
  answer.status.stop = from->stop();
  answer.status.boot = from->boot();
  answer.status.has_dead_man = from->dead_man() != nullptr;
  answer.status.dead_man = from->dead_man() == nullptr || from->dead_man()->str() == "held";
  const auto* const angles = from->angle();
  const std::size_t count =
      angles != nullptr ? std::min<std::size_t>(angles->size(), answer.angle.size()) : 0;
  for (std::size_t a = 0; a < count; ++a)
    answer.angle[a] = angles->Get(static_cast<flatbuffers::uoffset_t>(a));
  answer.valid = from->valid() & static_cast<std::uint32_t>((std::uint64_t{1} << count) - 1);
  return true;
}

}  // namespace lumbrical
