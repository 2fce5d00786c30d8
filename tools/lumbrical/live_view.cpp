// See live_view.h.
#include "live_view.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <span>
#include <string>
#include <thread>
#include <utility>

namespace lumbrical::tool {
namespace {

constexpr double kPerSecond = 60;

/// Every message stands behind its length, four bytes, the lowest first.
void frame_message(const std::vector<std::uint8_t>& message, std::vector<std::uint8_t>& framed) {
  framed.clear();
  for (int byte = 0; byte < 4; ++byte)
    framed.push_back(static_cast<std::uint8_t>(message.size() >> (8 * byte)));
  framed.insert(framed.end(), message.begin(), message.end());
}

}  // namespace

Status LiveView::start(const Model& model) {
  every_ = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(model.settings.rate / kPerSecond));
  if (Status status = session_message(scene_of(model), session_); !status.ok()) return status;
  PageContent content;
  if (Status status = read_viewer_page(content.html); !status.ok()) return status;
  content.live = [this](const auto& send_bytes) { send(send_bytes); };
  if (Status status = server_.start(std::move(content), 0); !status.ok()) return status;
  const std::string address = "http://127.0.0.1:" + std::to_string(server_.port()) + "/#live=live";
  std::fprintf(stderr, "%s shows this session while it runs\n", address.c_str());
  open_browser(address);
  return {};
}

void LiveView::put(const TickRecord& record) noexcept {
  if (record.output.tick < next_ || !mutex_.try_lock()) return;
  next_ = record.output.tick + every_;
  newest_ = record;
  ++count_;
  mutex_.unlock();
}

void LiveView::send(const std::function<bool(std::span<const std::uint8_t>)>& send_bytes) {
  std::vector<std::uint8_t> message, framed;
  frame_message(session_, framed);
  std::uint64_t sent = 0;
  while (send_bytes(framed) && server_.running()) {
    TickRecord record;
    for (bool fresh = false; !fresh && server_.running();) {
      std::this_thread::sleep_for(std::chrono::milliseconds(8));
      const std::lock_guard lock(mutex_);
      fresh = count_ != sent;
      sent = count_;
      if (fresh) record = newest_;
    }
    tick_message(record, message);
    frame_message(message, framed);
  }
}

}  // namespace lumbrical::tool
