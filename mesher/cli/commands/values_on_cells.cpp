#include "cli/commands/values_on_cells.h"

#include <fmt/format.h>

#include <set>

#include "algorithms/team_size.h"
#include "geometry/affine.h"
#include "podm/errors.h"
#include "podm/image_io.h"

namespace podm::cli {

namespace {

void check_names(const NamedFiles& values) {
  std::set<std::string> names{"label"};  // an array of every mesh
  for (const auto& [name, path] : values)
    for (const char* ending : {"", "_least", "_largest", "_covered"})
      if (!names.insert(name + ending).second)
        throw InputError(fmt::format("{}: two arrays of the mesh would have the name '{}'", spelled("values"),
                                     name + ending));
}

// True if some plane parallel to the faces of one grid's box separates it from the other grid.
bool lies_apart(const std::array<int, 3>& size, const Affine& to_ras, const std::array<int, 3>& other_size,
                const Affine& other_to_ras) {
  const Affine to_grid = inverse(to_ras);
  std::array<bool, 3> is_below{true, true, true}, is_above{true, true, true};
  for (int corner = 0; corner < 8; ++corner) {
    std::array<double, 3> at;
    for (std::size_t axis = 0; axis < 3; ++axis)
      at[axis] = (corner >> axis & 1) != 0 ? other_size[axis] - 0.5 : -0.5;
    const std::array<double, 3> here = map(to_grid, map(other_to_ras, at));
    for (std::size_t axis = 0; axis < 3; ++axis) {
      is_below[axis] = is_below[axis] && here[axis] < -0.5;
      is_above[axis] = is_above[axis] && here[axis] > size[axis] - 0.5;
    }
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (is_below[axis] || is_above[axis]) return true;
  return false;
}

}  // namespace

ImagesOfValues::ImagesOfValues(const MeshCommand& command, const LabelImage& image, std::uint64_t most_bytes)
    : command_(command), image_(image) {
  if (command.values.empty()) return;
  if (!command.mesh_path.ends_with(".vtu"))
    throw InputError(fmt::format("{}: {} cannot hold values of cells; write a .vtu", spelled("values"),
                                 command.mesh_path));
  check_names(command.values);
  for (const auto& [name, path] : command.values) {
    const ValueImage& values = images_.emplace_back(read_value_image(path, most_bytes));
    if (lies_apart(values.size, values.voxel_to_ras, image.size, image.voxel_to_ras) ||
        lies_apart(image.size, image.voxel_to_ras, values.size, values.voxel_to_ras))
      throw InputError(fmt::format("{}: the image overlaps no voxel of {}", path, command.image.path));
  }
}

std::vector<ValuesOnCells> ImagesOfValues::add_to(TetMesh& mesh) const {
  std::vector<ValuesOnCells> added;
  for (std::size_t i = 0; i < images_.size(); ++i) {
    const auto& [name, path] = command_.values[i];
    added.push_back({name, path,
                     add_cell_values(mesh, image_, name, images_[i], command_.values_of,
                                     loop_threads(command_.meshing.team))});
  }
  return added;
}

std::vector<std::string> ImagesOfValues::warnings() const {
  std::vector<std::string> all;
  for (const ValueImage& image : images_) all.insert(all.end(), image.warnings.begin(), image.warnings.end());
  return all;
}

}  // namespace podm::cli
