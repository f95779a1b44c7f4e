// SPDX-License-Identifier: Apache-2.0
#include "cli/cases.h"

#include "core/error.h"
#include "core/text.h"
#include "strata/pair_source.h"

namespace graze::cli {
namespace {

std::uint64_t number(const std::string& text, const std::string& name) {
  const std::optional<std::uint64_t> value = parse_whole(text);
  if (!value) throw UsageError(name + ": expected a whole number, found '" + text + "'");
  return *value;
}

}  // namespace

std::vector<corpus::Entry> read_cases(const std::string& name) {
  const std::size_t first = name.find(':'), last = name.rfind(':');
  if (first == std::string::npos || first == last || name.find('/') != std::string::npos) {
    std::vector<corpus::Entry> entries = corpus::read_pairs(name);
    if (entries.empty()) throw std::runtime_error(name + ": expected at least one case, found none");
    return entries;
  }
  const std::string stratum = name.substr(0, first), seed = name.substr(first + 1, last - first - 1),
                    index = name.substr(last + 1);
  const std::vector<strata::PairSource> sources = strata::stratum_sources(number(seed, name), 1, {stratum});
  if (sources.size() != 1) throw UsageError(name + ": expected one stratum, found a pattern of several");
  return {{sources.front().pair(number(index, name)), {{"stratum", stratum}, {"seed", seed}, {"index", index}}, 0}};
}

}  // namespace graze::cli
