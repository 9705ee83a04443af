#include "cli/reports/summary.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "cli/commands/labelled_image.h"

namespace podm::cli {
namespace {

constexpr std::size_t kLongestList = 20;  // an atlas has hundreds of labels; the record holds them all

std::string more(std::size_t total, const std::string& what) {
  return total > kLongestList ? fmt::format("  ... and {} more {}\n", total - kLongestList, what) : "";
}

std::string labels_text(const MeshRun& run) {
  const MeshingReport& report = run.report;
  std::vector<Label> labels(run.image.labels.begin() + 1, run.image.labels.end());
  const auto cells_of = [&](const Label& label) {
    const auto found = report.cells_of_label.find(label.value);
    return found == report.cells_of_label.end() ? 0 : found->second;
  };
  std::stable_sort(labels.begin(), labels.end(),
                   [&](const Label& a, const Label& b) { return cells_of(a) > cells_of(b); });
  std::string text = fmt::format("cells by label, volume in mm^3\n");
  for (std::size_t i = 0; i < std::min(labels.size(), kLongestList); ++i) {
    const auto volume = report.volume_of_label_mm3.find(labels[i].value);
    text += fmt::format("  {:>10} {:>14.6g}  {}\n", cells_of(labels[i]),
                        volume == report.volume_of_label_mm3.end() ? 0.0 : volume->second,
                        display_name(labels[i]));
  }
  return text + more(labels.size(), "labels");
}

std::string facets_text(const MeshRun& run) {
  const auto name = [&](LabelIndex label) {
    return label == kBackground ? std::string("outside") : display_name(run.image.labels[label]);
  };
  const auto& counts = run.mesh.facet_pairs;
  std::string text = "boundary facets by the labels that they separate\n";
  for (std::size_t i = 0; i < std::min(counts.size(), kLongestList); ++i)
    text += fmt::format("  {:>10}  {} | {}\n", counts[i].facets, name(counts[i].labels[1]),
                        name(counts[i].labels[0]));
  return text + more(counts.size(), "pairs");
}

std::string sides_text(const MeshingReport& report) {
  if (!report.facets_of_sides) return "";
  std::string text = "box        facets by side:";
  for (std::size_t side = 0; side < kNumSides; ++side)
    text += fmt::format(" {} {}", kSideNames[side], (*report.facets_of_sides)[side]);
  text += "\n";
  if (report.cells_mended_by_turning > 0)
    text += fmt::format("           {} cells that rounding inverted in the oblique frame are mended\n",
                        report.cells_mended_by_turning);
  if (!report.is_delaunay_when_turned.value_or(true) && !report.optimization)
    text += "           the file does not claim to be Delaunay: vertices on circumspheres are rounded\n";
  return text;
}

std::string quality_text(const MeshingReport& report) {
  const Quality& quality = report.quality;
  return fmt::format(
      "quality    radius-edge ratio up to {:.4g} (bound {}), boundary facet angles {:.4g} to {:.4g} deg"
      " (bound {}{}),\n"
      "           dihedral angles {:.4g} to {:.4g} deg, circumradius up to {:.4g} mm, shortest edge {:.4g} "
      "mm\n",
      quality.max_radius_edge, kRadiusEdgeBound, quality.min_facet_angle_deg, quality.max_facet_angle_deg,
      kFacetAngleBound, report.lines ? fmt::format(", near lines {}", kFacetAngleBoundNearLines) : "",
      quality.min_dihedral_deg, quality.max_dihedral_deg, quality.max_radius_mm, quality.shortest_edge_mm);
}

std::string perturbation_text(const MeshingReport& report) {
  if (!report.perturbation) return "";
  const PerturbationReport& perturbation = *report.perturbation;
  std::string text = fmt::format(
      "dihedral   cells with an angle below {:g} or above {:g} deg: {} ({} with a free vertex), before {} "
      "({})\n",
      perturbation.min_dihedral_deg, perturbation.max_dihedral_deg, perturbation.after.number(),
      perturbation.after.with_free_vertex, perturbation.before.number(),
      perturbation.before.with_free_vertex);
  std::string why;
  for (const auto& [reason, name] : Names<Unmoved>::kAll)
    if (const std::uint64_t cells = perturbation.unmoved[static_cast<std::size_t>(reason)]; cells > 0)
      why += fmt::format("{} {} {}", why.empty() ? "" : ",", name, cells);
  if (perturbation.not_reached > 0)
    why += fmt::format("{} not reached {}", why.empty() ? "" : ",", perturbation.not_reached);
  return why.empty() ? text : text + "           they remain because of" + why + "\n";
}

std::string words(std::string name) {
  std::replace(name.begin(), name.end(), '_', ' ');
  return name;
}

template <class Choice>
std::string counts_text(const std::map<Choice, std::uint64_t>& counts) {
  std::string text;
  for (const auto& [choice, count] : counts)
    if (count > 0) text += fmt::format("{}{} {}", text.empty() ? "" : ", ", count, words(to_string(choice)));
  return text.empty() ? "none" : text;
}

std::string optimization_text(const MeshingReport& report) {
  if (!report.optimization) return "";
  const OptimizationReport& done = *report.optimization;
  const auto line = [](double least_deg, double largest_deg, std::uint64_t before, std::uint64_t now) {
    return fmt::format("{} cells below {:g} or above {:g} deg, {} before", now, least_deg, largest_deg,
                       before);
  };
  std::string text = fmt::format(
      "optimized  {}\n           {}\n           by {}\n",
      line(done.least_dihedral_deg, done.largest_dihedral_deg, done.beyond_bounds_before, done.beyond_bounds),
      line(done.least_aim_deg, done.largest_aim_deg, done.beyond_aim_before, done.beyond_aim),
      counts_text(done.successes));
  if (done.beyond_bounds > 0)
    text +=
        fmt::format("           obstacles for cells beyond the bounds: {}\n", counts_text(done.obstacles));
  return text;
}

std::string difference_text(const TopologyReport::Difference& each) {
  std::string numbers;
  if (each.kind == TopologyDifference::kHandles || each.kind == TopologyDifference::kCavities) {
    const std::size_t i = each.kind == TopologyDifference::kHandles ? 1 : 2;
    numbers = fmt::format(" {} instead of {}", each.of_mesh[i], each.of_image[i]);
  } else if (each.kind == TopologyDifference::kSplit) {
    numbers = fmt::format(" into {}", each.of_mesh[0]);
  }
  return fmt::format("           {}{}: label {}{} at voxel ({}), {:.4g} {:.4g} {:.4g} mm\n",
                     to_string(each.kind), numbers, each.label.value,
                     each.label.name.empty() ? "" : fmt::format(" ({})", each.label.name),
                     fmt::join(each.voxel, ", "), each.ras_mm[0], each.ras_mm[1], each.ras_mm[2]);
}

std::string topology_text(const MeshingReport& report) {
  if (!report.topology) return "";
  constexpr std::size_t kMostListed = 20;  // the record has all
  const TopologyReport& of = *report.topology;
  std::string text = fmt::format(
      "topology   {} components, {} differ, {} before {} refinement{} down to a delta of {:.4g} mm\n"
      "           {} ambiguous places of the image explain {} more differences\n",
      of.components, of.differences.size(), of.differences_at_first, of.passes, of.passes == 1 ? "" : "s",
      of.least_delta_mm, of.ambiguous_places, of.ambiguous);
  for (std::size_t i = 0; i < std::min(kMostListed, of.differences.size()); ++i)
    text += difference_text(of.differences[i]);
  if (of.differences.size() > kMostListed)
    text += fmt::format("           and {} more\n", of.differences.size() - kMostListed);
  return text;
}

// Leaves out what is not there: a mesh may lack facets near lines, or away from them.
std::string near_lines_text(const LinesReport& of) {
  if (!of.min_facet_angle_near_deg || !of.max_radius_edge_near) return "";
  const std::string elsewhere =
      of.min_facet_angle_away_deg ? fmt::format(" (elsewhere {:.2f})", *of.min_facet_angle_away_deg) : "";
  return fmt::format(
      "           near them {} facets, least angle {:.2f} deg{}, and {} cells, largest ratio {:.3f}\n",
      of.facets_near, *of.min_facet_angle_near_deg, elsewhere, of.cells_near, *of.max_radius_edge_near);
}

std::string lines_text(const MeshingReport& report) {
  if (!report.lines) return "";
  const LinesReport& of = *report.lines;
  if (!of.is_traced) return "lines      not traced: the run ended before\n";
  std::string text =
      fmt::format("lines      {} edges, {:.6g} of {:.6g} mm ({:.3f} %), sampled at {:.4g} mm; {} splits\n",
                  of.edges, of.kept_mm, of.traced_mm, 100 * of.share_kept(), of.delta_mm, of.splits);
  text += near_lines_text(of);
  if (of.inexact_vertices > 0)
    text += fmt::format("           {} vertices lie beside a line: its place was not found\n",
                        of.inexact_vertices);
  if (!of.left_out.empty())
    text += fmt::format(
        "           {} stretches left out, {:.4g} mm of them too small or too near another line\n",
        of.left_out.size(), of.excluded_mm);
  if (of.stray_mm > 0)
    text += fmt::format("           {:.4g} mm more of edges where three labels meet only in the mesh\n",
                        of.stray_mm);
  if (of.untraced_mm > 0)
    text += fmt::format("           about {:.4g} mm more may be too fine to be traced\n", of.untraced_mm);
  if (!of.is_claimed()) text += "           the file does not claim the lines\n";
  if (!of.undecided.empty())
    text += fmt::format("           {} undecided places: the record lists them\n", of.undecided.size());
  return text;
}

std::string smoothing_text(const MeshRun& run) {
  if (!run.report.smoothing) return "";
  const SmoothingReport& done = *run.report.smoothing;
  std::string text =
      fmt::format("smoothed   by {:g} mm; volume in mm^3 and components of each label, before and after\n",
                  done.width_mm);
  std::vector<SmoothingReport::OfLabel> labels = done.labels;
  std::stable_sort(labels.begin(), labels.end(),
                   [](const auto& a, const auto& b) { return a.voxels_mm3 > b.voxels_mm3; });
  for (std::size_t i = 0; i < std::min(labels.size(), kLongestList); ++i)
    text += fmt::format("  {:>14.6g} {:>14.6g} {:>+7.2f} % {:>6} {:>6}  label {}{}\n", labels[i].voxels_mm3,
                        labels[i].smoothed_mm3, 100 * (labels[i].smoothed_mm3 / labels[i].voxels_mm3 - 1),
                        labels[i].voxels_components, labels[i].smoothed_components, labels[i].value,
                        labels[i].is_thin ? ", thin" : "");
  return text + more(labels.size(), "labels");
}

std::string calibration_text(const MeshingReport& report) {
  if (!report.calibration) return "";
  const Calibration& calibration = *report.calibration;
  const std::size_t dropped = calibration.meshes.size();
  return fmt::format(
      "target     {} cells: radius {:.6g} mm, found in {:.2f} s{}; the speed excludes the search\n",
      calibration.target_elements, calibration.radius_mm, calibration.seconds,
      dropped > 0 ? fmt::format(" after {} mesh{} that missed", dropped, dropped > 1 ? "es" : "") : "");
}

std::string sizes_by_place_text(const MeshRun& run) {
  const SizeOptions& sizes = run.options.sizes;
  std::vector<std::string> parts;
  if (sizes.image != nullptr)
    parts.push_back(fmt::format("at most {:.4g} times {}", run.report.size_image_factor, sizes.image->path));
  for (const InterfaceSize& near : sizes.near)
    parts.push_back(fmt::format("{:.4g} mm within {:.4g} mm of labels {} | {}", near.radius_mm, near.width_mm,
                                fmt::join(near.labels[0], ", "), fmt::join(near.labels[1], ", ")));
  if (sizes.grade > 0) parts.push_back(fmt::format("growing by at most {:.4g} mm per mm", sizes.grade));
  return parts.empty() ? "" : fmt::format("           {}\n", fmt::join(parts, ";\n           "));
}

std::string time_text(const MeshRun& run) {
  const auto phases = run.phases_s();
  std::string text = "time      ";
  for (const char* phase :
       {"read", "draw", "trace", "transform", "allocate", "lines", "initial", "octree", "refine", "exchange",
        "closing", "mend", "perturb", "optimize", "extract", "measure", "write"})
    if (const auto found = phases.find(phase); found != phases.end())
      text += fmt::format(" {} {:.2f} s", phase, found->second);
  return text +
         fmt::format("\nspeed      {:.0f} cells/s from image to mesh, {:.0f} cells/s refining\n",
                     run.cells_per_second(), run.refine_cells_per_second()) +
         calibration_text(run.report);
}

}  // namespace

namespace {

std::string values_text(const MeshRun& run) {
  std::string text;
  for (const ValuesOnCells& values : run.values) {
    text += fmt::format("values     {} of {}: means of cells {:.6g} to {:.6g}", values.name, values.path,
                        values.report.least_mean, values.report.largest_mean);
    if (values.report.partly_covered > 0)
      text += fmt::format("; {} cells are covered in part", values.report.partly_covered);
    text += "\n";
  }
  return text;
}

}  // namespace

std::string summary(const MeshRun& run) {
  const MeshingReport& report = run.report;
  const std::string& path = run.command.mesh_path;
  const std::string place = path.empty() ? "" : path + ": ";
  std::string text =
      fmt::format("{}{} cells, {} vertices, {} boundary facets; {} space\n", place, run.mesh.cells,
                  run.mesh.vertices, run.mesh.boundary_facets, to_string(run.options.space));
  text += labels_text(run) + smoothing_text(run) + facets_text(run) + sides_text(report) +
          quality_text(report) + perturbation_text(report) + optimization_text(report) +
          topology_text(report) + lines_text(report) + values_text(run);
  text += fmt::format("sizes      radius {}, delta {:.4g} mm\n",
                      report.radius_mm > 0 ? fmt::format("{:.4g} mm", report.radius_mm) : "unbounded",
                      report.delta_mm);
  text += sizes_by_place_text(run) + time_text(run) + run.ranks_text;
  text += fmt::format("memory     {:.3f} GiB at most\n",
                      static_cast<double>(run.peak_rss_bytes) / (1024.0 * 1024 * 1024));
  if (!run.mesh_sha256.empty()) text += fmt::format("sha256     {}\n", run.mesh_sha256);
  text += fmt::format("guarantees {}\n", report.guarantees.all_met() ? "all met" : "not met");
  return text;
}

namespace {

std::string hops_text(const std::vector<std::uint64_t>& accesses) {
  std::uint64_t all = 0;
  for (const std::uint64_t n : accesses) all += n;
  std::string text;
  for (const std::uint64_t n : accesses)
    text += fmt::format(" {:6.2f}", all > 0 ? 100 * static_cast<double>(n) / static_cast<double>(all) : 0);
  return text;
}

std::string statistics_line(const std::string& name, const std::string& place, const Counters& c) {
  const std::uint64_t committed = c.num_committed();
  const auto visited = static_cast<double>(c.conflict_tests);
  return fmt::format("{:>6} {:>11} {:>11} {:>11} {:>9} {:>9} {:>9.1f} {:>9.3f} {:>8.3f} {:>8.3f} {}\n", name,
                     place, committed, c.stale_cells, c.lock_conflicts, c.rejected,
                     committed > 0 ? visited / static_cast<double>(committed) : 0, c.overhead.contention_s,
                     c.overhead.begging_s, c.overhead.rollback_s, hops_text(c.hops.mesh_reads));
}

}  // namespace

std::string statistics(const MeshRun& run) {
  const MeshingReport& report = run.report;
  const bool is_virtual = run.options.team.executor == Executor::kVirtual;
  std::string text = fmt::format(
      "{:>6} {:>11} {:>11} {:>11} {:>9} {:>9} {:>9} {:>28}{}\n"
      "{:>6} {:>11} {:>11} {:>11} {:>9} {:>9} {:>9} {:>9} {:>8} {:>8}{}\n",
      "", "", "", "", "", "", "cells", is_virtual ? "simulated seconds lost to" : "seconds lost to",
      report.counters.hops.mesh_reads.empty() ? "" : "  % of accesses", "worker", "cpu/node", "committed",
      "stale", "conflict", "rejected", "visited", "waiting", "begging", "rollback",
      report.counters.hops.mesh_reads.empty() ? "" : "  at 0, 1, ... hops");
  for (std::size_t i = 0; i < report.workers.size(); ++i) {
    const WorkerReport& worker = report.workers[i];
    const std::string processor = worker.bound_to ? std::to_string(*worker.bound_to) : "any";
    text += statistics_line(std::to_string(i), fmt::format("{}/{}", processor, worker.node), worker.counters);
  }
  return text + statistics_line("all", "", report.counters);
}

}  // namespace podm::cli
