// SPDX-License-Identifier: Apache-2.0
// `graze tune --from`: makes the choice on a campaign's disagreements.
#include <fmt/format.h>

#include "backends/backends.h"
#include "cli/tune.h"
#include "core/cannot.h"
#include "core/error.h"
#include "fuzz/counts_json.h"
#include "reports/terminal.h"

namespace graze::cli {

void expect_errors_of(const std::string& directory, const fuzz::Json& campaign, const analysis::TuneSpec& spec,
                      const std::string& lane) {
  const fuzz::Json& strata = campaign.at("strata");
  for (const strata::PairSource& source : spec.sources) {
    const fuzz::Json& lanes = strata.at(source.id).at("lanes");
    if (!lanes.contains(lane)) throw UsageError(cannot("tune on", directory, "it did not run " + lane));
    const Counts counted = fuzz::counts_of(lanes[lane]),
                 now = spec.sweep(std::vector<std::string>{""}, {&source, 1}).front();
    if (!(counted == now))
      throw std::runtime_error(
          cannot("tune on", directory,
                 fmt::format("it counted {} wrong verdicts of {} in {}, but these pairs now show {}; it ran other "
                             "code, or its record was changed",
                             reports::grouped(counted.wrong()), lane, source.id, reports::grouped(now.wrong()))));
  }
}

std::string changes_csv(const Lane& lane, const analysis::DecideUnder& own_code, const analysis::TuneSpec& spec,
                        const analysis::Tuned& tuned, std::uint64_t seed, int threads) {
  std::vector<std::string> policies = {""};
  for (const analysis::PolicyErrors* best : analysis::best_of_curves(tuned.curves, spec.forbid, spec.max_rate)) {
    if (!best->changes_nothing() && (own_code || backends::on_host(lane_under(lane, best->policy))))
      policies.push_back(best->policy);
  }
  const analysis::NotRightPairs found = own_code ? analysis::not_right_pairs(own_code, policies, spec.sources, threads)
                                                 : analysis::not_right_pairs(lane, policies, spec.sources, threads);
  std::string csv = kChangesHeader;
  for (const analysis::NotRightPair& pair : found.first) {
    const Verdict truth = pair.intersects ? Verdict::intersects : Verdict::disjoint;
    const std::string place = fmt::format("{},{},{},{}", spec.sources[static_cast<std::size_t>(pair.place.source)].id,
                                          seed, pair.place.index, name(truth));
    const bool was_right = pair.verdicts[0] == truth;
    if (!was_right) csv += place + ",none,wrong\n";
    for (std::size_t p = 1; p < policies.size(); ++p) {
      const bool right = pair.verdicts[p] == truth;
      if (right != was_right) csv += fmt::format("{},{},{}\n", place, policies[p], right ? "fixes" : "breaks");
    }
  }
  if (found.first.size() < found.count)
    fmt::print("changes.csv lists the first {} of {} pairs.\n", reports::grouped(found.first.size()),
               reports::grouped(found.count));
  return csv;
}

}  // namespace graze::cli
