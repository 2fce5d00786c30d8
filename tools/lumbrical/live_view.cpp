// See live_view.h.
#include "live_view.h"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <optional>
#include <span>
#include <string>
#include <thread>
#include <utility>

namespace lumbrical::tool {
namespace {

constexpr double kPerSecond = 60;

/// Every message stands behind its length, four bytes, the lowest first, and the number of its hand.
void frame_message(const std::vector<std::uint8_t>& message, std::size_t hand,
                   std::vector<std::uint8_t>& framed) {
  framed.clear();
  for (int byte = 0; byte < 4; ++byte)
    framed.push_back(static_cast<std::uint8_t>(message.size() >> (8 * byte)));
  framed.push_back(static_cast<std::uint8_t>(hand));
  framed.insert(framed.end(), message.begin(), message.end());
}

}  // namespace

Status LiveView::start(const std::vector<Model>& models) {
  every_ = std::max<std::uint64_t>(1, static_cast<std::uint64_t>(models[0].settings.rate / kPerSecond));
  std::optional<Hand> second;
  if (models.size() > 1) second = models[1].hand;
  if (Status status = session_message(scene_of(models[0]), session_, second); !status.ok()) return status;
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
  sent_[record.hand].take(record);
  std::uint64_t& next = next_[record.hand];
  if (record.output.tick < next || !mutex_.try_lock()) return;
  next = record.output.tick + every_;
  Newest& newest = newest_[record.hand];
  newest.record = record;
  sent_[record.hand].put_into(newest.record);
  ++newest.count;
  mutex_.unlock();
}

void LiveView::send(const std::function<bool(std::span<const std::uint8_t>)>& send_bytes) {
  std::vector<std::uint8_t> message, framed;
  frame_message(session_, 0, framed);
  bool wanted = send_bytes(framed);
  std::array<std::uint64_t, kMostHands> sent{};
  TickRecord record;
  while (wanted && server_.running()) {
    std::this_thread::sleep_for(std::chrono::milliseconds(8));
    for (std::size_t hand = 0; hand < kMostHands && wanted; ++hand) {
      {
        const std::lock_guard lock(mutex_);
        if (newest_[hand].count == sent[hand]) continue;
        sent[hand] = newest_[hand].count;
        record = newest_[hand].record;
      }
      tick_message(record, message);
      frame_message(message, hand, framed);
      wanted = send_bytes(framed);
    }
  }
}

}  // namespace lumbrical::tool
