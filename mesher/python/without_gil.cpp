#include "python/without_gil.h"

#include <chrono>
#include <future>
#include <mutex>
#include <optional>
#include <utility>

namespace podm::python {
namespace {

namespace py = pybind11;

constexpr std::chrono::milliseconds kBetweenLooks{100};

// The latest progress of the working thread, until the other thread takes it.
class LatestProgress {
 public:
  void put(const Progress& progress) {
    const std::lock_guard lock(mutex_);
    latest_ = progress;
  }
  std::optional<Progress> take() {
    const std::lock_guard lock(mutex_);
    return std::exchange(latest_, std::nullopt);
  }

 private:
  std::mutex mutex_;
  std::optional<Progress> latest_;
};

bool ends_soon(const std::future<void>& work) {
  const py::gil_scoped_release others_run;
  return work.wait_for(kBetweenLooks) == std::future_status::ready;
}

// Returns the exception of a signal's handler or of the callback, or None.
py::object ask_python(LatestProgress& latest, const py::object& callback) {
  try {
    if (PyErr_CheckSignals() != 0) throw py::error_already_set();
    const auto progress = latest.take();
    if (progress && !callback.is_none()) callback(*progress);
  } catch (const py::error_already_set& raised) {
    if (raised.trace()) PyException_SetTraceback(raised.value().ptr(), raised.trace().ptr());
    return raised.value();
  }
  return py::none();
}

}  // namespace

py::object run_without_gil(const Work& work, const py::object& callback) {
  LatestProgress latest;
  std::stop_source stop;
  std::future<void> done = std::async(std::launch::async, [&] {
    work([&](const Progress& progress) { latest.put(progress); }, stop.get_token());
  });
  py::object exception = py::none();
  for (bool has_ended = false; !has_ended && exception.is_none();) {
    has_ended = ends_soon(done);
    exception = ask_python(latest, callback);
  }
  stop.request_stop();  // has no effect on work that has ended
  while (!ends_soon(done)) {
  }
  try {
    done.get();
  } catch (...) {
    if (exception.is_none()) throw;
  }
  return exception;
}

}  // namespace podm::python
