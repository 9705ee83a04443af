// podm phantom: writes an analytic phantom as a label image.
#include <fmt/format.h>

#include <cstdio>

#include "cli/commands/commands.h"
#include "cli/processes/signal_thread.h"
#include "podm/image_io.h"

namespace podm::cli {

int run(const PhantomCommand& command) {
  const SignalThread signals;  // leaves no partial image behind
  const LabelImage image = make_phantom(command.name, command.size);
  write_nifti(image, command.output_path);
  fmt::print(stderr, "{}: {} x {} x {} voxels of {:g} x {:g} x {:g} mm, {} labels\n", command.output_path,
             image.size[0], image.size[1], image.size[2], image.spacing[0], image.spacing[1],
             image.spacing[2], image.labels.size() - 1);
  return 0;
}

}  // namespace podm::cli
