#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>

#include "ranks/part.h"
#include "report/reports.h"

namespace podm::verify {

namespace {

std::string witness_text(const Witness& witness) {
  std::string text = fmt::format("      violated: {}", witness.statement);
  if (!witness.cells.empty()) text += fmt::format("; cell {}", fmt::join(witness.cells, ", "));
  if (!witness.vertices.empty()) text += fmt::format("; vertices {}", fmt::join(witness.vertices, ", "));
  if (witness.value != 0) text += fmt::format("; value {:.9g}", witness.value);
  if (!witness.points.empty()) text += fmt::format("; at ({:.9g})", fmt::join(witness.points[0], ", "));
  return text + "\n";
}

bool is_not_on_ranks(Needs needs) { return needs == Needs::kPromisedImage || needs == Needs::kLines; }

const char* why_left_out(const Claim& claim, const Mesh& mesh) {
  if (mesh.unclaimed.contains(claim.name)) return "the file does not claim it";
  if (mesh.part && is_not_on_ranks(claim.needs)) return "not on ranks";
  switch (claim.needs) {
    case Needs::kNothing:
      return "needs nothing";
    case Needs::kImage:
      return "needs --image";
    case Needs::kBound:
      return "needs --radius";
    case Needs::kDihedralBound:
      return "needs --min-dihedral or --max-dihedral";
    case Needs::kPromisedImage:
      return "needs --image, and a file that promises it";
    case Needs::kFlatBox:
      return "needs --image, and --box flat or a file that promises it";
    case Needs::kLines:
      return "needs --image and --lines-delta";
  }
  return "";
}

std::string left_out(const Mesh& mesh, const Options& options, const std::vector<ClaimResult>& results) {
  if (!options.claims.empty()) return "";
  std::vector<std::string> names;
  for (const Claim& claim : all_claims()) {
    const auto is_run = [&](const ClaimResult& result) { return result.claim == claim.name; };
    if (std::none_of(results.begin(), results.end(), is_run))
      names.push_back(fmt::format("{} ({})", claim.name, why_left_out(claim, mesh)));
  }
  return names.empty() ? "" : fmt::format("left out: {}\n", fmt::join(names, ", "));
}

}  // namespace

std::string terminal_report(const Inputs& inputs, const Options& options,
                            const std::vector<ClaimResult>& results, double seconds) {
  const Mesh& mesh = inputs.mesh;
  std::string text = fmt::format("{}: {}; {} tetrahedra, {} vertices\n", mesh.path, mesh.format,
                                 num_cells(mesh), num_vertices(mesh));
  for (const auto& [name, count] : mesh.other_cells)
    text += fmt::format("  also holds {} {}, not checked\n", count, name);
  if (inputs.image && inputs.image->smoothing)
    text += fmt::format("  image smoothed by {} mm, as {} states\n", inputs.image->smoothing->width_mm,
                        options.smooth_mm ? "--smooth" : "the mesh file");
  if (inputs.image)
    for (const std::string& warning : inputs.image->warnings) text += fmt::format("  warning: {}\n", warning);
  if (inputs.sizes)
    for (const std::string& warning : inputs.sizes->warnings) text += fmt::format("  warning: {}\n", warning);
  std::size_t num_passed = 0;
  for (const ClaimResult& result : results) {
    num_passed += result.verdict == Verdict::kPass;
    text += fmt::format("{:>7}  {:<16} {} ({:.2f} s)\n", to_string(result.verdict), result.claim,
                        result.reason, result.seconds);
    if (result.verdict == Verdict::kFail && !result.worst.empty()) text += witness_text(result.worst[0]);
  }
  return text + left_out(mesh, options, results) +
         fmt::format("{} of {} claims pass ({:.2f} s)\n", num_passed, results.size(), seconds);
}

}  // namespace podm::verify
