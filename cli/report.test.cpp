// SPDX-License-Identifier: Apache-2.0
// `graze report` as users run it.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class Report : public CommandTest {
 protected:
  static constexpr const char* kFuzz =
      "graze fuzz --pairs 3000 --lanes 'moller_1997/*,exact/f32/cpu' --executor twin "
      "--strata 'near_edge_edge,degenerate,thesis' ";

  nlohmann::json json(const char* file) { return shell.json(file); }
};

// The map of toolchains counts differences from x86-gcc, as computed from the signatures. x86-gcc's verdict equals
// cpu's on every pair, so these counts must equal the differences from cpu in the rates.
TEST_F(Report, MapsToolchains) {
  expect_done(
      "graze fuzz --pairs 4000 --lanes 'interval_overlap/*,exact/f32/cpu' --executor twin "
      "--toolchains x86-gcc,x86-gcc-v3,x87-24 --out c > /dev/null");
  const std::string said = shell("graze report c").out;
  EXPECT_TRUE(has(said, {"cpu, cuda-nofma, x86-gcc agree on all 4,000 pairs.", " differs most from x86-gcc: on "}));
  const nlohmann::ordered_json report = shell.json("c/report.json");
  const nlohmann::ordered_json& map = report.at("toolchains");
  std::map<std::size_t, nlohmann::ordered_json> differs;
  for (const auto& rate : report.at("rates")) {
    if (rate.at("stratum").is_null()) differs[rate.at("lane")] = rate.at("differs_from_cpu");
  }
  std::size_t compared = 0, differing = 0;
  for (const auto& row : map.at("rows")) {
    for (const auto& cell : row.at("cells")) {
      if (differs[cell.at("lane")].is_null()) continue;
      EXPECT_EQ(cell.at("differs"), differs[cell["lane"]]) << row;
      ++compared;
      differing += cell.at("differs").at("count") > 0;
    }
  }
  EXPECT_GE(compared, 8u) << map;
  EXPECT_GE(differing, 4u) << map;
  expect_done("graze report --from c/report.json --out r.html && cmp r.html c/report.html");
  for (const char* place : {"/toolchains/rows/0/cells/1/wrong/count", "/toolchains/rows/0/cells/0/variant",
                            "/toolchains/rows/0/cells/0/lane"}) {
    nlohmann::ordered_json other = report;
    const nlohmann::ordered_json::json_pointer at(place);
    other[at] = other[at].get<std::uint64_t>() + 1;
    std::ofstream(shell.folder / "other.json") << sealed(other);
    expect_error("graze report --from other.json --out r.html", 1, {"other.json"});
  }
}

