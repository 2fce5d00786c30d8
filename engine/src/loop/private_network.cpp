// See private_network.h.
#include "loop/private_network.h"

#include <arpa/inet.h>
#include <netdb.h>
#include <netinet/in.h>
#include <sys/socket.h>

#include <array>
#include <cstdint>
#include <cstring>

namespace lumbrical {
namespace {

bool in_range(std::uint32_t address, std::uint32_t network, int bits) {
  return (address ^ network) >> (32 - bits) == 0;
}

bool is_private_v4(std::uint32_t address) {
  return in_range(address, 0x7F000000, 8) || in_range(address, 0x0A000000, 8) ||
         in_range(address, 0xAC100000, 12) || in_range(address, 0xC0A80000, 16) ||
         in_range(address, 0xA9FE0000, 16) || address == 0;
}

std::uint32_t v4_of(const sockaddr& address) {
  return ntohl(reinterpret_cast<const sockaddr_in&>(address).sin_addr.s_addr);
}

const std::uint8_t* v6_of(const sockaddr& address) {
  return reinterpret_cast<const sockaddr_in6&>(address).sin6_addr.s6_addr;
}

// ::ffff:a.b.c.d
bool maps_v4(const std::uint8_t* bytes, std::uint32_t& address) {
  static constexpr std::array<std::uint8_t, 12> kMapped = {0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xFF, 0xFF};
  if (std::memcmp(bytes, kMapped.data(), kMapped.size()) != 0) return false;
  address = std::uint32_t{bytes[12]} << 24 | std::uint32_t{bytes[13]} << 16 | std::uint32_t{bytes[14]} << 8 |
            bytes[15];
  return true;
}

// ::1, and :: which stands for it
bool is_loopback_v6(const std::uint8_t* bytes) {
  for (int i = 0; i < 15; ++i) {
    if (bytes[i] != 0) return false;
  }
  return bytes[15] <= 1;
}

Status outside(const std::string& host) {
  return Status::error(
      host + ": lies outside loopback and private networks, and whoever is on the way " +
      "could command the device; put a tunnel in between (docs/device.md), or write network=any");
}

}  // namespace

int resolve(const std::string& host, const char* service, int flags, Addresses& list) {
  addrinfo hints{};
  hints.ai_socktype = SOCK_STREAM;  // or each would be there several times
  hints.ai_flags = flags;
  addrinfo* found = nullptr;
  const int error = getaddrinfo(host.c_str(), service, &hints, &found);
  list = {found, [](addrinfo* first) {
            if (first != nullptr) freeaddrinfo(first);
          }};
  return error;
}

bool is_private(const sockaddr& address) {
  if (address.sa_family == AF_INET) return is_private_v4(v4_of(address));
  if (address.sa_family != AF_INET6) return false;
  const std::uint8_t* const bytes = v6_of(address);
  if (std::uint32_t v4 = 0; maps_v4(bytes, v4)) return is_private_v4(v4);
  return is_loopback_v6(bytes) || (bytes[0] & 0xFE) == 0xFC ||
         (bytes[0] == 0xFE && (bytes[1] & 0xC0) == 0x80);
}

bool is_loopback(const sockaddr& address) {
  if (address.sa_family == AF_INET) return in_range(v4_of(address), 0x7F000000, 8);
  if (address.sa_family != AF_INET6) return false;
  const std::uint8_t* const bytes = v6_of(address);
  if (std::uint32_t v4 = 0; maps_v4(bytes, v4)) return in_range(v4, 0x7F000000, 8);
  return is_loopback_v6(bytes) && bytes[15] == 1;
}

Status find_host(const std::string& host, bool anywhere, std::vector<std::string>& addresses) {
  addresses.clear();
  Addresses list(nullptr, nullptr);
  if (const int error = resolve(host, nullptr, 0, list); error != 0) {
    return Status::error(host + ": host not found (" + gai_strerror(error) + ")");
  }
  for (const addrinfo* one = list.get(); one != nullptr; one = one->ai_next) {
    std::array<char, NI_MAXHOST> text{};
    if (!anywhere && !is_private(*one->ai_addr)) continue;
    if (getnameinfo(one->ai_addr, one->ai_addrlen, text.data(), text.size(), nullptr, 0, NI_NUMERICHOST) ==
        0) {
      addresses.emplace_back(text.data());
    }
  }
  return addresses.empty() ? outside(host) : Status();
}

Status check_host(const std::string& host, bool anywhere) {
  Addresses list(nullptr, nullptr);
  if (anywhere || resolve(host, nullptr, AI_NUMERICHOST, list) != 0) return {};
  return is_private(*list->ai_addr) ? Status() : outside(host);
}

}  // namespace lumbrical
