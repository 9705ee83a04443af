#include "experiments/image_folder.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>

#include "errors.h"

namespace podm::bench {
namespace {

namespace fs = std::filesystem;

// The formats that `podm mesh` lists. A file of another ending would only be refused by it.
constexpr std::array kEndings{".nii", ".nii.gz", ".nrrd", ".nhdr", ".mha", ".mhd", ".inr", ".inr.gz"};

bool is_label_image(const fs::directory_entry& entry) {
  const std::string name = entry.path().filename().string();
  return entry.is_regular_file() &&
         std::ranges::any_of(kEndings, [&](const char* ending) { return name.ends_with(ending); });
}

std::vector<std::string> images_of(const std::string& folder) {
  std::error_code error;
  std::vector<std::string> images;
  for (const auto& entry : fs::directory_iterator(folder, error))
    if (is_label_image(entry)) images.push_back(entry.path().string());
  if (error) throw InputError(fmt::format("--image {}: {}", folder, error.message()));
  if (images.empty())
    throw InputError(
        fmt::format("--image {}: no label image in this folder ({})", folder, fmt::join(kEndings, " ")));
  std::ranges::sort(images);
  return images;
}

}  // namespace

std::vector<std::string> with_images_of_folders(const std::vector<std::string>& images) {
  std::vector<std::string> all;
  for (const std::string& image : images)
    if (fs::is_directory(image))
      std::ranges::copy(images_of(image), std::back_inserter(all));
    else
      all.push_back(image);
  return all;
}

}  // namespace podm::bench
