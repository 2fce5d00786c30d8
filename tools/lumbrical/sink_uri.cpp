// See sink_uri.h.
#include "sink_uri.h"

#include <algorithm>
#include <charconv>
#include <iterator>
#include <string_view>

#include "lumbrical/datagram_wire.h"
#include "lumbrical/modbus_wire.h"
#include "lumbrical/shared_memory_wire.h"

namespace lumbrical::tool {
namespace {

struct Scheme {
  std::string_view text;
  TransportKind kind;
};
constexpr const char* kPlaces[] = {"host and port", "line such as /dev/ttyUSB0", "host and port",
                                   "region such as /device"};  // by TransportKind
constexpr Scheme kSchemes[] = {{"modbus-tcp://", TransportKind::tcp},
                               {"modbus-rtu://", TransportKind::rtu},
                               {"udp://", TransportKind::udp},
                               {"memory://", TransportKind::memory}};

template <class Number>
bool parse(std::string_view text, Number low, Number high, Number& number) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  return error == std::errc() && end == text.data() + text.size() && number >= low && number <= high;
}

bool parse_switch(std::string_view text, std::string_view yes, std::string_view no, bool& value) {
  if (text != yes && text != no) return false;
  value = text == yes;
  return true;
}

bool parse_parameter(std::string_view name, std::string_view value, SinkUri& uri) {
  if (name == "profile") {
    uri.profile = value;
    return !value.empty();
  }
  if (name == "side") {
    uri.side = value == "left" ? Side::left : Side::right;
    return value == "left" || value == "right";
  }
  if (name == "baud") return parse(value, 300, 10000000, uri.baud);
  if (name == "unit") return parse(value, 0, 247, uri.unit);
  if (name == "rate") return parse(value, 0.1, 20000.0, uri.rate);
  if (name == "network") return parse_switch(value, "any", "private", uri.anywhere);
  if (name == "guard") return parse_switch(value, "on", "off", uri.guard);
  if (name == "unattended") return parse_switch(value, "accepted", "refused", uri.unattended);
  if (name == "feedback") return parse_switch(value, "on", "off", uri.feedback);
  if (name == "on-loss") return parse_switch(value, "stop", "continue", uri.stop_on_loss);
  if (name == "dry-run") return parse_switch(value, "on", "off", uri.dry_run);
  if (name == "limiter") return parse_switch(value, "on", "off", uri.limiter);
  if (name == "observer") return parse_switch(value, "on", "off", uri.observer);
  if (name == "local") return parse_switch(value, "on", "off", uri.local);
  return false;
}

struct Parameter {
  std::string_view name;
  const char* values;
};
constexpr Parameter kParameters[] = {{"profile", "a file"},
                                     {"side", "left or right"},
                                     {"baud", "300 to 10000000"},
                                     {"unit", "0 to 247"},
                                     {"rate", "0.1 to 20000 [Hz]"},
                                     {"network", "any or private"},
                                     {"feedback", "on or off"},
                                     {"on-loss", "stop or continue"},
                                     {"dry-run", "on or off"},
                                     {"guard", "on or off"},
                                     {"unattended", "accepted or refused"},
                                     {"limiter", "on or off"},
                                     {"observer", "on or off"},
                                     {"local", "on or off"}};

// What is wrong with a parameter that could not be taken.
std::string fault_of(std::string_view name) {
  std::string names;
  for (const Parameter& parameter : kParameters) {
    if (parameter.name == name) return "can't be: " + std::string(name) + " is " + parameter.values;
    names += (names.empty() ? "" : ", ") + std::string(parameter.name);
  }
  return "is no parameter of a sink; there are " + names;
}

bool parse_place(std::string_view place, SinkUri& uri) {
  if (uri.kind == TransportKind::rtu) {
    uri.line = place;
    return !place.empty() && place.front() == '/';
  }
  if (uri.kind == TransportKind::memory) {
    uri.region = place;
    return place.size() > 1 && place.front() == '/';
  }
  std::string_view port;
  if (!split_host(place, false, uri.host, port) || uri.host.empty()) return false;
  return port.empty() || parse(port, 1, 65535, uri.port);
}

}  // namespace

