#include "readers/pvtu_pieces.h"

#include <fmt/format.h>

namespace podm::verify {

std::string text_of(const Point& point) { return fmt::format("({}, {}, {})", point[0], point[1], point[2]); }

std::string format_of_pieces(std::size_t num_pieces, const std::string& format_of_first) {
  return fmt::format("PVTU of {} pieces: {}", num_pieces, format_of_first);
}

void take_head(const Mesh& first, Mesh& whole) {
  whole.space = first.space;
  whole.label_names = first.label_names;
  whole.label_colours = first.label_colours;
  whole.unclaimed = first.unclaimed;
  whole.promised_dihedral_deg = first.promised_dihedral_deg;
  whole.promised_topology = first.promised_topology;
  whole.listed_differences = first.listed_differences;
  whole.smoothing_mm = first.smoothing_mm;
  whole.promises_flat_box = first.promises_flat_box;
  whole.promised_lines_delta_mm = first.promised_lines_delta_mm;
}

void check_labels_and_space(const MeshFile& file, const Mesh& piece, const Mesh& first) {
  if (piece.space != first.space) file.refuse("FieldData", "the space is not that of the first piece");
  if (piece.smoothing_mm != first.smoothing_mm)
    file.refuse("FieldData", "the width of smoothing is not that of the first piece");
  for (const auto* names : {&piece.label_names, &first.label_names}) {
    for (const auto& [value, name] : *names) {
      const auto here = piece.label_names.find(value), there = first.label_names.find(value);
      const auto name_in = [&](const auto& found, const Mesh& mesh) {
        return found == mesh.label_names.end() ? std::string("not named")
                                               : fmt::format("'{}'", found->second);
      };
      if (name_in(here, piece) == name_in(there, first)) continue;
      file.refuse("FieldData", fmt::format("label {} is {}, in the first piece {}", value,
                                           name_in(here, piece), name_in(there, first)));
    }
  }
}

}  // namespace podm::verify
