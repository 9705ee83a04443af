// The options of the image that commands read and of its label selection; the options of all commands except
// mesh.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include "cli/options/add_options.h"

namespace podm::cli {
namespace {

constexpr int kMaxPhantomSize = 4096;

}  // namespace

void add_image_argument(CLI::App& app, ImageArguments& image) {
  require(add_one(app, "IMAGE", "",
                  fmt::format("NIfTI, NRRD, MetaImage or INR label image of fewer than 2^31 voxels,\n"
                              "or phantom:NAME[@SIZE], NAME one of\n{}",
                              fmt::join(phantom_names(), ", ")),
                  into(image.path)));
}

void add_image_options(CLI::App& app, ImageArguments& image) {
  add_image_argument(app, image);
  add_label_options(app, image);
  begin_group(app, "Options");
}

void add_replay_command(CLI::App& program, ReplayCommand& command) {
  CLI::App& app = add_command(program, "replay",
                              "carry out a run's logged operations on one thread and compare the mesh");
  add_image_options(app, command.image);
  require(add_many(
      app, "LOG", "",
      "log of podm mesh --log, with the same image and label options; for\n"
      "podm-mpi mesh --log FILE, the logs of all ranks: FILE.0 FILE.1 ...",
      [&command](const std::string& text, const std::string&) { command.log_paths.push_back(text); }));
}

void add_replay_on_ranks_command(CLI::App& program, ReplayCommand& command) {
  CLI::App& app = add_command(program, "replay",
                              "carry out the logged operations of each rank on a rank, and compare the mesh");
  add_image_options(app, command.image);
  require(add_one(app, "LOG", "",
                  "the FILE of podm-mpi mesh --log FILE, with the same image and label options;\n"
                  "rank R reads FILE.R, and there must be as many ranks as in that run",
                  [&command](const std::string& text, const std::string&) { command.log_paths = {text}; }));
  add_one(app, "--in-process", "N",
          "ranks are threads of this process, one computing at a time [default: ranks are\n"
          "those of mpirun or srun]",
          {[&command](const std::string& text, const std::string& name) {
            command.ranks_in_process = static_cast<int>(parse_integer(text, name, 2, kMostThreads));
          }});
}

void add_info_command(CLI::App& program, InfoCommand& command) {
  CLI::App& app = add_command(program, "info", "print size, spacing (mm), affine and labels of an image");
  add_image_options(app, command.image);
  add_flag(app, "--json", command.json, "print one JSON object [default: text]");
  add_one(app, "-o,--output", "FILE",
          "also write the image that podm mesh would see, with its labels selected: NIfTI,\n"
          ".nii or .nii.gz [default: none]",
          into(command.output_path));
  CLI::Option* plan =
      add_flag(app, "--plan", command.plan,
               "also predict what podm mesh costs and loses with the options below: cells by\n"
               "label, memory, seconds, parts too thin for delta, components [default: no]");
  add_planned_options(app, command.planned, plan);
}

void add_phantom_command(CLI::App& program, PhantomCommand& command) {
  CLI::App& app = add_command(program, "phantom", "write an analytic phantom as a label image");
  require(add_one(app, "NAME", fmt::format("{}", fmt::join(phantom_names(), "|")), "the phantom",
                  into(command.name)));
  add_one(app, "--size", "N", "voxels along the longest axis",
          {[&command](const std::string& text, const std::string& name) {
             command.size = static_cast<int>(parse_integer(text, name, 1, kMaxPhantomSize));
           },
           std::to_string(command.size)});
  require(add_one(app, "-o,--output", "FILE", "NIfTI file: .nii or .nii.gz [required]",
                  into(command.output_path)));
  add_one(app, "--label-names", "FILE",
          "also write the names of the labels, for podm mesh --label-names [default: none]",
          into(command.label_names_path));
}

}  // namespace podm::cli
