// Small images that are common in practice, and some extreme ones.
#pragma once

#include <cmath>
#include <functional>
#include <ostream>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/affine.h"
#include "podm/label_image.h"

namespace podm::test {

/// Returns an axis-aligned image whose voxel (i,j,k) gets label index `label(i,j,k)`. Label values are 10
/// times the index.
inline LabelImage make_image(std::array<int, 3> size, std::array<double, 3> spacing, int num_labels,
                             const std::function<int(int, int, int)>& label) {
  LabelImage image;
  image.size = size;
  image.spacing = spacing;
  image.voxel_to_ras = {spacing[0], 0, 0, -7, 0, spacing[1], 0, 11, 0, 0, spacing[2], 3};
  for (int i = 0; i <= num_labels; ++i) image.labels.push_back({static_cast<std::uint32_t>(10 * i), ""});
  for (int k = 0; k < size[2]; ++k) {
    for (int j = 0; j < size[1]; ++j) {
      for (int i = 0; i < size[0]; ++i) image.voxels.push_back(static_cast<LabelIndex>(label(i, j, k)));
    }
  }
  return image;
}

inline LabelImage ball(int n, double radius) {
  const double c = (n - 1) / 2.0;
  return make_image({n, n, n}, {1, 1, 1}, 1,
                    [=](int i, int j, int k) { return std::hypot(i - c, j - c, k - c) < radius ? 1 : 0; });
}

struct NamedImage {
  const char* name;
  std::function<LabelImage()> make;
  friend std::ostream& operator<<(std::ostream& out, const NamedImage& x) { return out << x.name; }
};

inline std::vector<NamedImage> images() {
  return {
      {"ball", [] { return ball(24, 9); }},
      {"anisotropic_ball",
       [] {
         return make_image({30, 30, 12}, {0.7, 0.7, 2.1}, 1, [](int i, int j, int k) {
           return std::hypot(0.7 * (i - 14.5), 0.7 * (j - 14.5), 2.1 * (k - 5.5)) < 8 ? 1 : 0;
         });
       }},
      {"three_labels_meeting",
       [] {
         return make_image({24, 24, 24}, {1, 1, 1}, 3, [](int i, int j, int k) {
           if (std::hypot(i - 11.5, j - 11.5, k - 11.5) >= 10) return 0;
           return k < 9 ? 1 : i < 12 ? 2 : 3;
         });
       }},
      {"fills_the_image",
       [] {
         return make_image({9, 8, 7}, {1, 1.5, 2}, 2, [](int i, int, int) { return i < 4 ? 1 : 2; });
       }},
      {"single_voxel",
       [] {
         return make_image({5, 5, 5}, {1, 1, 1}, 1,
                           [](int i, int j, int k) { return i == 2 && j == 2 && k == 2; });
       }},
      {"single_slice",
       [] {
         return make_image({12, 12, 1}, {1, 1, 3}, 1, [](int i, int, int) { return i > 3; });
       }},
      {"thin_sheet",
       [] {
         return make_image({20, 20, 9}, {1, 1, 1}, 1, [](int, int, int k) { return k == 4; });
       }},
      {"checkerboard",
       [] {
         return make_image({6, 6, 6}, {1, 1, 1}, 2, [](int i, int j, int k) { return 1 + (i + j + k) % 2; });
       }},
      {"noise",
       [] {
         std::mt19937 random(11);
         return make_image({10, 10, 10}, {1, 1, 1}, 4,
                           [&](int, int, int) { return static_cast<int>(random() % 5); });
       }},
  };
}

inline LabelImage image_named(const std::string& name) {
  for (const NamedImage& image : images())
    if (name == image.name) return image.make();
  throw std::runtime_error("no image " + name);
}

struct NamedAffine {
  const char* name;
  Affine affine;  // voxels of 1 mm
  friend std::ostream& operator<<(std::ostream& out, const NamedAffine& x) { return out << x.name; }
};

inline std::vector<NamedAffine> affines() {
  const double c = std::cos(0.3), s = std::sin(0.3), d = std::cos(1.1), t = std::sin(1.1);
  return {{"turned_and_mirrored", {0, -1, 0, 5, -1, 0, 0, 6, 0, 0, -1, 7}},
          {"oblique", {c, -s * d, s * t, -95.8, s, c * d, -c * t, 97.4, 0, t, d, -79.9}},
          {"oblique_and_mirrored", {-c, -s * d, s * t, 31, -s, c * d, -c * t, 0.1, 0, t, d, 2}},
          {"sheared", {1, s, 0, -7, 0, c, 0, 11, 0, 0, 1, 3}},
          {"sheared_and_mirrored", {1, s, 0, -7, 0, c, 0, 11, 0, 0, -1, 3}}};
}

}  // namespace podm::test
