// The compiled half of the notebook module `rigtwin`: recordings whose columns numpy sees in place, files of every kind, rig descriptions,
// simulated runs. It calls the rooms and has no logic of its own; rigtwin/__init__.py makes frames of it.
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>
#include <pybind11/stl/filesystem.h>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "firmware/description/rig_description.hpp"
#include "firmware/description/rig_writer.hpp"
#include "firmware/description/text/input_error.hpp"
#include "firmware/description/text/quantity.hpp"
#include "firmware/description/text/run_stopped.hpp"
#include "firmware/description/version.hpp"
#include "firmware/loop/common/trip.hpp"
#include "firmware/recording/recording.hpp"
#include "firmware/simulation/road_choice.hpp"
#include "firmware/simulation/simulated_rig.hpp"
#include "host_sim/closed_loop/closed_loop.hpp"
#include "host_sim/compensation/compensated_stability.hpp"
#include "host_sim/recording_files/import.hpp"
#include "host_sim/recording_files/recording_files.hpp"
#include "model/components/channel.hpp"

namespace {

namespace py = pybind11;
using firmware::Recording;
using Numbers = py::array_t<double, py::array::c_style | py::array::forcecast>;

/// A column as Python gets it: name, unit, the recording's own memory.
using NamedColumn = std::tuple<std::string, std::string, py::array>;

/// An array over memory that `owner` keeps.
py::array view(const std::vector<double>& values, const py::object& owner) {
  return py::array_t<double>(static_cast<py::ssize_t>(values.size()), values.data(), owner);
}

/// Time first, then the channels and ducts that the recording has, then its further columns.
std::vector<NamedColumn> columns(const py::object& owner) {
  const auto& recording = owner.cast<const Recording&>();
  std::vector<NamedColumn> list;
  for (firmware::Quantity q = 0; q < firmware::quantity_count; ++q) {
    const std::vector<double>& values = firmware::values(recording, q);
    if (values.empty()) continue;
    list.emplace_back(firmware::quantity_name(q), firmware::quantity_unit(q), view(values, owner));
  }
  for (const firmware::ExtraColumn& extra : recording.extra) {
    list.emplace_back(extra.name, extra.unit, view(extra.values, owner));
  }
  return list;
}

std::shared_ptr<Recording> from_columns(const std::vector<std::tuple<std::string, std::string, Numbers>>& list) {
  auto recording = std::make_shared<Recording>();
  for (const auto& [name, unit, array] : list) {
    if (array.ndim() != 1)
      throw firmware::InputError("frame", 0, "column " + firmware::in_quotes(name) + " is no row of numbers",
                                 "one number a row");
    std::vector<double> values(array.data(), array.data() + array.size());
    if (const auto quantity = firmware::find_quantity(name)) {
      firmware::values(*recording, *quantity) = std::move(values);
    } else {
      recording->extra.push_back({name, unit, std::move(values)});
    }
  }
  if (recording->size() < 2)
    throw firmware::InputError("frame", 0, "it has less than two rows", "an index t [s] with at least two");
  recording->sample_period =
      (recording->time.back() - recording->time.front()) / static_cast<double>(recording->size() - 1);
  return recording;
}

/// Calls `progress` with the share done, and lets Ctrl-C through.
std::function<void(double)> guarded(const py::object& progress) {
  return [progress](double share) {
    const py::gil_scoped_acquire python;
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    if (!progress.is_none()) progress(share);
  };
}

/// A file of any kind that `rigtwin import` reads, with the remarks of its reader.
py::tuple read(const std::filesystem::path& file, const std::optional<std::string>& rig_text, const std::string& source,
               const host_sim::ImportChoices& choices) {
  const firmware::ChannelMap none;
  std::optional<firmware::RigDescription> rig;
  if (rig_text) rig = firmware::parse_rig(*rig_text, source);
  const host_sim::RigContext context{rig ? rig->channels : none, rig ? std::optional(rig->sample_rate) : std::nullopt,
                                     rig ? std::optional(rig->rig.kind) : std::nullopt};
  host_sim::Import import;
  {
    const py::gil_scoped_release others;
    import = host_sim::import_file(file, context, choices);
  }
  std::vector<std::pair<std::string, std::string>> left_out;
  for (const host_sim::LeftOut& one : import.left_out) left_out.emplace_back(one.name, one.reason);
  auto recording = std::make_shared<Recording>(std::move(import.recording));
  return py::make_tuple(py::cast(recording), import.format, import.notes, left_out);
}

struct RunChoice {
  firmware::RoadChoice road;
  double duration;
  bool noise, allow_stop;
};

/// As `rigtwin simulate`: RunStopped where the firmware stops the run before its end.
std::shared_ptr<Recording> simulate(const std::string& text, const std::string& source, const RunChoice& choice,
                                    const py::object& progress) {
  const firmware::RigDescription rig = firmware::parse_rig(text, source);
  host_sim::RunOptions options;
  options.seed = choice.road.seed;
  options.progress = guarded(progress);
  if (!choice.noise) options.noise = firmware::SimulatedRig::Noise::none;
  const py::gil_scoped_release others;
  host_sim::compensation::refuse_unstable_compensation(rig);
  const std::size_t samples = firmware::samples_of(choice.duration, rig.sample_rate);
  const auto motion = firmware::run_motion(choice.road, rig, samples, host_sim::read_recording);
  host_sim::Run run = host_sim::run_closed_loop(rig, motion, options);
  if (run.recording.size() == 0 || (firmware::is_fault(run.trip.reason) && !choice.allow_stop)) {
    throw firmware::RunStopped("the firmware stopped the run: " + std::string(firmware::name(run.trip.reason)) +
                               " at t = " + std::to_string(run.trip.time.seconds()) +
                               " s; allow_stop=True keeps what there is");
  }
  return std::make_shared<Recording>(std::move(run.recording));
}

void bind_exceptions(py::module_& module) {
  py::register_exception<firmware::InputError>(module, "InputError", PyExc_ValueError);
  py::register_exception<firmware::UsageError>(module, "UsageError", PyExc_TypeError);
  py::register_exception<firmware::OutputError>(module, "OutputError", PyExc_OSError);
  py::register_exception<firmware::RunStopped>(module, "RunStopped", PyExc_RuntimeError);
}

}  // namespace

