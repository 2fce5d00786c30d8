// See boundary.h. The last error's text of each thread, and the models that handles share.
#include "capi/boundary.h"

#include <algorithm>
#include <cstdio>
#include <exception>
#include <new>
#include <string_view>

namespace lumbrical::capi {
namespace {

// Of fixed size, so that running out of memory can be told, too.
constexpr std::size_t kRoom = 1024;
thread_local char last_message[kRoom] = "";

}  // namespace

void copy_text(std::string_view text, std::span<char> out) noexcept {
  constexpr std::string_view kGap = " ... ";
  const std::size_t room = out.size() - 1;
  auto end = out.begin();
  if (text.size() > room) {
    end = std::copy_n(text.begin(), room / 2 - kGap.size(), end);
    end = std::copy(kGap.begin(), kGap.end(), end);
    text.remove_prefix(text.size() - (room - room / 2));
  }
  *std::copy(text.begin(), text.end(), end) = '\0';
}

int tell(const char* function, int status, const char* text) noexcept {
  const int begun = std::snprintf(last_message, kRoom, "%s: ", function);
  copy_text(text, std::span(last_message).subspan(static_cast<std::size_t>(begun)));
  return status;
}

int tell_exception(const char* function) noexcept {
  try {
    throw;
  } catch (const std::bad_alloc&) {
    return tell(function, LUMBRICAL_FAILED, "out of memory");
  } catch (const std::exception& error) {
    return tell(function, LUMBRICAL_FAILED, error.what());
  } catch (...) {
    return tell(function, LUMBRICAL_FAILED, "an unknown exception");
  }
}

void list_objects(BuiltModel& built) {
  const Model& model = built.model;
  const std::size_t count = model.objects.size() + model.apart.size();
  built.object_name.assign(count, {});
  std::vector<bool> taken(count, false);
  for (const ApartObject& object : model.apart) {
    built.apart_object.push_back(static_cast<std::uint32_t>(object.place));
    built.object_name[object.place] = object.name;
    taken[object.place] = true;
  }
  std::size_t place = 0;
  for (const World::Object& object : model.objects) {
    while (taken[place]) ++place;
    built.world_object.push_back(static_cast<std::uint32_t>(place));
    built.object_name[place++] = object.name;
  }
}

std::size_t given_count(const Model& model) {
  const auto given = [](const ApartObject& object) { return object.mechanism.mobility == Mobility::given; };
  return static_cast<std::size_t>(std::count_if(model.apart.begin(), model.apart.end(), given));
}

Fault to_execution(const lumbrical_execution* given, Execution& execution) {
  if (given == nullptr) return {};
  if (Fault fault = check_struct(given, "execution")) return fault;
  if (Fault fault = check_enum(given->broadphase, 5, "execution->broadphase", execution.broadphase))
    return fault;
  execution.threads = given->threads;
  execution.leaf_size = given->leaf_size;
  return {};
}

}  // namespace lumbrical::capi

const char* lumbrical_message(void) { return lumbrical::capi::last_message; }
