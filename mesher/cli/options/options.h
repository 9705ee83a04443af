// The command line as data. Parsing reads no file and prints nothing.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

#include "cli/options/option_values.h"
#include "podm/choices.h"
#include "podm/image_io.h"
#include "podm/mesh_image.h"
#include "podm/mesh_io.h"
#include "podm/option.h"

namespace podm::cli {

/// An image and the selection of its labels.
struct ImageArguments {
  std::string path;       ///< or "phantom:NAME[@SIZE]"; for an array, its name in messages
  bool is_array = false;  ///< the image is in memory: see image_of_array()
  LabelSelection selection;
  std::string label_names_path;  ///< empty: none

  bool is_phantom() const { return !is_array && path.starts_with("phantom:"); }

  static constexpr auto options() {
    using I = ImageArguments;
    return std::tuple{nested(&I::selection),
                      option(&I::label_names_path, "label-names", "FILE", OptionGroup::kLabels,
                             "names and colours of labels: a table of ITK-SNAP, FreeSurfer or 3D Slicer\n"
                             "(.ctbl), or lines \"value name\"; they replace those in the image",
                             {.unset = "none", .uses = kInPodm | kOnRanks | kInPython, .keyword = "names"})};
  }
};

/// Checkpoints of a run on ranks.
struct CheckpointArguments {
  std::string folder;          ///< empty: none
  double least_seconds = 600;  ///< between two of them
  bool resume = false;

  static constexpr auto options() {
    using C = CheckpointArguments;
    using enum OptionGroup;
    return std::tuple{option(&C::folder, "checkpoint", "DIR", kOutput,
                             "write checkpoints to this folder, which all ranks see",
                             {.unset = "none", .uses = kOnRanks, .excludes = "target-elements"}),
                      option(&C::least_seconds, "checkpoint-seconds", "S", kOutput,
                             "the least time between two checkpoints, seconds; they are written between\n"
                             "rounds, and at the end of a run that a limit or a signal ends",
                             {.uses = kOnRanks, .quantity = "number of seconds", .needs = "checkpoint"}),
                      option(&C::resume, "resume", "", kRun,
                             "continue from the checkpoint in that folder, on any number of ranks",
                             {.unset = "no", .uses = kOnRanks, .needs = "checkpoint", .excludes = "log"})};
  }
};

/// podm mesh
struct MeshCommand {
  ImageArguments image;
  std::string mesh_path;  ///< empty: the mesh stays in memory
  MeshFileOptions mesh_file;
  NamedFiles values;  ///< images of values by the name of their arrays
  ValuesOf values_of = ValuesOf::kConstant;
  std::string surface_path;   ///< empty: no surfaces
  std::string record_path;    ///< empty: no record
  std::string log_path;       ///< empty: no linearization log
  std::string schedule_path;  ///< empty: no schedule
  std::string page_path;      ///< of --report; empty: no page
  CheckpointArguments checkpoints;
  MeshingOptions meshing;  ///< lacks the four fields below, which need files, the image or the machine
  std::vector<std::pair<std::string, double>> radius_of_mm;  ///< by label name or value
  std::string size_image_path;                               ///< empty: none
  std::vector<NearLabels> size_near;
  MemoryLimit max_memory;
  int ranks_in_process = 0;  ///< podm-mpi's, and none of MPI's; 0: MPI's
  NetworkArguments network;  ///< between ranks in process
  bool verify = false;
  bool verify_fidelity = false;  ///< implies verify
  bool stats = false;
  bool json_progress = false;
  bool quiet = false;

