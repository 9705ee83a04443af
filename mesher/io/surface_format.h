// The formats of closed surfaces: binary STL and binary PLY. The bytes of heads, vertices and facets have
// fixed lengths per file, so that ranks can write their parts of a file at once.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "podm/choices.h"
#include "podm/label_image.h"
#include "podm/tet_mesh.h"

namespace podm {

/// STL has single precision and no shared vertices.
enum class SurfaceFormat { kStl, kPly };

/// Returns nothing for the extension of no format; surface_format_of() throws InputError instead.
std::optional<SurfaceFormat> find_surface_format(const std::string& path);
SurfaceFormat surface_format_of(const std::string& path);
/// Returns the path of one label's surface: NAME_VALUE_LABELNAME.EXT for NAME.EXT.
std::string surface_path(const std::string& path, const Label& label);

struct SurfaceSize {
  std::uint64_t vertices = 0, facets = 0;
};
/// Throws InputError if the format cannot number as many.
void check_surface_size(SurfaceFormat format, const std::string& path, const SurfaceSize& size);
/// Returns the bytes before the vertices. After them come the vertices, if the format shares them, then the
/// facets.
std::string surface_head(SurfaceFormat format, Space space, const Label& label, const SurfaceSize& size);
std::size_t bytes_per_vertex(SurfaceFormat format);
std::size_t bytes_per_facet(SurfaceFormat format);
/// Both append the bytes of an item. `positions` are those of the vertices in the file.
void append_vertex(SurfaceFormat format, const std::array<double, 3>& point, std::string& bytes);
void append_facet(SurfaceFormat format, const std::array<std::array<double, 3>, 3>& points,
                  const std::array<std::uint32_t, 3>& positions, std::string& bytes);

/// Returns the facets of each label, oriented so that their normals point out of the label.
std::vector<std::vector<std::array<std::uint32_t, 3>>> outward_facets(const TetMesh& mesh);

}  // namespace podm
