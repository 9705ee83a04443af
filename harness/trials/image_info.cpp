#include "trials/image_info.h"

#include <nlohmann/json.hpp>

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kTimeoutS = 120;  // an image of hundreds of MiB is unpacked

std::optional<ImageSize> size_in(const std::string& info) {
  const Json image = Json::parse(info, nullptr, false);
  const Json size = image.is_object() ? image.value("size", Json()) : Json();
  if (!size.is_array() || size.size() != ImageSize{}.size()) return {};
  ImageSize voxels{};
  for (std::size_t axis = 0; axis < voxels.size(); ++axis) {
    if (!size[axis].is_number_unsigned()) return {};
    voxels[axis] = size[axis];
  }
  return voxels;
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
