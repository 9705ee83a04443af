#include "image/voxel_file.h"

#include <optional>

#include "image/image_by_bricks.h"
#include "image/index_voxels.h"
#include "podm/errors.h"

namespace podm {

namespace {

bool has_ending(const std::string& path, std::initializer_list<const char*> endings) {
  for (const char* ending : endings)
    if (path.ends_with(ending)) return true;
  return false;
}

std::optional<ImageHead> read_head(const std::string& path) {
  if (has_ending(path, {".nii", ".nii.gz"})) return read_nifti_head(path);
  if (has_ending(path, {".nrrd", ".nhdr", ".mha", ".mhd"})) return read_head_with_itk(path);
  return std::nullopt;
}

bool has_integers(VoxelType type) { return type != VoxelType::kFloat && type != VoxelType::kDouble; }

bool can_be_read_in_parts(const ImageHead& head) {
  const RawImage& image = head.image;
  const bool can_be_inflated = has_ending(image.path, {".nii", ".nii.gz"});
  return (can_be_inflated || !head.voxels.is_compressed) && has_integers(image.type) &&
         image.num_layers == 1 && image.segments.empty() && image.size.size() == 3 && image.slope == 1 &&
         image.intercept == 0;
}

LabelImage grid_of(const RawImage& head) {
  LabelImage grid;
  grid.voxel_to_ras = head.voxel_to_ras;
  grid.spacing = checked_spacing(head.path, grid.voxel_to_ras);
  check_distance(head.path, head.size, grid.voxel_to_ras);
  grid.size = {head.size[0], head.size[1], head.size[2]};
  grid.warnings = head.warnings;
  return grid;
}

}  // namespace

std::shared_ptr<const VoxelFile> VoxelFile::open(const std::string& path) {
  std::optional<ImageHead> head = read_head(path);
  if (!head || !can_be_read_in_parts(*head)) return nullptr;
  for (const int length : head->image.size)
    if (length < 1) return nullptr;
  return std::shared_ptr<const VoxelFile>(new VoxelFile(std::move(*head)));
}

VoxelFile::VoxelFile(ImageHead head) : head_(std::move(head)), grid_(grid_of(head_.image)) {
  const auto [x, y, z] = BrickGrid(grid_.size).size();
  if (1.0 * x * y * z > kMaxBricks)
    refuse(path(), "the image is too large (" + std::to_string(x) + " x " + std::to_string(y) + " x " +
                       std::to_string(z) + " bricks of 4 x 4 x 4 voxels, at most " +
                       std::to_string(kMaxBricks) + " in all are supported)");
  if (is_compressed()) return;
  file_.emplace(head_.voxels.path);
  expect_voxel_bytes(path(), head_.voxels, grid_.num_voxels() * bytes_of(type()));
}

LabelImage VoxelFile::read(const Voxel& low, const Voxel& high, std::size_t threads) const {
  return labelled(low, high, read_bytes(low, high), threads);
}

LabelImage VoxelFile::labelled(const Voxel& low, const Voxel& high, std::vector<unsigned char> bytes,
                               std::size_t threads) const {
  RawImage raw;
  raw.type = type();
  raw.size = {high.i - low.i, high.j - low.j, high.k - low.k};
  raw.bytes = std::move(bytes);
  if (head_.voxels.is_big_endian && bytes_of(raw.type) > 1) swap_bytes(raw.bytes, bytes_of(raw.type));
  LabelImage part = grid_;
  part.warnings.clear();
  part.size = {raw.size[0], raw.size[1], raw.size[2]};
  index_voxels(array_of(raw), path(), threads, part, low);
  return part;
}

// Rows that follow each other in the file are read at once.
std::vector<unsigned char> VoxelFile::read_bytes(const Voxel& low, const Voxel& high) const {
  const auto voxel = bytes_of(type());
  const bool has_rows = low.i == 0 && high.i == grid_.size[0],
             has_slices = has_rows && low.j == 0 && high.j == grid_.size[1];
  const std::size_t length = unsigned_of(high.i - low.i) * voxel *
                             (has_rows ? unsigned_of(high.j - low.j) : 1) *
                             (has_slices ? unsigned_of(high.k - low.k) : 1);
  std::vector<unsigned char> bytes(unsigned_of(high.i - low.i) * unsigned_of(high.j - low.j) *
                                   unsigned_of(high.k - low.k) * voxel);
  std::size_t at = 0;
  for (int k = low.k; k < (has_slices ? low.k + 1 : high.k); ++k)
    for (int j = low.j; j < (has_rows ? low.j + 1 : high.j); ++j, at += length)
      file_->read(bytes.data() + at, length, head_.voxels.offset + voxel * grid_.index(low.i, j, k));
  file_->expect_unchanged();
  return bytes;
}

VoxelStream::VoxelStream(const VoxelFile& file)
    : file_(file),
      stream_(file.head_.voxels.path),
      slice_bytes_(file.grid_.index(0, 0, 1) * bytes_of(file.type())) {
  stream_.skip(file.head_.voxels.offset);
}

LabelImage VoxelStream::read(int low, int high, std::size_t threads) {
  bytes_.erase(bytes_.begin(),
               bytes_.begin() + static_cast<std::ptrdiff_t>(unsigned_of(low - first_) * slice_bytes_));
  first_ = low;
  const std::size_t known = bytes_.size(), needed = unsigned_of(high - low) * slice_bytes_;
  bytes_.resize(std::max(known, needed));
  stream_.read(bytes_.data() + known, bytes_.size() - known);
  const auto [x, y, z] = file_.grid_.size;
  if (high == z && needed > known) stream_.expect_end();
  return file_.labelled({0, 0, low}, {x, y, high},
                        {bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(needed)}, threads);
}

}  // namespace podm
