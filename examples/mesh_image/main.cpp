// mesh_image IMAGE RADIUS_MM MESH: makes a mesh file from a label image, with the library only.
#include <cstdlib>
#include <iostream>

#include "podm/image_io.h"
#include "podm/mesh_image.h"
#include "podm/mesh_io.h"

int main(int argc, char** argv) {
  if (argc != 4) {
    std::cerr << "usage: mesh_image IMAGE RADIUS_MM MESH\n";
    return 2;
  }
  try {
    const podm::LabelImage image = podm::read_image(argv[1]);
    podm::MeshingOptions options;
    options.sizes.radius_mm = std::atof(argv[2]);
    podm::MeshingResult result = podm::mesh_image(image, options);
    podm::canonicalize(result.mesh);
    podm::write_mesh(result.mesh, argv[3]);
    std::cout << result.mesh.cells.size() << " cells, radius-edge ratio up to "
              << result.report.quality.max_radius_edge << "\n";
    return result.report.guarantees.all_met() ? 0 : 1;
  } catch (const podm::InputError& error) {
    std::cerr << "mesh_image: " << error.what() << "\n";
    return 2;
  }
}
