// Which sizes places in the object have, by samples, to predict what a mesh will cost.
#pragma once

#include <optional>
#include <vector>

#include "podm/label_image.h"
#include "podm/meshing_options.h"
#include "sizing/size_grid.h"

namespace podm {

class SizeCensus {
 public:
  /// `grid`: what make_size_grid() makes of these sizes.
  SizeCensus(const LabelImage& image, const SizeOptions& sizes, const SizeGrid& grid);

  /// The largest radius that a place has, mm; infinity if one has none.
  double largest_mm() const { return largest_mm_; }
  /// The same of the size image alone, before its factor, and of places that have one; 0: none has.
  double largest_of_image_mm() const { return largest_of_image_mm_; }

  /// Places of one label, of about the same sizes.
  struct Places {
    LabelIndex label;
    double of_image_mm, fixed_mm;  ///< what the image's factor applies to, and what not; infinity: nothing
    double volume, surface;        ///< shares of the label, and of all interfaces
    double border;                 ///< share of the interfaces with the background

    double radius_mm(double factor) const;
  };
  const std::vector<Places>& places() const { return places_; }

 private:
  double largest_mm_ = 0, largest_of_image_mm_ = 0;
  std::vector<Places> places_;
};

/// Nothing where there is no grid.
std::optional<SizeCensus> census_of(const LabelImage& image, const SizeOptions& sizes, const SizeGrid* grid);

}  // namespace podm
