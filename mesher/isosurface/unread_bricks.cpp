#include "isosurface/unread_bricks.h"

#include <algorithm>
#include <new>
#include <vector>

#include "podm/errors.h"
#include "runtime/mix.h"

namespace podm {

namespace {

constexpr int kPage = 16, kMargin = Surroundings::kMostBricks + 1;  // bricks
constexpr std::size_t kLinesOfLabels = 2;

// The labels of a brick lie before its words, if it has surface voxels.
std::size_t lines_with_labels(std::uint64_t mask) {
  return LayoutOfBrick::lines_of(mask) + (mask != 0 ? kLinesOfLabels : 0);
}

}  // namespace

// Bricks from `low` to `high`, which is excluded.
struct UnreadBricks::Range {
  std::array<int, 3> low, high;

  template <class Visit>
  void for_each(const Visit& visit) const {
    for (int k = low[2]; k < high[2]; ++k)
      for (int j = low[1]; j < high[1]; ++j)
        for (int i = low[0]; i < high[0]; ++i) visit(Voxel{i, j, k});
  }
};

// The voxels of a page and of the bricks around it, with their surface voxels.
class UnreadBricks::Page {
 public:
  Page(const UnreadBricks& of, const Range& page)
      : read_(with_margin(page, of.bricks_)),
        part_(of.image_.read(voxel_at(read_.low), end_within(read_.high, of.image_.size))),
        bricks_(part_.size),
        masks_(bricks_.count()),
        writer_(part_, bricks_, masks_, of.surroundings_) {
    mark_surface(part_, bricks_, 1, masks_);
    forget_rim(of.bricks_);
    expect_unchanged(of.image_, of.bricks_);
  }

  std::uint64_t mask(const Voxel& brick) const { return masks_[index(brick)]; }
  // Writes labels and words from `line` on. Returns the line of the words.
  std::size_t write(const Voxel& brick, std::size_t line, HugeArray<std::uint64_t>& words) const {
    if (mask(brick) != 0) {
      write_labels(brick, &words[line * LayoutOfBrick::kWordsOfLine]);
      line += kLinesOfLabels;
    }
    writer_.write_words(here(brick), mask(brick), &words[line * LayoutOfBrick::kWordsOfLine]);
    return line;
  }

 private:
  static Range with_margin(const Range& page, const BrickGrid& bricks) {
    Range wider = page;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      wider.low[axis] = std::max(0, page.low[axis] - kMargin);
      wider.high[axis] = std::min(bricks.size()[axis], page.high[axis] + kMargin);
    }
    return wider;
  }
  static Voxel voxel_at(const std::array<int, 3>& brick) {
    return {4 * brick[0], 4 * brick[1], 4 * brick[2]};
  }
  static Voxel end_within(const std::array<int, 3>& brick, const std::array<int, 3>& size) {
    const auto end = [&](std::size_t axis) {
      return static_cast<int>(std::min<std::int64_t>(4 * std::int64_t{brick[axis]}, size[axis]));
    };
    return {end(0), end(1), end(2)};
  }

  Voxel here(const Voxel& brick) const {
    return {brick.i - read_.low[0], brick.j - read_.low[1], brick.k - read_.low[2]};
  }
  std::size_t index(const Voxel& brick) const {
    const Voxel at = here(brick);
    return bricks_.index(at.i, at.j, at.k);
  }

  // The outermost bricks lack neighbors that were not read, except where the image ends.
  bool is_rim(const Voxel& brick, const BrickGrid& all) const {
    const auto is_outermost = [&](std::size_t axis, int at) {
      return (at == read_.low[axis] && at > 0) ||
             (at == read_.high[axis] - 1 && read_.high[axis] < all.size()[axis]);
    };
    return is_outermost(0, brick.i) || is_outermost(1, brick.j) || is_outermost(2, brick.k);
  }
  void forget_rim(const BrickGrid& all) {
    read_.for_each([&](const Voxel& brick) {
      if (is_rim(brick, all)) masks_[index(brick)] = 0;
    });
  }
  // The table and the words of other pages rest on the labels of bricks that were found first.
  void expect_unchanged(const ImageByBricks& image, const BrickGrid& all) const {
    read_.for_each([&](const Voxel& brick) {
      if (is_rim(brick, all)) return;
      const Voxel at = here(brick);
      const LabelIndex label =
          mask(brick) != 0 ? ImageByBricks::kMixed : part_.voxels[part_.index(4 * at.i, 4 * at.j, 4 * at.k)];
      if (label != image.label_of_brick[all.index(brick.i, brick.j, brick.k)])
        throw InputError(image.path + ": its voxels changed during the run");
    });
  }