PYBIND11_MODULE(_core, module) {
  module.attr("version") = std::string(firmware::version);
  bind_exceptions(module);
  py::class_<Recording, std::shared_ptr<Recording>>(module, "Recording")
      .def("columns", [](const py::object& self) { return columns(self); })
      .def_readwrite("comments", &Recording::comments)
      .def_readonly("remark", &Recording::remark)
      .def_static("from_columns", &from_columns);
  module.def("read",
             [](const std::filesystem::path& file, const std::optional<std::string>& rig, const std::string& source,
                std::vector<std::string> maps, std::optional<double> rate, std::optional<std::string> time,
                std::size_t skip, std::optional<double> from, std::optional<double> to) {
               return read(file, rig, source, {std::move(maps), rate, std::move(time), skip, from, to, {}});
             });
  module.def(
      "write",
      [](const std::filesystem::path& file, const Recording& recording) { host_sim::write_recording(file, recording); },
      py::call_guard<py::gil_scoped_release>());
  module.def("check", [](const std::string& text, const std::string& source) {
    const firmware::RigDescription rig = firmware::parse_rig(text, source);
    return std::pair(std::string(model::name(rig.rig.kind)), rig.sample_rate);
  });
  module.def("simulate", [](const std::string& rig, const std::string& source, const std::string& road, double speed,
                            double duration, std::uint64_t seed, std::optional<double> bandwidth,
                            std::optional<double> cut_off, bool noise, bool allow_stop, const py::object& progress) {
    return simulate(rig, source, {{road, speed, seed, bandwidth, cut_off}, duration, noise, allow_stop}, progress);
  });
}
