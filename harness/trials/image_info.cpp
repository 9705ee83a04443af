#include "trials/image_info.h"

#include "rows/codec.h"

namespace podm::bench {
namespace {

constexpr double kTimeoutS = 120;  // unpacking an image of hundreds of MiB takes long

// The part of `podm info --json` that is read.
struct InfoRecord {
  ImageSize size;
  static constexpr auto fields() { return PODM_FIELDS(InfoRecord, size); }
};

std::optional<ImageSize> size_in(const std::string& info) {
  try {
    return from_json<InfoRecord>(Json::parse(info, nullptr, false)).size;
  } catch (const FieldError&) {
    return {};
  }
}

}  // namespace

ImageInfo ask_for_info(const std::string& podm, const std::string& image, const StopQuery& stop_requested) {
  ImageInfo info;
  info.command = {podm, "info", image, "--json"};
  info.reply = ask(info.command, kTimeoutS, stop_requested);
  if (info.reply.succeeded()) info.size = size_in(info.reply.text);
  return info;
}

}  // namespace podm::bench
