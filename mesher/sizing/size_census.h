// Samples the local sizes in the object, to predict the cost of a mesh.
#pragma once

#include <optional>
#include <vector>

#include "podm/label_image.h"
#include "podm/meshing_options.h"
#include "sizing/size_grid.h"

namespace podm {

class SizeCensus {
 public:
  /// `grid` is the result of make_size_grid() for these sizes.
  SizeCensus(const LabelImage& image, const SizeOptions& sizes, const SizeGrid& grid);

  /// The largest bound of any place, mm; infinity if a place has none.
  double largest_mm() const { return largest_mm_; }
  /// The largest bound of the size image alone, mm, before its factor, over the places that have one; 0 if no
  /// place has one.
  double largest_of_image_mm() const { return largest_of_image_mm_; }

  /// The places of one label that have about the same sizes.
  struct Places {
    LabelIndex label;
    double of_image_mm, fixed_mm;  ///< bounds with and without the image's factor; infinity if none
    double volume, surface;        ///< shares of the label, and of all interfaces
    double border;                 ///< share of the interfaces with the background

    double radius_mm(double factor) const;
  };
  const std::vector<Places>& places() const { return places_; }

 private:
  double largest_mm_ = 0, largest_of_image_mm_ = 0;
  std::vector<Places> places_;
};

/// Returns nothing if there is no grid.
std::optional<SizeCensus> census_of(const LabelImage& image, const SizeOptions& sizes, const SizeGrid* grid);

}  // namespace podm