bool split_host(std::string_view text, bool alone_is_port, std::string& host, std::string_view& port) {
  if (text.starts_with('[')) {  // an IPv6 address
    const std::size_t end = text.find(']');
    if (end == std::string_view::npos) return false;
    host = text.substr(1, end - 1);
    text.remove_prefix(end + 1);
    if (!text.empty() && text.front() != ':') return false;
    port = text.substr(std::min<std::size_t>(1, text.size()));
    return true;
  }
  const std::size_t colon = text.find(':');
  if (colon != text.rfind(':')) return false;  // one without brackets
  if (colon == std::string_view::npos && alone_is_port) {
    port = text;
    return true;
  }
  host = text.substr(0, colon);
  port = colon == std::string_view::npos ? std::string_view() : text.substr(colon + 1);
  return true;
}

Status parse_sink_uri(const std::string& text, SinkUri& uri) {
  std::string_view rest = text;
  const auto* const scheme = std::find_if(std::begin(kSchemes), std::end(kSchemes),
                                          [&](const Scheme& one) { return rest.starts_with(one.text); });
  if (scheme == std::end(kSchemes)) {
    return Status::error(
        "\"" + text +
        "\" is no sink; use null, or modbus-tcp://HOST:PORT, modbus-rtu:///dev/ttyX, udp://HOST:PORT or " +
        "memory:///NAME, with ?profile=FILE");
  }
  uri.kind = scheme->kind;
  rest.remove_prefix(scheme->text.size());
  const std::size_t question = rest.find('?');
  if (!parse_place(rest.substr(0, question), uri)) {
    return Status::error("\"" + text + "\" names no " + kPlaces[static_cast<std::size_t>(uri.kind)]);
  }
  rest = question == std::string_view::npos ? std::string_view() : rest.substr(question + 1);
  while (!rest.empty()) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view one = rest.substr(0, end);
    const std::size_t equals = std::min(one.find('='), one.size());
    if (equals == one.size() || !parse_parameter(one.substr(0, equals), one.substr(equals + 1), uri))
      return Status::error("\"" + std::string(one) + "\" " + fault_of(one.substr(0, equals)));
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (uri.profile.empty())
    return Status::error("\"" + text + "\" names no device profile; add ?profile=FILE");
  return {};
}

Status load_profile(const SinkUri& uri, DeviceProfile& profile) {
  if (Status status = load_device_profile(uri.profile, profile); !status.ok()) return status;
  Transport& transport = profile.transport;
  const bool lacks_registers = has_registers(uri.kind) && !has_registers(transport.kind);
  transport.kind = uri.kind;
  profile.unattended = profile.unattended || uri.unattended;
  transport.anywhere = transport.anywhere || uri.anywhere;
  if (!uri.host.empty()) transport.host = uri.host;
  if (!uri.line.empty()) transport.line = uri.line;
  if (!uri.region.empty()) transport.region = uri.region;
  if (uri.port >= 0) transport.port = static_cast<std::uint16_t>(uri.port);
  if (uri.baud >= 0) transport.baud = static_cast<std::uint32_t>(uri.baud);
  if (profile.side && uri.side && *profile.side != *uri.side)
    return Status::error(uri.profile + ": drives a " + std::string(side_name(*profile.side)) +
                         " hand, and side=" + std::string(side_name(*uri.side)) + " asks for another");
  if (uri.side) profile.side = uri.side;
  if (uri.rate > 0) profile.rate = uri.rate;
  if (uri.unit >= 0) set_unit(profile, static_cast<std::uint8_t>(uri.unit));
  const Status status = check_profile(profile);
  if (status.ok() || !lacks_registers) return status;
  return Status::error(status.message() + "; the profile was made for a transport without registers");
}

std::string check_sink_uri(std::string& text) {
  SinkUri uri;
  return text == "null" ? std::string() : parse_sink_uri(text, uri).message();
}

Status make_wire(const DeviceProfile& profile, std::unique_ptr<DeviceWire>& wire) {
  switch (profile.transport.kind) {
    case TransportKind::udp:
      return make_datagram_wire(profile, wire);
    case TransportKind::memory:
      return make_shared_memory_wire(profile, wire);
    default:
      return make_modbus_wire(profile, wire);
  }
}

}  // namespace lumbrical::tool
