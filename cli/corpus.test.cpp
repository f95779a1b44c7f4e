// SPDX-License-Identifier: Apache-2.0
// `graze corpus` as users run it, and the repository's regression corpus.
#include <gtest/gtest.h>

#include <algorithm>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class CorpusVerb : public CommandTest {
 protected:
  void campaign(const std::string& out, const std::string& options) {
    expect_done("graze fuzz --threads 1 --executor twin " + options + " --out " + out);
  }
};

TEST_F(CorpusVerb, TakesACampaignListsItAndHolds) {
  campaign("c", "--pairs 20000 --strata 'lattice,degenerate'");
  const Ran added = shell("graze corpus add c --top 3");
  EXPECT_EQ(added.out,
            "15 new, 0 seen again, 0 known already; corpus/regression/cases.pairs holds 15\n"
            "Next: graze corpus verify\n")
      << added.err;
  const Ran listed = shell("graze corpus list | grep -c ^failing");
  EXPECT_EQ(listed.out, "15\n");
  expect_out("graze corpus verify --executor twin", {"15 failing, 0 fixed, 0 flaky"});
  const Ran some = shell("graze corpus add c --signatures '*/moller_1997:*,none/*' --top 1 --corpus some");
  EXPECT_EQ(some.out,
            "5 new, 0 seen again, 0 known already; some/cases.pairs holds 5\n"
            "Next: graze corpus verify --corpus some\n")
      << some.err;
  EXPECT_EQ(shell("graze corpus list --corpus some | grep -v moller_1997 | grep -cE '^ +(point|segment|area)/'").out,
            "0\n");
  // Adding the same campaign again changes no count; adding another campaign does.
  EXPECT_EQ(shell("cp corpus/regression/cases.pairs a; graze corpus add c --top 3; cmp corpus/regression/cases.pairs a")
                .status,
            0);
  campaign("d", "--pairs 20000 --strata 'lattice,degenerate' --seed 2");
  const Ran again = shell("graze corpus add d --top 3");
  EXPECT_EQ(again.out.find(" 0 seen again") == std::string::npos, true) << again.out;
}

// If none of a failure's wrong lanes runs, nothing confirms the failure, so it is not added, and a message says so.
TEST_F(CorpusVerb, WhatNoLaneCanConfirmIsNotAdded) {
  campaign("c", "--pairs 1000 --strata near_edge_edge --lanes 'moller_1997/*/cpu,guigue_devillers_2003/f32/cpu'");
  const std::string add = "graze corpus add c --lanes moller_1997/f32/cpu";
  const Ran some = shell.done(add);
  EXPECT_EQ(some.err.rfind("graze: c: ", 0), 0u) << some.err;
  EXPECT_TRUE(has(some.err, {" not added: no lane that was wrong on them runs here"}));
  EXPECT_FALSE(has(shell.file("corpus/regression/cases.pairs"), {"/guigue"}));
  expect_error(add + " --corpus none --signatures '*guigue_devillers_2003:*'", 1, {"c", "not added", "--lanes"});
  expect_error(add + " --corpus none --signatures '*guigue_devillers_2003:*,nosuch*'", 1, {"c", "'nosuch*'"});
  EXPECT_FALSE(std::filesystem::exists(shell.folder / "none/cases.pairs"));
  expect_error("graze corpus add c/cases/$(ls c/cases | head -n 1) --signatures nosuch --corpus none", 2,
               {"--signatures", "--top"});
}

// Each signature of the summary becomes a case with that signature's number of pairs, minimised or not.
TEST_F(CorpusVerb, TakesEverySignatureWithItsCount) {
  campaign("c", "--pairs 3000 --strata 'lattice,near_edge_edge' --lanes '*/f32/cpu'");
  const std::string same_as_summary =
      "import json, re\n"
      "wanted = {x['key']: x['count'] for x in json.load(open('c/summary.json'))['signatures']}\n"
      "found = re.findall(r' count=(\\d+) signature=(\\S+)', open('$r/cases.pairs').read())\n"
      "assert len(wanted) > 20 and wanted == {s: int(n) for n, s in found}, (len(wanted), len(found))\n";
  const auto check = [&](const std::string& corpus) {
    return shell("r=" + corpus + "; python3 -c \"" + same_as_summary + "\"");
  };
  expect_done("graze corpus add c --corpus r --lanes '*/f32/cpu'");
  const Ran found = check("r");
  EXPECT_EQ(found.status, 0) << found.err;
  expect_done("graze minimize c > /dev/null && graze corpus add c --corpus m --lanes '*/f32/cpu'");
  const Ran minimised = check("m");
  EXPECT_EQ(minimised.status, 0) << minimised.err;
  expect_done("grep -q kind=minimised m/cases.pairs && graze corpus verify --corpus m --lanes '*/f32/cpu'");
}

