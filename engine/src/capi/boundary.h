// Where C calls in: handles, what is checked of every argument, and how faults become a status and a message.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "lumbrical.h"
#include "lumbrical/recording.h"
#include "lumbrical/scene_file.h"
#include "lumbrical/status.h"
#include "lumbrical/tick.h"

namespace lumbrical::capi {

/// What a call answers: nothing wrong, or a lumbrical_status and one sentence.
struct [[nodiscard]] Fault {
  int status = LUMBRICAL_OK;
  std::string text;
  Fault() = default;
  Fault(int status_, std::string text_) : status(status_), text(std::move(text_)) {}
  Fault(const Status& outcome) : Fault(outcome, LUMBRICAL_BAD_DATA) {}
  Fault(const Status& outcome, int status_)
      : status(outcome.ok() ? LUMBRICAL_OK : status_), text(outcome.message()) {}
  explicit operator bool() const { return status != LUMBRICAL_OK; }
};

inline Fault bad_argument(std::string text) { return {LUMBRICAL_BAD_ARGUMENT, std::move(text)}; }

/// With a 0 behind it. Where there is no room for all its middle is left out: a text begins with the place,
/// which may be long, and ends with the remedy.
void copy_text(std::string_view text, std::span<char> out) noexcept;

/// Keeps the text for lumbrical_message and gives the status back.
int tell(const char* function, int status, const char* text) noexcept;
/// Of the exception that is being handled.
int tell_exception(const char* function) noexcept;

/// Does a call's work: a function that gives a Fault. Nothing is thrown across.
template <class Work>
int call(const char* function, const Work& work) noexcept {
  try {
    const Fault fault = work();
    return fault ? tell(function, fault.status, fault.text.c_str()) : static_cast<int>(LUMBRICAL_OK);
  } catch (...) {
    return tell_exception(function);
  }
}

/// What every handle begins with. A handle of another kind, which C's void pointers let through, is noticed.
struct Handle {
  explicit Handle(std::uint32_t kind_) : kind(kind_) {}
  ~Handle() { kind = 0; }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  std::uint32_t kind;
  mutable std::atomic<bool> busy{false};
};

template <class Type>
Fault check_handle(const Type* handle) {
  if (handle == nullptr) return bad_argument(std::string("the ") + Type::kName + " is null");
  if (handle->kind != Type::kKind)
    return bad_argument(std::string("the handle is no ") + Type::kName + ", or was destroyed");
  return {};
}

/// One thread at a time; `otherwise` says what is not done while another has it.
template <class Type>
Fault take_handle(const Type* handle, const char* otherwise = "") {
  if (Fault fault = check_handle(handle)) return fault;
  if (handle->busy.exchange(true, std::memory_order_acquire))
    return {LUMBRICAL_BUSY, std::string("another thread is using this ") + Type::kName + otherwise};
  return {};
}

/// The same as call, with the handle held for as long as the work takes.
template <class Type, class Work>
int call_with(const char* function, Type* handle, const Work& work) noexcept {
  return call(function, [&]() -> Fault {
    if (Fault fault = take_handle(handle)) return fault;
    struct Release {
      std::atomic<bool>& busy;
      ~Release() { busy.store(false, std::memory_order_release); }
    } const release{handle->busy};
    return work();
  });
}

/// One that another thread is in is left to it; nothing is wrong with a null one.
template <class Type>
int destroy(const char* function, Type* handle) noexcept {
  if (handle == nullptr) return LUMBRICAL_OK;
  const int status = call(function, [&] { return take_handle(handle, "; it is not destroyed"); });
  if (status == LUMBRICAL_OK) delete handle;
  return status;
}

inline Fault check_pointer(const void* pointer, const char* name) {
  return pointer == nullptr ? bad_argument(std::string(name) + " is null") : Fault();
}

/// A struct of this library's size; later versions will take earlier sizes, too.
template <class Struct>
Fault check_struct(const Struct* given, const char* name) {
  if (Fault fault = check_pointer(given, name)) return fault;
  if (given->size != sizeof(Struct))
    return bad_argument(std::string(name) + "->size is " + std::to_string(given->size) + " in the place of " +
                        std::to_string(sizeof(Struct)) + "; set it to sizeof *" + name);
  return {};
}

/// An array of which the first tells the size; none is needed where there is no room.
template <class Struct>
Fault check_array(const Struct* given, std::size_t capacity, const char* name) {
  return capacity == 0 ? Fault() : check_struct(given, name);
}

template <class Enum>
Fault check_enum(std::int32_t value, std::int32_t count, const char* name, Enum& result) {
  if (value < 0 || value >= count)
    return bad_argument(std::string(name) + " is " + std::to_string(value) + ", which is none of 0 to " +
                        std::to_string(count - 1));
  result = static_cast<Enum>(value);
  return {};
}

/// Into the caller's array, if there is room for all.
template <class Rows, class Out, class Convert>
Fault hand_over(const Rows& rows, Out* out, std::size_t capacity, std::size_t* count,
                const Convert& convert) {
  *count = rows.size();
  if (rows.size() > capacity)
    return {LUMBRICAL_TOO_SMALL,
            "there are " + std::to_string(rows.size()) + ", and room for " + std::to_string(capacity)};
  for (std::size_t i = 0; i < rows.size(); ++i) out[i] = convert(i);
  return {};
}

/// Of which sessions and handles share one.
struct BuiltModel {
  Model model;
  std::vector<std::uint32_t> world_object, apart_object;  ///< where they are in the order they were added
  std::vector<std::string> object_name;                   ///< in that order
  State start;                                            ///< of its sessions
};

void list_objects(BuiltModel& built);
std::size_t given_count(const Model& model);
Fault to_execution(const lumbrical_execution* given, Execution& execution);

}  // namespace lumbrical::capi

