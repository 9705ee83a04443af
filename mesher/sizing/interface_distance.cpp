// A face is a rectangle: the product of a point along its normal and of the lengths of two voxel sides. Its
// squared distance is therefore a sum of one term per axis. The least squared distance over all faces of a
// direction is found axis after axis, each time as the lower envelope of parabolas. (Felzenszwalb,
// Huttenlocher, "Distance transforms of sampled functions", 2012.) Seen from a voxel's center, the nearest
// point of a rectangle is at its middle or at an end along each axis. The parabolas are therefore placed at
// half voxels.
#include "sizing/interface_distance.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "isosurface/isosurface_block.h"
#include "runtime/parallel_for.h"

namespace podm {

namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

// The lower envelope of parabolas at half steps. Site s is at s/2 - 1/2 steps and has height `heights[s]`.
class Envelope {
 public:
  void make(const std::vector<double>& heights, double step) {
    parabolas_.clear();
    current_ = 0;
    for (std::size_t s = 0; s < heights.size(); ++s)
      if (heights[s] < kInfinity) add(step * (0.5 * static_cast<double>(s) - 0.5), heights[s]);
  }
  bool is_empty() const { return parabolas_.empty(); }
  // The envelope at `place`. Successive places must not decrease.
  double next_at(double place) {
    while (current_ + 1 < parabolas_.size() && parabolas_[current_ + 1].from <= place) ++current_;
    const Parabola& lowest = parabolas_[current_];
    return lowest.height + (place - lowest.at) * (place - lowest.at);
  }

 private:
  struct Parabola {
    double at, height, from;  // the parabola is lowest from `from` to the next parabola's
  };

  void add(double at, double height) {
    double from = -kInfinity;
    for (; !parabolas_.empty(); parabolas_.pop_back()) {
      const Parabola& last = parabolas_.back();
      from = (height + at * at - last.height - last.at * last.at) / (2 * (at - last.at));
      if (from > last.from) break;
      from = -kInfinity;
    }
    parabolas_.push_back({at, height, from});
  }

  std::vector<Parabola> parabolas_;
  std::size_t current_ = 0;
};

// The voxels of a part of the image's grid.
class Part {
 public:
  Part(const LabelImage& image, const std::vector<unsigned char>& side_of_label,
       const std::array<int, 3>& first, const std::array<int, 3>& size, double reach_mm)
      : image_(image),
        grid_(image, {}),
        side_of_label_(side_of_label),
        first_(first),
        size_(size),
        squared_reach_(static_cast<float>(reach_mm * reach_mm)) {}

  unsigned char side(const std::array<int, 3>& v) const {
    return side_of_label_[grid_.label({v[0], v[1], v[2]})];
  }
  // True if a face of the interface lies between the voxel and the one before it along the axis.
  bool has_face_before(std::array<int, 3> v, std::size_t axis) const {
    const unsigned char own = side(v);
    --v[axis];
    const unsigned char before = side(v);
    return own != 0 && before != 0 && own != before;
  }
  std::size_t num_voxels() const {
    return static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1]) *
           static_cast<std::size_t>(size_[2]);
  }

  // Squared distances to the faces that are normal to the axis, computed first along the normal, then along
  // the other axes. Infinity where no face is within reach.
  std::vector<float> squared_distances(std::size_t normal, std::size_t threads) const {
    std::vector<float> squared(num_voxels());
    for_each_line(normal, threads,
                  [&](const std::array<int, 3>& begin, std::size_t at, std::size_t step, Line& line) {
                    line.heights.assign(2 * static_cast<std::size_t>(size_[normal]) + 1, kInfinity);
                    std::array<int, 3> v = begin;
                    for (std::size_t s = 0; s < line.heights.size(); s += 2, ++v[normal])
                      if (has_face_before(v, normal)) line.heights[s] = 0;
                    put_envelope(line, normal, squared, at, step);
                  });
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (axis == normal) continue;
      for_each_line(axis, threads,
                    [&](const std::array<int, 3>&, std::size_t at, std::size_t step, Line& line) {
                      line.heights.assign(2 * static_cast<std::size_t>(size_[axis]) + 1, kInfinity);
                      for (std::size_t s = 1, i = at; s < line.heights.size(); s += 2, i += step) {
                        const double height = squared[i];
                        line.heights[s] = line.heights[s + 1] = height;
                        line.heights[s - 1] = std::min(line.heights[s - 1], height);
                      }
                      put_envelope(line, axis, squared, at, step);
                    });
    }
    return squared;
  }

 private:
  struct Line {  // one per thread
    std::vector<double> heights;
    Envelope envelope;
  };

  void put_envelope(Line& line, std::size_t axis, std::vector<float>& squared, std::size_t at,
                    std::size_t step) const {
    constexpr float kBeyond = std::numeric_limits<float>::infinity();
    line.envelope.make(line.heights, image_.spacing[axis]);
    for (int i = 0; i < size_[axis]; ++i, at += step) {
      const auto found = line.envelope.is_empty()
                             ? kBeyond
                             : static_cast<float>(line.envelope.next_at(i * image_.spacing[axis]));
      squared[at] = found <= squared_reach_ ? found : kBeyond;
    }
  }

  // Calls use(first voxel, its place, step to the next voxel, line) for every line along the axis.
  template <class Use>
  void for_each_line(std::size_t axis, std::size_t threads, const Use& use) const {
    const std::array<std::size_t, 3> steps{
        1, static_cast<std::size_t>(size_[0]),
        static_cast<std::size_t>(size_[0]) * static_cast<std::size_t>(size_[1])};
    const std::size_t inner = axis == 0 ? 1 : 0, outer = axis == 2 ? 1 : 2;
    std::vector<Line> lines(threads);
    parallel_for(static_cast<std::size_t>(size_[outer]), threads, [&](std::size_t o, std::size_t thread) {
      for (int i = 0; i < size_[inner]; ++i) {
        std::array<int, 3> voxel = first_;
        voxel[inner] += i;
        voxel[outer] += static_cast<int>(o);
        use(voxel, static_cast<std::size_t>(i) * steps[inner] + o * steps[outer], steps[axis], lines[thread]);
      }
    });
  }

  const LabelImage& image_;
  const LabelGrid<NoReads> grid_;
  const std::vector<unsigned char>& side_of_label_;
  const std::array<int, 3> first_, size_;
  const float squared_reach_;
};

