// The command line as data. Parsing reads no file and prints nothing.
#pragma once

#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

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
  std::string mesh_path;      ///< empty: the mesh stays in memory
  MeshFileOptions mesh_file;
  std::string surface_path;   ///< empty: no surfaces
  std::string record_path;    ///< empty: no record
  std::string log_path;       ///< empty: no linearization log
  std::string schedule_path;  ///< empty: no schedule
  std::string crossover;      ///< a number of threads or a file; empty: not asked
  MeshingOptions meshing;  ///< lacks crossover and the two fields below, which need files, image or machine
  std::vector<std::pair<std::string, double>> radius_of_mm;  ///< by label name or value
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
};

/// podm phantom
struct PhantomCommand {
  std::string name;
  int size = 128;  ///< voxels along the longest axis
  std::string output_path;
};

/// --help, --version: text for standard output.
struct ShowText {
  std::string text;
};

using Command =
    std::variant<MeshCommand, ReplayCommand, ConvertCommand, InfoCommand, PhantomCommand, ShowText>;

/// podm-mpi has the command mesh alone. So has the Python package, without what is about files or a terminal:
/// the image is no argument there.
enum class Program { kPodm, kPodmMpi, kPython };

/// Parses the arguments after the program's name. Throws InputError naming the option and the fault.
Command parse_command_line(std::vector<std::string> arguments, Program program = Program::kPodm);

}  // namespace podm::cli
