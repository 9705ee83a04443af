// The command line as data. Parsing reads no file and prints nothing.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "cli/options/option_values.h"
#include "podm/choices.h"
#include "podm/image_io.h"
#include "podm/mesh_image.h"
#include "podm/mesh_io.h"

namespace podm::cli {

/// An image and the selection of its labels.
struct ImageArguments {
  std::string path;       ///< or "phantom:NAME[@SIZE]"; for an array, its name in messages
  bool is_array = false;  ///< the image is in memory: see image_of_array()
  LabelSelection selection;
  std::string label_names_path;  ///< empty: none

  bool is_phantom() const { return !is_array && path.starts_with("phantom:"); }
};

inline constexpr int kMaxThreads = 1024;

/// Simulated cost of a message in virtual time (distributed/in_process_ranks.h).
struct NetworkArguments {
  double latency_us = 0;
  double gigabytes_per_s = std::numeric_limits<double>::infinity();
};

/// podm mesh
struct MeshCommand {
  ImageArguments image;
  std::string mesh_path;  ///< empty: the mesh stays in memory
  MeshFileOptions mesh_file;
  std::string surface_path;   ///< empty: no surfaces
  std::string record_path;    ///< empty: no record
  std::string log_path;       ///< empty: no linearization log
  std::string schedule_path;  ///< empty: no schedule
  std::string page_path;      ///< page of --report; empty: no page
  std::string crossover;      ///< a number of threads or a file; empty: not given
  /// Lacks the crossover and the fields below that depend on files, image or machine.
  MeshingOptions meshing;
  std::vector<std::pair<std::string, double>> radius_of_mm;  ///< by label name or value
  std::string size_image_path;                               ///< empty: none
  std::vector<NearLabels> size_near;
  std::uint64_t max_memory_bytes = 0;  ///< limit of the process; 0: depends on the machine
  int ranks_in_process = 0;            ///< ranks of podm-mpi without MPI; 0: MPI's ranks
  NetworkArguments network;            ///< between ranks in one process
  bool verify = false;
  bool verify_fidelity = false;  ///< implies verify
  bool stats = false;
  bool quiet = false;
};

/// podm replay
struct ReplayCommand {
  ImageArguments image;
  std::vector<std::string> log_paths;  ///< at least one
};

/// podm convert
struct ConvertCommand {
  std::string input_path, output_path;
  MeshFileOptions mesh_file;
};

/// podm info
struct InfoCommand {
  ImageArguments image;
  bool json = false;
  bool plan = false;  ///< also print the plan of the run below, which has no image of its own
  MeshCommand planned;
};

/// podm phantom
struct PhantomCommand {
  std::string name;
  int size = 128;  ///< voxels along the longest axis
  std::string output_path;
};

/// The quantity that colours the cells of a picture.
enum class Colour { kLabel, kDihedral, kRatio, kSize };

/// The plane at which a picture cuts its mesh open. Cells beyond it, on the side that the normal points to,
/// are left out.
struct CutPlane {
  std::array<double, 3> normal{0, 1, 0};  ///< any length except 0
  double place = 0.5;                     ///< position along the normal
  bool is_fraction = true;                ///< true: fraction of the mesh's extent; false: mm from the origin
};

/// podm view
struct ViewCommand {
  std::string mesh_path, output_path;
  std::optional<CutPlane> cut = CutPlane();  ///< unset: the mesh is whole
  bool flip = false;                         ///< leaves out the cells on the other side
  std::vector<std::string> labels, hide;     ///< names or values; empty `labels`: all
  Colour colour = Colour::kLabel;
  /// Degrees to the right of and above the direction that faces the cut.
  std::array<double, 2> camera_deg{20, 15};
  double zoom = 1;
  std::array<int, 2> size{1600, 1200};  ///< pixels
  std::string background = "#ffffff";
  bool without_legend = false;
};

/// --help, --version: text for standard output.
struct ShowText {
  std::string text;
};

using Command = std::variant<MeshCommand, ReplayCommand, ConvertCommand, InfoCommand, PhantomCommand,
                             ViewCommand, ShowText>;

/// The program that parses. podm-mpi has only the command mesh. The Python package also has only mesh,
/// without the options for files or a terminal; the image is not an argument there.
enum class Program { kPodm, kPodmMpi, kPython };

/// Parses the arguments after the program's name. Throws InputError that names the option and the fault.
Command parse_command_line(std::vector<std::string> arguments, Program program = Program::kPodm);

}  // namespace podm::cli

namespace podm {

template <>
struct Names<cli::Colour> {
  static constexpr std::array kAll{
      std::pair{cli::Colour::kLabel, "label"}, std::pair{cli::Colour::kDihedral, "dihedral"},
      std::pair{cli::Colour::kRatio, "ratio"}, std::pair{cli::Colour::kSize, "size"}};
};

}  // namespace podm