// One version of the code always answers yes; the other, under the same name, always answers no.
TEST_F(CorpusVerb, FailuresInBothDirectionsAreKeptAndOtherCodeOfOneNameIsRefused) {
  for (const std::string answer : {"0", "1"}) {
    expect_done("mkdir d" + answer + " && echo 'extern \"C\" int hit(const float*, const float*) { return " + answer +
                "; }' > d" + answer + "/m.cpp && graze fuzz --subject mine=d" + answer +
                "/m.cpp:hit --lanes mine/f32/cpu --strata near_vertex_face --pairs 200 --out c" + answer);
  }
  expect_error("graze corpus add c0 c1 --corpus both", 2, {"c0", "c1", "mine", "d0/m.cpp", "d1/m.cpp"});
  EXPECT_FALSE(std::filesystem::exists(shell.folder / "both"));
  EXPECT_TRUE(has(shell("graze corpus add c0 --corpus r").out, {", 0 seen again"}));
  EXPECT_TRUE(has(shell("graze corpus add c1 --corpus r").out, {", 0 seen again"}));
  expect_done("grep -q 'signature=[^ ]*mine:-' r/cases.pairs && grep -q 'signature=[^ ]*mine:+' r/cases.pairs");
}

TEST_F(CorpusVerb, AMinimisedCaseStandsForItsFile) {
  campaign("c", "--pairs 5000 --strata lattice");
  ASSERT_EQ(shell("set -- c/cases/*; { head -n 2 $1; grep '^[-0-9]' $1 | head -n 1 | sed 's/ stratum=.* "
                  "truth/ kind=minimised from=x truth/'; tail -n +3 $1; } > m")
                .status,
            0);
  // If a file has a minimised case, only that case is added.
  EXPECT_TRUE(shell("graze corpus add m --corpus s").out.starts_with("1 new"));
  EXPECT_EQ(shell("grep -c 'kind=minimised from=x' s/cases.pairs").out, "1\n");
  expect_done("graze repro s/cases.pairs > /dev/null");
  EXPECT_EQ(shell("graze repro m --emit obj | grep -c 'Case minimised from x:'").out, "1\n");
}

TEST_F(CorpusVerb, AChangedVerdictFailsUntilItIsRecorded) {
  shell("echo '0 0 0 4 0 0 2 0 0  1 0 0 1 0 4 1 0 2' > p; graze corpus add p --corpus r");
  expect_done("graze corpus verify --corpus r");
  const std::string forge = "sed -i 's/moller_1997:-/moller_1997:./2; s/state=failing/state=fixed/' r/cases.pairs;";
  const Ran changed = shell(forge + "cp r/cases.pairs forged; graze corpus verify --corpus r");
  EXPECT_EQ(changed.status, 1) << changed.out;
  EXPECT_TRUE(has(changed.out,
                  {": moller_1997/f32/cpu: was intersects (right), is disjoint (wrong)\n", ": fixed -> failing\n"}));
  expect_done("cmp forged r/cases.pairs");  // verify without --update changes nothing
  expect_done("graze corpus verify --corpus r --update");
  expect_done("graze corpus verify --corpus r");
}