struct lumbrical_scene : lumbrical::capi::Handle {
  static constexpr std::uint32_t kKind = 0x5ce4e001;
  static constexpr const char* kName = "scene";
  lumbrical_scene() : Handle(kKind) {}
  lumbrical::Scene scene;
  lumbrical::Execution execution;
  lumbrical::Motion motion;  // without samples: none
  double seconds = 0;
};

struct lumbrical_model : lumbrical::capi::Handle {
  static constexpr std::uint32_t kKind = 0x30de1002;
  static constexpr const char* kName = "model";
  explicit lumbrical_model(std::shared_ptr<const lumbrical::capi::BuiltModel> built_)
      : Handle(kKind), built(std::move(built_)) {}
  std::shared_ptr<const lumbrical::capi::BuiltModel> built;
};

struct lumbrical_session : lumbrical::capi::Handle {
  static constexpr std::uint32_t kKind = 0x5e5510a3;
  static constexpr const char* kName = "session";
  explicit lumbrical_session(std::shared_ptr<const lumbrical::capi::BuiltModel> built_)
      : Handle(kKind),
        built(std::move(built_)),
        state(built->start),
        scratch(lumbrical::make_scratch(built->model)) {
    scratch.hash_stages = false;
  }
  std::shared_ptr<const lumbrical::capi::BuiltModel> built;
  lumbrical::State state;
  lumbrical::Scratch scratch;
  lumbrical::TickRecord record;                   // of the last tick
  bool ticked = false;                            // there is a last tick
  std::unique_ptr<lumbrical::Recorder> recorder;  // null: nothing is recorded
};

struct lumbrical_reader : lumbrical::capi::Handle {
  static constexpr std::uint32_t kKind = 0x3eade304;
  static constexpr const char* kName = "reader";
  lumbrical_reader() : Handle(kKind) {}
  lumbrical::RecordingReader reader;
  std::vector<std::uint32_t> apart_object;  // where they are in the order of the scene
  /// The tick that was handed out last, null before the first, and room for the next: one that can't be read
  /// does not take its place.
  lumbrical::TickRecord records[2];
  const lumbrical::TickRecord* last = nullptr;
};
