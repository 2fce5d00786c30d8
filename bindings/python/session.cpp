// Sessions and batches of hands, for Python.
#include <algorithm>
#include <chrono>
#include <span>

#include "bind.h"
#include "lumbrical/batch.h"
#include "lumbrical/jacobian.h"

namespace lumbrical::python {
namespace {

class Session : public Bound {
 public:
  explicit Session(PyModel& model)
      : model_(model.shared_from_this()), state(model_->start), scratch(make_scratch(model_->model)) {
    scratch.hash_stages = false;
  }
  [[nodiscard]] const Model& model() const { return model_->model; }
  [[nodiscard]] const State& start() const { return model_->start; }
  void check_ticked() const {
    if (!ticked) throw std::runtime_error("the session has not been ticked yet");
  }

 private:
  std::shared_ptr<PyModel> model_;

 public:
  State state;
  Scratch scratch;
  std::unique_ptr<Recorder> recorder;
  bool warned = false;  // that it has failed
  std::atomic<bool> busy{false};
  bool ticked = false;
};

std::size_t given_count(const Model& model) {
  std::size_t count = 0;
  for (const ApartObject& object : model.apart) count += object.mechanism.mobility == Mobility::given ? 1 : 0;
  return count;
}

// Whether poses stand where they belong: a row for each frame, which one frame by itself and one object may
// leave out. Rows of none tell no object anything, as recordings may have it.
bool is_given_shape(const std::vector<std::size_t>& shape, std::size_t ticks, std::size_t objects) {
  if (shape.size() == 2) return shape[0] == ticks && (shape[1] == objects || shape[1] == 0);
  if (shape.size() == 1) return (ticks == 1 && shape[0] == objects) || (objects == 1 && shape[0] == ticks);
  return shape.empty() && ticks == 1 && objects == 1;
}

// Of every tick one after the other.
std::vector<ObjectFrame> given_of(const py::object& given, const Model& model, std::size_t ticks) {
  if (given.is_none()) return {};
  std::vector<ObjectFrame> poses = rows_of<ObjectFrame>(given, "given", "pose_dtype");
  const py::object shape = given.attr("shape");
  const std::size_t count = given_count(model);
  if (!is_given_shape(shape.cast<std::vector<std::size_t>>(), ticks, count))
    throw py::value_error("given is of shape " + py::repr(shape).cast<std::string>() + " in the place of (" +
                          std::to_string(ticks) + ", " + std::to_string(count) +
                          "): a row for each frame, with the poses of the " + std::to_string(count) +
                          " given objects");
  return poses;
}

ActuatorFrame recorded_tick(Session& self, const DeviceFrame& frame, std::span<const ObjectFrame> given) {
  TickRecord record;
  take_input(frame, given, record);
  const auto start = std::chrono::steady_clock::now();
  record.output = tick(self.model(), self.state, self.scratch, frame, given);
  const std::chrono::nanoseconds duration = std::chrono::steady_clock::now() - start;
  record.duration_ns = static_cast<std::uint32_t>(std::min<std::int64_t>(duration.count(), UINT32_MAX));
  take_results(self.state, self.scratch, record);
  self.recorder->record(record, &self.state);  // what goes wrong is a warning, and an error in the end
  return record.output;
}

// A full disk must take neither a tick's forces nor the next ticks away. Once: what there is to warn of.
std::string news_of(Session& self) {
  if (!self.recorder || self.warned || self.recorder->failure().ok()) return {};
  self.warned = true;
  return self.recorder->failure().message() + "; ticks go on, but are no longer recorded";
}

void warn(const std::string& text) {
  if (!text.empty() && PyErr_WarnFormat(PyExc_RuntimeWarning, 1, "%U", text_of(text).ptr()) != 0)
    throw py::error_already_set();
}

// While other Python threads go on. A signal ends it between two ticks, of which the first ones are done.
void run_unlocked(Session& self, const std::vector<DeviceFrame>& frames,
                  const std::vector<ObjectFrame>& given, std::vector<ActuatorFrame>& outputs) {
  const std::size_t per_tick = frames.empty() ? 0 : given.size() / frames.size();
  const py::gil_scoped_release release;
  Interrupts interrupts;
  for (std::size_t i = 0; i < frames.size() && !interrupts.came(); ++i) {
    const auto now = std::span(given).subspan(i * per_tick, per_tick);
    outputs[i] = self.recorder ? recorded_tick(self, frames[i], now)
                               : tick(self.model(), self.state, self.scratch, frames[i], now);
    self.ticked = true;
  }
}

py::array run_frames(Session& self, const std::vector<DeviceFrame>& frames, const py::object& given_poses) {
  const std::vector<ObjectFrame> given = given_of(given_poses, self.model(), frames.size());
  std::vector<ActuatorFrame> outputs(frames.size());
  std::string news;
  {
    const Busy busy(self.busy);
    run_unlocked(self, frames, given, outputs);
    Interrupts::raise();
    news = news_of(self);
  }
  warn(news);
  return array_of(std::move(outputs));
}

py::array run(Session& self, const py::object& frames, const py::object& given) {
  return run_frames(self, frames_of(frames), given);
}

// The same for one frame, whose output is of no dimension.
py::object run_one(Session& self, const py::object& frame, const py::object& given) {
  const std::vector<DeviceFrame> frames = frames_of(frame);
  if (frames.size() != 1) throw py::value_error("tick takes one frame; run takes many");
  return run_frames(self, frames, given).attr("reshape")(py::tuple());
}

ContactRow row_of(const Model& model, const NamedContact& named) {
  const Contact& contact = named.contact;
  return {named.segment,     named.object,   named.triangle,
          contact.primitive, contact.depth,  contact.area,
          contact.volume,    contact.error,  contact.centroid,
          contact.centre,    contact.normal, model.settings.stiffness * contact.volume * contact.normal};
}

py::array contacts(Session& self) {
  const Busy busy(self.busy);
  self.check_ticked();
  std::vector<ContactRow> rows;
  {
    const py::gil_scoped_release release;
    for (const NamedContact& contact : all_contacts(self.model(), self.scratch))
      rows.push_back(row_of(self.model(), contact));
  }
  return array_of(std::move(rows));
}

py::tuple jacobians(Session& self, std::uint32_t segments) {
  const Busy busy(self.busy);
  self.check_ticked();
  std::array<SegmentJacobian, kSegmentCount> found{};
  {
    const py::gil_scoped_release release;
    segment_jacobians(self.model(), self.scratch, found, segments);
  }
  py::array_t<double> values({kSegmentCount, 6, 6});
  py::list known;
  for (std::size_t s = 0; s < kSegmentCount; ++s) {
    std::memcpy(values.mutable_data(s), found[s].value.data(), sizeof found[s].value);
    known.append(found[s].known);
  }
  return py::make_tuple(values, py::module_::import("numpy").attr("array")(known));
}

void record(Session& self, const Path& path, std::uint32_t force_interval) {
  const Busy busy(self.busy);
  if (self.recorder) throw std::runtime_error("the session is recorded already");
  if (Status status = check_recording_start(self.model(), self.start(), self.state); !status.ok())
    throw std::runtime_error(status.message());
  auto recorder = std::make_unique<Recorder>();
  RecorderOptions options;
  options.force_interval = force_interval;
  Status status;
  {
    const py::gil_scoped_release release;
    status = recorder->open(path.text, scene_of(self.model()), options);
  }
  check(status);
  self.recorder = std::move(recorder);
  self.warned = false;
  self.scratch.hash_stages = true;
}

std::uint64_t stop_recording(Session& self) {
  const Busy busy(self.busy);
  if (!self.recorder) throw std::runtime_error("the session is not recorded");
  const std::unique_ptr<Recorder> recorder = std::move(self.recorder);
  self.scratch.hash_stages = false;
  Status status;
  {
    const py::gil_scoped_release release;
    status = recorder->close();
  }
  if (!status.ok())
    refuse(status.message() + "; the file has " + std::to_string(recorder->kept()) + " ticks");
  return recorder->kept();
}

State snapshot(Session& self) {
  const Busy busy(self.busy);
  return self.state;
}

void restore(Session& self, const py::object& given) {
  const auto state = taken<State>(given, "state", "a State");
  const Busy busy(self.busy);
  if (self.recorder) throw std::runtime_error("a session can't leave its course while it is recorded");
  check(check_state(self.model(), state));
  self.state = state;
}

/// Many hands on one model that have nothing to do with each other.
struct Batch : Bound {
  Batch(PyModel& model_, std::size_t count) : model(model_.shared_from_this()) {
    if (count > kMostHands)
      throw py::value_error("count is out of range: give 0 to " + std::to_string(kMostHands));
    const py::gil_scoped_release release;
    states.assign(count, model->start);
  }
  static constexpr std::size_t kMostHands = 0xffffffff;
  std::shared_ptr<PyModel> model;
  std::vector<State> states;
  std::vector<Scratch> scratch;
  std::atomic<bool> busy{false};
};

py::array run_batch(Batch& self, const py::object& given_frames, std::uint32_t threads) {
  const std::vector<DeviceFrame> frames = frames_of(given_frames);
  if (frames.size() != self.states.size())
    throw py::value_error("there are " + std::to_string(frames.size()) + " frames for " +
                          std::to_string(self.states.size()) + " hands");
  if (threads > 64) throw py::value_error("threads is above 64");
  std::vector<ActuatorFrame> outputs(frames.size());
  const Busy busy(self.busy);
  {
    const py::gil_scoped_release release;
    tick_each(self.model->model, frames, self.states, outputs,
              threads == 0 ? std::min(core_count(), 64u) : threads, self.scratch);
  }
  return array_of(std::move(outputs));
}

}  // namespace

void bind_session(py::module_& module) {
  const char* const kOutputs =
      "An output, of output_dtype, for each frame, of frame_dtype. given: of pose_dtype, (frames, given "
      "objects), in the order in which they were added; (given objects,) for one frame, (frames,) for one "
      "object.";
  using namespace py::literals;
  py::class_<State>(module, "State", "What one tick leaves for the next.")
      .def_readonly("tick", &HandState::tick)
      .def_property_readonly("hash", &hash_state);

  py::class_<Session>(module, "Session", "One hand in the world of a model, tick by tick.")
      .def(py::init<PyModel&>(), "model"_a)
      .def("tick", &run_one, "frame"_a, "given"_a = py::none(), kOutputs)
      .def("run", &run, "frames"_a, "given"_a = py::none(), kOutputs)
      .def(
          "contacts", &contacts,
          "Of contact_dtype, in W, of the last tick: \"object\" counts in Model.object_names. A contact's "
          "\"force\" is the pressure on its triangle alone: friction, bumps, pads' layers and damping are in "
          "outputs, and limits and fading besides.")
      .def("jacobians", &jacobians, "segments"_a = 0xffffu)
      .def_property_readonly("objects",
                             [](const py::object& self) {
                               const Session& session = self.cast<const Session&>();
                               session.check_ticked();
                               const auto& rows = session.scratch.object_output;
                               return view_of(rows.data(), {static_cast<py::ssize_t>(rows.size())}, self,
                                              false);
                             })
      .def_property_readonly("joints",
                             [](const py::object& self) {
                               const Session& session = self.cast<const Session&>();
                               session.check_ticked();
                               return view_of(placed_joints(session.scratch).data(), {kJointCount}, self,
                                              false);
                             })
      .def_property("state", &snapshot, &restore)
      .def("record", &record, "path"_a, py::kw_only(), "force_interval"_a = 1u)
      .def("stop_recording", &stop_recording);

  py::class_<Batch>(module, "Batch",
                    "Many hands that have nothing to do with each other, in the world of a model.")
      .def(py::init<PyModel&, std::size_t>(), "model"_a, "count"_a)
      .def("tick", &run_batch, "frames"_a, "threads"_a = 0u)
      .def("__len__", [](const Batch& self) { return self.states.size(); });
  module.def("core_count", &core_count);
}

}  // namespace lumbrical::python
