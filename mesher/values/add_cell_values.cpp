#include <fmt/format.h>

#include <algorithm>

#include "podm/cell_values.h"
#include "podm/errors.h"
#include "values/cell_values.h"

namespace podm {

namespace {

// Returns the map from voxel indices of `values` to the coordinates of the mesh.
std::array<Rational, 12> grid_to_mesh(const ValueImage& values, const LabelImage& image, Space space) {
  const std::array<Rational, 12> to_ras = exact_affine(values.voxel_to_ras);
  switch (space) {
    case Space::kRas:
      return to_ras;
    case Space::kLps:
      return product(exact_affine({-1, 0, 0, 0, 0, -1, 0, 0, 0, 0, 1, 0}), to_ras);
    case Space::kVoxel:
      return product(exact_inverse(exact_affine(image.voxel_to_ras)), to_ras);
  }
  throw InternalError("a mesh is in an unknown space");
}

template <class Member>
CellArray array_of(const std::vector<CellValue>& of_cells, std::string name, Member member) {
  CellArray array{std::move(name), std::vector<double>(of_cells.size())};
  std::transform(of_cells.begin(), of_cells.end(), array.values.begin(),
                 [member](const CellValue& value) { return value.*member; });
  return array;
}

void refuse_uncovered(const std::vector<CellValue>& of_cells, const std::string& path) {
  const auto uncovered = static_cast<std::size_t>(std::count_if(
      of_cells.begin(), of_cells.end(), [](const CellValue& value) { return value.covered_share == 0; }));
  if (uncovered == of_cells.size() && uncovered > 0)
    throw InputError(fmt::format("{}: the image overlaps no cell of the mesh", path));
  if (uncovered > 0)
    throw InputError(fmt::format("{}: the image does not overlap {} of the {} cells of the mesh", path,
                                 uncovered, of_cells.size()));
}

}  // namespace

CellValuesReport add_cell_values(TetMesh& mesh, const LabelImage& image, const std::string& name,
                                 const ValueImage& values, ValuesOf of, int threads) {
  const std::vector<CellValue> of_cells =
      values_of_cells(mesh, values, grid_to_mesh(values, image, mesh.space), of, threads);
  refuse_uncovered(of_cells, values.path);
  mesh.cell_arrays.push_back(array_of(of_cells, name, &CellValue::mean));
  const std::vector<double>& means = mesh.cell_arrays.back().values;
  CellValuesReport report;
  if (!means.empty()) {
    const auto [least, largest] = std::minmax_element(means.begin(), means.end());
    report = {.least_mean = *least, .largest_mean = *largest};
  }
  report.partly_covered = static_cast<std::uint64_t>(std::count_if(
      of_cells.begin(), of_cells.end(), [](const CellValue& value) { return value.covered_share < 1; }));
  mesh.cell_arrays.push_back(array_of(of_cells, name + "_least", &CellValue::least));
  mesh.cell_arrays.push_back(array_of(of_cells, name + "_largest", &CellValue::largest));
  mesh.cell_arrays.push_back(array_of(of_cells, name + "_covered", &CellValue::covered_share));
  return report;
}

}  // namespace podm
