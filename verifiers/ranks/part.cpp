#include "ranks/part.h"

namespace podm::verify {

std::vector<GlobalId> ascending(std::vector<GlobalId> cells) {
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

std::vector<GlobalId> own_of(const Mesh& mesh, std::vector<GlobalId> cells) {
  if (mesh.part) {
    Communication& ranks = ranks_of(mesh);
    auto lists = lists_for<GlobalId>(ranks);
    for (const GlobalId cell : cells) lists[owner_of_cell(mesh, cell)].push_back(cell);
    cells = exchange_joined(ranks, std::move(lists));
  }
  return ascending(std::move(cells));
}

}  // namespace podm::verify
