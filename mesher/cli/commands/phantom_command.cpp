// podm phantom: writes an analytic phantom as a label image.
#include <fmt/format.h>

#include <cstdio>
#include <optional>

#include "cli/commands/commands.h"
#include "cli/processes/signal_thread.h"
#include "files/atomic_file.h"
#include "podm/errors.h"
#include "podm/image_io.h"

namespace podm::cli {
namespace {

void write_names(const LabelImage& image, AtomicFile& table) {
  for (const Label& label : image.labels)
    if (!label.name.empty()) table.write(fmt::format("{} \"{}\"\n", label.value, label.name));
  table.finish();
}

}  // namespace

int run(const PhantomCommand& command) {
  const SignalThread signals;  // leaves no partial image behind
  if (command.label_names_path == command.output_path)
    throw InputError(fmt::format("--label-names: {} is the file of the image", command.output_path));
  const LabelImage image = make_phantom(command.name, command.size);
  std::optional<AtomicFile> table;
  if (!command.label_names_path.empty()) write_names(image, table.emplace(command.label_names_path));
  write_nifti(image, command.output_path);
  if (table) table->publish();
  fmt::print(stderr, "{}: {} x {} x {} voxels of {:g} x {:g} x {:g} mm, {} labels\n", command.output_path,
             image.size[0], image.size[1], image.size[2], image.spacing[0], image.spacing[1],
             image.spacing[2], image.labels.size() - 1);
  return 0;
}

}  // namespace podm::cli
