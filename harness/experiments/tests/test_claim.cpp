// Tests of the form of claims, and of faults that are refused.
#include "experiments/claim.h"

#include <gtest/gtest.h>

#include "tests/synthetic_rows.h"

namespace podm::bench {
namespace {

using Json = nlohmann::ordered_json;

TEST(Claim, EveryKeyOfARatioIsRead) {
  const Claim claim = read_claim_of(R"(
note = "n"
basis = "measured"
trials = ["10M", "1*"]
where = {contention = ["local", "random"], threads = {at_least = 2, at_most = 8}, leaf_size = "none"}
extent = "one socket"
needs_cores = 16
kind = "ratio"
value = "refining_seconds"
of = {algorithm = "podm"}
over = {algorithm = "pdr-podm"}
across = ["seed", "input"]
at_least = 0.5
at_most = 2
)");
  EXPECT_EQ(claim.name, "c");
  EXPECT_EQ(claim.statement, "s");
  EXPECT_EQ(claim.note, "n");
  EXPECT_EQ(claim.basis, Basis::kMeasured);
  EXPECT_EQ(claim.trials, (std::vector<std::string>{"10M", "1*"}));
  ASSERT_EQ(claim.where.size(), 3u);
  EXPECT_EQ(describe(claim.where), "contention=local or random, threads>=2 and <=8, leaf_size=none");
  EXPECT_EQ(claim.extent, Extent::kOneSocket);
  EXPECT_EQ(claim.needs_cores, 16);
  EXPECT_EQ(claim.kind, ClaimKind::kRatio);
  EXPECT_STREQ(claim.value->name, "refining_seconds");
  EXPECT_EQ(describe(claim.of), "algorithm=podm");
  EXPECT_EQ(describe(claim.over), "algorithm=pdr-podm");
  EXPECT_FALSE(claim.over_best);
  EXPECT_EQ(claim.across, (std::vector<std::string>{"seed", "input"}));
  EXPECT_EQ(describe_bound(claim), "at least 0.5 and at most 2");
}

TEST(Claim, OtherKindsHaveTheirOwnKeys) {
  const Claim order = read_claim_of(
      "basis = 'simulated'\nkind = 'order'\nvalue = 'lost_seconds'\nabove = {contention = 'random'}\n"
      "below = 'best of the others'\n");
  EXPECT_EQ(order.kind, ClaimKind::kOrder);
  EXPECT_TRUE(order.over_best);
  EXPECT_EQ(describe_bound(order), "above 1");
  const Claim trend = read_claim_of(
      "basis = 'measured'\nkind = 'trend'\nvalue = 'refining_seconds'\nalong = 'threads'\n"
      "direction = 'falls'\nfactor_per_doubling = 1.4\n");
  EXPECT_EQ(trend.along, "threads");
  EXPECT_FALSE(trend.grows);
  EXPECT_EQ(describe_bound(trend), "falls by at least 1.4 per doubling");
  const Claim share = read_claim_of("basis = 'any'\nkind = 'share'\nvalue = 'ended'\nat_least = 0.9\n");
  EXPECT_EQ(describe_bound(share), "at least 0.9");
}

TEST(Claim, FaultsNameThePlace) {
  const std::string bound = "basis = 'measured'\nkind = 'bound'\nvalue = 'seconds'\n";  // lines 3 to 5
  const std::string ratio = "basis = 'measured'\nkind = 'ratio'\nvalue = 'seconds'\nat_most = 1\n";
  const std::string trend = "basis = 'measured'\nkind = 'trend'\nvalue = 'seconds'\n";
  const std::string share = "basis = 'any'\nkind = 'share'\n";
  struct Case {
    std::string lines, place, word;
  };
  const Case cases[] = {
      {"", "claim.toml:", "basis"},  // absent keys
      {"basis = 'measured'\n", "claim.toml:", "value"},
      {"basis = 'measured'\nvalue = 'seconds'\n", "claim.toml:", "kind"},
      {bound, "claim.toml:", "at_least or at_most"},
      {ratio, "claim.toml:", "'of'"},
      {ratio + "of = {algorithm = 'podm'}\n", "claim.toml:", "'over'"},
      {trend + "along = 'threads'\n", "claim.toml:", "direction"},
      {share + "value = 'ended'\n", "claim.toml:", "at_least"},
      {bound + "at_most = 1\ncolour = 2\n",
       "claim.toml:7:1:", "colour"},  // keys that no claim, or not this kind, has
      {bound + "at_most = 1\nof = {algorithm = 'podm'}\n", "claim.toml:7:1:", "of"},
      {trend + "along = 'threads'\ndirection = 'falls'\nat_most = 1\n", "claim.toml:8:1:", "at_most"},
      {"basis = 'guessed'\n" + bound.substr(19), "claim.toml:3:9:", "simulated"},  // unknown words
      {"basis = 'measured'\nvalue = 'beauty'\nkind = 'bound'\nat_most = 1\n",
       "claim.toml:4:9:", "lost_seconds"},
      {"basis = 'measured'\nvalue = 'seconds'\nkind = 'proof'\n", "claim.toml:5:8:", "share"},
      {bound + "at_most = 1\nextent = 'some'\n", "claim.toml:7:10:", "one socket"},
      {trend + "along = 'threads'\ndirection = 'wanders'\n", "claim.toml:7:13:", "grows"},
      {ratio + "of = {algorithm = 'podm'}\nover = 'the best'\n", "claim.toml:8:8:", "best of the others"},
      {ratio + "of = {threads = 2}\nover = 'best of the others'\nat_least = 1\nacross = ['algorithm']\n",
       "claim.toml:10:10:", "merge"},
      {bound + "at_most = 'x'\n", "claim.toml:6:11:", "number"},  // wrong types
      {bound + "at_most = nan\n", "claim.toml:6:11:", "number"},
      {bound + "at_most = 1\nwhere = 'podm'\n", "claim.toml:7:9:", "table"},
      {bound + "at_most = 1\nneeds_cores = 0\n", "claim.toml:7:15:", "needs_cores"},
      {bound + "at_most = 1\nwhere = {threads = []}\n", "claim.toml:7:20:", "empty"},
      {bound + "at_most = 1\nwhere = {}\n", "claim.toml:7:9:", "no option"},
      {bound + "at_most = 1\nwhere = {threads = {least = 1}}\n", "claim.toml:7:", "at_least"},
      {bound + "at_least = 2\nat_most = 1\n", "claim.toml:7:11:", "less"},  // contradictions
      {"basis = 'simulated'\n" + bound.substr(19) + "at_most = 1\n", "claim.toml:5:9:", "simulated"},
      {"basis = 'any'\nkind = 'bound'\nvalue = 'lost_seconds'\nat_most = 1\n", "claim.toml:5:9:", "any"},
      {"basis = 'measured'\nkind = 'bound'\nvalue = 'virtual_refining_seconds'\nat_most = 1\n",
       "claim.toml:5:9:", "measured"},
      {share + "value = 'guarantee_misses'\nat_least = 1\n", "claim.toml:5:9:", "0 or 1"},
      {share + "value = 'ended'\nat_least = 1.5\n", "claim.toml:6:12:", "up to 1"},
      {share + "value = 'ended'\nat_least = 1\nneeds_cores = 2\n", "claim.toml:7:15:", "measured"},
      {share + "value = 'ended'\nat_least = 1\nextent = 'one socket'\n", "claim.toml:7:10:", "simulated"},
      {bound + "at_most = 1\ntrials = ['2M']\n", "claim.toml:7:10:", "2M"},  // values that no trial has
      {bound + "at_most = 1\nwhere = {contention = 'locl'}\n", "claim.toml:7:23:", "contention=locl"},
      {bound + "at_most = 1\nwhere = {contention = ['local', 'locl']}\n", "claim.toml:7:33:", "locl"},
      {bound + "at_most = 1\nwhere = {colour = 'red'}\n", "claim.toml:7:19:", "colour"},
      {bound + "at_most = 1\nwhere = {executor = 'virtual'}\n", "claim.toml:7:21:", "executor=virtual"},
      {ratio + "of = {algorithm = 'podm'}\nover = {algorithm = 'pdr'}\n",
       "claim.toml:8:21:", "algorithm=pdr"},
      {trend + "along = 'begging'\ndirection = 'falls'\n", "claim.toml:6:9:", "begging"},
  };
  for (const auto& [lines, place, word] : cases) {
    std::string what = "none";
    try {
      read_claim_of(lines);
    } catch (const TomlError& error) {
      what = error.what();
    }
    EXPECT_TRUE(what.starts_with(place)) << what << "\nfor\n" << lines;
    EXPECT_NE(what.find(word), std::string::npos) << what << "\nfor\n" << lines;
  }
}

TEST(Claim, NumbersOfThreadsAreUpToTheMachine) {
  EXPECT_NO_THROW(read_claim_of(
      "basis = 'measured'\nkind = 'bound'\nvalue = 'seconds'\nat_most = 1\nwhere = {threads = 256}\n"));
}

TEST(Claim, ThatSupersedesOthersGivesAReason) {
  const std::string bound = "basis = 'measured'\nkind = 'bound'\nvalue = 'seconds'\nat_most = 1\n";
  const Claim claim = read_claim_of(bound + "supersedes = ['old', 'exp:older']\nreason = 'r'\n");
  EXPECT_EQ(claim.supersedes, (std::vector<std::string>{"old", "exp:older"}));
  EXPECT_EQ(claim.reason, "r");
  EXPECT_THROW(read_claim_of(bound + "supersedes = 'old'\n"), TomlError);
  EXPECT_EQ(read_claim_of(bound + "reason = 'r'\n").reason, "r") << "of a claim that changed";
}

TEST(WithdrawnClaim, NeedsItsStatementAndAReason) {
  const auto read = [](const std::string& lines) {
    const TomlValue table = parse_toml_text("name = 'c'\n" + lines, "claim.toml");
    TomlSection section(table, "[[withdrawn]]");
    return read_withdrawn_claim(section);
  };
  const WithdrawnClaim claim = read("statement = 's'\nreason = 'r'\nsuperseded_by = 'd'\n");
  EXPECT_EQ(claim.name + claim.statement + claim.reason + claim.superseded_by, "csrd");
  EXPECT_EQ(claim.place, "claim.toml:1:8");
  for (const char* lines :
       {"statement = 's'\n", "reason = 'r'\n", "statement = 's'\nreason = 'r'\nvalue = 'seconds'\n"})
    EXPECT_THROW(read(lines), TomlError) << lines;
}

}  // namespace
}  // namespace podm::bench
