// The extension module podm._podm, which takes and returns arrays and texts. The interface for users is in
// podm/*.py.
#include <pybind11/functional.h>
#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <climits>
#include <map>
#include <memory>
#include <new>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>

#include "algorithms/team_size.h"
#include "cli/commands/labelled_image.h"
#include "cli/options/options_for_image.h"
#include "cli/options/options_json.h"
#include "cli/reports/json_text.h"
#include "cli/reports/plan.h"
#include "cli/reports/summary.h"
#include "podm/errors.h"
#include "podm/mesh_io.h"
#include "python/from_python.h"
#include "python/mesh_in_memory.h"
#include "python/without_gil.h"
#include "run/measure_quality.h"

namespace podm::python {
namespace {

namespace py = pybind11;

using Names = std::map<std::uint32_t, std::string>;

// Replaces bytes that are not UTF-8, which file and label names may contain, as the record does.
py::str text(const std::string& bytes) {
  PyObject* const decoded =
      PyUnicode_DecodeUTF8(bytes.data(), static_cast<Py_ssize_t>(bytes.size()), "replace");
  if (decoded == nullptr) throw py::error_already_set();
  return py::reinterpret_steal<py::str>(decoded);
}

std::vector<py::str> texts(const std::vector<std::string>& all) {
  std::vector<py::str> decoded;
  for (const std::string& bytes : all) decoded.push_back(text(bytes));
  return decoded;
}

// podm/images.py lets only such arrays through.
VoxelType voxel_type(const py::dtype& dtype) {
  const bool is_signed = dtype.kind() == 'i';
  if (dtype.kind() == 'f') return dtype.itemsize() == 4 ? VoxelType::kFloat : VoxelType::kDouble;
  switch (dtype.itemsize()) {
    case 1:
      return is_signed ? VoxelType::kInt8 : VoxelType::kUint8;
    case 2:
      return is_signed ? VoxelType::kInt16 : VoxelType::kUint16;
    case 4:
      return is_signed ? VoxelType::kInt32 : VoxelType::kUint32;
    case 8:
      return is_signed ? VoxelType::kInt64 : VoxelType::kUint64;
  }
  throw InternalError("an array whose numbers take " + std::to_string(dtype.itemsize()) + " bytes");
}

VoxelArray voxel_array(const py::array& array) {
  VoxelArray voxels{array.data(), voxel_type(array.dtype()), {}, {}};
  for (py::ssize_t axis = 0; axis < array.ndim(); ++axis) {
    voxels.size.push_back(static_cast<int>(std::min<py::ssize_t>(array.shape(axis), INT_MAX)));
    if (axis < 3) voxels.strides_bytes[static_cast<std::size_t>(axis)] = array.strides(axis);
  }
  return voxels;
}

// The mesh, None where there is none, and the exception that ended the run early, None where nothing did.
py::tuple mesh(const Input& input, const py::dict& options, const py::object& progress) {
  cli::MeshCommand command = command_of(options, kInPython);
  std::shared_ptr<MeshInMemory> made;
  const Work work = [&](const ProgressCallback& progress_callback, const std::stop_token& stop) {
    made = std::make_shared<MeshInMemory>(std::move(command), input, progress_callback, stop);
  };
  const py::object exception = run_without_gil(work, progress);
  return py::make_tuple(made, exception);
}

py::tuple mesh_file(const std::string& path, const Names& names, const py::dict& options,
                    const py::object& progress) {
  return mesh({.path = path, .names = names}, options, progress);
}

py::tuple mesh_array(const py::array& array, const std::array<double, 12>& voxel_to_ras, const Names& names,
                     const py::dict& options, const py::object& progress) {
  return mesh({.path = "labels", .array = voxel_array(array), .voxel_to_ras = voxel_to_ras, .names = names},
              options, progress);
}

// JSON: what podm info --plan has of a run with these options of podm mesh.
std::string plan(const Input& input, const py::dict& options) {
  cli::MeshCommand command = command_of(options, kInPlan);
  const py::gil_scoped_release others_run;
  command.image.path = input.path;
  command.image.is_array = input.array.has_value();
  const WorkTimer timer(loop_threads(command.meshing.team));
  const LabelImage image = read_input(input, command, cli::memory_limit_bytes(command));
  const double read_s = timer.seconds();
  nlohmann::ordered_json plan = cli::plan_json(cli::make_plan(command, image, read_s), image);
  plan["warnings"] = image.warnings;
  return cli::json_line(plan);
}

std::string plan_file(const std::string& path, const Names& names, const py::dict& options) {
  return plan({.path = path, .names = names}, options);
}

std::string plan_array(const py::array& array, const std::array<double, 12>& voxel_to_ras, const Names& names,
                       const py::dict& options) {
  return plan({.path = "labels", .array = voxel_array(array), .voxel_to_ras = voxel_to_ras, .names = names},
              options);
}

py::array read_only(py::array array) {
  array.attr("setflags")(py::arg("write") = false);
  return array;
}

// Returns a view that keeps `owner`, whose memory it shows, alive.
template <class Number, std::size_t kColumns>
py::array rows(const std::vector<std::array<Number, kColumns>>& values, const py::object& owner) {
  static_assert(sizeof values[0] == kColumns * sizeof(Number));
  return read_only(
      py::array_t<Number>({values.size(), kColumns}, reinterpret_cast<const Number*>(values.data()), owner));
}

template <class Number>
py::array column(const std::vector<Number>& values, const py::object& owner) {
  return read_only(py::array_t<Number>(values.size(), values.data(), owner));
}

// Returns an array that owns the memory.
py::array array_of(std::vector<double> values) {
  auto* const kept = new std::vector<double>(std::move(values));
  const py::capsule owner(kept, [](void* memory) { delete static_cast<std::vector<double>*>(memory); });
  return py::array_t<double>(kept->size(), kept->data(), owner);
}

py::dict qualities(const MeshInMemory& made) {
  CellQualities all;
  {
    const py::gil_scoped_release others_run;
    all = qualities_of_cells(made.mesh());
  }
  py::dict arrays;
  arrays["radius_edge"] = array_of(std::move(all.radius_edge));
  arrays["circumradius"] = array_of(std::move(all.circumradius));
  arrays["min_dihedral_deg"] = array_of(std::move(all.min_dihedral_deg));
  arrays["max_dihedral_deg"] = array_of(std::move(all.max_dihedral_deg));
  arrays["volume"] = array_of(std::move(all.volume));
  return arrays;
}

// Returns bytes, because file names are bytes.
std::vector<py::bytes> claims(MeshInMemory& made, bool with_fidelity,
                              const std::function<std::string()>& write_image) {
  std::vector<py::bytes> arguments;
  for (const std::string& argument : made.claims(with_fidelity, write_image))
    arguments.emplace_back(argument);
  return arguments;
}

// Returns the value and the name of every label, the background first.
std::vector<std::pair<std::uint32_t, py::str>> labels_of(const MeshInMemory& made) {
  std::vector<std::pair<std::uint32_t, py::str>> labels;
  for (const Label& label : made.mesh().labels)
    labels.emplace_back(label.value, text(cli::display_name(label)));
  return labels;
}

// Returns the colour of each label that has one, by value.
std::map<std::uint32_t, std::tuple<int, int, int>> colours_of(const MeshInMemory& made) {
  std::map<std::uint32_t, std::tuple<int, int, int>> colours;
  for (const Label& label : made.mesh().labels)
    if (label.colour) colours[label.value] = {(*label.colour)[0], (*label.colour)[1], (*label.colour)[2]};
  return colours;
}

// Returns what write_mesh() does.
std::vector<py::str> save(const MeshInMemory& made, const std::string& path, const py::object& gmsh_version) {
  std::vector<std::string> losses;
  const MeshFileOptions options{gmsh_version_of(gmsh_version)};
  {
    const py::gil_scoped_release others_run;
    check_mesh_path(path, options);
    if (made.mesh().cells.empty()) throw InputError(path + ": the mesh has no cell; no file is written");
    losses = write_mesh(made.mesh(), path, options);
  }
  return texts(losses);
}

void save_surfaces(const MeshInMemory& made, const std::string& path) {
  check_surface_path(path);
  write_surfaces(made.mesh(), path);
}

void define_progress(py::module_& module) {
  py::class_<Progress>(module, "Progress", "Progress of a run of the mesher.")
      .def_readonly("phase", &Progress::phase,
                    "\"transform\", \"refine\", \"perturb\", \"optimize\", \"extract\" or \"measure\"")
      .def_readonly("fraction", &Progress::fraction, "of the phase, an estimate from 0 to 1")
      .def_readonly("cells", &Progress::cells, "so far")
      .def_readonly("seconds", &Progress::seconds, "since the run began")
      .def("__repr__", [](const Progress& progress) {
        return py::str("podm.Progress(phase={!r}, fraction={:.3f}, cells={}, seconds={:.1f})")
            .format(progress.phase, progress.fraction, progress.cells, progress.seconds);
      });
}

void define_mesh(py::module_& module) {
  using Self = const std::shared_ptr<MeshInMemory>&;
  const auto release = py::call_guard<py::gil_scoped_release>();
  const auto view = [](auto member, auto make) {
    return [=](const py::object& self) { return make(self.cast<Self>()->mesh().*member, self); };
  };
  const auto view_of_lines = [](auto member, auto make) {
    return [=](const py::object& self) { return make(self.cast<Self>()->mesh().lines.*member, self); };
  };
  const auto rows_of = [](const auto& values, const py::object& owner) { return rows(values, owner); };
  const auto column_of = [](const auto& values, const py::object& owner) { return column(values, owner); };
  py::class_<MeshInMemory, std::shared_ptr<MeshInMemory>>(module, "MeshInMemory")
      .def_property_readonly("points", view(&TetMesh::vertices, rows_of))
      .def_property_readonly("cells", view(&TetMesh::cells, rows_of))
      .def_property_readonly("label_of_cell", view(&TetMesh::cell_labels, column_of))
      .def_property_readonly("facets", view(&TetMesh::facets, rows_of))
      .def_property_readonly("labels_of_facet", view(&TetMesh::facet_labels, rows_of))
      .def_property_readonly("edges_of_lines", view_of_lines(&MeshLines::edges, rows_of))
      .def_property_readonly("line_of_edge", view_of_lines(&MeshLines::line_of_edge, column_of))
      .def_property_readonly("labels_of_lines", [](Self made) { return made->mesh().lines.labels_of_line; })
      .def_property_readonly("labels", &labels_of)
      .def_property_readonly("colours", &colours_of)
      .def_property_readonly("space", [](Self made) { return to_string(made->mesh().space); })
      .def_property_readonly("stop_reason",
                             [](Self made) { return to_string(made->run().report.stop_reason); })
      .def_property_readonly("unmet", [](Self made) { return texts(made->run().unmet()); })
      .def_property_readonly("warnings", [](Self made) { return texts(made->run().report.warnings); })
      .def_property_readonly(
          "voxels", [](const py::object& self) { return column(self.cast<Self>()->image().voxels, self); })
      .def_property_readonly("image_size", [](Self made) { return made->image().size; })
      .def_property_readonly("voxel_to_ras", [](Self made) { return made->image().voxel_to_ras; })
      .def("record", &MeshInMemory::record, release)
      .def("claims", &claims, py::arg("with_fidelity"), py::arg("write_image"))
      .def("summary", [](Self made) { return text(cli::summary(made->run())); })
      .def("qualities", &qualities)
      .def("save", &save, py::arg("path"), py::arg("gmsh_version"))
      .def("save_surfaces", &save_surfaces, py::arg("path"), release);
}

// Translates exceptions into those of the package, with messages in its terms.
void translate(std::exception_ptr thrown) {
  // Never released, because the interpreter ends before statics are destroyed.
  static const py::handle package_errors = py::module_::import("podm.errors").release();
  const auto raise = [](const char* name, const std::string& message) {
    PyErr_SetObject(package_errors.attr(name).ptr(), text(message).ptr());
  };
  try {
    if (thrown) std::rethrow_exception(thrown);
  } catch (const InputError& error) {
    raise("Error", error.what());
  } catch (const InternalError& error) {
    raise("InternalError", error.what());
  } catch (const std::bad_alloc&) {
    PyErr_SetString(PyExc_MemoryError, "use a smaller image, a larger radius or max_memory_gib");
  }
}

}  // namespace
}  // namespace podm::python

PYBIND11_MODULE(_podm, module) {
  using namespace podm::python;
  namespace py = pybind11;
  py::register_exception_translator(&translate);
  define_progress(module);
  define_mesh(module);
  module.attr("__version__") = PODM_VERSION;
  podm::messages_are_for_python = true;
  module.def("options", &podm::cli::options_json);
  module.def("mesh_file", &mesh_file, py::arg("path"), py::arg("names"), py::arg("options"),
             py::arg("progress"));
  module.def("mesh_array", &mesh_array, py::arg("array"), py::arg("voxel_to_ras"), py::arg("names"),
             py::arg("options"), py::arg("progress"));
  module.def("plan_file", &plan_file, py::arg("path"), py::arg("names"), py::arg("options"));
  module.def("plan_array", &plan_array, py::arg("array"), py::arg("voxel_to_ras"), py::arg("names"),
             py::arg("options"));
}
