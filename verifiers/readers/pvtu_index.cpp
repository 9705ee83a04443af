// Format: VTK file formats, "XML file formats", parallel formats.
#include "readers/pvtu_index.h"

#include <expat.h>
#include <fmt/format.h>

#include <exception>
#include <filesystem>
#include <memory>
#include <set>
#include <string_view>

#include "errors.h"

namespace podm::verify {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kLongestIndex = 1 << 26;  // bytes: half a million pieces

struct FreeParser {
  void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
};

class PvtuParser {
 public:
  explicit PvtuParser(const MeshFile& file) : file_(file), parser_(XML_ParserCreate(nullptr)) {
    if (!parser_) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetStartElementHandler(parser_.get(), [](void* self, const char* name, const char** attributes) {
      static_cast<PvtuParser*>(self)->guarded([&](PvtuParser& p) { p.on_start(name, attributes); });
    });
    XML_SetStartDoctypeDeclHandler(parser_.get(), [](void* self, const char*, const char*, const char*, int) {
      static_cast<PvtuParser*>(self)->guarded(
          [](PvtuParser& p) { p.refuse("a document type is declared; PVTU files have none"); });
    });
  }

  std::vector<PieceSource> parse() {
    const std::string_view bytes = file_.bytes();
    if (bytes.size() > kLongestIndex)
      file_.refuse(MeshFile::byte_at(kLongestIndex), "an index is not that long");
    const auto status = XML_Parse(parser_.get(), bytes.data(), static_cast<int>(bytes.size()), XML_TRUE);
    if (failure_) std::rethrow_exception(failure_);
    if (status == XML_STATUS_ERROR) refuse(XML_ErrorString(XML_GetErrorCode(parser_.get())));
    if (!has_grid_) refuse("no element PUnstructuredGrid");
    if (pieces_.empty()) refuse("the index names no pieces");
    return std::move(pieces_);
  }

 private:
  // No exception may pass through expat: it is stored and the parser is stopped.
  template <class Handle>
  void guarded(Handle handle) {
    if (failure_) return;
    try {
      handle(*this);
    } catch (...) {
      failure_ = std::current_exception();
      XML_StopParser(parser_.get(), XML_FALSE);
    }
  }

  std::size_t line() const { return XML_GetCurrentLineNumber(parser_.get()); }
  [[noreturn]] void refuse(const std::string& fault) const {
    file_.refuse(fmt::format("line {}", line()), fault);
  }

  void on_start(std::string_view name, const char** attributes) {
    const auto attribute = [attributes](std::string_view wanted) -> std::string {
      for (const char** a = attributes; *a != nullptr; a += 2)
        if (wanted == a[0]) return a[1];
      return "";
    };
    if (is_first_ && name != "VTKFile") refuse("the root element is not VTKFile");
    if (is_first_ && attribute("type") != "PUnstructuredGrid")
      refuse(fmt::format("VTKFile of type '{}', not PUnstructuredGrid", attribute("type")));
    is_first_ = false;
    if (name == "PUnstructuredGrid") {
      has_grid_ = true;
      const std::string level = attribute("GhostLevel");
      if (!level.empty() && level != "0")
        refuse("the pieces have ghost cells, which cannot be distinguished");
    }
    if (name == "Piece") add_piece(attribute("Source"));
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

  const MeshFile& file_;
  std::unique_ptr<XML_ParserStruct, FreeParser> parser_;
  std::exception_ptr failure_;
  bool is_first_ = true, has_grid_ = false;
  std::vector<PieceSource> pieces_;
  std::set<fs::path> named_;
};

}  // namespace

std::string PieceSource::place() const { return fmt::format("line {}, Piece", line); }

std::vector<PieceSource> parse_pvtu(const MeshFile& file) { return PvtuParser(file).parse(); }

}  // namespace podm::verify
