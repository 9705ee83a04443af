// SPDX-License-Identifier: GPL-3.0-or-later
// CGAL's 3D mesh generation as a peer of podm. It reads a label image and prints counts and the seconds of
// its phases.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Image_3.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/version.h>
#if CGAL_VERSION_NR >= 1050600000
#include <CGAL/Mesh_3/Detect_features_in_image.h>
#include <CGAL/Mesh_domain_with_polyline_features_3.h>
#endif
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>
#include <CGAL/tags.h>
#include <sys/resource.h>
#include <tbb/global_control.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <exception>
#include <fstream>
#include <iostream>
#include <limits>
#include <nlohmann/json.hpp>
#include <optional>
#include <stdexcept>
#include <string>

namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Json = nlohmann::ordered_json;

#ifdef CGAL_MESH_3_USE_LAZY_UNSORTED_REFINEMENT_QUEUE
constexpr const char* kQueue = "unsorted";
#else
constexpr const char* kQueue = "sorted";
#endif
// The guarantees of podm, requested from CGAL.
constexpr double kFacetAngleDeg = 30;
constexpr double kRadiusEdgeBound = 1.93;

struct Options {
  std::string image_path;
  double cell_size_mm = 0;       // 0: unbounded, the surface alone drives
  double facet_size_mm = 0;      // 0: unbounded
  double facet_distance_mm = 0;  // 0: unbounded
  double edge_size_mm = 0;       // of lines; 0: unbounded
  std::string output_path;       // empty: no file
  std::size_t threads = 0;       // 0: Sequential_tag
  // Sliver removal after refinement; each stage has seconds of its own.
  bool perturb = false;  // move vertices
  bool exude = false;    // weight vertices
  bool lines = false;    // keep the lines where three or more labels meet, which CGAL detects
};

CGAL::Image_3 read_image(const std::string& path) {
  CGAL::Image_3 image;
  if (!image.read(path)) throw std::runtime_error(path + ": not an INR image that CGAL can read");
  return image;
}

std::uint64_t peak_resident_bytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<std::uint64_t>(usage.ru_maxrss) * 1024;
}

// Writes Medit; the references of cells are the image's labels.
template <class Complex>
void write_mesh(const Complex& complex, const std::string& path) {
  if (path.empty()) return;
  std::ofstream file(path);
  file.precision(17);
  complex.output_to_medit(file, false, false);
  if (!file.flush()) throw std::runtime_error(path + ": cannot be written");
}

template <class Work>
double seconds_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

// "seconds" are those of make_mesh_3: initial points, triangulation, refinement, and the start of TBB's
// threads.
template <class Concurrency, class Domain>
void mesh(const Domain& domain, const Options& options, Json& result) {
  using Triangulation = typename CGAL::Mesh_triangulation_3<Domain, CGAL::Default, Concurrency>::type;
  using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
  using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
  namespace params = CGAL::parameters;

  constexpr double kUnbounded = std::numeric_limits<double>::max();
  const Criteria criteria(params::edge_size = options.edge_size_mm > 0 ? options.edge_size_mm : kUnbounded,
                          params::facet_angle = kFacetAngleDeg, params::facet_size = options.facet_size_mm,
                          params::facet_distance = options.facet_distance_mm,
                          params::cell_radius_edge_ratio = kRadiusEdgeBound,
                          params::cell_size = options.cell_size_mm);
  Complex complex;
  result["seconds"] = seconds_of([&] {
    complex = CGAL::make_mesh_3<Complex>(domain, criteria, params::no_perturb(), params::no_exude());
  });
  if (options.perturb) result["perturb_seconds"] = seconds_of([&] { CGAL::perturb_mesh_3(complex, domain); });
  if (options.exude) result["exude_seconds"] = seconds_of([&] { CGAL::exude_mesh_3(complex); });
  write_mesh(complex, options.output_path);
  result["cells"] = complex.number_of_cells_in_complex();
  result["vertices"] = complex.triangulation().number_of_vertices();
  result["boundary_facets"] = complex.number_of_facets_in_complex();
  result["peak_rss_bytes"] = peak_resident_bytes();
}

#if defined(CGAL_MESH_3_USE_LAZY_UNSORTED_REFINEMENT_QUEUE) && CGAL_VERSION_NR >= 1060000000
// CGAL 6.1.1 does not compile here: elements of this queue have constant members, and its deque cannot move
// them.
template <class Domain>
void mesh_in_parallel(const Domain&, const Options&, Json&) {
  throw std::runtime_error("CGAL " CGAL_VERSION_STR " has no unsorted queue in parallel: --threads 0");
}
#else
template <class Domain>
void mesh_in_parallel(const Domain& domain, const Options& options, Json& result) {
  mesh<CGAL::Parallel_tag>(domain, options, result);
}
#endif

