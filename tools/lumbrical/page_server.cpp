// See page_server.h.
#include "page_server.h"

#include <arpa/inet.h>
#include <fcntl.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <exception>
#include <list>
#include <string_view>
#include <thread>
#include <utility>
#include <vector>

#include "http_request.h"

namespace lumbrical::tool {
namespace {

constexpr std::size_t kMostHead = 16384;
constexpr std::size_t kMostConnections = 32;
constexpr std::size_t kPiece = std::size_t{256} << 10;
constexpr int kGlance = 200;      // ms, after which threads look whether they are still wanted
constexpr int kPatience = 30000;  // ms, for a browser that neither asks nor takes

/// Without the page's own policy, which must allow nothing more than the page needs, it is not served.
std::string policy_of(const std::string& html) {
  constexpr std::string_view kStart = "http-equiv=\"Content-Security-Policy\" content=\"";
  const std::size_t start = html.find(kStart);
  if (start == std::string::npos) return {};
  const std::size_t begin = start + kStart.size();
  return html.substr(begin, html.find('"', begin) - begin) + "; frame-ancestors 'none'";
}

/// Waits until the socket is ready, no longer wanted, or out of patience; true: ready.
bool wait_for(int socket, short events, const std::atomic<bool>& running) {
  for (int waited = 0; running && waited < kPatience; waited += kGlance) {
    pollfd ready{socket, events, 0};
    if (poll(&ready, 1, kGlance) > 0) return true;
  }
  return false;
}

struct Connection {
  int socket = -1;
  const std::atomic<bool>& running;

  bool send(const void* data, std::size_t size) const {
    const char* at = static_cast<const char*>(data);
    while (size > 0) {
      if (!wait_for(socket, POLLOUT, running)) return false;
      const ssize_t sent = ::send(socket, at, size, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (sent < 0 && (errno == EAGAIN || errno == EINTR)) continue;
      if (sent <= 0) return false;
      at += sent;
      size -= static_cast<std::size_t>(sent);
    }
    return true;
  }
  bool send(std::string_view text) const { return send(text.data(), text.size()); }

  /// The next request's head from what has come; `rest` keeps what is behind it.
  bool receive_head(std::string& rest, std::string& head) const {
    for (;;) {
      const std::size_t end = rest.find("\r\n\r\n");
      if (end != std::string::npos) {
        head = rest.substr(0, end + 2);
        rest.erase(0, end + 4);
        return true;
      }
      if (rest.size() > kMostHead || !wait_for(socket, POLLIN, running)) return false;
      char piece[4096];
      const ssize_t count = recv(socket, piece, sizeof piece, MSG_DONTWAIT);
      if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
      if (count <= 0) return false;
      rest.append(piece, static_cast<std::size_t>(count));
    }
  }
};

struct OpenFile {
  int descriptor = -1;
  explicit OpenFile(int opened) : descriptor(opened) {}
  OpenFile(const OpenFile&) = delete;
  OpenFile& operator=(const OpenFile&) = delete;
  ~OpenFile() {
    if (descriptor >= 0) ::close(descriptor);
  }
};

struct Head {
  std::string status = "200 OK", type = "text/plain; charset=utf-8", more{};
  std::uint64_t length = 0;
  bool chunked = false;
};

std::string head_text(const Head& head, const std::string& policy, bool keep_alive) {
  return "HTTP/1.1 " + head.status + "\r\nContent-Type: " + head.type +
         (head.chunked ? "\r\nTransfer-Encoding: chunked"
                       : "\r\nContent-Length: " + std::to_string(head.length)) +
         "\r\n" + head.more +
         "Cache-Control: no-store\r\nX-Content-Type-Options: nosniff\r\nReferrer-Policy: no-referrer\r\n"
         "Cross-Origin-Resource-Policy: same-origin\r\nCross-Origin-Opener-Policy: same-origin\r\n"
         "Content-Security-Policy: " +
         policy + "\r\nConnection: " + (keep_alive ? "keep-alive" : "close") + "\r\n\r\n";
}

}  // namespace

struct PageServer::Server {
  PageContent content;
  std::string policy;
  int listener = -1;
  std::uint16_t port = 0;
  std::atomic<bool> running{true};
  std::atomic<std::size_t> connections{0};
  struct Worker {
    std::atomic<bool> done{false};
    std::thread thread;
  };
  std::list<Worker> workers;  // of `acceptor` alone, until that has ended
  std::thread acceptor;