  static constexpr auto options() {
    using M = MeshCommand;
    using enum OptionGroup;
    constexpr unsigned kOfPlaces = kInAll | kInPlan;
    return std::tuple{
        nested(&M::image),
        nested(&M::meshing),
        option(&M::radius_of_mm, "radius-of", "LABEL=MM", kSize,
               "the radius of one label, by name or value, e.g. liver=2; repeatable",
               {.unset = "--radius",
                .record = "radius_of_mm",
                .uses = kInPodm | kOnRanks | kInPlan | kInPython}),
        option(&M::size_image_path, "size-image", "FILE", kSize,
               "local bounds on circumradii: a volume of mm on its own grid; values of 0 or less\n"
               "set no bound",
               {.unset = "none", .uses = kOfPlaces}),
        option(&M::size_near, "size-near", "A,B=MM[:WIDTH]", kSize,
               "bound within WIDTH mm of the interface of two labels, by name or value (the\n"
               "background by its value), e.g. liver,0=1:3; repeatable",
               {.unset = "none; WIDTH: MM", .uses = kOfPlaces}),
        option(
            &M::max_memory, "max-memory-gib", "GIB", kLimits, "memory of the process, GiB",
            {.unset = kDefaultMemory,
             .record = "max_memory_bytes",
             .uses = kInPodm | kOnRanks | kInPython,
             .quantity = "number of GiB",
             .help_on_ranks = "memory of each process, GiB; the processes of a machine share the\ndefault"}),
        option(&M::mesh_path, "output", "MESH", kOutput,
               "mesh file: .vtu or .vtk (VTK), .msh (Gmsh), .xdmf (DOLFINx), .inp (Abaqus,\n"
               "CalculiX), .e or .exo (Exodus II), .mesh (Medit), .node or .ele (TetGen)",
               {.uses = kOfFiles,
                .help_on_ranks = "mesh: .pvtu, with one .vtu per rank, .xdmf or .vtkhdf",
                .short_name = "-o",
                .is_required = true}),
        nested(&M::mesh_file),
        option(&M::values, "values", "NAME=FILE", kOutput,
               "write the mean of another image over each cell as NAME, with NAME_least,\n"
               "NAME_largest and NAME_covered (.vtu alone); repeatable",
               {.unset = "none", .uses = kOfFiles, .not_on_ranks = "only .vtu holds values"}),
        option(&M::values_of, "values-of", "", kOutput,
               "the field of these images: one value per voxel, or trilinear between centers",
               {.uses = kOfFiles, .not_on_ranks = "only .vtu holds values", .needs = "values"}),
        option(&M::surface_path, "surface", "FILE", kOutput,
               "also write the closed surface of each label: .stl or .ply",
               {.unset = "none", .uses = kOfFiles}),
        option(&M::record_path, "record", "FILE", kOutput, "append one JSON line that describes the run",
               {.unset = "none", .uses = kOfFiles}),
        option(&M::page_path, "report", "PAGE", kOutput,
               "an HTML page that needs no network: options, claims, histograms of quality per\n"
               "label, and the mesh in an interactive view",
               {.unset = "none", .uses = kOfFiles, .not_on_ranks = "the page needs the whole mesh"}),
        option(&M::schedule_path, "schedule", "FILE", kOutput,
               "write when each leaf was refined, for podm-verify",
               {.unset = "none",
                .uses = kOfFiles,
                .not_on_ranks = "each rank has leaves of its own",
                .excludes = "crossover"}),
        option(&M::log_path, "log", "FILE", kOutput, "write every operation in its order, for podm replay",
               {.unset = "none",
                .uses = kOfFiles,
                .help_on_ranks =
                    "write every operation in its order, for podm replay: rank R to FILE.R, a single\n"
                    "rank to FILE"}),
        nested(&M::checkpoints),
        option(&M::ranks_in_process, "in-process", "N", kRun,
               "ranks are threads of this process, one computing at a time, each with a virtual\n"
               "clock, for tests and predictions",
               {.unset = "ranks are those of mpirun or srun", .uses = kOnRanks, .most = kMostThreads}),
        option(&M::network, "network", "US,GB/S", kRun,
               "latency, us, and GB/s of the network between them, e.g. 2,12.5",
               {.unset = "free", .uses = kOnRanks, .needs = "in-process"}),
        option(&M::verify, "verify", "", kRun,
               "check the written mesh with podm-verify; exit 1 unless all claims hold",
               {.unset = "no", .uses = kOfFiles}),
        option(&M::verify_fidelity, "verify-fidelity", "", kRun,
               "--verify, and also that surfaces of mesh and image are within a voxel or 2 delta\n"
               "of each other; a mesh much coarser than a structure may fail",
               {.unset = "no", .uses = kOfFiles}),
        option(&M::stats, "stats", "", kRun, "print a table of the work and the losses of each thread",
               {.unset = "no", .uses = kOfFiles}),
        option(&M::json_progress, "json-progress", "", kRun,
               "print progress as JSON lines on standard output: phase, fraction, cells, seconds",
               {.unset = "no", .uses = kOfFiles}),
        option(&M::quiet, "quiet", "", kRun, "print neither progress nor summary",
               {.unset = "both, on standard error", .uses = kOfFiles})};
  }
};

/// podm replay and podm-mpi replay
struct ReplayCommand {
  ImageArguments image;
  std::vector<std::string> log_paths;  ///< at least one; of podm-mpi one, that of podm-mpi mesh --log
  int ranks_in_process = 0;            ///< podm-mpi's, and none of MPI's; 0: MPI's
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
  std::string output_path;  ///< of the image with its selected labels; empty: none
  bool plan = false;        ///< also print the plan of the run below, which has no image of its own
  MeshCommand planned;
};

/// podm phantom
struct PhantomCommand {
  std::string name;
  int size = 128;  ///< voxels along the longest axis
  std::string output_path, label_names_path;
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

/// podm serve
struct ServeCommand {
  std::uint64_t port = 0;  ///< 0: the system chooses one
  bool without_browser = false;
  double max_upload_mib = 1024;
  MemoryLimit max_memory;
  double max_seconds = 3600;

  static constexpr auto options() {
    using S = ServeCommand;
    using enum OptionGroup;
    return std::tuple{
        option(&S::port, "port", "N", kRun, "port of 127.0.0.1",
               {.unset = "a free one", .uses = kInPodm, .most = 65535}),
        option(&S::without_browser, "no-browser", "", kRun, "only print the address",
               {.unset = "a browser opens it", .uses = kInPodm}),
        option(&S::max_upload_mib, "max-upload-mib", "MIB", kRun, "largest image that the page may send, MiB",
               {.uses = kInPodm, .quantity = "number of MiB"}),
        option(&S::max_memory, "max-memory-gib", "GIB", kRun,
               "memory of each program that the page runs, GiB",
               {.unset = kDefaultMemory, .uses = kInPodm, .quantity = "number of GiB"}),
        option(&S::max_seconds, "max-seconds", "S", kRun,
               "longest time of each program that the page runs, seconds; a mesh that\n"
               "reaches it is valid and coarse in places",
               {.uses = kInPodm, .quantity = "number of seconds"})};
  }
};

/// --help, --version: text for standard output.
struct ShowText {
  std::string text;
};

using Command = std::variant<MeshCommand, ReplayCommand, ConvertCommand, InfoCommand, PhantomCommand,
                             ViewCommand, ServeCommand, ShowText>;

/// podm-mpi has the commands mesh and replay.
enum class Program { kPodm, kPodmMpi };

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
