// The little of HTTP/1.1 that a page on this machine asks for.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace lumbrical::tool {

struct HttpRequest {
  std::string method, path;  ///< path without query, decoded
  std::string host, range;   ///< header fields; empty: not sent
  bool keep_alive = true;
};

/// The head of a request, all lines of it; none where it is not one.
std::optional<HttpRequest> parse_request(std::string_view head);

/// Bytes first .. last of a file.
struct ByteRange {
  std::uint64_t first = 0, last = 0;
};

/// The range a field "bytes=..." asks for of so many bytes; none where there is no such range.
std::optional<ByteRange> parse_range(std::string_view field, std::uint64_t size);

/// Whether the Host field names this machine by its loopback address or name, and this port, which browsers
/// leave out where it is 80: any other was led here by a name of somebody else's (DNS rebinding).
bool is_own_host(std::string_view host, std::uint16_t port);

}  // namespace lumbrical::tool
