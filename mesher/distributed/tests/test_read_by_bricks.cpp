// Ranks that read an image by bricks know the same of it, and make the same mesh, as ranks that hold it.
#include "distributed/read_by_bricks.h"

#include <gtest/gtest.h>

#include <atomic>
#include <filesystem>
#include <new>

#include "algorithms/memory_model.h"
#include "distributed/image_digest.h"
#include "distributed/in_process_ranks.h"
#include "distributed/mesh_image_on_ranks.h"
#include "distributed/rank_failure.h"
#include "image/foreground.h"
#include "image/image_by_bricks.h"
#include "image/interface_sides.h"
#include "image/rows_of_image.h"
#include "tests/fault_of.h"
#include "tests/images.h"
#include "tests/scratch_folder.h"

namespace podm::test {
namespace {

// Two balls far apart, one of two labels.
LabelImage scene() {
  return make_image({90, 41, 38}, {1, 1, 1.2}, 3, [](int i, int j, int k) {
    if (std::hypot(i - 20, j - 20, 1.2 * (k - 17)) < 13) return i < 22 ? 1 : 2;
    return std::hypot(i - 70, j - 19, 1.2 * (k - 20)) < 11 ? 3 : 0;
  });
}

std::uint64_t sides_along(const LabelImage& image, std::size_t axis) {
  return sum_over_rows(image, 1, std::uint64_t{0},
                       [&](std::uint64_t& sum, int j, int k) { sum += count_sides(image, axis, 1, j, k); });
}

MeshingOptions options_of_meshes() {
  MeshingOptions options;
  options.sizes.radius_mm = 3.5;
  options.team.threads = 2;
  return options;
}

class ReadByBricks : public testing::TestWithParam<std::tuple<int, const char*>> {
 protected:
  ReadByBricks() { write_nifti(scene(), path_); }

  // Calls use(image, ranks) on each rank.
  template <class Use>
  void read(const LabelSelection& selection, const Use& use) const {
    SharedValue<LabelImage> shared;
    run_ranks({.num_ranks = num_ranks_, .one_at_a_time = true}, [&](Communication& ranks) {
      const std::shared_ptr<const VoxelFile> file = VoxelFile::open(path_);
      ASSERT_NE(file, nullptr);
      use(*read_by_bricks(file, selection, 1 + ranks.rank() % 2, ~std::uint64_t{0}, shared, ranks), ranks);
    });
  }

