// The options of podm mesh, and those that podm convert shares with it.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <tuple>

#include "cli/crossover.h"
#include "cli/options/add_options.h"
#include "cli/options/options_for_image.h"
#include "podm/bounds.h"

namespace podm::cli {
namespace {

constexpr const char* kSizeGroup = "Size of the cells";
constexpr const char* kSurfaceGroup = "Surfaces";
constexpr const char* kDihedralGroup = "Dihedral angles";
constexpr const char* kAlgorithmGroup = "Algorithm";
constexpr const char* kRunGroup = "Run";

void add_sizing_options(CLI::App& app, MeshCommand& command) {
  MeshingOptions& meshing = command.meshing;
  begin_group(app, kSizeGroup);
  CLI::Option* radius = add_one(app, "--radius", "MM",
                                "largest circumradius of a cell, mm [default: unbounded, the surface drives]",
                                into_length(meshing.sizes.radius_mm));
  add_many(app, "--radius-of", "LABEL=MM",
           "the same for one label, by name or value, e.g. liver=2;\nrepeatable [default: --radius]",
           [&command](const std::string& text, const std::string& name) {
             command.radius_of_mm.push_back(parse_label_length(text, name));
           });
  add_one(app, "--size-image", "FILE",
          "bounds on circumradii by place: a volume of mm, on a grid of its own; values not\n"
          "above 0 are no bounds [default: none]",
          into(command.size_image_path));
  add_many(app, "--size-near", "A,B=MM[:WIDTH]",
           "bound within WIDTH mm of where two labels meet, by name or value, the background\n"
           "by its own, e.g. liver,0=1:3; repeatable [default: nowhere; WIDTH: MM]",
           [&command](const std::string& text, const std::string& name) {
             command.size_near.push_back(parse_near_labels(text, name));
           });
  add_one(app, "--grade", "G",
          "bounds of labels and by place grow by no more than G mm a mm of the way\n"
          "[default: at once]",
          into_positive(meshing.sizes.grade, "number"));
  add_one(app, "--delta", "MM", "sampling distance of the surfaces, mm [default: from voxel size and radius]",
          into_length(meshing.sizes.delta_mm));
  CLI::Option* target =
      add_one(app, "--target-elements", "N",
              "choose the radius, and a factor of --size-image, for this many cells\n[default: none]",
              into_count(meshing.sizes.target_elements));
  exclude(target, radius);
  need(add_one(app, "--target-tolerance", "PERCENT",
               "cells that the mesh may have more or fewer than that, in percent",
               into_positive(meshing.sizes.target_tolerance_percent, "percentage")),
       target);
}

void add_surface_options(CLI::App& app, MeshingOptions& meshing) {
  begin_group(app, kSurfaceGroup);
  add_one(app, "--smooth", "MM",
          "lay interfaces where labels tie that are blurred by a Gaussian this wide, mm,\n"
          "instead of on the stairs of voxels, which keep their labels; some 1.5 voxels;\n"
          "thin parts are blurred by less [default: stairs]",
          into_length(meshing.smoothing_mm));
}

void add_dihedral_options(CLI::App& app, MeshingOptions& meshing) {
  OptimizeOptions& optimize = meshing.optimize;
  begin_group(app, kDihedralGroup);
  add_one(app, "--min-dihedral", "DEG",
          fmt::format("at the end move vertices so that next to no cell has a dihedral angle below\n"
                      "this, degrees up to {:g}, or above {:g} less {:g} times this: all bounds are\n"
                      "kept, and the mesh stays Delaunay [default: nothing moves]",
                      kMostMinDihedral, max_dihedral_deg(0), max_dihedral_deg(0) - max_dihedral_deg(1)),
          into_positive(meshing.min_dihedral_deg, "angle in degrees"));
  CLI::Option* flag =
      add_flag(app, "--optimize", optimize.is_wanted,
               "better the worst cells of the finished mesh: all other bounds and the surfaces\n"
               "stay, but it is no longer Delaunay [default: no]");
  need(add_one(app, "--dihedral-bounds", "MIN,MAX",
               "least and largest dihedral angle of a cell, degrees; half as much again is\n"
               "aimed at, and cells that surfaces keep from it are counted",
               {[&optimize](const std::string& text, const std::string& name) {
                  std::tie(optimize.least_dihedral_deg, optimize.largest_dihedral_deg) =
                      parse_two_positive(text, name, "MIN,MAX, as in 8,165");
                },
                fmt::format("{},{}", optimize.least_dihedral_deg, optimize.largest_dihedral_deg)}),
       flag);
}

void add_limit_options(CLI::App& app, MeshCommand& command, Program which) {
  MeshingOptions& meshing = command.meshing;
  begin_group(app, which == Program::kPython
                       ? "Limits (the mesh of a run that meets one is valid)"
                       : "Limits (a run that meets one writes a valid mesh and exits with 1)");
  add_one(app, "--max-elements", "N", "stop at this many cells [default: none]",
          into_count(meshing.limits.max_elements));
  add_one(app, "--max-seconds", "S", "stop meshing after this many seconds [default: none]",
          into_positive(meshing.limits.max_seconds, "number of seconds"));
  add_one(app, "--max-memory-gib", "GIB",
          fmt::format("memory of the process, GiB [default: {} % of what is available{}]",
                      kPercentOfAvailableMemory,
                      which != Program::kPodmMpi ? "" : "\nover the ranks of the machine"),
          [&command](const std::string& text, const std::string& name) {
            const double bytes = parse_positive(text, name, "number of GiB") * kBytesPerGib;
            // Far above any machine, and within the range of an integer.
            constexpr double kMost = 1e18;
            command.max_memory_bytes = static_cast<std::uint64_t>(std::clamp(bytes, 1.0, kMost));
          });
}

void add_algorithm_option(CLI::App& app, MeshingOptions& meshing) {
  add_choice(app, "--algorithm",
             "podm: threads anywhere, with locks; pdr-podm: leaf by leaf of an octree,\n"
             "by nodes of several threads; pdr: leaf by leaf, a thread each, no locks;\n"
             "podm-home: podm by nodes of several threads, each in its own block of space;\n"
             "auto: podm, or podm-home on threads pinned to several NUMA nodes",
             meshing.algorithm);
}

void add_algorithm_options(CLI::App& app, MeshCommand& command) {
  MeshingOptions& meshing = command.meshing;
  begin_group(app, kAlgorithmGroup);
  add_algorithm_option(app, meshing);
  add_one(app, "--crossover", "N|FILE",
          fmt::format("threads from which on auto is podm-home, or the file in which podm-bench stored\n"
                      "what it measured here [default: the file named by {}, if any]",
                      kCrossoverVariable),
          into(command.crossover));
  add_one(app, "--nodes", "N", "computing nodes of pdr-podm and podm-home [default: NUMA nodes in use]",
          into_threads(meshing.team.nodes));
  add_one(app, "--cores-per-node", "N", "threads of each computing node [default: threads over nodes]",
          into_threads(meshing.team.cores_per_node));
  add_one(app, "--initial-ratio", "X",
          "bounds of the initial mesh of pdr, pdr-podm and\npodm-mpi over the final ones",
          into_positive(meshing.leaves.initial_ratio, "number"));
  add_one(app, "--initial-threads", "N", "threads of the initial mesh [default: all]",
          into_threads(meshing.team.initial_threads));
  add_one(app, "--leaf-size", "MM", "side of the octree's leaves, mm [default: from the initial bound]",
          into_length(meshing.leaves.size_mm));
}

void add_rank_options(CLI::App& app, MeshCommand& command) {
  CLI::Option* ranks =
      add_one(app, "--in-process", "N",
              "ranks are threads of this process, one computing at a time, each with a virtual\n"
              "clock, to test or to predict [default: ranks are those of mpirun or srun]",
              into_threads(command.ranks_in_process));
  need(add_one(app, "--network", "US,GB/S",
               "latency, us, and GB/s of the network between them, e.g. 2,12.5 [default: free]",
               [&command](const std::string& text, const std::string& name) {
                 const auto [latency_us, gigabytes_per_s] =
                     parse_two_positive(text, name, "US,GB/S, as in 2,12.5");
                 command.network = {latency_us, gigabytes_per_s};
               }),
       ranks);
}

// On ranks the seed determines the mesh, too.
void add_seed_option(CLI::App& app, MeshingOptions& meshing, Program which) {
  if (which == Program::kPodmMpi) meshing.team.seed = meshing.cut_seed;
  add_one(app, "--seed", "N",
          which != Program::kPodmMpi ? "draws pauses after conflicts, and what virtual time draws"
                                     : "0: blocks of equal predicted work; else draws where they are cut;\n"
                                       "and pauses, and the order in which ranks in process compute",
          {[&meshing, which](const std::string& text, const std::string& name) {
             meshing.team.seed = parse_integer(text, name, 0, std::numeric_limits<std::uint32_t>::max());
             if (which == Program::kPodmMpi) meshing.cut_seed = meshing.team.seed;
           },
           std::to_string(meshing.team.seed)});
}

void add_threads_option(CLI::App& app, MeshingOptions& meshing, Program which) {
  add_one(app, "--threads", "N",
          which != Program::kPodmMpi
              ? "threads of all phases; 1 makes the same mesh every time\n"
                "[default: one for refinement, all cores for the feature transform]"
              : "threads of each rank, in all phases; with 1 as many ranks make the same mesh\n"
                "every time [default: processors over the ranks of the machine; 1 in process]",
          into_threads(meshing.team.threads));
}

void add_oversubscribe_option(CLI::App& app, MeshingOptions& meshing) {
  add_flag(app, "--oversubscribe", meshing.team.oversubscribe,
           "allow more threads than processors [default: refused]");
}

void add_run_options(CLI::App& app, MeshCommand& command, Program which) {
  MeshingOptions& meshing = command.meshing;
  if (which == Program::kPodmMpi) add_rank_options(app, command);
  add_threads_option(app, meshing, which);
  add_choice(app, "--contention", "what a thread does that meets another's lock", meshing.team.contention);
  add_choice(app, "--begging",
             "whom a thread with cells to spare serves first: random (the first to beg)\n"
             "or hierarchical (the nearest in the machine)",
             meshing.team.begging);
  add_one(app, "--pin", "PLAN",
          "bind threads to processors: compact, scatter, none,\n"
          "or processors such as 0,2,4-7",
          into(meshing.team.pin));
  add_oversubscribe_option(app, meshing);
  add_one(app, "--topology", "FILE",
          "machine that the threads stand for: hwloc XML, or TOML that tells its costs, too\n"
          "(NAME.toml, see experiments/machines) [default: this machine]",
          into(meshing.team.topology_path));
  add_one(app, "--cost-factor", "NAME=FACTOR",
          "multiply one constant of a machine in TOML by a factor; 0 switches it off.\n"
          "results/README.md lists the names [default: none]",
          into(meshing.team.cost_factor));
  add_choice(app, "--executor",
             "threads, or virtual: one core plays any number of threads in virtual time,\n"
             "the same for the same seed; times are simulated",
             meshing.team.executor);
  add_choice(app, "--virtual-cost", "time of an attempt: unit (1 us) or measured (by its work)",
             meshing.team.virtual_cost);
  add_seed_option(app, meshing, which);
}

void add_space_option(CLI::App& app, MeshingOptions& meshing) {
  add_choice(app, "--space", "frame of the coordinates: RAS or LPS (mm), or voxel (indices)", meshing.space);
}

void add_output_options(CLI::App& app, MeshCommand& command, bool is_on_ranks) {
  require(add_one(app, "-o,--output", "MESH",
                  is_on_ranks ? "mesh: .pvtu, with a .vtu a rank, or .xdmf [required]"
                              : "mesh file: .vtu or .vtk (VTK), .msh (Gmsh), .xdmf (DOLFINx), .inp (Abaqus,\n"
                                "CalculiX), .e or .exo (Exodus II), .mesh (Medit), .node or .ele (TetGen)\n"
                                "[required]",
                  into(command.mesh_path)));
  if (!is_on_ranks) add_mesh_file_options(app, command.mesh_file);
  add_one(app, "--surface", "FILE", "also the closed surface of each label: .stl or .ply [default: none]",
          into(command.surface_path));
  add_space_option(app, command.meshing);
  add_one(app, "--record", "FILE", "append one JSON line that describes the run [default: none]",
          into(command.record_path));
  if (!is_on_ranks)
    add_one(app, "--report", "PAGE",
            "an HTML page that needs no network: what was asked and what holds, histograms of\n"
            "quality by label, the mesh to turn and to cut [default: none]",
            into(command.page_path));
  add_one(app, "--schedule", "FILE", "write which leaf was refined when, for podm-verify [default: none]",
          into(command.schedule_path));
  add_one(app, "--log", "FILE",
          is_on_ranks ? "write every operation in its order, for podm replay: rank R to FILE.R, one\n"
                        "rank alone to FILE [default: none]"
                      : "write every operation in its order, for podm replay [default: none]",
          into(command.log_path));
}

void add_telling_options(CLI::App& app, MeshCommand& command) {
  add_flag(app, "--verify", command.verify,
           "have podm-verify check the written mesh; exit 1 unless all holds [default: no]");
  add_flag(app, "--verify-fidelity", command.verify_fidelity,
           "the same, and that surfaces of mesh and image are within a voxel or 2 delta of\n"
           "each other; a mesh much coarser than a structure may miss it [default: no]");
  add_flag(app, "--stats", command.stats, "a table of what each thread did and lost [default: no]");
  add_flag(app, "--quiet", command.quiet, "neither progress nor summary [default: both, on standard error]");
}

}  // namespace

void add_mesh_file_options(CLI::App& app, MeshFileOptions& options) {
  add_one(app, "--gmsh-version", type_of_choices<GmshVersion>(),
          "of a .msh file; FreeFem++ and SfePy read 2.2 [default: 4.1]",
          {[&options](const std::string& text, const std::string& name) {
            options.gmsh_version = parse_choice<GmshVersion>(text, name);
          }});
}

void add_mesh_command(CLI::App& program, MeshCommand& command, Program which) {
  const bool is_on_ranks = which == Program::kPodmMpi;
  CLI::App& app = add_command(program, "mesh",
                              is_on_ranks ? "mesh a label image on all ranks that mpirun or srun has started"
                                          : "mesh a label image into tetrahedra with guarantees");
  const bool is_in_python = which == Program::kPython;
  is_in_python ? add_label_options(app, command.image) : add_image_options(app, command.image);
  add_sizing_options(app, command);
  add_surface_options(app, command.meshing);
  add_dihedral_options(app, command.meshing);
  add_limit_options(app, command, which);
  begin_group(app, "Output");
  is_in_python ? add_space_option(app, command.meshing) : add_output_options(app, command, is_on_ranks);
  add_algorithm_options(app, command);
  begin_group(app, kRunGroup);
  add_run_options(app, command, which);
  if (!is_in_python) add_telling_options(app, command);
  if (is_on_ranks)
    end_help(app,
             "Not on ranks yet, and refused: --target-elements, --size-image, --size-near, --grade,\n"
             "--smooth, --min-dihedral, --surface, --optimize, --report, --algorithm podm-home,\n"
             "--schedule, --executor virtual.");
}

void add_planned_options(CLI::App& app, MeshCommand& command, CLI::Option* plan) {
  add_sizing_options(app, command);
  add_surface_options(app, command.meshing);
  add_dihedral_options(app, command.meshing);
  begin_group(app, kAlgorithmGroup);
  add_algorithm_option(app, command.meshing);
  begin_group(app, kRunGroup);
  add_threads_option(app, command.meshing, Program::kPodm);
  add_oversubscribe_option(app, command.meshing);
  for (const char* group : {kSizeGroup, kSurfaceGroup, kDihedralGroup, kAlgorithmGroup, kRunGroup})
    need_in_group(app, group, plan);
}

void add_convert_command(CLI::App& program, ConvertCommand& command) {
  CLI::App& app = add_command(program, "convert", "write a mesh file of any maker in another format");
  require(add_one(app, "IN", "", "mesh file that podm-verify reads", into(command.input_path)));
  require(add_one(app, "OUT", "", "mesh file, with an extension that podm mesh -o takes",
                  into(command.output_path)));
  add_mesh_file_options(app, command.mesh_file);
  end_help(
      app,
      "Labels and their names stay; facets are those between labels; vertices, cells and facets come in\n"
      "the order in which podm mesh writes them.");
}

}  // namespace podm::cli
