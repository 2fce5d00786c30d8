// Serves one page and the files it may read to browsers on this machine: HTTP/1.1 on the loopback address, a
// thread per connection, and nothing but what was named is reachable.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>

#include "lumbrical/status.h"

namespace lumbrical::tool {

struct PageContent {
  std::string html;                          ///< at "/"; its Content-Security-Policy is sent as a header too
  std::map<std::string, std::string> files;  ///< path in the address ("/a/rec.mcap") -> file, in any ranges
  /// At "/live": calls `send` until that answers false. Runs on threads of the server. May be empty.
  std::function<void(const std::function<bool(std::span<const std::uint8_t>)>& send)> live;
};

class PageServer {
 public:
  PageServer();
  ~PageServer();  ///< ends all connections
  PageServer(const PageServer&) = delete;
  PageServer& operator=(const PageServer&) = delete;

  /// Listens on 127.0.0.1; `port` 0: any that is free.
  Status start(PageContent content, std::uint16_t port);
  [[nodiscard]] std::uint16_t port() const;
  /// False once the server is going away, for what `live` waits for.
  [[nodiscard]] bool running() const;

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

/// The viewer's page, as installed with this program or built beside it.
Status read_viewer_page(std::string& html);

/// Shows the address in the desktop's browser, if there is a desktop.
void open_browser(const std::string& address);

/// A file's name as it stands in an address.
std::string percent_encoded(const std::string& name);

}  // namespace lumbrical::tool