  const ScratchFolder folder_;
  const int num_ranks_ = std::get<0>(GetParam());
  const std::string path_ = folder_ / (std::string("scene.") + std::get<1>(GetParam()));
};

TEST_P(ReadByBricks, FindsWhatTheWholeImageHas) {
  LabelSelection merged, kept;
  merged.merges.push_back({{10, 20}, "pair"});
  kept.keep.emplace_back(20, 30);
  for (const LabelSelection& selection : {LabelSelection{}, merged, kept}) {
    const LabelImage whole = read_image(path_, selection, 1);
    read(selection, [&](const LabelImage& image, Communication&) {
      ASSERT_NE(by_bricks(image), nullptr);
      EXPECT_EQ(image.size, whole.size);
      EXPECT_EQ(image.voxel_to_ras, whole.voxel_to_ras);
      ASSERT_EQ(image.labels.size(), whole.labels.size());
      for (std::size_t i = 0; i < image.labels.size(); ++i) {
        EXPECT_EQ(image.labels[i].value, whole.labels[i].value);
        EXPECT_EQ(image.labels[i].name, whole.labels[i].name);
      }
      EXPECT_EQ(count_voxels(image, 1), count_voxels(whole, 1));
      EXPECT_EQ(foreground_bounds(image).low, foreground_bounds(whole).low);
      EXPECT_EQ(foreground_bounds(image).high, foreground_bounds(whole).high);
      EXPECT_EQ(digest_of(image, 1), digest_of(whole, 2));
      for (std::size_t axis = 0; axis < 3; ++axis)
        EXPECT_EQ(by_bricks(image)->sides[axis], sides_along(whole, axis));
    });
  }
}

TEST_P(ReadByBricks, MakesTheMeshOfTheWholeImage) {
  MeshingOptions options = options_of_meshes();
  options.team.threads = 1;
  const LabelImage whole = read_image(path_, {}, 1);
  std::vector<std::uint64_t> hashes;
  const auto mesh = [&](const LabelImage& image, Communication& ranks) {
    const MeshingOnRanks made = mesh_image_on_ranks(image, options, ranks);
    if (ranks.rank() > 0) return;
    hashes.push_back(made.mesh_hash);
    EXPECT_TRUE(made.report.guarantees.all_met());
    EXPECT_EQ(made.parts[0].image_bytes_read > 0, by_bricks(image) != nullptr);
  };
  run_ranks({.num_ranks = num_ranks_, .one_at_a_time = true},
            [&](Communication& ranks) { mesh(whole, ranks); });
  read({}, mesh);
  ASSERT_EQ(hashes.size(), 2u);
  EXPECT_EQ(hashes[0], hashes[1]);
}

// Loops of threads ask for the first pages.
TEST_P(ReadByBricks, EndsInAnErrorIfAPageCannotBeRead) {
  const auto mesh_with = [&](int good_reads, const auto& fail) {
    std::atomic<int> num_reads = 0;
    read({}, [&](const LabelImage& image, Communication& ranks) {
      ImageByBricks failing = *by_bricks(image);
      failing.read = [&](const Voxel& low, const Voxel& high) {
        if (num_reads++ >= good_reads) fail();
        return by_bricks(image)->read(low, high);
      };
      mesh_image_on_ranks(failing, options_of_meshes(), ranks);
    });
  };
  for (const int good_reads : {0, 1}) {
    const std::string fault =
        fault_of<InputError>([&] { mesh_with(good_reads, [] { throw InputError("scene.nii: gone"); }); });
    EXPECT_TRUE(fault.starts_with("rank ")) << fault;
    EXPECT_TRUE(fault.ends_with(": scene.nii: gone")) << fault;
    if (num_ranks_ == 1) continue;  // a single rank that refines without memory ends as at a limit
    EXPECT_THROW(mesh_with(good_reads, [] { throw std::bad_alloc(); }), OutOfMemory);
  }
}

// The voxels of a compressed file are in memory.
TEST_P(ReadByBricks, RefusesAFileThatChangesDuringTheRun) {
  if (path_.ends_with(".gz")) return;
  LabelImage other = scene();
  std::reverse(other.voxels.begin(), other.voxels.end());
  for (const bool is_time_kept : {false, true}) {
    write_nifti(scene(), path_);
    const auto time = std::filesystem::last_write_time(path_);
    const std::string fault = fault_of<InputError>([&] {
      read({}, [&](const LabelImage& image, Communication& ranks) {
        if (ranks.rank() == 0) {
          write_nifti(other, folder_ / "other.nii");
          std::filesystem::copy_file(folder_ / "other.nii", path_,
                                     std::filesystem::copy_options::overwrite_existing);
          std::filesystem::last_write_time(path_, is_time_kept ? time : time + std::chrono::seconds(1));
        }
        mesh_image_on_ranks(image, options_of_meshes(), ranks);
      });
    });
    EXPECT_NE(fault.find(path_ + (is_time_kept ? ": its voxels" : ": the file") + " changed during the run"),
              std::string::npos)
        << fault;
  }
}

TEST_P(ReadByBricks, RefusesAnImageForWhichThereIsNoRoom) {
  SharedValue<LabelImage> shared;
  const auto read_with = [&](std::uint64_t most_bytes) {
    run_ranks({.num_ranks = num_ranks_}, [&](Communication& ranks) {
      read_by_bricks(VoxelFile::open(path_), {}, 1, most_bytes, shared, ranks);
    });
  };
  EXPECT_NE(fault_of<InputError>([&] { read_with(1000); }).find("its voxels take"), std::string::npos);
}

TEST_P(ReadByBricks, RefusesWhatNoRankCanRead) {
  LabelSelection absent;
  absent.keep.emplace_back(77, 77);
  EXPECT_NE(fault_of<InputError>([&] {
              read(absent, [](const LabelImage&, Communication&) {});
            }).find("label 77 is not in the image"),
            std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Ranks, ReadByBricks,
                         testing::Combine(testing::Values(1, 2, 7), testing::Values("nii", "nii.gz")));

TEST(BytesOfBricks, AreLessOnMoreRanks) {
  ImageByBricks image;
  image.label_of_brick.assign(1 << 24, kBackground);
  const std::uint64_t of_table = bytes_of_bricks(image, 1);
  EXPECT_EQ(bytes_of_bricks(image, 64), of_table);
  std::fill_n(image.label_of_brick.begin(), 1 << 22, ImageByBricks::kMixed);
  const std::uint64_t of_all = bytes_of_bricks(image, 1) - of_table;
  EXPECT_EQ(bytes_of_bricks(image, 2) - of_table, of_all);
  EXPECT_LT(bytes_of_bricks(image, 64) - of_table, of_all / 3);
  EXPECT_GT(bytes_of_bricks(image, 64) - of_table, of_all / 64);
}

TEST(VoxelFile, IsNotForImagesThatMustBeReadAsAWhole) {
  EXPECT_EQ(VoxelFile::open("phantom:spheres@32"), nullptr);
}

}  // namespace
}  // namespace podm::test
