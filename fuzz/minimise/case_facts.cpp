// SPDX-License-Identifier: Apache-2.0
#include "fuzz/minimise/case_facts.h"

#include <algorithm>
#include <sstream>

#include "analysis/explain.h"
#include "fuzz/campaign/result_files.h"

namespace graze::fuzz {

const corpus::Entry& shown_case(const std::vector<corpus::Entry>& entries) {
  const auto found = std::find_if(entries.begin(), entries.end(), [](const corpus::Entry& entry) {
    const std::string* kind = corpus::field(entry, "kind");
    return kind && *kind == "minimised";
  });
  return found == entries.end() ? entries.front() : *found;
}

std::string pair_text(const Pair& pair) {
  std::ostringstream out;
  corpus::write_entry(out, {pair});
  const std::string line = out.str();
  return line.substr(0, line.find('\n'));
}

std::filesystem::path facts_file(const std::filesystem::path& case_file) {
  return std::filesystem::path(case_file).replace_extension(".json");
}

Json case_facts(const LanesUnderTest& under_test, const corpus::Entry& entry) {
  std::vector<const Lane*> apart, to_explain;
  const std::vector<Verdict> verdicts = decide(under_test, entry.pair, apart);
  if (!apart.empty())
    throw std::runtime_error(apart.front()->id + ": expected one verdict of device and twin, found two");
  const std::string* signature = corpus::field(entry, "signature");
  Json facts = {{"pair", pair_text(entry.pair)}, {"verdicts", Json::object()}};
  for (std::size_t l = 0; l < under_test.lanes.size(); ++l) {
    facts["verdicts"][under_test.lanes[l]->id] = name(verdicts[l]);
    if (signature && under_test.lanes[l]->info->id == analysis::subject_of(*signature))
      to_explain.push_back(under_test.lanes[l]);
  }
  facts["sentences"] = analysis::sentences(analysis::explain(entry.pair, to_explain));
  return facts;
}

void store_facts(const LanesUnderTest& under_test, const std::filesystem::path& case_file) {
  const std::vector<corpus::Entry> entries = corpus::read_pairs(case_file);
  if (entries.empty()) throw corpus::FormatError(case_file.string() + ": expected at least one case, found none");
  const corpus::Entry& shown = shown_case(entries);
  const Json before = Json::parse(read_whole(facts_file(case_file)), nullptr, false);
  if (before.is_object() && before.value("pair", Json()) == pair_text(shown.pair) && before.contains("verdicts")) {
    const Json& verdicts = before["verdicts"];
    const bool same_lanes = verdicts.size() == under_test.lanes.size() &&
                            std::all_of(under_test.lanes.begin(), under_test.lanes.end(),
                                        [&](const Lane* l) { return verdicts.contains(l->id); });
    if (same_lanes) return;
  }
  write_whole(facts_file(case_file), case_facts(under_test, shown).dump(1) + "\n");
}

}  // namespace graze::fuzz
