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

/// An image and what is kept of it.
struct ImageArguments {
  std::string path;       ///< or "phantom:NAME[@SIZE]"; of an array what messages call it
  bool is_array = false;  ///< in memory: see image_of_array()
  LabelSelection selection;
  std::string label_names_path;  ///< empty: none

  bool is_phantom() const { return !is_array && path.starts_with("phantom:"); }
};

inline constexpr int kMaxThreads = 1024;

/// What virtual time takes for a message (distributed/in_process_ranks.h).
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
  std::string page_path;      ///< of --report; empty: no page
  MeshingOptions meshing;     ///< lacks the four fields below, which need files, the image or the machine
  std::vector<std::pair<std::string, double>> radius_of_mm;  ///< by label name or value
  std::string size_image_path;                               ///< empty: none
  std::vector<NearLabels> size_near;
  std::uint64_t max_memory_bytes = 0;  ///< what the process may take; 0: as the machine has
  int ranks_in_process = 0;            ///< podm-mpi's, and none of MPI's; 0: MPI's
  NetworkArguments network;            ///< between ranks in process
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
  bool plan = false;  ///< also tell of the run below, which has no image of its own
  MeshCommand planned;
};

/// podm phantom
struct PhantomCommand {
  std::string name;
  int size = 128;  ///< voxels along the longest axis
  std::string output_path;
};

/// What colours the cells of a picture.
enum class Colour { kLabel, kDihedral, kRatio, kSize };

/// Where a picture cuts its mesh open: cells beyond, on the side that the normal points to, are left out.
struct CutPlane {
  std::array<double, 3> normal{0, 1, 0};  ///< of any length but 0
  double place = 0.5;                     ///< along the normal
  bool is_fraction = true;                ///< of the mesh's extent; else mm from the origin
};

/// podm view
struct ViewCommand {
  std::string mesh_path, output_path;
  std::optional<CutPlane> cut = CutPlane();  ///< nothing: the mesh is whole
  bool flip = false;                         ///< leave out the cells on the other side
  std::vector<std::string> labels, hide;     ///< names or values; no labels: all
  Colour colour = Colour::kLabel;
  std::array<double, 2> camera_deg{20, 15};  ///< to the right of and above the direction that faces the cut
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

/// podm-mpi has the command mesh alone. So has the Python package, without what is about files or a terminal:
/// the image is no argument there.
enum class Program { kPodm, kPodmMpi, kPython };

/// Parses the arguments after the program's name. Throws InputError naming the option and the fault.
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