  bool answer_text(const Connection& to, const HttpRequest& request, const Head& head,
                   std::string_view text) const {
    Head sized = head;
    sized.length = text.size();
    return to.send(head_text(sized, policy, request.keep_alive)) &&
           (request.method == "HEAD" || to.send(text));
  }

  bool answer_file(const Connection& to, const HttpRequest& request, const std::string& path) const {
    const OpenFile file{::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
    struct stat status {};
    if (file.descriptor < 0 || fstat(file.descriptor, &status) != 0)
      return answer_text(to, request, {"404 Not Found"}, "The file is no longer there.\n");
    return send_file(to, request, file.descriptor, static_cast<std::uint64_t>(status.st_size));
  }

  bool send_file(const Connection& to, const HttpRequest& request, int file, std::uint64_t size) const {
    Head head{"200 OK", "application/octet-stream", "Accept-Ranges: bytes\r\n", size};
    std::uint64_t at = 0;
    if (!request.range.empty()) {
      const auto range = parse_range(request.range, size);
      const std::string of = "/" + std::to_string(size) + "\r\n";
      if (!range)
        return answer_text(to, request,
                           {"416 Range Not Satisfiable", head.type, "Content-Range: bytes *" + of}, "");
      head.status = "206 Partial Content";
      head.length = range->last - range->first + 1;
      head.more +=
          "Content-Range: bytes " + std::to_string(range->first) + "-" + std::to_string(range->last) + of;
      at = range->first;
    }
    if (!to.send(head_text(head, policy, request.keep_alive))) return false;
    if (request.method == "HEAD") return true;
    std::vector<char> piece(std::min<std::uint64_t>(kPiece, head.length));
    for (std::uint64_t left = head.length; left > 0;) {
      const ssize_t count =
          pread(file, piece.data(), std::min<std::uint64_t>(piece.size(), left), static_cast<off_t>(at));
      if (count <= 0 || !to.send(piece.data(), static_cast<std::size_t>(count))) return false;
      at += static_cast<std::uint64_t>(count);
      left -= static_cast<std::uint64_t>(count);
    }
    return true;
  }

  bool answer_live(const Connection& to) const {
    Head head{"200 OK", "application/octet-stream"};
    head.chunked = true;
    if (!to.send(head_text(head, policy, false))) return false;
    std::string chunk;
    content.live([&](std::span<const std::uint8_t> bytes) {
      char size[24];
      std::snprintf(size, sizeof size, "%zx\r\n", bytes.size());
      chunk.assign(size).append(bytes.begin(), bytes.end()).append("\r\n");
      return to.send(chunk);  // at once, so that the end does not come amid it
    });
    // When the session ends the server stops, and to.send() sends no more.
    constexpr std::string_view kEnd = "0\r\n\r\n";
    ::send(to.socket, kEnd.data(), kEnd.size(), MSG_NOSIGNAL | MSG_DONTWAIT);
    return false;
  }

  /// False: the connection is over.
  bool answer(const Connection& to, const HttpRequest& request) const {
    if (!is_own_host(request.host, port))
      return answer_text(to, request, {"403 Forbidden"},
                         "This page answers to 127.0.0.1 and localhost only.\n");
    if (request.method != "GET" && request.method != "HEAD")
      return answer_text(to, request, {"405 Method Not Allowed", "text/plain", "Allow: GET, HEAD\r\n"}, "");
    if (request.path == "/")
      return answer_text(to, request, {"200 OK", "text/html; charset=utf-8"}, content.html);
    if (request.path == "/live" && content.live && request.method == "GET") return answer_live(to);
    const auto file = content.files.find(request.path);
    if (file != content.files.end()) return answer_file(to, request, file->second);
    return answer_text(to, request, {"404 Not Found"}, "There is no such file.\n");
  }

  void serve(int socket) {
    try {
      answer_all({socket, running});
    } catch (const std::exception&) {  // no memory for this one; nobody could catch what leaves a thread
    }
    --connections;  // first: who sees the end may ask again at once
    ::close(socket);
  }

  void answer_all(const Connection& connection) const {
    std::string rest, head;
    while (running && connection.receive_head(rest, head)) {
      const auto request = parse_request(head);
      if (!request) {
        answer_text(connection, {"GET", "", "", "", false}, {"400 Bad Request"}, "");
        break;
      }
      if (!answer(connection, *request) || !request->keep_alive) break;
    }
  }

  /// Where there is no thread or memory for it, the connection is closed; browsers try again.
  void start_worker(int socket) {
    ++connections;
    try {
      Worker& worker = workers.emplace_back();
      worker.thread = std::thread([this, socket, &worker] {
        serve(socket);
        worker.done = true;
      });
    } catch (const std::exception&) {
      if (!workers.empty() && !workers.back().thread.joinable()) workers.pop_back();
      ::close(socket);
      --connections;
    }
  }

  void accept_all() {
    while (running) {
      workers.remove_if([](Worker& worker) {
        if (!worker.done) return false;
        worker.thread.join();
        return true;
      });
      pollfd ready{listener, POLLIN, 0};
      if (poll(&ready, 1, kGlance) <= 0) continue;
      const int socket = accept4(listener, nullptr, nullptr, SOCK_CLOEXEC);
      if (socket < 0) {  // no descriptor is free, and who asks stays
        std::this_thread::sleep_for(std::chrono::milliseconds(kGlance));
        continue;
      }
      if (connections >= kMostConnections) {
        ::close(socket);
        continue;
      }
      const int on = 1;
      setsockopt(socket, IPPROTO_TCP, TCP_NODELAY, &on, sizeof on);
      start_worker(socket);
    }
    for (Worker& worker : workers) worker.thread.join();
  }

  Status listen_on(std::uint16_t wanted) {
    const auto failed = [&](const char* what) {
      return Status::error(std::string("127.0.0.1:") + std::to_string(wanted) + ": " + what + ": " +
                           std::strerror(errno) + "; choose another --port, or 0 for any that is free");
    };
    listener = socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    if (listener < 0) return failed("no socket");
    const int on = 1;
    setsockopt(listener, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(wanted);
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    if (bind(listener, reinterpret_cast<sockaddr*>(&address), sizeof address) != 0 ||
        listen(listener, 16) != 0)
      return failed("can't be listened on");
    socklen_t size = sizeof address;
    getsockname(listener, reinterpret_cast<sockaddr*>(&address), &size);
    port = ntohs(address.sin_port);
    return {};
  }

  void stop() {
    running = false;
    if (acceptor.joinable()) acceptor.join();
    if (listener >= 0) ::close(listener);
  }
};

PageServer::PageServer() : server_(std::make_unique<Server>()) {}
PageServer::~PageServer() { server_->stop(); }

Status PageServer::start(PageContent content, std::uint16_t port) {
  server_->policy = policy_of(content.html);
  if (server_->policy.empty())
    return Status::error("the viewer's page has no Content-Security-Policy; build it anew");
  server_->content = std::move(content);
  if (Status status = server_->listen_on(port); !status.ok()) return status;
  try {
    server_->acceptor = std::thread([this] { server_->accept_all(); });
  } catch (const std::exception&) {
    return Status::error("no thread for the viewer's page; the system has reached its limit");
  }
  return {};
}

std::uint16_t PageServer::port() const { return server_->port; }
bool PageServer::running() const { return server_->running; }

}  // namespace lumbrical::tool
