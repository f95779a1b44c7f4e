// SPDX-License-Identifier: Apache-2.0
// `graze minimize` as users run it.
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <regex>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class Minimize : public CommandTest {
 protected:
  static constexpr const char* kFuzz =
      "graze fuzz --seed 2 --pairs 240 --lanes '*/f32/*' --executor twin --strata 'near_edge_edge,degenerate' ";
};

TEST_F(Minimize, ACaseIsPrintedAndWrittenWithItsOriginal) {
  expect_out("graze minimize exact_contact:1:1 --lanes 'guigue_*/f32/cpu' --out small.pairs",
             {"exact_contact:1:1, guigue_devillers_2003\n", "1-minimal: none of the "});
  const std::string file = shell.file("small.pairs");
  const std::size_t minimised = file.find("kind=minimised"), worst = file.find("kind=worst"),
                    original = file.find("index=1");
  EXPECT_LT(minimised, worst);
  EXPECT_LT(worst, original);
  EXPECT_NE(original, std::string::npos);
  EXPECT_TRUE(has(file, {"from=exact_contact:1:1"}));
  // Both pairs fail as recorded.
  const Ran repro = shell.done("graze repro small.pairs --lanes 'guigue_*/f32/cpu'");
  std::size_t as_recorded = 0;
  for (std::size_t at = 0; (at = repro.out.find("(as recorded)", at)) != std::string::npos; ++at) ++as_recorded;
  EXPECT_EQ(as_recorded, 2u) << repro.out;
  // If the result is used as input, its cases are minimised again from the start, with the same result.
  expect_done("graze minimize small.pairs --lanes 'guigue_*/f32/cpu' --out again.pairs && cmp small.pairs again.pairs");
}

TEST_F(Minimize, ACampaignTwiceIsTheSameBytesWhateverTheThreads) {
  expect_done(std::string(kFuzz) + "--out one > /dev/null && cp -r one two && cp -r one fresh");
  expect_done("graze minimize one --threads 1 && graze minimize two --threads 4 && diff -r one/cases two/cases");
  const auto run = shell.json("one/timings.json")["runs"].back();
  EXPECT_GT(run["processor_seconds_worst"], 0);
  EXPECT_LT(run["processor_seconds_worst"], 0.5 * run["processor_seconds"].get<double>());
  const auto summary = shell.json("one/summary.json");
  ASSERT_GT(summary["signatures"].size(), 50u);
  for (const auto& row : summary["signatures"]) {
    const std::string name = row["case"], file = contents(shell.folder / "one" / name),
                      fresh = contents(shell.folder / "fresh" / name);
    EXPECT_TRUE(has(file, {"kind=minimised"})) << name;
    const std::size_t entries = fresh.find('\n', fresh.find('\n') + 1) + 1;
    EXPECT_TRUE(file.ends_with(fresh.substr(entries))) << name;  // the originals, as they were
  }
  expect_done("graze minimize one && diff -r one/cases two/cases");
  expect_done("graze minimize one --again && diff -r one/cases two/cases");
  // Running the campaign's command again leaves the results in place.
  expect_done(std::string(kFuzz) + "--out one > /dev/null && diff -r one/cases two/cases");
  expect_done(
      "f=$(grep -om1 'cases/[0-9a-f]*.pairs' one/summary.json); graze repro one/$f --executor twin > /dev/null");
}

TEST_F(Minimize, KilledItGoesOn) {
  expect_done(std::string(kFuzz) + "--out whole > /dev/null && cp -r whole parts && graze minimize whole");
  for (const int write : {1, 20, 200})
    ASSERT_EQ(shell(signal_at_write(SIGKILL, write) + "graze minimize parts").status, 128 + SIGKILL) << write;
  expect_done("graze minimize parts && rm -f parts/cases/*.part && diff -r whole/cases parts/cases");
}

TEST_F(Minimize, CtrlCSaysWhatWasDoneAndTheSameCommandGoesOn) {
  expect_done(std::string(kFuzz) + "--out whole > /dev/null && cp -r whole parts && graze minimize whole");
  for (const int signal : {SIGINT, SIGTERM}) {
    const Ran ran = shell(signal_at_write(signal, 20) + "graze minimize parts");
    ASSERT_EQ(ran.status, 130) << ran.out << ran.err;
    EXPECT_TRUE(std::regex_search(ran.err, std::regex("graze: interrupted; minimised [0-9]+ of [0-9]+ signatures; "
                                                      "run the same command to resume\n$")))
        << ran.err;
    EXPECT_EQ(ran.out, "");
    expect_done("test -z \"$(ls parts/cases | grep part)\"");
  }
  expect_done("graze minimize parts && diff -r whole/cases parts/cases");
}

