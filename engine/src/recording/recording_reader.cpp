// Reading a recording: find its session and chunks, then hand out one tick after the other.
#include <algorithm>
#include <filesystem>
#include <memory>
#include <new>
#include <system_error>
#include <utility>

#include "lumbrical/tick.h"
#include "lumbrical/world.h"
#include "recording/reader_file.h"
#include "recording/tick_message.h"

namespace lumbrical {

using namespace mcap;

RecordingReader::RecordingReader() = default;
RecordingReader::~RecordingReader() = default;
RecordingReader::RecordingReader(RecordingReader&&) noexcept = default;
RecordingReader& RecordingReader::operator=(RecordingReader&&) noexcept = default;

Status RecordingReader::open(const std::string& path, std::optional<Side> side) try {
  auto file = std::make_unique<File>();
  file->asked = side;
  if (Status status = file->open(path); !status.ok()) return status;
  file_ = std::move(file);
  return {};
} catch (const std::bad_alloc&) {
  return Status::error(path + ": not enough memory to read the recording");
}

const RecordingInfo& RecordingReader::info() const {
  static const RecordingInfo kNothing;
  return file_ ? file_->info : kNothing;
}

Status RecordingReader::find_world(const std::string& path) try {
  if (!file_ || !file_->scene.world || file_->scene.world->bytes) return {};
  const World& named = *file_->scene.world;
  std::string chosen = path;
  if (chosen.empty()) {
    // A recording is somebody else's: it names no file but one beside it, and no link leads elsewhere.
    namespace fs = std::filesystem;
    chosen = (fs::path(info().path).parent_path() / named.path).string();
    std::error_code ignored;
    const fs::file_type type = fs::symlink_status(chosen, ignored).type();
    if (type != fs::file_type::regular)
      return Status::error(
          info().path + ": was recorded with the world file " + named.path + ", which is " +
          (type == fs::file_type::not_found ? "not beside it" : "no regular file beside it") +
          "; put it there, or name it with --world FILE");
  }
  std::shared_ptr<const World> world;
  if (Status status = open_world(chosen, world); !status.ok()) return status;
  if (world->content != named.content)
    return Status::error(info().path + ": was recorded with another world than is in " + chosen +
                         "; put the right one beside the recording, or name it with --world FILE");
  auto found = std::make_shared<World>(*world);
  found->path = named.path;  // as recorded, so that copies of the session are the same
  file_->scene.world = std::move(found);
  return {};
} catch (const std::bad_alloc&) {
  return Status::error(info().path + ": not enough memory to find its world");
}

const Scene& RecordingReader::scene() const {
  static const Scene kNothing;
  return file_ ? file_->scene : kNothing;
}

const State& RecordingReader::initial_state() const {
  static const State kNothing;
  return file_ ? file_->initial_state[file_->hand] : kNothing;
}

State RecordingReader::initial_state(const Model& model) const {
  State state = initial_state();
  if (state.objects.size() != model.apart.size()) state.objects = make_state(model).objects;
  return state;
}

const std::optional<Hand>& RecordingReader::other_hand() const {
  static const std::optional<Hand> kNothing;
  return file_ ? file_->other_hand : kNothing;
}

const State& RecordingReader::other_initial_state() const {
  static const State kNothing;
  return file_ ? file_->initial_state[1 - file_->hand] : kNothing;
}

Status RecordingReader::next(TickRecord& record, bool& end) try {
  end = true;
  if (!file_) return Status::error("no recording is open; call open() first");
  return file_->next(record, end);
} catch (const std::bad_alloc&) {
  return Status::error(info().path + ": not enough memory to read the recording");
}

Status RecordingReader::next_message(RecordedMessage& message, bool& end) {
  TickRecord none;
  if (file_) file_->all_messages = true;
  const Status status = next(file_ ? file_->passed_on : none, end);
  if (!file_) return status;
  file_->all_messages = false;
  message = file_->message;
  return status;
}

std::optional<Divergence> RecordingReader::altered_input() const {
  return file_ ? file_->altered : std::nullopt;
}

Status RecordingReader::seek(std::uint64_t tick) {
  if (!file_) return Status::error("no recording is open; call open() first");
  const std::uint64_t time = tick_time(tick, 1e9 / file_->scene.settings.rate);
  const std::vector<ChunkIndex>& chunks = file_->chunks;
  const auto chunk = std::partition_point(chunks.begin(), chunks.end(),
                                          [time](const ChunkIndex& c) { return c.end_time < time; });
  const bool from_start = tick == 0 || chunk == chunks.begin();
  if (from_start)
    file_->rewind();
  else if (chunk != chunks.end())
    file_->go_to_chunk(static_cast<std::size_t>(chunk - chunks.begin()));
  else
    file_->go_to_chunk(chunks.size() - 1);
  file_->skip_below = tick;
  return {};
}

Status open_hands(const std::string& path, std::vector<RecordingReader>& readers,
                  std::optional<Side> side) try {
  std::vector<RecordingReader> opened(1);
  if (Status status = opened[0].open(path, side); !status.ok()) return status;
  if (const std::optional<Hand> other = opened[0].other_hand(); other && !side)
    if (Status status = opened.emplace_back().open(path, other->side); !status.ok()) return status;
  readers = std::move(opened);
  return {};
} catch (const std::bad_alloc&) {
  return Status::error(path + ": not enough memory to read the recording");
}

}  // namespace lumbrical
