// See lumbrical/modbus_wire.h.
#include "lumbrical/modbus_wire.h"

#include <string>
#include <utility>

#include "base/steady_clock.h"
#include "loop/private_network.h"
#include "modbus/exchange_words.h"
#include "modbus/modbus_link.h"

namespace lumbrical {
namespace {

class ModbusWire final : public DeviceWire {
 public:
  explicit ModbusWire(const DeviceProfile& profile) : profile_(profile), words_(profile) {
    link_.patience.hurry = [this] { return patience.hurry && patience.hurry(); };
  }
  Status open() override {
    set_patience();
    return link_.open(profile_.transport, profile_.response_timeout);
  }
  void close() override { link_.close(); }
  WireResult greet() override;
  WireResult read_commands(ActuatorArray& command) override;
  WireResult look_back(bool& foreign) override;
  WireResult exchange(const WireCommand& command, WireAnswer& answer) override;

 private:
  void set_patience() {
    link_.patience.usual = patience.usual;
    link_.patience.hurried = patience.hurried;
  }
  WireResult told(const LinkResult& result, const char* doing, const RegisterBlock& block) const;
  WireResult write_commands();
  WireResult transfer(WireAnswer& answer);

  DeviceProfile profile_;
  ExchangeWords words_;
  ModbusLink link_;
  std::uint16_t last_beat_ = 0;
  std::int64_t last_look_ = 0;
  std::size_t look_ = 0;
};

// What is wrong is told with the names of the registers it was about.
WireResult ModbusWire::told(const LinkResult& result, const char* doing, const RegisterBlock& block) const {
  if (result.ok()) return {};
  return {result.outcome == LinkOutcome::broken ? WireOutcome::broken : WireOutcome::refused,
          std::string(result.text) + ", " + doing + " " + name_registers(profile_, block)};
}

// What the profile wants to be written first; then its conditions, until they hold.
WireResult ModbusWire::greet() {
  set_patience();
  for (const RegisterWrite& write : profile_.handshake) {
    const RegisterBlock block{write.unit, write.address, 1};
    if (WireResult result = told(link_.write(block, &write.value), "writing", block); !result.ok())
      return result;
  }
  for (const RegisterCheck& check : profile_.expected) {
    const RegisterBlock block{check.unit, check.address, 1};
    std::uint16_t value = 0;
    const LinkResult read = link_.read(profile_.read_function, block, &value);
    if (WireResult result = told(read, "reading", block); !result.ok()) return result;
    if ((value & check.mask) != check.value)
      return {WireOutcome::waiting,
              "the device is not ready yet: " + name_registers(profile_, block) + " holds another value"};
  }
  return {};
}

// Those that can't be read count as safe.
WireResult ModbusWire::read_commands(ActuatorArray& command) {
  set_patience();
  SafetyOutput safe;
  safe.command = start_safety(profile_).output;
  words_.write(profile_, {0, safe, {}});
  WireResult worst;
  std::size_t at = 0;
  for (const RegisterBlock& block : words_.plan.writes) {
    WireResult result = told(link_.read(3, block, words_.written.data() + at), "reading", block);
    if (result.outcome == WireOutcome::broken) return result;
    if (!result.ok()) worst = std::move(result);
    at += block.count;
  }
  words_.commands(profile_, command);
  return worst;
}

// Do the registers still hold what was written? A few of them at a time, and not all the time.
WireResult ModbusWire::look_back(bool& foreign) {
  foreign = false;
  if (!(profile_.read_back > 0)) return {};
  const std::int64_t now = steady_ns();
  if (in_seconds(now - last_look_) < profile_.read_back) return {};
  last_look_ = now;
  set_patience();
  const auto [block, at] = words_.part(look_++);
  const LinkResult result = link_.read(3, block, words_.read_back.data());
  foreign = result.ok() && !words_.holds(block, at);
  if (result.exception == kIllegalFunction || result.exception == kIllegalAddress)
    return {WireOutcome::refused,
            "the device does not let its commands be read back (" + std::string(result.text) + ")"};
  WireResult looked = told(result, "reading back", block);
  if (looked.outcome == WireOutcome::refused) looked.outcome = WireOutcome::waiting;  // busy, say
  return looked;
}

WireResult ModbusWire::exchange(const WireCommand& command, WireAnswer& answer) {
  set_patience();
  words_.write(profile_, command);
  WireResult result = transfer(answer);
  if (!result.ok()) return result;
  answer.status = words_.status(profile_);
  words_.angles(profile_, answer.angle, answer.valid);
  return result;
}

// A device that refuses a part of its commands may hold a force there: it is told the others, but its
// heartbeat stands still, so that its watchdog lets go.
WireResult ModbusWire::write_commands() {
  std::uint16_t* const beat = words_.heartbeat(profile_);
  WireResult refused;
  std::size_t at = 0;
  for (const RegisterBlock& block : words_.plan.writes) {
    const bool is_last = &block == &words_.plan.writes.back();
    if (beat != nullptr && is_last && !refused.ok()) *beat = last_beat_;
    WireResult result = told(link_.write(block, words_.written.data() + at), "writing", block);
    if (result.outcome == WireOutcome::broken) return result;
    if (!result.ok()) refused = std::move(result);
    at += block.count;
  }
  if (beat != nullptr) last_beat_ = *beat;
  return refused;
}

WireResult ModbusWire::transfer(WireAnswer& answer) {
  const ExchangePlan& plan = words_.plan;
  answer.asked = steady_ns();
  if (plan.combined)
    return told(link_.exchange(plan.writes[0], words_.written.data(), plan.reads[0], words_.read.data()),
                "writing", plan.writes[0]);
  if (WireResult result = write_commands(); !result.ok()) return result;
  std::size_t at = 0;
  answer.asked = steady_ns();
  for (const RegisterBlock& block : plan.reads) {
    const LinkResult read = link_.read(profile_.read_function, block, words_.read.data() + at);
    if (WireResult result = told(read, "reading", block); !result.ok()) return result;
    at += block.count;
  }
  return {};
}

}  // namespace

Status make_modbus_wire(const DeviceProfile& profile, std::unique_ptr<DeviceWire>& wire) {
  if (!has_registers(profile.transport.kind))
    return Status::error(profile.name + ": is no Modbus device by its transport");
  if (Status status = check_profile(profile); !status.ok()) return status;
  const Transport& transport = profile.transport;
  if (transport.kind == TransportKind::tcp) {
    if (Status status = check_host(transport.host, transport.anywhere); !status.ok()) return status;
  }
  wire = std::make_unique<ModbusWire>(profile);
  return {};
}

}  // namespace lumbrical
