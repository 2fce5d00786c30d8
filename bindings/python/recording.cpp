// Recordings, for Python: read into arrays, replayed, changed.
#include <span>

#include "bind.h"

namespace lumbrical::python {
namespace {

std::optional<Side> side_of(const std::optional<std::string>& side) {
  if (!side) return std::nullopt;
  if (*side != "left" && *side != "right") throw py::value_error("side is neither \"left\" nor \"right\"");
  return *side == "left" ? Side::left : Side::right;
}

class Recording : public Bound {
 public:
  Recording(const Path& path, const std::optional<std::string>& side) {
    const std::optional<Side> which = side_of(side);
    auto opened = std::make_unique<RecordingReader>();
    Status status;
    {
      const py::gil_scoped_release release;
      status = opened->open(path.text, which);
    }
    check(status);
    reader_ = std::move(opened);
  }
  RecordingReader& reader() {
    if (!reader_) throw py::value_error("the recording is closed");
    return *reader_;
  }
  void close() {
    const Busy guard(busy);
    reader_.reset();
  }
  std::atomic<bool> busy{false};

 private:
  std::unique_ptr<RecordingReader> reader_;
};

// From a tick to another, without that, every so many.
struct Range {
  std::uint64_t first, step;
  std::optional<std::uint64_t> last;
};

Range range_of(const py::object& first, const py::object& last, const py::object& step) {
  const auto number = [](const py::object& given, const char* name) {
    return taken<std::uint64_t>(given, name,
                                "a whole number, 0 or more: a tick counts from the session's start");
  };
  Range range{number(first, "first"), number(step, "step"), std::nullopt};
  if (!last.is_none()) range.last = number(last, "last");
  if (range.step == 0) throw py::value_error("step is 0");
  return range;
}

template <class Take>
void read_ticks(Recording& self, const Range& range, const Take& take) {
  const auto& [first, step, last] = range;
  const Busy busy(self.busy);
  RecordingReader& reader = self.reader();
  Status status;
  {
    const py::gil_scoped_release release;
    status = reader.seek(first);
    TickRecord record;
    bool end = false;
    Interrupts interrupts;
    while (status.ok() && !interrupts.came()) {
      status = reader.next(record, end);
      if (!status.ok() || end || (last && record.output.tick >= *last)) break;
      if ((record.output.tick - first) % step == 0) take(record);
    }
  }
  Interrupts::raise();
  check(status);
}

py::array read(Recording& self, const py::object& first, const py::object& last, const py::object& step) {
  std::vector<RecordedTick> rows;
  read_ticks(self, range_of(first, last, step), [&rows](const TickRecord& record) {
    rows.emplace_back(RecordedTick{record.device, record.output, record.state_hash, record.duration_ns});
  });
  return array_of(std::move(rows));
}

// A row for each tick, of as many as there are in the first: others would stand in each other's place.
template <class Item, class ListOf>
py::object read_table(Recording& self, const Range& range, const char* names, const ListOf& list_of) {
  std::vector<Item> rows;
  std::size_t ticks = 0, per_tick = 0;
  std::string uneven;
  read_ticks(self, range, [&](const TickRecord& record) {
    const std::span<const Item> list = list_of(record);
    if (ticks == 0) per_tick = list.size();
    if (uneven.empty() && list.size() != per_tick)
      uneven = "tick " + std::to_string(record.output.tick) + " has " + std::to_string(list.size()) + " " +
               names + ", those before " + std::to_string(per_tick) +
               " each; read these by themselves, with last=" + std::to_string(record.output.tick);
    if (!uneven.empty()) return;
    rows.insert(rows.end(), list.begin(), list.end());
    ++ticks;
  });
  if (!uneven.empty()) refuse(uneven);
  return array_of(std::move(rows)).attr("reshape")(py::make_tuple(ticks, per_tick));
}

py::object read_objects(Recording& self, const py::object& first, const py::object& last,
                        const py::object& step) {
  return read_table<ObjectOutput>(self, range_of(first, last, step), "objects", [](const TickRecord& record) {
    return std::span(record.object).first(record.object_count);
  });
}

py::object read_given(Recording& self, const py::object& first, const py::object& last,
                      const py::object& step) {
  return read_table<ObjectFrame>(
      self, range_of(first, last, step), "poses of given objects",
      [](const TickRecord& record) { return std::span(record.given).first(record.given_count); });
}

py::dict info(Recording& self) {
  using namespace py::literals;
  const RecordingInfo& from = self.reader().info();
  py::list hands;
  for (const Side side : from.hands) hands.append(side_name(side));
  py::dict metadata;
  for (const auto& [name, value] : from.metadata) metadata[text_of(name)] = text_of(value);
  return py::dict("path"_a = text_of(from.path), "hands"_a = hands, "ticks"_a = from.ticks,
                  "first_tick"_a = from.first_tick, "last_tick"_a = from.last_tick,
                  "missing_ticks"_a = from.missing_ticks, "seconds"_a = from.seconds,
                  "complete"_a = from.complete, "metadata"_a = metadata);
}

std::shared_ptr<PyModel> model_of(Recording& self, const std::optional<Path>& world, std::uint32_t threads,
                                  const std::string& broadphase) {
  const Execution execution = execution_of(threads, broadphase, "auto");
  auto built = std::make_shared<PyModel>();
  const Busy busy(self.busy);
  RecordingReader& reader = self.reader();
  Status status;
  {
    const py::gil_scoped_release release;
    status = reader.find_world(world ? world->text : "");
    if (status.ok()) status = build_model(reader.scene(), execution, built->model);
    if (status.ok()) built->start = reader.initial_state(built->model);
  }
  check(status);
  return built;
}

ReplayOptions options_of(const std::optional<Path>& world, std::uint32_t threads,
                         const std::string& broadphase) {
  ReplayOptions options;
  if (world) options.world = world->text;
  options.execution = execution_of(threads, broadphase, "auto");
  return options;
}

// What run(options, result) makes of it while other Python threads go on, and signals come through.
template <class Result, class Run>
Result found_by(ReplayOptions options, const Run& run) {
  Result result;
  Status status;
  Interrupts interrupts;
  options.stop = [&] { return interrupts.came(); };
  {
    const py::gil_scoped_release release;
    status = run(options, result);
  }
  Interrupts::raise();
  check(status);
  return result;
}

py::dict run_replay(const Path& path, const std::optional<Path>& world, std::uint32_t threads,
                    const std::string& broadphase) {
  using namespace py::literals;
  const auto result = found_by<ReplayResult>(
      options_of(world, threads, broadphase),
      [&](const ReplayOptions& options, ReplayResult& out) { return replay_hands(path.text, options, out); });
  py::object divergence = py::none();
  if (const auto& first = result.first_divergence)
    divergence = py::dict("tick"_a = first->tick, "stage"_a = first->stage, "field"_a = first->field,
                          "recorded"_a = first->recorded, "replayed"_a = first->replayed);
  const py::object damage = result.damage.empty() ? py::object(py::none()) : text_of(result.damage);
  return py::dict("identical"_a = !result.first_divergence, "ticks"_a = result.ticks, "damage"_a = damage,
                  "divergence"_a = divergence, "recorded_time"_a = result.recorded_time,
                  "replayed_time"_a = result.replayed_time);
}

template <std::size_t kCount>
py::dict changes(const std::array<Change, kCount>& from) {
  using namespace py::literals;
  py::array_t<double> max(kCount), rms(kCount);
  for (std::size_t i = 0; i < kCount; ++i) {
    max.mutable_at(i) = from[i].max;
    rms.mutable_at(i) = from[i].rms;
  }
  return py::dict("max"_a = max, "rms"_a = rms);
}

// What changes is told of one hand: of two, one has to be chosen.
Status open_one_hand(const std::string& path, std::optional<Side> side, RecordingReader& reader) {
  if (Status status = reader.open(path, side); !status.ok()) return status;
  if (side || reader.info().hands.size() < 2) return {};
  return Status::error(path + ": holds two hands; choose one, side=\"left\" or side=\"right\"");
}

py::dict run_what_if(const Path& path, std::optional<double> stiffness, const std::optional<std::string>& law,
                     std::optional<double> precision, const std::optional<std::string>& side,
                     const std::optional<Path>& world, std::uint32_t threads) {
  using namespace py::literals;
  const std::optional<Side> which = side_of(side);
  ReplayOptions changed = options_of(world, threads, "auto");
  changed.stiffness = stiffness;
  changed.precision = precision;
  if (law) changed.law = law_of(*law);
  const auto result = found_by<WhatIfResult>(changed, [&](const ReplayOptions& options, WhatIfResult& out) {
    RecordingReader reader;
    Status status = open_one_hand(path.text, which, reader);
    return status.ok() ? what_if(reader, options, out) : status;
  });
  return py::dict("ticks"_a = result.ticks, "force"_a = changes(result.force),
                  "force_jnd"_a = changes(result.force_jnd), "torque"_a = changes(result.torque),
                  "baseline_time"_a = result.baseline_time, "changed_time"_a = result.changed_time);
}

}  // namespace

void bind_recording(py::module_& module) {
  using namespace py::literals;
  py::class_<Recording>(module, "Recording", "A recorded session; of one of two hands, side says which.")
      .def(py::init<const Path&, const std::optional<std::string>&>(), "path"_a, "side"_a = py::none())
      .def_property_readonly("info", &info)
      .def("read", &read, "first"_a = 0u, "last"_a = py::none(), "step"_a = 1u)
      .def("read_objects", &read_objects, "first"_a = 0u, "last"_a = py::none(), "step"_a = 1u,
           "(ticks, objects felt apart) of object_dtype.")
      .def("read_given", &read_given, "first"_a = 0u, "last"_a = py::none(), "step"_a = 1u,
           "(ticks, given objects) of pose_dtype: what Session.run takes with the frames of the same ticks, "
           "to the same bits.")
      .def("model", &model_of, py::kw_only(), "world"_a = py::none(), "threads"_a = 1u,
           "broadphase"_a = "auto")
      .def("close", &Recording::close)
      .def("__enter__", [](py::object self) { return self; })
      .def("__exit__", [](Recording& self, const py::args&) { self.close(); });
  module.def("replay", &run_replay, "path"_a, py::kw_only(), "world"_a = py::none(), "threads"_a = 1u,
             "broadphase"_a = "auto",
             "\"damage\" says what is wrong with the file, whatever \"identical\" says of the ticks that can "
             "be read; None: nothing.");
  module.def("what_if", &run_what_if, "path"_a, py::kw_only(), "stiffness"_a = py::none(),
             "law"_a = py::none(), "precision"_a = py::none(), "side"_a = py::none(), "world"_a = py::none(),
             "threads"_a = 1u,
             "Of one hand: a session of two has none to answer for both, so side says which, \"left\" or "
             "\"right\".");
}

}  // namespace lumbrical::python
