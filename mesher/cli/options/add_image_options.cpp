// The options of the image that commands read and of its label selection; the options of all commands except
// mesh.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <limits>

#include "cli/options/add_options.h"

namespace podm::cli {
namespace {

constexpr int kMaxPhantomSize = 4096;

}  // namespace

void add_image_options(CLI::App& app, ImageArguments& image) {
  require(add_one(app, "IMAGE", "",
                  fmt::format("NIfTI, NRRD, MetaImage or INR label image of fewer than 2^31 voxels,\n"
                              "or phantom:NAME[@SIZE], NAME one of {}",
                              fmt::join(phantom_names(), ", ")),
                  into(image.path)));
  add_label_options(app, image);
  begin_group(app, "Options");
}

void add_label_options(CLI::App& app, ImageArguments& image) {
  begin_group(app, "Labels");
  add_one(app, "--labels", "RANGES", "keep these label values only, e.g. 1,3-7 [default: all]",
          [&image](const std::string& text, const std::string& name) {
            image.selection.keep = parse_label_ranges(text, name);
          });
  add_one(app, "--drop", "RANGES", "turn these label values into background [default: none]",
          [&image](const std::string& text, const std::string& name) {
            image.selection.drop = parse_label_ranges(text, name);
          });
  add_many(app, "--merge", "VALUES=NAME",
           "make one label of several, e.g. 2,3=kidney; repeatable [default: none]",
           [&image](const std::string& text, const std::string&) {
             image.selection.merges.push_back(parse_merge(text));
           });
  add_one(app, "--drop-islands", "MM3",
          "give components of a label (voxels joined by faces) that are smaller than\n"
          "this, mm^3, to the neighbour that they touch most [default: none]",
          into_positive(image.selection.drop_islands_mm3, "volume in mm^3"));
  add_one(app, "--background", "VALUE", "label value of the background",
          {[&image](const std::string& text, const std::string& name) {
             image.selection.background = static_cast<std::uint32_t>(
                 parse_integer(text, name, 0, std::numeric_limits<std::uint32_t>::max()));
           },
           std::to_string(image.selection.background)});
  add_one(app, "--label-names", "FILE",
          "names of labels: an ITK-SNAP table or lines \"value name\" [default: none]",
          into(image.label_names_path));
}

void add_replay_command(CLI::App& program, ReplayCommand& command) {
  CLI::App& app = add_command(program, "replay",
                              "carry out a run's logged operations on one thread and compare the mesh");
  add_image_options(app, command.image);
  require(add_many(
      app, "LOG", "",
      "what podm mesh --log wrote, with the same image and label options; of\n"
      "podm-mpi mesh --log FILE the logs of all ranks: FILE.0 FILE.1 ...",
      [&command](const std::string& text, const std::string&) { command.log_paths.push_back(text); }));
}

void add_info_command(CLI::App& program, InfoCommand& command) {
  CLI::App& app = add_command(program, "info", "print size, spacing (mm), affine and labels of an image");
  add_image_options(app, command.image);
  add_flag(app, "--json", command.json, "print one JSON object [default: text]");
  CLI::Option* plan =
      add_flag(app, "--plan", command.plan,
               "also what podm mesh will cost and lose with the options below: cells by\n"
               "label, memory, seconds, what delta is too coarse for, components [default: no]");
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
}

}  // namespace podm::cli
