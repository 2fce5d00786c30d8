// Which hosts may be talked to: neither Modbus nor datagrams have a lock on their door.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "lumbrical/status.h"

struct addrinfo;
struct sockaddr;

namespace lumbrical {

/// Whether an address is of this machine or of a private network: 127/8, 10/8, 172.16/12, 192.168/16,
/// 169.254/16 and 0.0.0.0; ::1, ::, fc00::/7, fe80::/10 and those of IPv4 within IPv6.
bool is_private(const sockaddr& address);
bool is_loopback(const sockaddr& address);

/// As the system's resolver gives them; empty: none.
using Addresses = std::unique_ptr<addrinfo, void (*)(addrinfo*)>;

/// Of a host's service, or null for none; `flags` of getaddrinfo, whose error it returns.
int resolve(const std::string& host, const char* service, int flags, Addresses& list);

/// The addresses of a host as numbers, in the order to be tried, without those outside unless `anywhere`.
/// `host` may be a number itself, which is not asked for: then the answer comes at once. Otherwise it may
/// take as long as the system's resolver does.
Status find_host(const std::string& host, bool anywhere, std::vector<std::string>& addresses);

/// Whether find_host would refuse it, as far as that can be said without asking the network.
Status check_host(const std::string& host, bool anywhere);

}  // namespace lumbrical