  void write_labels(const Voxel& brick, std::uint64_t* to) const {
    std::array<LabelIndex, 64> labels{};
    const Voxel first{4 * here(brick).i, 4 * here(brick).j, 4 * here(brick).k};
    for (int k = first.k; k < std::min(first.k + 4, part_.size[2]); ++k)
      for (int j = first.j; j < std::min(first.j + 4, part_.size[1]); ++j)
        for (int i = first.i; i < std::min(first.i + 4, part_.size[0]); ++i)
          labels[place_in_brick({i, j, k})] = part_.voxels[part_.index(i, j, k)];
    std::memcpy(to, labels.data(), sizeof labels);
  }

  const Range read_;
  const LabelImage part_;
  const BrickGrid bricks_;
  SurfaceMasks masks_;
  const FeatureWriter writer_;
};

UnreadBricks::UnreadBricks(const ImageByBricks& image, const BrickGrid& bricks, std::size_t first_line,
                           HugeArray<std::uint64_t>& words)
    : image_(image),
      bricks_(bricks),
      surroundings_(image),
      words_(words),
      first_line_(first_line),
      next_line_(first_line) {}

std::uint64_t UnreadBricks::bytes_read() const {
  return (next_line_ - first_line_) * LayoutOfBrick::kWordsOfLine * sizeof(std::uint64_t);
}

UnreadBricks::Range UnreadBricks::page_of(std::size_t index) const {
  const auto nx = static_cast<std::size_t>(bricks_.size()[0]),
             ny = static_cast<std::size_t>(bricks_.size()[1]);
  const std::array<int, 3> brick{static_cast<int>(index % nx), static_cast<int>(index / nx % ny),
                                 static_cast<int>(index / nx / ny)};
  Range page{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    page.low[axis] = brick[axis] / kPage * kPage;
    page.high[axis] = std::min(page.low[axis] + kPage, bricks_.size()[axis]);
  }
  return page;
}

Brick UnreadBricks::read(std::size_t index) {
  const Range page = page_of(index);
  const std::uint64_t number = mix(bricks_.index(page.low[0], page.low[1], page.low[2]));
  const std::scoped_lock lock(mutexes_[number % mutexes_.size()]);
  if (Brick(words_[index]).is_unread()) read_page(page);
  return Brick(words_[index]);
}

void UnreadBricks::read_page(const Range& range) {
  const Page page(*this, range);
  std::size_t lines = 0;
  const auto for_each_unread = [&](const auto& visit) {
    range.for_each([&](const Voxel& brick) {
      const std::size_t index = bricks_.index(brick.i, brick.j, brick.k);
      if (const Brick unread(words_[index]); unread.is_unread()) visit(brick, index, unread.label());
    });
  };
  for_each_unread(
      [&](const Voxel& brick, std::size_t, LabelIndex) { lines += lines_with_labels(page.mask(brick)); });
  std::size_t line = next_line_.fetch_add(lines);
  if ((line + lines) * LayoutOfBrick::kWordsOfLine > words_.capacity()) throw std::bad_alloc();
  for_each_unread([&](const Voxel& brick, std::size_t index, LabelIndex label) {
    const auto of_words = static_cast<std::uint32_t>(page.write(brick, line, words_));
    __atomic_store_n(&words_[index], Brick::near(of_words, label).word(), __ATOMIC_RELEASE);
    line += lines_with_labels(page.mask(brick));
  });
}

}  // namespace podm
