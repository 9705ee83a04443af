// Format: VTK file formats, "XML file formats", parallel formats.
#include "readers/pvtu_index.h"

#include <fmt/format.h>

#include <filesystem>
#include <set>
#include <string_view>

#include "readers/xml_parser.h"

namespace podm::verify {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestIndex = 1 << 26;  // bytes: half a million pieces

class PvtuParser : XmlParser {
 public:
  explicit PvtuParser(const MeshFile& file) : XmlParser(file, "PVTU") {}

  std::vector<PieceSource> parse() {
    const std::string_view bytes = file_.bytes();
    if (bytes.size() > kLongestIndex)
      file_.refuse(MeshFile::byte_at(kLongestIndex), "an index is not that long");
    parse_part(bytes, true);
    if (!has_grid_) refuse("no element PUnstructuredGrid");
    if (pieces_.empty()) refuse("the index names no pieces");
    return std::move(pieces_);
  }

 private:
  void on_start(std::string_view name) override {
    if (is_first_ && name != "VTKFile") refuse("the root element is not VTKFile");
    if (is_first_ && attribute("type") != "PUnstructuredGrid")
      refuse(fmt::format("VTKFile of type '{}', not PUnstructuredGrid", attribute("type")));
    is_first_ = false;
    if (name == "PUnstructuredGrid") {
      has_grid_ = true;
      const std::string_view level = attribute("GhostLevel");
      if (!level.empty() && level != "0")
        refuse("the pieces have ghost cells, which cannot be distinguished");
    }
    if (name == "Piece") add_piece(std::string(attribute("Source")));
  }

  void add_piece(const std::string& source) {
    if (source.empty()) refuse("Piece: no Source");
    PieceSource piece{(fs::path(file_.path()).parent_path() / source).string(), line()};
    std::error_code none_there;
    const fs::path canonical = fs::weakly_canonical(piece.path, none_there);
    if (!named_.insert(none_there ? fs::path(piece.path) : canonical).second)
      refuse(fmt::format("Piece: {} is named twice", source));
    pieces_.push_back(std::move(piece));
  }

  bool is_first_ = true, has_grid_ = false;
  std::vector<PieceSource> pieces_;
  std::set<fs::path> named_;
};

}  // namespace

std::string PieceSource::place() const { return fmt::format("line {}, Piece", line); }

std::vector<PieceSource> parse_pvtu(const MeshFile& file) { return PvtuParser(file).parse(); }

}  // namespace podm::verify
