// See http_request.h.
#include "http_request.h"

#include <algorithm>
#include <charconv>

namespace lumbrical::tool {
namespace {

/// Takes what stands before `separator`, or all, off the front.
std::string_view take_until(std::string_view& text, std::string_view separator) {
  const std::size_t at = text.find(separator);
  const std::string_view before = text.substr(0, at);
  text.remove_prefix(at == std::string_view::npos ? text.size() : at + separator.size());
  return before;
}

std::string lower(std::string_view text) {
  std::string result(text);
  std::transform(result.begin(), result.end(), result.begin(),
                 [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; });
  return result;
}

std::string_view trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

bool read_number(std::string_view text, std::uint64_t& value) {
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  return error == std::errc() && end == text.data() + text.size();
}

/// "%20" as a space; what is no such code stays.
std::string percent_decoded(std::string_view text) {
  std::string result;
  for (std::size_t i = 0; i < text.size(); ++i) {
    std::uint8_t byte = 0;
    const char* const digits = text.data() + i + 1;
    if (text[i] == '%' && text.size() - i > 2 &&
        std::from_chars(digits, digits + 2, byte, 16).ptr == digits + 2) {
      result += static_cast<char>(byte);
      i += 2;
    } else {
      result += text[i];
    }
  }
  return result;
}

}  // namespace

std::optional<HttpRequest> parse_request(std::string_view head) {
  HttpRequest request;
  std::string_view line = take_until(head, "\r\n");
  request.method = take_until(line, " ");
  std::string_view target = take_until(line, " ");
  if (line != "HTTP/1.1" && line != "HTTP/1.0") return std::nullopt;
  request.keep_alive = line == "HTTP/1.1";
  request.path = percent_decoded(take_until(target, "?"));
  if (request.method.empty() || !request.path.starts_with('/')) return std::nullopt;
  while (!head.empty()) {
    std::string_view field = take_until(head, "\r\n");
    if (field.empty()) break;
    const std::string name = lower(take_until(field, ":"));
    const std::string_view value = trimmed(field);
    if (name == "host") request.host = lower(value);
    if (name == "range") request.range = value;
    if (name == "connection" && lower(value) == "close") request.keep_alive = false;
    // Nobody who asks for a page sends one along.
    if (name == "transfer-encoding" || (name == "content-length" && value != "0")) return std::nullopt;
  }
  return request;
}

std::optional<ByteRange> parse_range(std::string_view field, std::uint64_t size) {
  if (take_until(field, "=") != "bytes" || size == 0) return std::nullopt;
  const std::string_view first = take_until(field, "-");
  ByteRange range{0, size - 1};
  if (first.empty()) {
    std::uint64_t count = 0;
    if (!read_number(field, count) || count == 0) return std::nullopt;
    range.first = size - std::min(size, count);
    return range;
  }
  if (!read_number(first, range.first) || range.first >= size) return std::nullopt;
  if (!field.empty() && !read_number(field, range.last)) return std::nullopt;
  range.last = std::min(range.last, size - 1);
  return range.first <= range.last ? std::optional(range) : std::nullopt;
}

bool is_own_host(std::string_view host, std::uint16_t port) {
  const std::string after = ":" + std::to_string(port);
  if (host.ends_with(after))
    host.remove_suffix(after.size());
  else if (port != 80)
    return false;  // the one that browsers leave out
  return host == "127.0.0.1" || host == "localhost";
}

}  // namespace lumbrical::tool
