// Runs long work while the Python interpreter stays responsive: other Python threads run, and Ctrl-C works.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <stop_token>

#include "podm/mesh_image.h"

namespace podm::python {

using Work = std::function<void(const ProgressCallback&, const std::stop_token&)>;

/// Calls work(progress, stop) in a thread of its own, without the GIL, and returns when it has ended.
/// Meanwhile the calling thread, which has the GIL, handles Python's signals and passes the latest Progress
/// to `callback`, unless it is None, several times per second. An exception of a signal handler or of the
/// callback requests a stop, and is returned when the work has ended. Without such an exception, throws what
/// the work throws, or returns None.
pybind11::object run_without_gil(const Work& work, const pybind11::object& callback);

}  // namespace podm::python
