#include "trials/image_info.h"

#include "rows/codec.h"

namespace podm::bench {
namespace {

constexpr double kTimeoutS = 120;  // unpacking an image of hundreds of MiB takes long

// The part of `podm info --json` that is read.
struct InfoRecord {
  ImageSize size;
  std::optional<double> voxel_volume_mm3;
  static constexpr auto fields() { return PODM_FIELDS(InfoRecord, size, (voxel_volume_mm3)); }
};

void read_info(const std::string& text, ImageInfo& info) {
  try {
    const auto record = from_json<InfoRecord>(Json::parse(text, nullptr, false));
    info.size = record.size;
    info.voxel_volume_mm3 = record.voxel_volume_mm3;
  } catch (const FieldError&) {
    // Both stay unset.
  }
}

}  // namespace

ImageInfo ask_for_info(const std::string& podm, const std::string& image, const StopQuery& stop_requested) {
  ImageInfo info;
  info.command = {podm, "info", image, "--json"};
  info.reply = ask(info.command, kTimeoutS, stop_requested);
  if (info.reply.succeeded()) read_info(info.reply.text, info);
  return info;
}

}  // namespace podm::bench