struct VoxelBounds {
  std::array<int, 3> low{std::numeric_limits<int>::max(), std::numeric_limits<int>::max(),
                         std::numeric_limits<int>::max()};
  std::array<int, 3> high{-2, -2, -2};

  void add(const std::array<int, 3>& v) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      low[axis] = std::min(low[axis], v[axis]);
      high[axis] = std::max(high[axis], v[axis]);
    }
  }
};

// The bounds of the voxels that follow a face along an axis.
VoxelBounds bounds_of_faces(const LabelImage& image, const std::vector<unsigned char>& side_of_label,
                            std::size_t threads) {
  const Part all(image, side_of_label, {0, 0, 0}, image.size, 0);
  std::vector<VoxelBounds> of_thread(threads);
  parallel_for(static_cast<std::size_t>(image.size[2]) + 1, threads,
               [&](std::size_t slice, std::size_t thread) {
                 const int k = static_cast<int>(slice);
                 for (int j = 0; j <= image.size[1]; ++j)
                   for (int i = 0; i <= image.size[0]; ++i)
                     for (std::size_t axis = 0; axis < 3; ++axis)
                       if (all.has_face_before({i, j, k}, axis)) of_thread[thread].add({i, j, k});
               });
  VoxelBounds bounds;
  for (const VoxelBounds& part : of_thread) {
    if (part.high[0] < 0) continue;
    bounds.add(part.low);
    bounds.add(part.high);
  }
  return bounds;
}

}  // namespace

std::optional<InterfaceDistances> interface_distances(const LabelImage& image,
                                                      const std::vector<unsigned char>& side_of_label,
                                                      double reach_mm, int threads) {
  const std::size_t used = num_threads(threads);
  const VoxelBounds faces = bounds_of_faces(image, side_of_label, used);
  if (faces.high[0] < 0) return std::nullopt;
  InterfaceDistances result;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const double voxels =
        std::min(std::ceil(reach_mm / image.spacing[axis]), static_cast<double>(image.size[axis]));
    const int reach = static_cast<int>(voxels) + 1;
    result.first[axis] = std::max(faces.low[axis] - 1 - reach, -1);
    result.size[axis] = std::min(faces.high[axis] + reach, image.size[axis]) + 1 - result.first[axis];
  }
  const Part part(image, side_of_label, result.first, result.size, reach_mm);
  result.distance_mm = part.squared_distances(0, used);
  for (const std::size_t normal : {1, 2}) {
    const std::vector<float> other = part.squared_distances(normal, used);
    for (std::size_t i = 0; i < other.size(); ++i)
      result.distance_mm[i] = std::min(result.distance_mm[i], other[i]);
  }
  for (float& distance : result.distance_mm) distance = std::sqrt(distance);
  return result;
}

}  // namespace podm