TEST_F(Minimize, ACaseThatIsInterruptedIsNotWritten) {
  expect_done(
      "graze fuzz --seed 2 --pairs 1000 --strata near_edge_edge --lanes '*/cpu' --out one > /dev/null && "
      "cat one/cases/*.pairs | grep -v '^#' > all && (head -n 1 $(ls one/cases/*.pairs | head -n 1); cat all) > "
      "many.pairs");
  const Ran ran = signalled("graze minimize many.pairs --out small.pairs", "TERM");
  EXPECT_EQ(ran.status, 130) << ran.out << ran.err;
  EXPECT_TRUE(std::regex_search(
      ran.err, std::regex("graze: interrupted; minimised [0-9]+ of [0-9]+ cases and wrote nothing\n$")))
      << ran.err;
  expect_done("test ! -e small.pairs");
}

TEST_F(Minimize, SaysTheCauseAndWhetherItEnded) {
  const Ran ran = shell.done("graze minimize extreme_scale:1:3 --lanes 'projected_sat/f32/cpu' --out small.pairs");
  EXPECT_TRUE(std::regex_search(ran.out, std::regex("\n  cause: [a-z ]+, as before\n"))) << ran.out;
  const std::string file = shell.file("small.pairs");
  EXPECT_TRUE(
      std::regex_search(file, std::regex("kind=minimised .* cause=[a-z_]+ one_minimal=yes moves_in_vain=[0-9]+\n")))
      << file;
}

TEST_F(Minimize, LanesAreThoseOfTheCampaignOrThoseAskedFor) {
  expect_done("graze fuzz --seed 2 --pairs 100 --strata near_edge_edge --lanes '*/cpu' --out host > /dev/null");
  expect_out("graze minimize host && grep -h kind=minimised host/cases/*.pairs", {":-f32/cpu "});
  expect_out("graze minimize host --lanes 'moller_*'", {"no selected lane is wrong on the others"});
  const auto kinds = shell.json("host/failures.json");
  EXPECT_EQ(kinds["lanes"], (nlohmann::ordered_json{"moller_1997/f32/cpu", "moller_1997/f64/cpu"}));
  expect_done("graze failures host | grep 'signatures belong to no kind'");
  expect_done("graze report host | grep 'signatures belong to no kind of failure'");
  expect_error("graze minimize host --lanes 'moller_*/cuda-nofma'", 2, {"the campaign did not run it"});
}

// Each case file states its signature; a file that another program wrote, changed or moved is rejected.
TEST_F(Minimize, CasesThatAreNotTheCampaignsAreRefusedAndCanBeBroughtBack) {
  expect_done(std::string(kFuzz) + "--out c > /dev/null && graze minimize c > /dev/null && cp -r c whole");
  const auto rows = shell.json("c/summary.json")["signatures"];
  const std::string first = "c/" + rows.front()["case"].get<std::string>(), key = rows.front()["key"],
                    last = "c/" + rows.back()["case"].get<std::string>();
  for (const auto& [edit, found] : {std::pair("cp " + last + ' ' + first, std::string("second line")),
                                    {"sed -i '$d' " + first, "3 cases"},
                                    {"sed -i '$s/^[^ ]*/0x1.5p+3/' " + first, "pair"},
                                    {"sed -i '3s/^[^ ]*/0x1.5p+3/' " + first, "line 3"},
                                    {"sed -i '$s/margin=[^ ]*/margin=7/' " + first, "pair"},
                                    {"sed -i '$s/signature=/signature=area/' " + first, "another signature"},
                                    {"sed -i '/kind=minimised/d' " + first, "out of order"},
                                    {"sed -i 's/kind=worst/kind=minimised/' " + first, "out of order"},
                                    {"sed -i '3{h;d};$G' " + first, "out of order"},
                                    {"rm " + first, "missing"},
                                    {"echo 1 2 3 > " + first, first + ":1"}}) {
    expect_done(edit);
    for (const char* reader : {"failures", "minimize"})
      expect_error(std::string("graze ") + reader + " c", 1, {first, key, found});
    const Ran report = shell("graze report c");
    EXPECT_EQ(report.status, 1) << edit;
    ASSERT_TRUE(names(report.err.substr(0, report.err.size() - 1), {first, key, found}));
    const std::string again = report.err.substr(report.err.find("then: ") + 6);
    expect_done("rm -f " + first + " && " + again.substr(0, again.size() - 1) + " > /dev/null && graze minimize c && " +
                "diff -r whole/cases c/cases && cmp whole/failures.json c/failures.json");
  }
}

