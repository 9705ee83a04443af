// A parser of VTK's XML files by expat. A derived class handles elements; what it throws is thrown by
// parse().
#pragma once

#include <expat.h>
#include <fmt/format.h>

#include <exception>
#include <memory>
#include <new>
#include <string>
#include <string_view>

#include "readers/mesh_file.h"

namespace podm::verify {

class XmlParser {
 public:
  XmlParser(const MeshFile& file, const char* format)
      : file_(file), format_(format), parser_(XML_ParserCreate(nullptr)) {
    if (!parser_) throw std::bad_alloc();
    XML_SetUserData(parser_.get(), this);
    XML_SetElementHandler(
        parser_.get(),
        [](void* self, const char* name, const char** attributes) {
          static_cast<XmlParser*>(self)->guarded([&](XmlParser& parser) {
            parser.attributes_ = attributes;
            parser.on_start(name);
          });
        },
        [](void* self, const char*) {
          static_cast<XmlParser*>(self)->guarded([](XmlParser& parser) { parser.on_end(); });
        });
    XML_SetStartDoctypeDeclHandler(parser_.get(), [](void* self, const char*, const char*, const char*, int) {
      static_cast<XmlParser*>(self)->guarded([](XmlParser& parser) {
        parser.refuse(fmt::format("a document type is declared; {} files have none", parser.format_));
      });
    });
  }
  virtual ~XmlParser() = default;
  XmlParser(const XmlParser&) = delete;  // expat keeps its address
  XmlParser& operator=(const XmlParser&) = delete;

 protected:
  virtual void on_start(std::string_view name) = 0;
  virtual void on_end() {}

  /// Parses the next part of the file, and refuses what is not XML unless stop() was called.
  void parse_part(std::string_view part, bool is_last) {
    const auto status = XML_Parse(parser_.get(), part.data(), static_cast<int>(part.size()), is_last);
    if (failure_) std::rethrow_exception(failure_);
    if (status == XML_STATUS_ERROR && !is_stopped_) refuse(XML_ErrorString(XML_GetErrorCode(parser_.get())));
  }
  /// Ends the parsing after this element.
  void stop() {
    is_stopped_ = true;
    XML_StopParser(parser_.get(), XML_FALSE);
  }

  /// Returns "" if the present element has no such attribute.
  std::string_view attribute(std::string_view name) const {
    for (const char** a = attributes_; *a != nullptr; a += 2)
      if (name == a[0]) return a[1];
    return "";
  }
  std::size_t position() const { return static_cast<std::size_t>(XML_GetCurrentByteIndex(parser_.get())); }
  std::size_t after_tag() const {
    return position() + static_cast<std::size_t>(XML_GetCurrentByteCount(parser_.get()));
  }
  std::size_t line() const { return XML_GetCurrentLineNumber(parser_.get()); }
  [[noreturn]] void refuse(const std::string& fault) const {
    file_.refuse(fmt::format("line {}", line()), fault);
  }

  const MeshFile& file_;

 private:
  struct Free {
    void operator()(XML_Parser parser) const { XML_ParserFree(parser); }
  };

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

  const char* format_;
  std::unique_ptr<XML_ParserStruct, Free> parser_;
  std::exception_ptr failure_;
  bool is_stopped_ = false;
  const char** attributes_ = nullptr;
};

}  // namespace podm::verify
