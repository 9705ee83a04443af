// Makes segmentations as 3D Slicer writes them (.seg.nrrd) for tests.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "image/tests/image_files.h"

namespace podm {

struct SegmentInFile {
  std::string name;
  std::uint32_t value = 1;
  std::size_t layer = 0;
  std::string colour = "1 0.5 0";
};

template <class Voxel>
struct SegmentationFile {
  std::array<int, 3> size{5, 4, 3};
  std::vector<SegmentInFile> segments;
  std::vector<std::vector<Voxel>> layers;
  bool is_gzipped = false;
  std::size_t layer_axis = 0;  ///< 0 to 3
  std::string type = "unsigned char";
  std::string directions = "(1,0,0) (0,2,0) (0,0,3)";
  std::string more_fields = {};  ///< appended to the header

  std::size_t num_voxels() const {
    return static_cast<std::size_t>(size[0]) * static_cast<std::size_t>(size[1]) *
           static_cast<std::size_t>(size[2]);
  }

  /// Fills each layer with random values of its segments, and 0.
  void draw_voxels(std::size_t num_layers, unsigned seed) {
    std::mt19937 random(seed);
    layers.assign(num_layers, std::vector<Voxel>(num_voxels()));
    for (std::size_t layer = 0; layer < num_layers; ++layer) {
      std::vector<Voxel> values{0};
      for (const SegmentInFile& segment : segments)
        if (segment.layer == layer) values.push_back(static_cast<Voxel>(segment.value));
      for (Voxel& voxel : layers[layer]) voxel = values[random() % values.size()];
    }
  }

  bool covers(const SegmentInFile& segment, std::size_t voxel) const {
    return layers[segment.layer][voxel] == static_cast<Voxel>(segment.value);
  }

  std::string bytes() const {
    const std::string axes =
        std::to_string(size[0]) + " " + std::to_string(size[1]) + " " + std::to_string(size[2]);
    const auto with_layers = [&](const std::string& of_layers, const std::string& of_space) {
      std::istringstream words(of_space);
      std::string all, word;
      for (std::size_t axis = 0; axis <= 3; ++axis) {
        if (layers.size() > 1 && axis == layer_axis) all += of_layers + " ";
        if (words >> word) all += word + " ";
      }
      return all;
    };
    std::string fields =
        "type: " + type + "\ndimension: " + (layers.size() == 1 ? "3" : "4") +
        "\nspace: left-posterior-superior\nsizes: " + with_layers(std::to_string(layers.size()), axes) +
        "\nspace directions: " + with_layers("none", directions) +
        "\nkinds: " + with_layers("list", "domain domain domain") +
        "\nendian: little\nencoding: " + (is_gzipped ? "gzip" : "raw") + "\nspace origin: (10,20,30)\n";
    for (std::size_t i = 0; i < segments.size(); ++i) {
      const std::string prefix = "Segment" + std::to_string(i) + "_";
      fields += prefix + "Color:=" + segments[i].colour + "\n" + prefix + "Extent:=0 4 0 3 0 2\n" + prefix +
                "ID:=Segment_" + std::to_string(i) + "\n" + prefix +
                "LabelValue:=" + std::to_string(segments[i].value) + "\n" + prefix +
                "Layer:=" + std::to_string(segments[i].layer) + "\n" + prefix + "Name:=" + segments[i].name +
                "\n" + prefix + "Tags:=Segmentation.Status:inprogress|\n";
    }
    std::vector<Voxel> voxels;
    std::size_t step = 1;  // voxels that the file has of one layer before it has some of the next
    for (std::size_t axis = 0; axis < layer_axis; ++axis) step *= static_cast<std::size_t>(size[axis]);
    for (std::size_t first = 0; first < num_voxels(); first += step)
      for (const auto& layer : layers)
        for (std::size_t i = first; i < first + step; ++i) voxels.push_back(layer[i]);
    const std::string data = bytes_of_values(voxels);
    return nrrd_header(fields + "Segmentation_MasterRepresentation:=Binary labelmap\n" + more_fields) +
           (is_gzipped ? deflated(data) : data);
  }
};

}  // namespace podm