// The forged pair has the right truth, but other lanes are wrong on it: only the lanes reveal the forgery.
TEST_F(Minimize, CasesOnWhichOtherLanesAreWrongAreRefused) {
  expect_done(std::string(kFuzz) + "--out c > /dev/null");
  const auto rows = shell.json("c/summary.json")["signatures"];
  int forged = 0;
  for (const auto& one : rows) {
    for (const auto& other : rows) {
      const std::string key = one["key"], other_key = other["key"];
      const std::size_t lanes = key.find(':');
      if (forged > 0 || key == other_key || key.substr(0, lanes) != other_key.substr(0, lanes)) continue;
      const std::string file = contents(shell.folder / "c" / one["case"]);
      std::string text = contents(shell.folder / "c" / other["case"]);
      for (std::size_t at = 0; (at = text.find(other_key, at)) != text.npos; at += key.size())
        text.replace(at, other_key.size(), key);
      const std::size_t head = text.find('#'), end = text.find('\n', head);
      text.replace(head, end - head, file.substr(head, file.find('\n', head) - head));
      if (std::count(text.begin(), text.end(), '\n') != std::count(file.begin(), file.end(), '\n')) continue;
      ++forged;
      std::ofstream(shell.folder / "c" / one["case"]) << text;
      for (const char* reader : {"failures", "minimize"})
        expect_error(std::string("graze ") + reader + " c", 1, {one["case"], key, "verdict"});
    }
  }
  EXPECT_EQ(forged, 1);
}

TEST_F(Minimize, KindsAreTheOldOnesOrTheNewOnes) {
  expect_done(std::string(kFuzz) + "--out c > /dev/null && graze minimize c && cp c/failures.json whole");
  for (const char* seconds : {"0.05", "0.1", "0.2", "0.4"}) {
    shell(std::string("timeout -s KILL ") + seconds + " graze minimize c --again");
    expect_done("cmp whole c/failures.json");
  }
  // Kinds are rejected if their cases have changed since.
  expect_done(std::string(kFuzz) +
              "--out d > /dev/null && graze failures d > /dev/null && cp d/failures.json of_originals");
  expect_done("graze minimize d --shard 1/1000 && graze report d > said");
  EXPECT_TRUE(has(shell.file("said"), {"The kinds of failure are not known yet"}));
  expect_done(
      "cmp d/failures.json of_originals && graze failures d > /dev/null && ! cmp -s d/failures.json of_originals");
}

TEST_F(Minimize, WhereNothingCanBeWrittenItSaysSoAtOnce) {
  const std::string read_only = "unshare -rm sh -c 'mount --bind c c && mount -o remount,bind,ro c && ";
  expect_done(std::string(kFuzz) + "--out c > /dev/null && graze minimize c > /dev/null && cp c/failures.json before");
  if (shell(read_only + "true'").status != 0) GTEST_SKIP() << "no mount namespaces here";
  expect_error(read_only + "graze minimize c'", 1, {"c", "Read-only file system"});
  expect_done("cmp before c/failures.json");
}

TEST_F(Minimize, BadInputGetsOneLine) {
  expect_error("graze minimize", 2, {"CASE"});
  expect_error("graze minimize missing.pairs", 1, {"missing.pairs", "No such file or directory"});
  expect_error("graze minimize nowhere:1:2", 2, {"'nowhere'"});
  expect_error("mkdir empty; graze minimize empty", 1, {"empty"});
  expect_error("mkdir odd; echo '{\"spec\": 1, \"signatures\": 2}' > odd/summary.json; graze minimize odd", 1,
               {"odd/summary.json"});
  expect_error("echo '0 0 0 1 0 0 0 1 0  0 0 5 1 0 5 0 1 5' > right.pairs; graze minimize right.pairs", 1,
               {"right.pairs"});
  expect_error("echo 'nan 0 0 1 0 0 0 1 0  0 0 5 1 0 5 0 1 5' > nan.pairs; graze minimize nan.pairs", 1, {"nan.pairs"});
  expect_error("graze minimize exact_contact:1:1 --lanes nothing", 2, {"'nothing'"});
  expect_error("graze minimize exact_contact:1:1 --out no/where.pairs > /dev/null", 1,
               {"no/where.pairs", "No such file or directory"});
}

}  // namespace
}  // namespace graze::cli