// Every verb that reads a campaign's JSON refuses counts that another program changed, and names the file.
TEST_F(Report, CountsThatCannotBeAreRefused) {
  expect_done(std::string(kFuzz) + "--out c > /dev/null && graze minimize c > /dev/null && graze report c");
  const nlohmann::ordered_json summary = shell.json("c/summary.json");
  const auto write = [&](const char* file, const nlohmann::ordered_json& json) {
    const bool is_summary = file == std::string("c/summary.json");  // checked against the database
    std::ofstream(shell.folder / file) << (is_summary ? json.dump(1) + '\n' : sealed(json));
  };
  const std::string readers[] = {"report c",   "report --compare c c",    "failures c",
                                 "minimize c", "corpus add c --corpus r", "dump c"};
  for (const char* place : {"/strata/degenerate/lanes/moller_1997~1f32~1cpu/false_negative", "/strata/thesis/pairs",
                            "/disagreements", "/signatures/0/count", "/spec/seed", "/build/version"}) {
    nlohmann::ordered_json other = summary;
    const nlohmann::ordered_json::json_pointer at(place);
    other[at] = other[at].is_string() ? nlohmann::ordered_json("x")
                                      : nlohmann::ordered_json(other[at].get<std::uint64_t>() + 1200);
    write("c/summary.json", other);
    for (const std::string& reader : readers) {
      if (&reader != &readers[0] && place != std::string("/disagreements")) continue;
      expect_error("graze " + reader, 1, {"c/summary.json", "campaign.sqlite"});
    }
  }
  write("c/summary.json", summary);
  nlohmann::ordered_json kinds = shell.json("c/failures.json"), more = kinds;
  more["kinds"][0]["pairs"] = more["kinds"][0]["pairs"].get<std::uint64_t>() + 1;
  write("c/failures.json", more);
  expect_error("graze failures c", 1, {"c/failures.json", "graze minimize"});
  // Missing kinds, and lanes, strata and margins that do not exist, are refused, so no failure is hidden or invented.
  const auto refused = [&](const std::string& found) {
    for (const char* reader : {"failures c", "report c", "report --compare c c"})
      expect_error(std::string("graze ") + reader, 1, {"c/failures.json", found, "graze minimize c"});
  };
  more = kinds;
  more["kinds"] = nlohmann::ordered_json::array();
  write("c/failures.json", more);
  refused("no kind with moller_1997/f32/cpu");
  for (const auto& [field, value, found] : {std::tuple<const char*, nlohmann::ordered_json, const char*>(
                                                "lanes", {"x"}, "the lane \"x\", which is not an examined"),
                                            {"strata", {{"lattice", 99}}, "whose strata"},
                                            {"margins", {{"banana", kinds["kinds"][0]["pairs"]}}, "whose margins"}}) {
    more = kinds;
    more["kinds"][0][field] = value;
    write("c/failures.json", more);
    refused(found);
  }
  expect_done("head -c 300 c/failures.json > k; cp k c/failures.json");
  refused("damaged");
  write("c/failures.json", kinds);
  expect_done("graze failures c > /dev/null");
  // The checksum reveals changes to texts, which no count can reveal.
  for (const std::string file : {"failures.json", "timings.json", "costs.json", "report.json"}) {
    const std::string reader =
        file == "failures.json" || file == "timings.json" ? "report c" : "report --from c/report.json --out r.html";
    expect_done("cp c/" + file + " k && sed -i '0,/\": *\"/s//\": \"x/' c/" + file);  // in the first text
    expect_done("! cmp -s k c/" + file);
    expect_error("graze " + reader, 1, {"c/" + file, "changed or damaged"});
    expect_done("cp k c/" + file);
  }

  const std::string timed = shell.file("c/timings.json");
  nlohmann::ordered_json timings = nlohmann::ordered_json::parse(timed), costs;
  for (nlohmann::ordered_json& run : timings["runs"]) {
    if (run.contains("costs")) run["costs"]["lanes"]["exact/f32/cpu"]["thesis"]["middle"] = -1;
  }
  write("c/timings.json", timings);
  expect_error("graze report c", 1, {"c/timings.json", "exact/f32/cpu", "thesis"});
  timings = nlohmann::ordered_json::parse(timed);
  timings["runs"][0]["pairs"] = -1;
  write("c/timings.json", timings);
  expect_error("graze report c", 1, {"c/timings.json", "-1"});
  // A damaged file is reported, and is neither removed nor overwritten.
  std::ofstream(shell.folder / "c/timings.json") << timed.substr(0, timed.size() - 30);
  for (const char* verb : {"report c", "minimize c", "merge c --out m"})
    expect_error(std::string("graze ") + verb, 1, {"c/timings.json", "damaged", "remove it"});
  expect_done(std::string(kFuzz) + "--out c 2>&1 | grep 'c/timings.json: it has been changed or damaged'");
  EXPECT_EQ(shell.file("c/timings.json"), timed.substr(0, timed.size() - 30));
  EXPECT_TRUE(std::filesystem::exists(shell.folder / "c/costs.json"));
  std::ofstream(shell.folder / "c/timings.json") << timed;
  costs = shell.json("c/costs.json");
  for (const auto& [field, value] : {std::pair("middle", -1), {"pairs", 1'000'000}}) {
    nlohmann::ordered_json other = costs;
    other["rows"][0][field] = value;
    write("c/costs.json", other);
    expect_error("graze report --from c/report.json --out r.html", 1, {"c/costs.json"});
  }
  write("c/costs.json", costs);
  expect_done(std::string(kFuzz) + "--seed 2 --out other && graze report other && cp other/costs.json c/costs.json");
  expect_error("graze report --from c/report.json --out r.html", 1, {"c/costs.json", "another report"});
  write("c/costs.json", costs);

  nlohmann::ordered_json report = shell.json("c/report.json");
  for (const char* part : {"count", "of", "share"}) {
    nlohmann::ordered_json other = report;
    other["rates"][0]["wrong"][part] = 12345678;
    write("r.json", other);
    expect_error("graze report --from r.json --out r.html", 1, {"r.json"});
  }
  // Thresholds must follow from the margins, and each margin must occur once.
  const nlohmann::ordered_json all_strata = nullptr;
  std::size_t threshold = 0;
  while (report["thresholds"][threshold]["stratum"] != all_strata ||
         report["thresholds"][threshold]["group"] != all_strata)
    ++threshold;
  const auto expect_margins = [&](const std::string& place, const nlohmann::ordered_json& value, const char* said) {
    nlohmann::ordered_json other = report;
    nlohmann::ordered_json& changed = other[nlohmann::ordered_json::json_pointer(place)];
    ASSERT_NE(changed, value);
    changed = value;
    write("r.json", other);
    expect_error("graze report --from r.json --out r.html", 1, {"r.json", said});
  };
  expect_margins(fmt::format("/thresholds/{}/disjoint/exponent", threshold), -31, "follows from the margins");
  expect_margins("/margins/0/points/0/side", "nonsense", "a side and an exponent");
  const nlohmann::ordered_json& points = report["margins"][0]["points"];
  ASSERT_EQ(points[0]["side"], points[1]["side"]);
  expect_margins("/margins/0/points/1/exponent", points[0]["exponent"], "each margin once");
  report["strata"][0]["pairs"] = 1;
  write("r.json", report);
  expect_error("graze report --from r.json --out r.html", 1, {"r.json", "3000"});

  // Deeply nested JSON must not overflow the stack, with or without the database.
  const std::string text = shell.file("c/summary.json");
  const auto expect_too_deep = [&] {
    std::ofstream(shell.folder / "c/summary.json")
        << text.substr(0, text.rfind('}')) << R"(,"x":)" << std::string(60'000, '[') << std::string(60'000, ']') << '}';
    for (const std::string& reader : readers)
      expect_error("graze " + reader, 1, {"c/summary.json", "not the summary of a campaign"});
    std::ofstream(shell.folder / "c/summary.json") << text;
  };
  expect_too_deep();

  // Without its database, a summary can only be checked against itself.
  std::filesystem::remove(shell.folder / "c/campaign.sqlite");
  expect_done("graze report c | grep 'checked only against each other'");
  expect_too_deep();
  using Words = std::vector<std::string>;
  for (const auto& [place, value, words] :
       {std::tuple("/strata/degenerate/lanes/moller_1997~1f32~1cpu/false_negative", nlohmann::ordered_json(1230),
                   Words{"degenerate", "1230"}),
        {"/strata/degenerate/lanes/moller_1997~1f32~1cpu/declined", 1001, {"moller_1997/f32/cpu", "declined", "1001"}},
        {"/strata/degenerate/intersects", 1001, {"degenerate", "intersect", "1000", "1001"}},
        {"/strata/degenerate/pairs", 1001, {"degenerate", "margin", "1001", "1000"}},
        {"/spec/pairs", 2999, {"pairs", "2999", "3000"}},
        {"/strata/degenerate/intersects", 600, {"degenerate", "intersect", "by margin", "600"}},
        {"/strata/degenerate/lanes/moller_1997~1f32~1cpu/differs_from_cpu", 1, {"degenerate", "differs_from_cpu"}},
        {"/spec/seed", -1, {"seed", "-1"}},
        {"/spec/seed", 1.5, {"seed", "1.5"}},
        {"/spec/seed", std::uint64_t{1} << 60, {"seed", "2^53"}},
        {"/build/commit", 5, {"commit", "5"}},
        {"/build/cuda", -5, {"cuda", "-5"}},
        {"/disagreements", 0, {"disagreements", "0"}},
        {"/disagreements", 3001, {"disagreements", "3001"}},
        {"/signatures", nlohmann::ordered_json::array(), {"moller_1997/f32/cpu", "by signature", "0"}},
        {"/signatures/1", summary["signatures"][0], {"signature", "twice"}},
        {"/signatures/0/count", 1, {"moller_1997/f32/cpu", "by signature"}},
        {"/signatures/0/count", 3001, {"signature", "3000", "3001"}}}) {
    nlohmann::ordered_json other = summary;
    other[nlohmann::ordered_json::json_pointer(place)] = value;
    write("c/summary.json", other);
    expect_error("graze report c", 1, {"c/summary.json"});
    expect_error("graze failures c", 1, words);
  }
}

// If a record is replaced by a pipe, no verb waits for the pipe. No verb replaces another program's file.
TEST_F(Report, PipesAndForeignFilesAmongTheRecordsAreRefused) {
  const std::string fuzz = "graze fuzz --pairs 300 --lanes moller_1997/f32/cpu --strata near_vertex_face --out c";
  expect_done(fuzz + " > /dev/null && graze minimize c > /dev/null && graze report c");
  const std::string first = shell("basename $(ls c/cases/*.maps.json | head -n 1) .maps.json").out,
                    hash = first.substr(0, first.size() - 1);
  const std::string verbs[] = {"graze report c", "graze minimize c", fuzz, "graze status c", "graze merge c --out m"};
  std::size_t refused = 0;
  for (const std::string& file :
       {std::string("summary.json"), std::string("campaign.sqlite"), std::string("timings.json"),
        std::string("failures.json"), std::string("costs.json"), std::string("status.json"), "cases/" + hash + ".pairs",
        "cases/" + hash + ".maps.json"}) {
    expect_done("mv c/" + file + " kept && mkfifo c/" + file);
    bool named = false;
    for (const std::string& verb : verbs) {
      const Ran ran = shell("timeout 60 " + verb);
      EXPECT_TRUE(ran.status <= 2) << verb << ' ' << file << ' ' << ran.status;  // 124 if it waited
      named = named || (ran.status != 0 && ran.err.find(file) != ran.err.npos);
      refused += ran.status != 0;
    }
    EXPECT_TRUE(named) << file;
    expect_done("rm -rf m && mv kept c/" + file);
  }
  EXPECT_GT(refused, 15u);

  // Another program's files below cases/ are kept.
  const std::string pairs = "c/cases/" + hash + ".pairs", maps = "c/cases/" + hash + ".maps.json";
  expect_done("cp " + pairs + " kept && echo mine > " + pairs);
  expect_error(fuzz, 2, {pairs, "--force"});
  EXPECT_EQ(shell.file(pairs), "mine\n");
  expect_done("cp kept " + pairs + " && echo '{\"a\": 1}' > " + maps);
  expect_error("graze minimize c --again", 2, {maps, "--force"});
  EXPECT_EQ(shell.file(maps), "{\"a\": 1}\n");
  expect_done("rm " + maps + " && graze minimize c");
  // A truncated result of Graze is recognised and replaced.
  expect_done("truncate -s -30 c/costs.json && graze report c && graze report --from c/report.json --out r.html");
}

// SQLite would write to files with these names, or delete them.
TEST_F(Report, ForeignFilesBesideTheDatabaseStay) {
  const std::string fuzz = "graze fuzz --pairs 300 --lanes moller_1997/f32/cpu --strata uniform --out c";
  expect_done(fuzz);
  for (const char* suffix : {"-wal", "-shm", "-journal"}) {
    const std::string file = std::string("c/campaign.sqlite") + suffix;
    for (const char* make : {"echo mine > mine && cp mine ", "echo mine > mine && ln mine ", ": > mine && ln mine "}) {
      expect_done(make + file);
      expect_error(fuzz, 1, {file, "move it away"});
      if (suffix == std::string_view("-wal")) {
        expect_error("graze report c", 1, {file, "move it away"});
      }
      expect_done("cmp mine " + file);
      expect_done(fuzz + " --discard-damaged && cmp mine " + file + ".damaged && rm " + file + ".damaged");
    }
  }
  expect_done(fuzz);
  // A journal that another database's killed transaction left would be rolled back into this database.
  const std::string file = "c/campaign.sqlite-journal";
  expect_done(
      "cp c/campaign.sqlite kept && cp kept o && python3 -c '\nimport shutil, sqlite3\n"
      "base = sqlite3.connect(\"o\", isolation_level=None)\n"
      "for command in (\"pragma journal_mode = delete\", \"pragma cache_size = 1\", \"begin immediate\",\n"
      "                \"update batch set counts = zeroblob(length(counts))\",\n"
      "                \"create table big as with recursive n(i) as (select 1 union all select i + 1 from n limit "
      "99)\"\n"
      "                \" select randomblob(3000) from n\"): base.execute(command).fetchall()\n"
      "shutil.copy(\"o-journal\", \"" +
      file + "\")'");
  expect_done("test -s " + file + " && cp " + file + " mine");
  expect_error(fuzz, 1, {file, "move it away"});
  expect_done("cmp kept c/campaign.sqlite && cmp mine " + file);
  expect_done(fuzz + " --discard-damaged && cmp mine " + file + ".damaged && graze report c");
}

// A trigger in the database could delete rows although the run reports that it is done.
TEST_F(Report, OtherTablesAndTriggersAreRefused) {
  const std::string fuzz = "graze fuzz --pairs 300 --lanes moller_1997/f32/cpu --strata uniform --out c";
  for (const char* edit : {"delete from batch; create trigger t after insert on batch begin delete from batch; end",
                           "create table more(x)", "create view v as select 1", "drop table batch"}) {
    expect_done("rm -rf c; " + fuzz +
                " > /dev/null && python3 -c 'import sqlite3; sqlite3.connect(\"c/campaign.sqlite\")"
                ".executescript(\"" +
                edit + "\")'");
    for (const std::string& verb : {fuzz, std::string("graze report c"), std::string("graze merge c --out m")})
      expect_error(verb, 1, {"campaign.sqlite", "tables"});
  }
}

// In a campaign's folder, status.json is Graze's own file: a damaged one is replaced and stops no campaign.
TEST_F(Report, ADamagedStatusIsReplaced) {
  const std::string fuzz = "graze fuzz --pairs 300 --lanes moller_1997/f32/cpu --strata uniform --out c";
  expect_done(fuzz);
  for (const char* text : {"{}", "[]", "plain text", ""}) {
    std::ofstream(shell.folder / "c/status.json") << text;
    expect_error("graze status c", 1, {"c/status.json", "damaged", "the next run"});
    expect_done(fuzz);
    expect_done("graze status c | grep ' done '");
  }
  expect_done("echo precious > theirs && ln -sf ../theirs c/status.json");
  expect_error(fuzz, 2, {"c/status.json", "link"});
  EXPECT_EQ(shell.file("theirs"), "precious\n");
}

TEST_F(Report, SameBytesWhateverTheThreads) {
  expect_done(std::string(kFuzz) + "--threads 1 --out one > /dev/null && graze minimize one && graze report one");
  // Lane costs differ from run to run; only costs.json and the page contain them.
  expect_done(std::string(kFuzz) +
              "--threads 2 --out two > /dev/null && graze minimize two && cp one/timings.json two && graze report two");
  expect_done(
      "for f in report.html report.json costs.json rates.csv margins.csv thresholds.csv extremes.csv signatures.csv "
      "failures.json; do "
      "test -s one/$f && cmp one/$f two/$f || exit 1; done");
  const nlohmann::json report = json("one/report.json");
  ASSERT_GT(report["cards"].size(), 10u);
  for (const auto& card : report["cards"]) {
    EXPECT_EQ(card["minimised"], true);
    EXPECT_FALSE(card["sentences"].empty());
    EXPECT_EQ(card["verdicts"].size(), report["lanes"].size());
    EXPECT_EQ(card["kind"]["settled"].size(), 2u);
    // The card's commands run and confirm its statements.
    if (&card != &report["cards"][0]) continue;
    for (const auto& command : card["commands"]) {
      EXPECT_EQ(shell(command["text"].get<std::string>() + " > said").status, 0) << command["text"];
    }
  }
  // The page made from the stored data has the same bytes.
  expect_done("graze report --from one/report.json --out page.html && cmp page.html one/report.html");
}

TEST_F(Report, TheCommandItNamesRunsTheCampaignAgain) {
  expect_done(std::string(kFuzz) + "--out one > /dev/null && graze report one");
  expect_done(json("one/report.json")["run"]["command"].get<std::string>() + " > /dev/null");
  const nlohmann::json one = json("one/summary.json"), again = json("campaign/summary.json");
  EXPECT_EQ(one["spec"], again["spec"]);
  EXPECT_EQ(one["strata"], again["strata"]);
}

TEST_F(Report, ComparesTwoCampaigns) {
  for (const char* seed : {"1", "2"})
    expect_done(
        fmt::format("{0} --seed {1} --out seed{1} > /dev/null && graze minimize seed{1} > /dev/null", kFuzz, seed));
  const Ran said = shell.done("graze report --compare seed1 seed2");
  const nlohmann::json report = json("seed2/compare.json");
  EXPECT_TRUE(said.out.starts_with(fmt::format(
      "None of {} rates changed, and no kind of failure with at least 14 expected signatures came or went; differences "
      "under ",
      report["rates"].size())))
      << said.out;
  EXPECT_TRUE(has(said.out, {"\nThe seed differs: 1 before, 2 after.\nWrote "}));
  EXPECT_FALSE(std::filesystem::exists(shell.folder / "seed2/report.json"));
  EXPECT_EQ(report["run"]["seed"], 2);
  EXPECT_EQ(report["compare"]["other"]["seed"], 1);
  EXPECT_EQ(report["compare"]["rates"].size(), report["rates"].size());
  EXPECT_EQ(report["compare"]["kinds_compared"], true);
  expect_done("test -s seed2/compare.html && test -s seed2/compare.csv");
  // If a campaign has no kinds, the report says that kinds are not compared.
  expect_done("rm seed1/failures.json");
  EXPECT_TRUE(has(shell("graze report --compare seed1 seed2").out,
                  {"and kinds of failure are not compared; differences under "}));
}

// If the code is edited between two campaigns, the campaigns can be compared in both orders, and each page shows its
// own campaign's code.
TEST_F(Report, ComparesCodeBeforeAndAfterAnEdit) {
  for (const std::string answer : {"0", "1"}) {
    expect_done("echo 'extern \"C\" int hit(const float*, const float*) { return " + answer +
                "; }' > m.cpp && graze fuzz --subject mine=m.cpp:hit --lanes mine/f32/cpu --strata near_vertex_face "
                "--pairs 200 --out c" +
                answer + " > /dev/null && graze minimize c" + answer + " > /dev/null");
  }
  for (const char* order : {"c0 c1", "c1 c0"}) {
    const Ran said = shell.done(std::string("graze report --compare ") + order);
    EXPECT_EQ(said.err, "");
    EXPECT_TRUE(said.out.starts_with("Changed: 200 verdicts of 1 of 2 lanes: ")) << said.out;
    EXPECT_TRUE(has(said.out, {"The code of mine differs: "}));
  }
  EXPECT_EQ(json("c1/compare.json")["run"]["subjects"], json("c0/compare.json")["compare"]["other"]["subjects"]);
  const auto shows_code = [&](const char* file) { return shell.file(file).find("#include \\\"") != std::string::npos; };
  EXPECT_TRUE(shows_code("c1/compare.json"));
  EXPECT_FALSE(shows_code("c0/compare.json"));
  const Ran old = shell.done("graze report c0");
  EXPECT_EQ(old.err, "");
  EXPECT_TRUE(has(old.out, {"m.cpp:hit has changed since the campaign ran: its hash is "}));
  // If two source files have the same name, each report has only the programs for its own code.
  expect_done(
      "mkdir p && mv m.cpp p && graze fuzz --subject mine=p/m.cpp:hit --lanes mine/f32/cpu --strata "
      "near_vertex_face --pairs 200 --out cp > /dev/null && graze minimize cp > /dev/null && "
      "graze report --compare c0 cp > said && ! grep -q 'has changed' said && grep -q p/m.cpp cp/compare.json");
}

TEST_F(Report, BadUseIsOneLine) {
  expect_error("graze report", 2, {"--compare", "--from", "0"});
  expect_error("graze report none", 1, {"none", "summary.json"});
  expect_error("graze report --from x.json", 2, {"--from", "--out"});
  expect_error("echo '{}' > x.json; graze report --from x.json --out y.html", 1, {"x.json"});
  expect_error("mkdir d; echo '{\"spec\": 1, \"strata\": 2}' > d/summary.json; graze report d", 1, {"d/summary.json"});
  expect_done(std::string(kFuzz) + "--out c > /dev/null");
  expect_error("ulimit -f 40; graze report c", 1, {"c/report.json", "File too large"});
  EXPECT_FALSE(std::filesystem::exists(shell.folder / "c/report.json"));
  expect_error("rm c/cases/*; graze report c", 1, {"c/cases"});
}

}  // namespace
}  // namespace graze::cli