TEST_F(CorpusVerb, BadInputGetsOneLine) {
  expect_error("graze corpus", 2, {"subcommand"});
  expect_error("graze corpus verify", 1, {"corpus/regression/cases.pairs", "corpus add"});
  expect_error("graze corpus list --corpus none", 1, {"none/cases.pairs", "corpus add"});
  expect_error("mkdir e; echo 'graze-pairs 1' > e/cases.pairs; graze corpus verify --corpus e", 1,
               {"no case", "e/cases.pairs"});
  expect_error("mkdir d; graze corpus add d", 1, {"d", "summary.json"});
  expect_error("echo '{\"complete\":true}' > d/summary.json; graze corpus add d", 1, {"d/summary.json"});
  expect_error("echo '{\"complete\":false}' > d/summary.json; graze corpus add d", 1, {"d/summary.json"});
  expect_error("head -c 99 /dev/urandom > d/summary.json; graze corpus add d", 1, {"d/summary.json"});
  expect_error("graze corpus add missing.pairs", 1, {"missing.pairs", "No such file or directory"});
  expect_error("graze corpus add nowhere:1:2", 2, {"'nowhere'"});
  expect_error("echo '0 0 0 4 0 0 0 4 0  0 0 9 4 0 9 0 4 9' > easy; graze corpus add easy", 1, {"easy"});
  expect_error("echo 'nan 0 0 4 0 0 0 4 0  0 0 9 4 0 9 0 4 9' > nan; graze corpus add nan", 1, {"nan"});
  expect_error("sed -i 's/$/ | signature=x/' easy; graze corpus add easy", 1, {"easy", "signature", "x"});
  expect_error("touch file; graze corpus add near_edge_edge:1:42 --corpus file", 1, {"file", "Not a directory"});
  EXPECT_NE(shell("test -e corpus/regression/cases.pairs").status, 0);
}

TEST_F(CorpusVerb, NoRecordOfTheLanesThatRunIsAFailure) {
  shell("echo '0 0 0 4 0 0 2 0 0  1 0 0 1 0 4 1 0 2' > p; graze corpus add p --corpus r --lanes 'moller_*'");
  expect_done("graze corpus verify --corpus r");
  expect_error("graze corpus verify --corpus r --lanes separating_axes/f32/cpu > /dev/null", 1,
               {"r/cases.pairs", "--lanes"});
}

// Kills `add` before each of its writes. Afterwards the file is either the old or the new one, and running the command
// again writes the same bytes.
TEST_F(CorpusVerb, KilledWhileAddingLosesNothing) {
  campaign("c", "--pairs 30000 --strata 'near_*,coplanar_*'");
  expect_done("graze corpus add c --corpus whole --top 3 && graze corpus add c --corpus whole");
  expect_done("graze corpus add c --corpus killed --top 3 && cp killed/cases.pairs old");
  int killed = 0;
  while (shell(signal_at_write(SIGKILL, killed + 1) + "graze corpus add c --corpus killed").status != 0) {
    ASSERT_LT(++killed, 100);
    expect_done("cmp killed/cases.pairs old || cmp killed/cases.pairs whole/cases.pairs");
  }
  EXPECT_GE(killed, 2);  // before the new file is written, and before it replaces the old one
  expect_done("graze corpus add c --corpus killed");
  expect_done("cmp killed/cases.pairs whole/cases.pairs");
}

TEST_F(CorpusVerb, TwoAtOnceLoseNothing) {
  expect_done(
      "mkdir r; for i in 0 1 2 3 4 5 6 7 8 9; do graze corpus add degenerate:1:$i --corpus r & done; wait;"
      "for i in 0 1 2 3 4 5 6 7 8 9; do graze corpus add degenerate:1:$i --corpus s; done;"
      "a=$(graze corpus list --corpus r | grep -c ^failing); test \"$a\" -gt 9;"
      "test \"$a\" = \"$(graze corpus list --corpus s | grep -c ^failing)\"");
}

TEST_F(CorpusVerb, AFullDiskLosesNothing) {
  campaign("c", "--pairs 10000");
  expect_done("graze corpus add c --top 2 --corpus r; cp r/cases.pairs old");
  expect_error("ulimit -f 40; graze corpus add c --corpus r", 1, {"r/cases.pairs"});
  const Ran ran = shell("ulimit -f 0; graze corpus verify --corpus r --lanes 'moller_1997/f32/cpu' --update");
  EXPECT_EQ(ran.status, 1) << ran.err;
  EXPECT_FALSE(has(ran.out, {"recorded"}));
  expect_done("cmp r/cases.pairs old");
}

// Lanes without contraction give the same verdicts everywhere; others depend on the compiler and the CUDA toolkit.
TEST_F(CorpusVerb, TheRepositorysOwnHolds) {
  expect_done("graze corpus verify --lanes '*/cpu,*/cuda-nofma' --corpus '" GRAZE_SOURCE_DIR "/corpus/regression'");
}

}  // namespace
}  // namespace graze::cli
