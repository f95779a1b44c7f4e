// SPDX-License-Identifier: Apache-2.0
// --junit of `fuzz`, `try` and `corpus verify`, read by another program's XML parser.
#include "reports/junit.h"

#include <gtest/gtest.h>

#include "cli/run_graze.h"

namespace graze::cli {
namespace {

class Junit : public CommandTest {
 protected:
  // Returns {"suite": {"test": failure, or null}}, with skipped tests as "skipped: why".
  nlohmann::json read(const std::string& file) {
    const Ran ran = shell.done(
        "python3 -c \"import json, sys, xml.etree.ElementTree as x\n"
        "out = {}\n"
        "for suite in x.parse('" +
        file +
        "').getroot():\n"
        "    tests = out.setdefault(suite.get('name'), {})\n"
        "    assert len(suite) == int(suite.get('tests')), suite.attrib\n"
        "    assert len(suite.findall('*/failure')) == int(suite.get('failures')), suite.attrib\n"
        "    assert len(suite.findall('*/skipped')) == int(suite.get('skipped')), suite.attrib\n"
        "    for test in suite:\n"
        "        assert test.get('classname') == suite.get('name')\n"
        "        failure, skipped = test.find('failure'), test.find('skipped')\n"
        "        if failure is not None: assert failure.text.startswith(failure.get('message'))\n"
        "        tests[test.get('name')] = failure.text if failure is not None else \\\n"
        "            'skipped: ' + skipped.get('message') if skipped is not None else None\n"
        "print(json.dumps(out))\"");
    return nlohmann::json::parse(ran.out, nullptr, false);
  }
};

TEST_F(Junit, EscapesWhatXmlForbids) {
  const reports::JunitCase cases[] = {{"a<b", "x & \"y\"", "", ""},
                                      {"a<b", "z", std::string("first > 1\nsecond \x01 \xff ]]>"), ""},
                                      {"other", "s", "", "no <device>"}};
  std::ofstream(shell.folder / "t.xml") << reports::junit(cases);
  const nlohmann::json found = read("t.xml");
  EXPECT_EQ(found, (nlohmann::json{{"a<b", {{"x & \"y\"", nullptr}, {"z", "first > 1\nsecond \\x01 \\xff ]]>"}}},
                                   {"other", {{"s", "skipped: no <device>"}}}}));
}

// Each lane on each stratum is a test, which fails if the summary counts wrong verdicts, and shows a pair on which the
// lane is wrong.
TEST_F(Junit, OfACampaignHasTheCountsOfItsSummary) {
  expect_done(
      "graze fuzz --executor twin --pairs 4000 --strata 'uniform,lattice,near_edge_edge' --out c --junit r.xml "
      "--lanes 'exact/f32/cpu,moller_1997/f32/c*'");
  const nlohmann::json tests = read("r.xml");
  const auto summary = shell.json("c/summary.json");
  int failures = 0, all = 0;
  for (const std::string lane : summary["spec"]["lanes"]) {
    for (const std::string stratum : summary["spec"]["strata"]) {
      const nlohmann::json &counts = summary["strata"][stratum]["lanes"][lane], &test = tests.at(lane).at(stratum);
      const int wrong = counts["false_positive"].get<int>() + counts["false_negative"].get<int>();
      ++all;
      ASSERT_EQ(test.is_null(), wrong == 0) << lane << ' ' << stratum << test;
      if (wrong == 0) continue;
      const std::string text = test;
      std::string digits = text.substr(9, text.find(" of ") - 9);
      std::erase(digits, ',');
      EXPECT_EQ(digits, std::to_string(wrong)) << text;
      if (++failures > 6) continue;
      const std::string pair = text.substr(text.find("such as ") + 8, text.find('\n') - text.find("such as ") - 8);
      const Ran again = shell("echo '" + pair + "' > p; graze check p --json --executor twin --lanes " + lane);
      const auto verdicts = nlohmann::json::parse(again.out, nullptr, false);
      ASSERT_TRUE(verdicts.is_object()) << again.out << again.err;
      EXPECT_NE(verdicts["lanes"][lane], verdicts["truth"]["verdict"]) << again.out;
      EXPECT_EQ(shell(text.substr(text.find("Why: ") + 5)).status, 0) << text;
    }
  }
  EXPECT_GT(failures, 6);
  EXPECT_LT(failures, all);
  // A requested lane that does not run is a skipped test.
  EXPECT_TRUE(tests.contains("moller_1997/f32/cuda-fast")) << tests;
  const std::string skipped = tests.at("moller_1997/f32/cuda-fast").at("all strata");
  EXPECT_TRUE(skipped.starts_with("skipped: ")) << skipped;

  // A file that Graze did not write is kept; the campaign does not begin.
  const Ran refused = shell("echo '<testsuites/>' > mine.xml; graze fuzz --pairs 100 --out d --junit mine.xml");
  EXPECT_EQ(refused.status, 2) << refused.err;
  EXPECT_EQ(shell("cat mine.xml; ls d").out, "<testsuites/>\n");
  EXPECT_EQ(shell("graze fuzz --pairs 100 --out d --junit .").status, 1);
  EXPECT_FALSE(std::filesystem::exists(shell.folder / "d"));
  expect_done("graze fuzz --pairs 100 --lanes exact/f32/cpu --out e --junit r.xml");
  EXPECT_EQ(read("r.xml").size(), 1u);
  EXPECT_EQ(shell("graze fuzz --pairs 100 --shard 1/2 --out f --junit s.xml").status, 2);
}

TEST_F(Junit, OfTryAndOfACorpus) {
  shell("echo 'bool meet(const float* a, const float* b) { return a[0] < b[0]; }' > own.cpp");
  expect_done("graze try own.cpp:meet --pairs 500 --junit t.xml");
  const nlohmann::json tests = read("t.xml");
  EXPECT_TRUE(tests.at("exact/f32/cpu").at("uniform").is_null());
  EXPECT_TRUE(tests.at("own/f32/cpu").at("uniform").is_string()) << tests;

  ASSERT_EQ(shell("graze fuzz --executor twin --pairs 2000 --strata lattice --lanes '*/f32/cpu' --out c && "
                  "graze corpus add c --top 2 --lanes '*/f32/cpu'")
                .status,
            0);
  const std::string verify = "graze corpus verify --lanes '*/f32/cpu' --junit v.xml";
  expect_done(verify);
  const auto passed = read("v.xml").at("corpus/regression/cases.pairs");
  EXPECT_GT(passed.size(), 4u);
  for (const auto& [name, failure] : passed.items()) EXPECT_TRUE(failure.is_null()) << name;
  // A verdict that differs from the record.
  shell("sed -i '0,/moller_1997:[.]f32/ s/moller_1997:[.]f32/moller_1997:-f32/' corpus/regression/cases.pairs");
  const Ran changed = shell(verify);
  const auto failed = read("v.xml").at("corpus/regression/cases.pairs");
  const auto failures = std::count_if(failed.begin(), failed.end(), [](const auto& test) { return test.is_string(); });
  EXPECT_EQ(changed.status, 1) << changed.out << changed.err;
  EXPECT_EQ(failures, 1) << failed;
}

}  // namespace
}  // namespace graze::cli
