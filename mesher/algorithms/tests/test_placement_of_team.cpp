// The machine of a run's workers: this one, or one that a file describes.
#include "algorithms/placement_of_team.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "podm/errors.h"
#include "tests/fault_of.h"
#include "tests/scratch_folder.h"

namespace podm::test {
namespace {

const std::string kBlacklight = PODM_MACHINES "/blacklight.toml";

TEST(PlacementOfTeam, ADescriptionInTomlHasCosts) {
  const PlacementOfTeam placement =
      place_team({.threads = 40, .pin = "compact", .topology_path = kBlacklight});
  ASSERT_TRUE(placement.model);
  EXPECT_EQ(placement.model->num_nodes(), 16);
  EXPECT_EQ(placement.machine.num_cores(), 256);
  EXPECT_FALSE(placement.is_real);
  EXPECT_EQ(placement.places[15].node, 0);
  EXPECT_EQ(placement.places[39].node, 2);
}

TEST(PlacementOfTeam, OtherMachinesHaveNone) {
  const ScratchFolder folder;
  const Topology described = place_team({.topology_path = kBlacklight}).machine;
  const PlacementOfTeam as_xml =
      place_team({.threads = 40, .topology_path = folder.write("blacklight.xml", described.to_xml())});
  EXPECT_FALSE(as_xml.model);
  EXPECT_EQ(as_xml.machine.num_cores(), 256);
  EXPECT_FALSE(place_team({}).model);
}

TEST(PlacementOfTeam, MachinesThatMakeNoSenseAreRefused) {
  const ScratchFolder folder;
  for (const char* name : {"machine.toml", "machine.xml"}) {
    const std::string path = folder.write(name, "name = 3");
    EXPECT_THAT(fault_of<InputError>([&] { place_team({.topology_path = path}); }),
                testing::StartsWith(path + ":"));
  }
}

}  // namespace
}  // namespace podm::test