// `make` makes the domain.
template <class Make>
void mesh_domain(const Make& make, const Options& options, Json& result) {
  std::optional<decltype(make())> domain;
  result["prepare_seconds"] = seconds_of([&] { domain.emplace(make()); });
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  std::max<std::size_t>(options.threads, 1));
  if (options.threads == 0)
    mesh<CGAL::Sequential_tag>(*domain, options, result);
  else
    mesh_in_parallel(*domain, options, result);
}

#if CGAL_VERSION_NR >= 1050600000
void mesh_with_lines(const CGAL::Image_3& image, const Options& options, Json& result) {
  using WithLines = CGAL::Mesh_domain_with_polyline_features_3<Domain>;
  const auto make = [&] {
    return WithLines::create_labeled_image_mesh_domain(
        image, CGAL::parameters::features_detector(CGAL::Mesh_3::Detect_features_in_image()));
  };
  mesh_domain(make, options, result);
}
#else
void mesh_with_lines(const CGAL::Image_3&, const Options&, Json&) {
  throw std::runtime_error("CGAL " CGAL_VERSION_STR " detects no lines in images: CGAL 5.6 or later does");
}
#endif

Json run(const Options& options) {
  Json result;
  CGAL::Image_3 image;
  result["read_seconds"] = seconds_of([&] { image = read_image(options.image_path); });
  if (options.lines)
    mesh_with_lines(image, options, result);
  else
    mesh_domain([&] { return Domain::create_labeled_image_mesh_domain(image); }, options, result);
  result["options"] = {{"image", options.image_path},
                       {"cell_size_mm", options.cell_size_mm},
                       {"facet_size_mm", options.facet_size_mm},
                       {"facet_distance_mm", options.facet_distance_mm},
                       {"edge_size_mm", options.edge_size_mm},
                       {"lines", options.lines},
                       {"facet_angle_deg", kFacetAngleDeg},
                       {"cell_radius_edge_ratio", kRadiusEdgeBound},
                       {"threads", options.threads},
                       {"perturb", options.perturb},
                       {"exude", options.exude},
                       {"queue", kQueue},
                       {"cgal", CGAL_VERSION_STR}};
  return result;
}

}  // namespace

int main(int argc, char** argv) {
  Options options;
  CLI::App app("CGAL's mesh generation of a label image, timed. Prints one JSON line.");
  app.set_version_flag("--version", "CGAL " CGAL_VERSION_STR " Mesh_3, GPL-3.0-or-later");
  app.add_option("IMAGE", options.image_path, "label image, .inr or .inr.gz")
      ->required()
      ->check(CLI::ExistingFile);
  app.add_option("--cell-size", options.cell_size_mm,
                 "largest circumradius of a cell, mm [default: unbounded]")
      ->check(CLI::PositiveNumber);
  app.add_option("--facet-size", options.facet_size_mm,
                 "largest radius of a facet's ball about the surface, mm [default: unbounded]")
      ->check(CLI::PositiveNumber);
  app.add_option("--facet-distance", options.facet_distance_mm,
                 "largest distance of a facet to the surface, mm [default: unbounded]")
      ->check(CLI::PositiveNumber);
  app.add_flag(
      "--lines", options.lines,
      "keep the lines where three or more labels meet, which CGAL 5.6 and later detect [default: do not]");
  app.add_option("--edge-size", options.edge_size_mm, "largest edge of these lines, mm [default: unbounded]")
      ->check(CLI::PositiveNumber)
      ->needs("--lines");
  app.add_option("--output", options.output_path, "Medit file of the mesh, .mesh [default: none]");
  app.add_option("--threads", options.threads, "0: CGAL's Sequential_tag [default: 0]");
  app.add_flag("--perturb", options.perturb, "afterwards move vertices against slivers [default: do not]");
  app.add_flag("--exude", options.exude, "after that weight them against slivers [default: do not]");
  try {
    app.parse(argc, argv);
  } catch (const CLI::ParseError& error) {
    return app.exit(error) == 0 ? 0 : 2;
  }
  try {
    std::cout << run(options) << std::endl;
  } catch (const std::exception& error) {
    std::cerr << "cgal_mesh3: " << error.what() << '\n';
    return 2;
  }
}
