// SPDX-License-Identifier: GPL-3.0-or-later
// A label image (.inr) meshed by CGAL's Delaunay refinement, as Medit text: a foreign mesh of an image. Facet
// angle 30 degrees and radius-edge ratio 2 are within the bounds under which it is proved to end.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Image_3.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>

#include <cstdlib>
#include <fstream>
#include <iostream>
#include <string_view>

namespace params = CGAL::parameters;
using Domain = CGAL::Labeled_mesh_domain_3<CGAL::Exact_predicates_inexact_constructions_kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;

int main(int argc, char** argv) {
  CGAL::Image_3 image;
  if (argc < 4 || !image.read(argv[1])) {
    std::cerr << "usage: cgal_image_mesh IMAGE.inr MESH.mesh CELL_SIZE_MM [exude]\n";
    return 2;
  }
  const bool exudes = argc == 5 && std::string_view(argv[4]) == "exude";
  const Domain domain = Domain::create_labeled_image_mesh_domain(image);
  const Criteria criteria(params::facet_angle = 30, params::facet_distance = 0.5,
                          params::cell_radius_edge_ratio = 2, params::cell_size = std::atof(argv[3]));
  Complex complex = CGAL::make_mesh_3<Complex>(domain, criteria, params::no_perturb(), params::no_exude());
  if (exudes) CGAL::exude_mesh_3(complex);
  std::ofstream file(argv[2]);
  complex.output_to_medit(file);
  return file ? 0 : 2;
}
