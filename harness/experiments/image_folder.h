// A folder of label images in place of the images themselves.
#pragma once

#include <string>
#include <vector>

namespace podm::bench {

/// Replaces each folder among `images` by the label images in it, in the order of their names. A file is a
/// label image if its name ends like that of a format that podm reads; other files and folders below are left
/// out. Throws InputError for a folder without label images.
std::vector<std::string> with_images_of_folders(const std::vector<std::string>& images);

}  // namespace podm::bench
