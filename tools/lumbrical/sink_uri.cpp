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

struct Parameter {
  std::string_view name;
  const char* values;
  bool (*take)(std::string_view value, SinkUri& uri);
};

bool take_profile(std::string_view value, SinkUri& uri) {
  uri.profile = value;
  return !value.empty();
}

bool take_side(std::string_view value, SinkUri& uri) {
  uri.side = value == "left" ? Side::left : Side::right;
  return value == "left" || value == "right";
}

template <bool SinkUri::*kMember>
bool take_on(std::string_view value, SinkUri& uri) {
  return parse_switch(value, "on", "off", uri.*kMember);
}

constexpr Parameter kParameters[] = {
    {"profile", "a file", take_profile},
    {"side", "left or right", take_side},
    {"baud", "300 to 10000000",
     [](auto value, SinkUri& uri) { return parse(value, 300, 10000000, uri.baud); }},
    {"unit", "0 to 247", [](auto value, SinkUri& uri) { return parse(value, 0, 247, uri.unit); }},
    {"rate", "0.1 to 20000 [Hz]",
     [](auto value, SinkUri& uri) { return parse(value, 0.1, 20000.0, uri.rate); }},
    {"network", "any or private",
     [](auto value, SinkUri& uri) { return parse_switch(value, "any", "private", uri.anywhere); }},
    {"feedback", "on or off", take_on<&SinkUri::feedback>},
    {"on-loss", "stop or continue",
     [](auto value, SinkUri& uri) { return parse_switch(value, "stop", "continue", uri.stop_on_loss); }},
    {"dry-run", "on or off", take_on<&SinkUri::dry_run>},
    {"guard", "on or off", take_on<&SinkUri::guard>},
    {"unattended", "accepted or refused",
     [](auto value, SinkUri& uri) { return parse_switch(value, "accepted", "refused", uri.unattended); }},
    {"limiter", "on or off", take_on<&SinkUri::limiter>},
    {"observer", "on or off", take_on<&SinkUri::observer>},
    {"local", "on or off", take_on<&SinkUri::local>}};

Status parse_parameter(std::string_view text, SinkUri& uri) {
  const std::size_t equals = std::min(text.find('='), text.size());
  const std::string_view name = text.substr(0, equals);
  const std::string quoted = "\"" + std::string(text) + "\" ";
  std::string names;
  for (const Parameter& parameter : kParameters) {
    if (parameter.name != name) {
      names += (names.empty() ? "" : ", ") + std::string(parameter.name);
      continue;
    }
    if (equals < text.size() && parameter.take(text.substr(equals + 1), uri)) return {};
    return Status::error(quoted + "can't be: " + std::string(name) + " is " + parameter.values);
  }
  return Status::error(quoted + "is no parameter of a sink; there are " + names);
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
    if (Status status = parse_parameter(rest.substr(0, end), uri); !status.ok()) return status;
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  if (uri.profile.empty())
    return Status::error("\"" + text + "\" names no device profile; add ?profile=FILE");
  return {};
}

Status load_profile(const SinkUri& uri, DeviceProfile& profile) {
  if (Status status = load_device_profile(uri.profile, profile); !status.ok()) return status;
  Transport& transport = profile.transport;
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
  return move_to_transport(uri.kind, profile);
}

Status move_to_transport(TransportKind kind, DeviceProfile& profile) {
  const bool lacks_registers = has_registers(kind) && !has_registers(profile.transport.kind);
  profile.transport.kind = kind;
  const Status status = check_profile(profile);
  if (status.ok() || !lacks_registers) return status;
  return Status::error(profile.name +
                       ": the profile was made for a transport without registers, and this one has them; "
                       "use its own, or write for each field where it is. First of all " +
                       status.message());
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
