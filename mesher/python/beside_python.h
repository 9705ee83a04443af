// Work of minutes beside a Python interpreter that stays responsive: other Python threads run, Ctrl-C is
// heeded.
#pragma once

#include <pybind11/pybind11.h>

#include <functional>
#include <stop_token>

#include "podm/mesh_image.h"

namespace podm::python {

using Work = std::function<void(const ProgressCallback&, const std::stop_token&)>;

/// Calls work(progress, stop) in a thread of its own, without the GIL, and returns when it has ended.
/// Meanwhile the calling thread, which has the GIL, heeds Python's signals and tells `callback`, unless it is
/// None, of the latest Progress, each some times a second. An exception of either requests a stop and is
/// returned when the work has ended; None: there was none. What the work throws is thrown, unless there is
/// such an exception.
pybind11::object run_beside_python(const Work& work, const pybind11::object& callback);

}  // namespace podm::python
