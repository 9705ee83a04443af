#include "image/label_selection.h"

#include <gtest/gtest.h>

#include <functional>

#include "errors.h"

namespace podm::verify {
namespace {

using Voxels = std::vector<std::uint32_t>;

Image image_of(Voxels voxels) {
  Image image;
  image.path = "row.nii";
  image.size = {static_cast<int>(voxels.size()), 1, 1};
  image.voxels = std::move(voxels);
  return image;
}

Voxels selected(const LabelSelection& selection, Voxels voxels = {0, 1, 2, 3, 4, 5, 9}) {
  Image image = image_of(std::move(voxels));
  select_labels(image, selection);
  return image.voxels;
}

std::string fault_of(const std::function<void()>& action) {
  try {
    action();
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

TEST(LabelSelection, RangesAreClosedAndSingleValuesAreRanges) {
  EXPECT_EQ(parse_label_ranges("1,3-7", "--labels"), (LabelSelection::Ranges{{1, 1}, {3, 7}}));
  EXPECT_EQ(parse_label_ranges("0-4294967295", "--drop"), (LabelSelection::Ranges{{0, 4294967295}}));
  EXPECT_EQ(parse_merge("2,3=kidney"), (std::vector<std::uint32_t>{2, 3}));
}

TEST(LabelSelection, WhatIsNoRangeIsRefusedByTheNameOfTheOption) {
  for (const char* text : {"", "a", "1,", ",1", "-1", "1-", "1-2-3", "4294967296", "1 ", "7-3"})
    EXPECT_EQ(fault_of([&] { parse_label_ranges(text, "--drop"); }).rfind("--drop: ", 0), 0U) << text;
  for (const char* text : {"", "2,3", "2,3=", "=kidney", "2,x=kidney", "2-3=kidney"})
    EXPECT_EQ(fault_of([&] { parse_merge(text); }).rfind("--merge: ", 0), 0U) << text;
}

TEST(LabelSelection, KeepingAndDroppingComeBeforeMerging) {
  EXPECT_EQ(selected({}), (Voxels{0, 1, 2, 3, 4, 5, 9}));
  EXPECT_EQ(selected({.keep = {{2, 4}, {9, 9}}}), (Voxels{0, 0, 2, 3, 4, 0, 9}));
  EXPECT_EQ(selected({.keep = {{2, 4}}, .drop = {{3, 8}}}), (Voxels{0, 0, 2, 0, 0, 0, 0}));
  EXPECT_EQ(selected({.drop = {{2, 2}}, .merges = {{4, 1}, {2, 9, 3}}}), (Voxels{0, 4, 0, 2, 4, 5, 2}))
      << "a merge has its first value even where that one is dropped";
}

TEST(LabelSelection, AnotherBackgroundChangesPlacesWithZero) {
  EXPECT_EQ(selected({.background = 5}), (Voxels{5, 1, 2, 3, 4, 0, 9}));
  EXPECT_EQ(selected({.background = 5, .drop = {{0, 1}}}), (Voxels{0, 0, 2, 3, 4, 0, 9}));
  EXPECT_EQ(selected({.background = 7, .merges = {{0, 1}}}), (Voxels{7, 7, 2, 3, 4, 5, 9}));
  Mesh mesh;
  mesh.cell_labels = {0, 1, 5};
  mesh.facet_labels = {{5, 1}, {0, 1}};
  mesh.label_names = {{0, "zero"}, {1, "one"}, {5, "outside"}};
  move_background(mesh, 5);
  EXPECT_EQ(mesh.cell_labels, (std::vector<LabelValue>{5, 1, 0}));
  EXPECT_EQ(mesh.facet_labels, (std::vector<std::array<LabelValue, 2>>{{0, 1}, {5, 1}}));
  EXPECT_EQ(mesh.label_names, (std::map<LabelValue, std::string>{{0, "outside"}, {1, "one"}, {5, "zero"}}));
}

TEST(LabelSelection, ContradictionsAreRefused) {
  const auto fault = [](const LabelSelection& selection) { return fault_of([&] { selected(selection); }); };
  EXPECT_EQ(fault({.keep = {{6, 6}}}), "row.nii: --labels: no voxel has label 6");
  EXPECT_EQ(fault({.drop = {{8, 8}}}), "row.nii: --drop: no voxel has label 8");
  EXPECT_EQ(fault({.merges = {{2, 7}}}), "row.nii: --merge: no voxel has label 7");
  EXPECT_EQ(fault({.keep = {{0, 0}}}), "row.nii: --labels: label 0 is the background");
  EXPECT_EQ(fault({.merges = {{2, 3}, {3, 4}}}), "row.nii: --merge: label 3 is merged twice");
  EXPECT_EQ(fault({.drop = {{1, 9}}}), "row.nii: no voxel has a label that is selected");
  EXPECT_EQ(fault({.keep = {{5, 7}}}), "none") << "a range may hold values without voxels";
}

}  // namespace
}  // namespace podm::verify
